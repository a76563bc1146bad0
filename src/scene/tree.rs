//! A scene's TOML as a tree that knows where everything stands in the text.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use toml::de::{DeTable, DeValue};

use super::mistake::{Included, Mistake, Span};

/// A change to a scene from outside: `--set grow.elm.to.limbs.count=30`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// Dotted path of keys.
    pub path: String,
    /// The value as TOML; what is no TOML is taken as text.
    pub value: String,
}

/// A value and where it stands; `None` for what an override gives.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub value: Value,
    pub span: Option<Span>,
    pub key_span: Option<Span>,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    Table(BTreeMap<String, Entry>),
    Array(Vec<Entry>),
    String(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    /// A date, or an integer that does not fit: nothing that a scene can use.
    Other(&'static str),
}

impl Value {
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Table(_) => "a table",
            Self::Array(_) => "a list",
            Self::String(_) => "text",
            Self::Integer(_) => "a whole number",
            Self::Float(_) => "a number",
            Self::Boolean(_) => "true or false",
            Self::Other(kind) => kind,
        }
    }
}

impl Entry {
    /// Where the entry at this dotted path stands, or the nearest one around it.
    pub fn find_span(&self, place: &str) -> Option<Span> {
        let mut at = self;
        let mut span = None;
        for key in place.split('.').filter(|key| !key.is_empty()) {
            let next = match &at.value {
                Value::Table(table) => table.get(key),
                Value::Array(items) => key.parse().ok().and_then(|i: usize| items.get(i)),
                _ => None,
            };
            let Some(next) = next else { break };
            // A table's own span covers all of it; its key says which it is.
            span = match &next.value {
                Value::Table(_) | Value::Array(_) => next.key_span.clone().or(next.span.clone()),
                _ => next.span.clone(),
            };
            at = next;
        }
        span
    }

    /// The tree as JSON, for serde. Numbers that JSON cannot hold become null; validation refuses them before.
    pub fn to_json(&self) -> serde_json::Value {
        match &self.value {
            Value::Table(table) => table.iter().map(|(k, v)| (k.clone(), v.to_json())).collect(),
            Value::Array(items) => items.iter().map(Self::to_json).collect(),
            Value::String(text) => text.as_str().into(),
            Value::Integer(number) => (*number).into(),
            Value::Float(number) => (*number).into(),
            Value::Boolean(b) => (*b).into(),
            Value::Other(_) => serde_json::Value::Null,
        }
    }
}

/// The tree of a TOML text, of the scene's own or of a `file` that it includes, and its syntax errors.
pub(super) fn parse(text: &str, file: Option<&Arc<Included>>) -> (Entry, Vec<Mistake>) {
    let (table, errors) = DeTable::parse_recoverable(text);
    let reader = Reader { file };
    let mistakes = errors
        .iter()
        .map(|error| Mistake {
            span: error.span().map(|range| reader.span(range)),
            place: String::new(),
            message: error.message().to_owned(),
        })
        .collect();
    let span = Some(reader.span(table.span()));
    (Entry { value: reader.table(table.get_ref()), span, key_span: None }, mistakes)
}

/// Converts TOML to entries whose spans are of one text.
struct Reader<'a> {
    file: Option<&'a Arc<Included>>,
}

impl Reader<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        Span { range, file: self.file.cloned() }
    }

    fn table(&self, table: &DeTable<'_>) -> Value {
        let entries = table.iter().map(|(key, value)| {
            let entry = Entry {
                value: self.value(value.get_ref()),
                span: Some(self.span(value.span())),
                key_span: Some(self.span(key.span())),
            };
            (key.get_ref().to_string(), entry)
        });
        Value::Table(entries.collect())
    }

    fn value(&self, value: &DeValue<'_>) -> Value {
        match value {
            DeValue::Table(table) => self.table(table),
            DeValue::Array(items) => Value::Array(
                items
                    .iter()
                    .map(|item| Entry {
                        value: self.value(item.get_ref()),
                        span: Some(self.span(item.span())),
                        key_span: None,
                    })
                    .collect(),
            ),
            DeValue::String(text) => Value::String(text.to_string()),
            DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
                .map_or(Value::Other("a whole number of more than 64 bits"), Value::Integer),
            DeValue::Float(number) => number.as_str().parse().map_or(Value::Other("no number"), Value::Float),
            DeValue::Boolean(b) => Value::Boolean(*b),
            DeValue::Datetime(_) => Value::Other("a date"),
        }
    }
}

/// A number as TOML has it: with a point where it is whole.
pub(super) fn float(x: f64) -> String {
    format!("{x:?}")
}

