//! The JSON Schema of scenes, and the scene reference made of it.

use std::fmt::Write;
use std::sync::OnceLock;

use serde_json::{Map, Value as Json};

use super::document::Scene;

/// The JSON Schema (draft 2020-12) of a scene file.
pub fn schema() -> &'static Json {
    static SCHEMA: OnceLock<Json> = OnceLock::new();
    SCHEMA.get_or_init(|| schemars::schema_for!(Scene).to_value())
}

/// The scene reference in Markdown: every table, its keys, their types and ranges, and what they mean.
#[must_use]
pub fn schema_markdown() -> String {
    let schema = schema();
    let mut text = String::from(
        "# Scene reference\n\nMade by `lichtenberg schema --markdown` from the schema that scenes are checked against.\n",
    );
    section(&mut text, "Scene", schema);
    for (name, definition) in schema.get("$defs").and_then(Json::as_object).into_iter().flatten() {
        section(&mut text, name, definition);
    }
    text
}

fn section(text: &mut String, name: &str, schema: &Json) {
    let _ = write!(text, "\n## {name}\n\n{}\n", description(schema));
    if let Some(keys) = schema.get("properties").and_then(Json::as_object) {
        table(text, keys, schema);
    }
    let choices = ["oneOf", "anyOf"].into_iter().find_map(|k| schema.get(k)?.as_array());
    let mut first = true;
    for choice in choices.into_iter().flatten() {
        if std::mem::take(&mut first) {
            text.push_str("\nOne of:\n\n");
        }
        let tag = choice.get("properties").and_then(Json::as_object).and_then(|p| p.iter().next());
        let words: Vec<String> = choice
            .get("const")
            .into_iter()
            .chain(choice.get("enum").and_then(Json::as_array).into_iter().flatten())
            .map(|w| format!("`{w}`"))
            .collect();
        match tag {
            Some((tag, inner)) => {
                let _ = writeln!(text, "- `{tag}`: {}; {}", kind(inner), one_line(choice));
                for (key, value) in inner.get("properties").and_then(Json::as_object).into_iter().flatten() {
                    let must = if is_required(inner, key) { ", needed" } else { "" };
                    let _ = writeln!(text, "  - `{key}` ({}{must}): {}", kind(value), one_line(value));
                }
            }
            None if !words.is_empty() => {
                let _ = writeln!(text, "- {}: {}", words.join(", "), one_line(choice));
            }
            None => {
                let _ = writeln!(text, "- {}", kind(choice));
            }
        }
    }
}

fn table(text: &mut String, keys: &Map<String, Json>, schema: &Json) {
    text.push_str("\n| key | type | default | |\n| --- | --- | --- | --- |\n");
    for (key, value) in keys {
        let default = match value.get("default") {
            _ if is_required(schema, key) => "needed".to_owned(),
            None | Some(Json::Null) => String::new(),
            Some(default) => format!("`{default}`"),
        };
        let _ = writeln!(text, "| `{key}` | {} | {default} | {} |", kind(value), one_line(value));
    }
}

fn is_required(schema: &Json, key: &str) -> bool {
    let required = schema.get("required").and_then(Json::as_array);
    required.is_some_and(|r| r.iter().any(|k| k == key))
}

fn description(schema: &Json) -> &str {
    schema.get("description").and_then(Json::as_str).unwrap_or("")
}

fn one_line(schema: &Json) -> String {
    description(schema).split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

/// A type in words, with a link where it has a section of its own.
fn kind(schema: &Json) -> String {
    if let Some(path) = schema.get("$ref").and_then(Json::as_str) {
        let name = path.rsplit('/').next().unwrap_or(path);
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(choices) = schema.get("anyOf").and_then(Json::as_array) {
        let kinds: Vec<_> = choices.iter().map(kind).filter(|k| k != "null").collect();
        return kinds.join(" or ");
    }
    if let Some(listed) = schema.get("enum").and_then(Json::as_array) {
        return listed.iter().map(|v| format!("`{v}`")).collect::<Vec<_>>().join(", ");
    }
    let name = match schema.get("type") {
        Some(Json::String(name)) => name.as_str(),
        Some(Json::Array(names)) => names.iter().filter_map(Json::as_str).find(|n| *n != "null").unwrap_or(""),
        _ => "",
    };
    match name {
        "array" => format!("list of {}", schema.get("items").map_or("anything".to_owned(), kind)),
        "object" => match schema.get("additionalProperties") {
            Some(inner @ Json::Object(_)) => format!("table of {} by name", kind(inner)),
            _ => "table".to_owned(),
        },
        "string" => "text".to_owned(),
        "integer" | "number" => {
            let bound = |key: &str, word: &str| schema.get(key).and_then(Json::as_f64).map(|b| format!("{word}{b}"));
            let bounds: Vec<_> = [("exclusiveMinimum", "> "), ("minimum", ">= "), ("maximum", "<= ")]
                .into_iter()
                .filter_map(|(key, word)| bound(key, word))
                .collect();
            let name = if name == "integer" { "whole number" } else { "number" };
            if bounds.is_empty() { name.to_owned() } else { format!("{name} {}", bounds.join(", ")) }
        }
        "boolean" => "true or false".to_owned(),
        "null" => "null".to_owned(),
        _ => "anything".to_owned(),
    }
}
