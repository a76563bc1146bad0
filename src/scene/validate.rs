//! Holds a scene's tree beside the project's own JSON Schema and collects every mistake.

use serde_json::{Map, Value as Json};

use super::mistake::{Mistake, Span};
use super::tree::{Entry, Value};
use crate::math::unknown;

/// Adds what is wrong with `root` under `schema`.
pub(super) fn validate(root: &Entry, schema: &Json, mistakes: &mut Vec<Mistake>) {
    Walk { schema, mistakes }.check(root, schema, "");
}

struct Walk<'a> {
    schema: &'a Json,
    mistakes: &'a mut Vec<Mistake>,
}

impl<'a> Walk<'a> {
    /// The schema itself, or what its `$ref` names.
    fn follow(&self, schema: &'a Json) -> &'a Json {
        let mut schema = schema;
        while let Some(path) = schema.get("$ref").and_then(Json::as_str) {
            let Some(next) = self.schema.pointer(path.trim_start_matches('#')) else { break };
            schema = next;
        }
        schema
    }

    fn wrong(&mut self, entry: &Entry, place: &str, message: String) {
        self.mistakes.push(Mistake {
            span: entry.span.clone().or(entry.key_span.clone()),
            place: place.to_owned(),
            message,
        });
    }

    fn check(&mut self, entry: &Entry, schema: &'a Json, place: &str) {
        let schema = self.follow(schema);
        if let Some(choices) = schema.get("oneOf").and_then(Json::as_array) {
            return self.check_choice(entry, choices, place);
        }
        if let Some(choices) = schema.get("anyOf").and_then(Json::as_array) {
            let fits = choices.iter().map(|c| self.follow(c)).find(|c| self.accepts(c, &entry.value));
            return match fits {
                Some(choice) => self.check(entry, choice, place),
                None => {
                    let wanted: Vec<_> =
                        choices.iter().map(|c| self.wanted(self.follow(c))).filter(|w| w != "nothing").collect();
                    self.wrong(entry, place, format!("expected {}, found {}", wanted.join(" or "), entry.value.kind()));
                }
            };
        }
        if !self.accepts(schema, &entry.value) {
            let message = format!("expected {}, found {}", self.wanted(schema), entry.value.kind());
            return self.wrong(entry, place, message);
        }
        match &entry.value {
            Value::Table(table) => {
                if let Json::Object(schema) = schema {
                    self.check_table(entry, table, schema, place);
                }
            }
            Value::Array(items) => self.check_array(entry, items, schema, place),
            Value::Integer(number) => self.check_number(entry, *number as f64, schema, place),
            Value::Float(number) => self.check_number(entry, *number, schema, place),
            Value::String(text) => {
                self.check_listed(entry, &Json::from(text.as_str()), schema, place);
                if text.is_empty() && schema.get("minLength").is_some() {
                    self.wrong(entry, place, "expected some text, found none".to_owned());
                }
            }
            Value::Boolean(_) | Value::Other(_) => {}
        }
    }

    /// An enum: a word alone, or a table with the word as its only key.
    fn check_choice(&mut self, entry: &Entry, choices: &'a [Json], place: &str) {
        let words: Vec<String> = choices.iter().flat_map(|c| words(self.follow(c))).collect();
        let tagged: Vec<(&'a String, &'a Json)> =
            choices.iter().filter_map(|c| self.follow(c).get("properties")?.as_object()?.iter().next()).collect();
        let listed = || {
            let tags = tagged.iter().map(|(tag, _)| format!("{{ {tag} = ... }}"));
            words.iter().map(|w| format!("\"{w}\"")).chain(tags).collect::<Vec<_>>().join(", ")
        };
        match &entry.value {
            Value::String(word) if words.contains(word) => {}
            Value::String(word) if !words.is_empty() => {
                let message = unknown("choice", word, words.iter());
                self.wrong(entry, place, message);
            }
            Value::Table(table) if !tagged.is_empty() => {
                for (key, value) in table {
                    let inner = join(place, key);
                    match tagged.iter().find(|(tag, _)| *tag == key) {
                        Some((_, schema)) => self.check(value, schema, &inner),
                        None => {
                            let message = unknown("choice", key, tagged.iter().map(|(tag, _)| *tag));
                            self.wrong_key(value, &inner, message);
                        }
                    }
                }
                if table.len() != 1 {
                    self.wrong(entry, place, format!("expected exactly one of {}, found {}", listed(), table.len()));
                }
            }
            value => {
                let message = format!("expected one of {}, found {}", listed(), value.kind());
                self.wrong(entry, place, message);
            }
        }
    }

    fn wrong_key(&mut self, entry: &Entry, place: &str, message: String) {
        self.mistakes.push(Mistake {
            span: entry.key_span.clone().or(entry.span.clone()),
            place: place.to_owned(),
            message,
        });
    }

    fn check_table(
        &mut self,
        entry: &Entry,
        table: &std::collections::BTreeMap<String, Entry>,
        schema: &'a Map<String, Json>,
        place: &str,
    ) {
        let none = Map::new();
        let properties = schema.get("properties").and_then(Json::as_object);
        for (key, value) in table {
            let inner = join(place, key);
            if let Some(schema) = properties.and_then(|p| p.get(key)) {
                self.check(value, schema, &inner);
            } else if let Some(schema @ Json::Object(_)) = schema.get("additionalProperties") {
                if !is_name(key) {
                    let message =
                        format!("{key:?} is no name: use a letter, then letters, digits, `_` and `-`, 40 at most");
                    self.wrong_key(value, &inner, message);
                }
                self.check(value, schema, &inner);
            } else {
                let known = properties.unwrap_or(&none);
                let message = unknown("key", key, known.keys());
                self.wrong_key(value, &inner, message);
            }
        }
        let required = schema.get("required").and_then(Json::as_array);
        for key in required.into_iter().flatten().filter_map(Json::as_str) {
            if !table.contains_key(key) {
                let mut holder = entry.clone();
                holder.span = entry.key_span.clone().or(entry.span.clone());
                if place.is_empty() {
                    holder.span = Some(Span { range: 0..0, file: None });
                }
                self.wrong(&holder, place, format!("the key `{key}` is missing"));
            }
        }
    }

    fn check_array(&mut self, entry: &Entry, items: &[Entry], schema: &'a Json, place: &str) {
        let bound = |key| schema.get(key).and_then(Json::as_u64);
        let (least, most) = (bound("minItems").unwrap_or(0), bound("maxItems").unwrap_or(u64::MAX));
        if !(least..=most).contains(&(items.len() as u64)) {
            let wanted = match (least, most) {
                (_, u64::MAX) => format!("at least {least}"),
                _ if least == most => format!("{least}"),
                _ => format!("{least} to {most}"),
            };
            self.wrong(entry, place, format!("expected {wanted} items, found {}", items.len()));
        }
        if let Some(schema) = schema.get("items") {
            for (i, item) in items.iter().enumerate() {
                self.check(item, schema, &join(place, &i.to_string()));
            }
        }
    }

    fn check_number(&mut self, entry: &Entry, number: f64, schema: &Json, place: &str) {
        if !number.is_finite() {
            return self.wrong(entry, place, format!("expected a number, found {number}"));
        }
        if schema.get("enum").is_some() {
            return self.check_listed(entry, &entry.to_json(), schema, place);
        }
        let bound = |key| schema.get(key).and_then(Json::as_f64);
        let above = bound("exclusiveMinimum");
        let (least, most) = (bound("minimum"), bound("maximum"));
        let fits =
            above.is_none_or(|b| number > b) && least.is_none_or(|b| number >= b) && most.is_none_or(|b| number <= b);
        if !fits {
            let wanted = match (above, least, most) {
                (Some(a), _, Some(m)) => format!("above {a} and at most {m}"),
                (None, Some(l), Some(m)) => format!("from {l} to {m}"),
                (Some(a), _, None) => format!("above {a}"),
                (None, Some(l), None) => format!("of at least {l}"),
                (None, None, m) => format!("of at most {}", m.unwrap_or(f64::MAX)),
            };
            self.wrong(entry, place, format!("expected a number {wanted}, found {number}"));
        }
    }

    fn check_listed(&mut self, entry: &Entry, value: &Json, schema: &Json, place: &str) {
        let Some(listed) = schema.get("enum").and_then(Json::as_array) else { return };
        if !listed.contains(value) {
            let text = |v: &Json| v.as_str().map_or_else(|| v.to_string(), str::to_owned);
            let known: Vec<String> = listed.iter().map(text).collect();
            let message = match value {
                Json::String(word) => unknown("choice", word, known.iter()),
                _ => format!("expected one of {}, found {value}", known.join(", ")),
            };
            self.wrong(entry, place, message);
        }
    }

    /// Is `value` of the type that `schema` asks for?
    fn accepts(&self, schema: &Json, value: &Value) -> bool {
        if schema.get("oneOf").is_some() || schema.get("anyOf").is_some() {
            return true;
        }
        let accepts = |kind: &str| match value {
            Value::Table(_) => kind == "object",
            Value::Array(_) => kind == "array",
            Value::String(_) => kind == "string",
            Value::Integer(_) => kind == "integer" || kind == "number",
            Value::Float(_) => kind == "number",
            Value::Boolean(_) => kind == "boolean",
            Value::Other(_) => false,
        };
        match schema.get("type") {
            Some(Json::String(kind)) => accepts(kind),
            Some(Json::Array(kinds)) => kinds.iter().filter_map(Json::as_str).any(accepts),
            // Only listed values: a number or a word.
            _ => match schema.get("enum").and_then(|e| e.get(0)) {
                Some(Json::Number(_)) => matches!(value, Value::Integer(_)),
                Some(Json::String(_)) => matches!(value, Value::String(_)),
                _ => true,
            },
        }
    }

    /// What `schema` asks for, in words.
    fn wanted(&self, schema: &Json) -> String {
        let word = |kind: &str| match kind {
            "object" => "a table",
            "array" => "a list",
            "string" => "text",
            "integer" => "a whole number",
            "number" => "a number",
            "boolean" => "true or false",
            _ => "nothing",
        };
        match schema.get("type") {
            Some(Json::String(kind)) => word(kind).to_owned(),
            Some(Json::Array(kinds)) => {
                let words: Vec<_> =
                    kinds.iter().filter_map(Json::as_str).map(word).filter(|w| *w != "nothing").collect();
                words.join(" or ")
            }
            _ if schema.get("oneOf").is_some() => "a choice".to_owned(),
            _ => match schema.get("enum").and_then(Json::as_array) {
                Some(listed) => {
                    let all: Vec<_> = listed.iter().map(Json::to_string).collect();
                    format!("one of {}", all.join(", "))
                }
                None => "something else".to_owned(),
            },
        }
    }
}

/// The words that an enum's schema lists.
fn words(schema: &Json) -> Vec<String> {
    let listed = schema.get("enum").and_then(Json::as_array);
    let constant = schema.get("const");
    listed.into_iter().flatten().chain(constant).filter_map(Json::as_str).map(str::to_owned).collect()
}

/// A name that is safe everywhere: in files, identifiers and reports.
fn is_name(key: &str) -> bool {
    key.starts_with(|c: char| c.is_ascii_alphabetic())
        && key.len() <= 40
        && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

fn join(place: &str, key: &str) -> String {
    if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") }
}
