//! Names and texts of strangers as they are shown: no control character reaches a terminal, or begins a line of its own.

use std::borrow::Cow;
use std::path::Path;

/// Does it steer a terminal, or the direction of the text after it (Unicode, UAX 9)?
fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// What stands for such a character, in as many bytes as it has.
fn stand_in(c: char) -> char {
    match c.len_utf8() {
        1 => '?',
        2 => '\u{bf}',
        _ => char::REPLACEMENT_CHARACTER,
    }
}

fn replaced(text: &str, wrong: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&wrong) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.chars().map(|c| if wrong(c) { stand_in(c) } else { c }).collect())
}

/// A text as one line, with its places unchanged.
pub fn line(text: &str) -> Cow<'_, str> {
    replaced(text, steers)
}

/// A text of lines with its places unchanged.
pub fn lines(text: &str) -> Cow<'_, str> {
    replaced(text, |c| steers(c) && c != '\n' && c != '\t')
}

/// A file's name as one line; what is not UTF-8 has a stand-in.
pub fn path(path: &Path) -> String {
    line(&path.to_string_lossy()).into_owned()
}

/// A command of a workflow of GitHub that marks `file` with `text`, encoded as its toolkit does.
pub fn annotation(file: &Path, text: &str) -> String {
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let property = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    format!("::error file={}::{}", property(&file.to_string_lossy()), data(text))
}

/// A cell of a table in Markdown, with nothing in it but text.
pub fn cell(text: &str) -> String {
    let mut cell = String::new();
    for c in line(text).chars() {
        if "\\|`<>&*[]~".contains(c) {
            cell.push('\\');
        }
        cell.push(c);
    }
    cell
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_steers() {
        assert_eq!(line("plain \u{f6} \u{732b}"), "plain \u{f6} \u{732b}");
        let wild = "a\u{1b}[2J\n\u{9b}b\u{202e}c\t\u{7f}";
        assert_eq!(line(wild), "a?[2J?\u{bf}b\u{fffd}c??");
        assert_eq!(line(wild).len(), wild.len());
        assert_eq!(lines(wild), "a?[2J\n\u{bf}b\u{fffd}c\t?");
    }

    #[test]
    fn github_reads_one_annotation() {
        let file = Path::new("a,b:c%\n::error::x");
        let told = annotation(file, "50 %\r\n::warning::y");
        assert_eq!(told, "::error file=a%2Cb%3Ac%25%0A%3A%3Aerror%3A%3Ax::50 %25%0D%0A::warning::y");
        assert_eq!(cell("a|b`c\n<d>"), "a\\|b\\`c?\\<d\\>");
    }
}