/// Takes every span out: this did not come from the scene's text.
fn without_spans(mut value: Value) -> Value {
    let entries: Vec<&mut Entry> = match &mut value {
        Value::Table(table) => table.values_mut().collect(),
        Value::Array(items) => items.iter_mut().collect(),
        _ => Vec::new(),
    };
    for entry in entries {
        let inner = std::mem::replace(&mut entry.value, Value::Boolean(false));
        *entry = Entry { value: without_spans(inner), span: None, key_span: None };
    }
    value
}

/// Applies `overrides` in order; missing tables on the way are made, and validation judges what comes out.
pub(super) fn apply(root: &mut Entry, overrides: &[Override], mistakes: &mut Vec<Mistake>) {
    for change in overrides {
        if change.path == "include" {
            let message = "what a scene includes cannot be changed from outside".to_owned();
            mistakes.push(Mistake { span: None, place: change.path.clone(), message });
            continue;
        }
        let value = match DeValue::parse(&change.value) {
            Ok(value) => without_spans(Reader { file: None }.value(value.get_ref())),
            Err(_) => Value::String(change.value.clone()),
        };
        let keys: Vec<&str> = change.path.split('.').collect();
        if keys.iter().any(|key| key.is_empty()) || !set(root, &keys, value) {
            mistakes.push(Mistake {
                span: None,
                place: change.path.clone(),
                message: "a change needs a path of keys, such as grow.elm.to.limbs.count, or grow.elm.from.at.0 for the first of \
                          a list".to_owned(),
            });
        }
    }
}

/// Sets what is at `keys` within `entry`; false where a list has no such item.
fn set(entry: &mut Entry, keys: &[&str], value: Value) -> bool {
    let Some((key, rest)) = keys.split_first() else {
        entry.value = value;
        entry.span = None;
        return true;
    };
    if let Value::Array(items) = &mut entry.value {
        let item = key.parse().ok().and_then(|i: usize| items.get_mut(i));
        return item.is_some_and(|item| set(item, rest, value));
    }
    if !matches!(entry.value, Value::Table(_)) {
        entry.value = Value::Table(BTreeMap::new());
    }
    let Value::Table(table) = &mut entry.value else { return false };
    let inner = table.entry((*key).to_owned()).or_insert(Entry {
        value: Value::Table(BTreeMap::new()),
        span: None,
        key_span: None,
    });
    set(inner, rest, value)
}

/// The keys whose tables are merged when `like` takes things over; others are replaced whole.
const MERGED: [&str; 5] = ["weights", "field", "nodes", "lattice", "to"];

/// A chain of `like` has at most this many links.
const MOST_LIKE: usize = 100;

/// Fills in what spaces, steps and objects take from others by `like`.
pub(super) fn inherit(root: &mut Entry, mistakes: &mut Vec<Mistake>) {
    for kind in ["space", "grow", "object"] {
        let Value::Table(tables) = &mut root.value else { return };
        let Some(Entry { value: Value::Table(named), .. }) = tables.get_mut(kind) else { continue };
        let names: Vec<String> = named.keys().cloned().collect();
        for name in names {
            let mut chain = vec![name.clone()];
            // From the nearest to the furthest: what is there already stays.
            while let Some(base) = chain.last().and_then(|last| like(named, last)) {
                let from = named.get(&base).cloned();
                let wrong = match &from {
                    None => Some(crate::math::unknown(kind, &base, named.keys())),
                    Some(_) if chain.contains(&base) => Some(format!("{kind} `{name}` is like itself")),
                    Some(_) if chain.len() > MOST_LIKE => Some(format!("more than {MOST_LIKE} are like one another")),
                    Some(_) => None,
                };
                if let Some(message) = wrong {
                    let span = named.get(&name).and_then(|e| e.find_span("like"));
                    mistakes.push(Mistake { span, place: format!("{kind}.{name}.like"), message });
                    break;
                }
                if let (Some(to), Some(from)) = (named.get_mut(&name), &from) {
                    merge(to, from);
                }
                chain.push(base);
            }
        }
    }
}

fn like(named: &BTreeMap<String, Entry>, name: &str) -> Option<String> {
    let Value::Table(table) = &named.get(name)?.value else { return None };
    match &table.get("like")?.value {
        Value::String(base) => Some(base.clone()),
        _ => None,
    }
}

/// Takes over what is not in `to`, key by key.
pub(super) fn merge(to: &mut Entry, from: &Entry) {
    let (Value::Table(to), Value::Table(from)) = (&mut to.value, &from.value) else { return };
    for (key, value) in from {
        match to.get_mut(key) {
            None => {
                to.insert(key.clone(), value.clone());
            }
            Some(own) if MERGED.contains(&key.as_str()) => merge(own, value),
            Some(_) => {}
        }
    }
}
