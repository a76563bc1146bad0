//! Differences between the scenes in the metadata of two pictures.

use std::collections::BTreeMap;

use serde_json::Value;

/// The parameters that differ between two resolved scenes in JSON, as `path: old -> new`, sorted by path.
#[must_use]
pub fn changes(expected: &str, actual: &str) -> Vec<String> {
    let (Ok(expected), Ok(actual)) = (serde_json::from_str(expected), serde_json::from_str(actual)) else {
        return Vec::new();
    };
    let (mut old, mut new) = (BTreeMap::new(), BTreeMap::new());
    leaves(&expected, "", &mut old);
    leaves(&actual, "", &mut new);
    let paths: std::collections::BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let shown = |value: Option<&String>| value.map_or("not there", String::as_str).to_owned();
    paths
        .into_iter()
        .filter(|path| old.get(*path) != new.get(*path))
        .map(|path| format!("{path}: {} -> {}", shown(old.get(path)), shown(new.get(path))))
        .collect()
}

/// Adds every value that is no object, by its path.
fn leaves(value: &Value, path: &str, out: &mut BTreeMap<String, String>) {
    match value {
        Value::Object(table) => {
            for (key, value) in table {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                leaves(value, &path, out);
            }
        }
        value => {
            out.insert(path.to_owned(), value.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_what_changed() {
        let found = changes(
            r#"{"seed":1,"grow":{"a":{"n":2,"x":[1,2]}}}"#,
            r#"{"seed":1,"grow":{"a":{"n":3,"x":[1,2]}},"b":"c"}"#,
        );
        assert_eq!(found, ["b: not there -> \"c\"", "grow.a.n: 2 -> 3"]);
        assert!(changes("no scene", "{}").is_empty());
    }
}
