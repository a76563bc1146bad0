//! The header of an OpenEXR file, byte for byte.

use std::ops::Range;

/// Bytes before the first attribute: the magic number and the version.
const START: usize = 8;

/// Sorts the attributes of a file of one part by name: the encoder keeps them in a map without order. Their order means nothing
/// to readers, and no offset changes. What is no such header is left as it is.
pub(super) fn sort_attributes(file: &mut [u8]) {
    let Some(mut attributes) = attributes(file) else { return };
    let end = attributes.last().map_or(START, |last| last.end);
    attributes.sort_by(|a, b| file[a.clone()].cmp(&file[b.clone()]));
    let sorted: Vec<u8> = attributes.into_iter().flat_map(|at| file[at].iter().copied()).collect();
    file[START..end].copy_from_slice(&sorted);
}

/// Where each attribute is: name, type, size and value.
fn attributes(file: &[u8]) -> Option<Vec<Range<usize>>> {
    let after_text = |at: usize| Some(at + file.get(at..)?.iter().position(|&byte| byte == 0)? + 1);
    let mut attributes = Vec::new();
    let mut start = START;
    while *file.get(start)? != 0 {
        let size = after_text(after_text(start)?)?;
        let value = size + 4;
        let length = u32::from_le_bytes(file.get(size..value)?.try_into().ok()?) as usize;
        let end = value.checked_add(length).filter(|&end| end < file.len())?;
        attributes.push(start..end);
        start = end;
    }
    Some(attributes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_sorted() {
        let attribute = |name: &str, value: &[u8]| {
            let size = (value.len() as u32).to_le_bytes();
            [name.as_bytes(), b"\0string\0", &size, value].concat()
        };
        let (a, b, c) = (attribute("a", b"1"), attribute("b", b"\0\0"), attribute("c", b""));
        let file = |parts: [&[u8]; 3]| [b"vi1\x01\x02\0\0\0", parts[0], parts[1], parts[2], b"\0rest"].concat();
        let mut shuffled = file([&c, &a, &b]);
        sort_attributes(&mut shuffled);
        assert_eq!(shuffled, file([&a, &b, &c]));
        let mut cut = file([&c, &a, &b])[..20].to_vec();
        let before = cut.clone();
        sort_attributes(&mut cut);
        assert_eq!(cut, before);
    }
}
