//! Mistakes in a scene: where, what, and what would be right.

use std::fmt;
use std::ops::Range;

use super::source::Source;

/// One mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// The bytes of the scene's text that are wrong; `None` where an override or a command is.
    pub span: Option<Range<usize>>,
    /// The dotted path of keys.
    pub place: String,
    /// What is wrong, and what would be right.
    pub message: String,
}

/// Every mistake found in a scene.
#[derive(Clone, Debug)]
pub struct SceneError {
    /// The scene's name in errors.
    pub name: String,
    /// Its text.
    pub text: String,
    /// At least one mistake, in the order of the text.
    pub mistakes: Vec<Mistake>,
}

impl SceneError {
    /// An error of the mistakes in `source`, sorted, each once.
    pub(super) fn new(source: &Source, mut mistakes: Vec<Mistake>) -> Self {
        if mistakes.is_empty() {
            mistakes.push(Mistake { span: None, place: String::new(), message: "the scene cannot be read".to_owned() });
        }
        mistakes.sort_by(|a, b| {
            let key = |m: &Mistake| m.span.as_ref().map_or(0, |s| s.start);
            (key(a), &a.message).cmp(&(key(b), &b.message))
        });
        // What is inherited by `like` is reported once, where it is written.
        mistakes.dedup_by(|a, b| a.message == b.message && a.span == b.span && a.span.is_some());
        Self { name: source.name.clone(), text: source.text.clone(), mistakes }
    }

    /// Line and column, from 1, of a byte of the text.
    #[must_use]
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let before = &self.text.as_bytes()[..byte.min(self.text.len())];
        let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
        let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        (line, String::from_utf8_lossy(&before[start..]).chars().count() + 1)
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, mistake) in self.mistakes.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{}", self.name)?;
            if let Some(span) = &mistake.span {
                let (line, column) = self.line_column(span.start);
                write!(f, ":{line}:{column}")?;
            }
            write!(f, ": ")?;
            if !mistake.place.is_empty() {
                write!(f, "{}: ", mistake.place)?;
            }
            write!(f, "{}", mistake.message)?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}
