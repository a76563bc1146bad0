//! Names with places for values: `{seed}`, `####`. They need not be UTF-8.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use super::shown;
use crate::math::unknown;

/// A name of these bytes, which come from names.
#[cfg(unix)]
fn name(bytes: Vec<u8>) -> OsString {
    std::os::unix::ffi::OsStringExt::from_vec(bytes)
}

#[cfg(not(unix))]
fn name(bytes: Vec<u8>) -> OsString {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

/// `pattern` with each `{key}` replaced.
///
/// # Errors
/// A sentence about a key that has no value, or does not end.
pub fn fill(pattern: &OsStr, values: &BTreeMap<String, String>) -> Result<PathBuf, String> {
    let mut out = Vec::new();
    let mut rest = pattern.as_encoded_bytes();
    while let Some(open) = rest.iter().position(|&b| b == b'{') {
        let length = rest[open..].iter().position(|&b| b == b'}');
        let shown = || shown::path(Path::new(pattern));
        let close = open + length.ok_or_else(|| format!("`{}` has a {{ without its }}", shown()))?;
        let key = String::from_utf8_lossy(&rest[open + 1..close]);
        let value = values.get(&*key).ok_or_else(|| unknown("value for the pattern", &key, values.keys()))?;
        out.extend(&rest[..open]);
        // Values may be lists or text with separators; a name may not.
        let plain = value.chars().map(|c| if c.is_alphanumeric() || "._-+".contains(c) { c } else { '-' });
        out.extend(plain.collect::<String>().bytes());
        rest = &rest[close + 1..];
    }
    out.extend(rest);
    Ok(name(out).into())
}

/// Is `part` in a name?
pub fn contains(pattern: &Path, part: &str) -> bool {
    find(pattern, part).is_some()
}

fn find(pattern: &Path, part: &str) -> Option<usize> {
    pattern.as_os_str().as_encoded_bytes().windows(part.len()).position(|bytes| bytes == part.as_bytes())
}

/// `pattern` with `part` replaced wherever it is.
pub fn replace(pattern: &Path, part: &str, value: &str) -> PathBuf {
    let mut path = pattern.to_owned();
    while let Some(at) = find(&path, part) {
        let bytes = path.as_os_str().as_encoded_bytes();
        path = name([&bytes[..at], value.as_bytes(), &bytes[at + part.len()..]].concat()).into();
    }
    path
}

/// `pattern` with its last run of `#` replaced by `number` with as many digits; `None` where it has none. Folders may have others.
pub fn number(pattern: &Path, number: u32) -> Option<PathBuf> {
    let bytes = pattern.as_os_str().as_encoded_bytes();
    let end = bytes.iter().rposition(|&b| b == b'#')? + 1;
    let start = bytes[..end].iter().rposition(|&b| b != b'#').map_or(0, |before| before + 1);
    let digits = format!("{number:0len$}", len = end - start);
    Some(name([&bytes[..start], digits.as_bytes(), &bytes[end..]].concat()).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_filled() {
        let values = BTreeMap::from([("scene".to_owned(), "elm".to_owned()), ("a.b".to_owned(), "[1, 2]".to_owned())]);
        let fill = |pattern: &str| fill(OsStr::new(pattern), &values);
        assert_eq!(fill("out/{scene}_{a.b}.png").unwrap(), Path::new("out/elm_-1--2-.png"));
        assert!(fill("{scen}").unwrap_err().contains("did you mean `scene`"));
        assert!(fill("{scene").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn any_name_has_places() {
        use std::os::unix::ffi::OsStrExt;
        let path = |bytes: &[u8]| PathBuf::from(OsStr::from_bytes(bytes));
        let values = BTreeMap::from([("seed".to_owned(), "7".to_owned())]);
        assert_eq!(fill(OsStr::from_bytes(b"\xff{seed}\xfe"), &values).unwrap(), path(b"\xff7\xfe"));
        assert_eq!(replace(&path(b"\xff{seed}-{seed}"), "{seed}", "1"), path(b"\xff1-1"));
        assert_eq!(number(&path(b"#/\xff.###.png"), 12), Some(path(b"#/\xff.012.png")));
        assert_eq!(number(&path(b"##"), 1234), Some(path(b"1234")));
        assert_eq!(number(&path(b"\xff"), 1), None);
        assert!(contains(&path(b"\xff{seed}"), "{seed}") && !contains(&path(b"\xff"), "{seed}"));
    }
}
