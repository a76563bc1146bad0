//! A checksum line in a text file, which shows whether the file was edited after it was written.

use crate::math::fnv1a;

/// The keyword of the line.
const KEYWORD: &str = "lichtenberg-seal";

/// The checksum of `text`, whatever its line ends.
fn checksum(text: &str) -> u64 {
    fnv1a(text.bytes().filter(|&b| b != b'\r'))
}

/// Adds a comment line with the checksum of `text`: the first line, or the second below one that starts with `comment`
/// twice and so declares the file's type (`##RenderMan`). `comment` is what starts a comment.
#[must_use]
pub fn seal(comment: &str, text: &str) -> String {
    let line = format!("{comment} {KEYWORD} {:016x}\n", checksum(text));
    match text.split_once('\n') {
        Some((declared, rest)) if declared.starts_with(&comment.repeat(2)) => format!("{declared}\n{line}{rest}"),
        _ => line + text,
    }
}

/// Does `text` differ from every result of [`seal`]: was it edited, or has it no checksum?
#[must_use]
pub fn is_edited(text: &str) -> bool {
    let mut lines = text.splitn(3, '\n');
    let (Some(first), Some(second)) = (lines.next(), lines.next()) else { return true };
    let third = lines.next();
    let sum = |line: &str| {
        let (_, sum) = line.split_once(KEYWORD)?;
        u64::from_str_radix(sum.trim(), 16).ok()
    };
    let rest = third.map_or(String::new(), |third| format!("\n{third}"));
    match (sum(first), sum(second)) {
        (Some(sum), _) => sum != checksum(&format!("{second}{rest}")),
        (None, Some(sum)) => sum != checksum(&format!("{first}{rest}")),
        (None, None) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_edits() {
        let sealed = seal("//", "camera {}\n");
        assert!(!is_edited(&sealed));
        assert!(!is_edited(&sealed.replace('\n', "\r\n")));
        assert!(is_edited(&sealed.replace("camera", "Camera")));
        assert!(is_edited("camera {}\n"));
        let sealed = seal("#", "##RenderMan RIB-Structure 1.1\nversion 3.03\n");
        assert!(sealed.starts_with("##RenderMan RIB-Structure 1.1\n# lichtenberg-seal"));
        assert!(!is_edited(&sealed) && is_edited(&sealed.replace("3.03", "3.04")));
    }
}
