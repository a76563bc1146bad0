//! Mistakes in a scene: where, what, and what would be right.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use super::source::Source;

/// A file that a scene includes.
#[derive(Debug, PartialEq, Eq)]
pub struct Included {
    /// What to call it in errors.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// Bytes of a scene's text, or of a file that it includes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// Which bytes.
    pub range: Range<usize>,
    /// Of which text; `None` for the scene's own.
    pub file: Option<Arc<Included>>,
}

/// One mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// The text that is wrong; `None` where an override or a command is.
    pub span: Option<Span>,
    /// The dotted path of keys.
    pub place: String,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl Mistake {
    /// The included file, the scene's own text before all, and the first byte.
    fn order(&self) -> (Option<&str>, usize) {
        self.span.as_ref().map_or((None, 0), |s| (s.file.as_ref().map(|file| file.name.as_str()), s.range.start))
    }
}

/// Every mistake found in a scene.
#[derive(Clone, Debug)]
pub struct SceneError {
    /// The scene's name in errors.
    pub name: String,
    /// Its text.
    pub text: String,
    /// At least one mistake, in the order of the text; those in included files last.
    pub mistakes: Vec<Mistake>,
}

impl SceneError {
    /// An error of the mistakes in `source`, sorted, each once.
    pub(super) fn new(source: &Source, mut mistakes: Vec<Mistake>) -> Self {
        if mistakes.is_empty() {
            mistakes.push(Mistake { span: None, place: String::new(), message: "the scene cannot be read".to_owned() });
        }
        mistakes.sort_by(|a, b| (a.order(), &a.message).cmp(&(b.order(), &b.message)));
        // What is inherited by `like` is reported once, where it is written.
        mistakes.dedup_by(|a, b| a.message == b.message && a.span == b.span && a.span.is_some());
        Self { name: source.name.clone(), text: source.text.clone(), mistakes }
    }

    /// The name and the text of the file that a mistake is in.
    #[must_use]
    pub fn file<'a>(&'a self, mistake: &'a Mistake) -> (&'a str, &'a str) {
        match mistake.span.as_ref().and_then(|span| span.file.as_ref()) {
            Some(file) => (&file.name, &file.text),
            None => (&self.name, &self.text),
        }
    }

    /// Line and column, from 1, of a mistake in its file; `None` where it is in no text.
    #[must_use]
    pub fn line_column(&self, mistake: &Mistake) -> Option<(usize, usize)> {
        let byte = mistake.span.as_ref()?.range.start;
        let (_, text) = self.file(mistake);
        let before = &text.as_bytes()[..byte.min(text.len())];
        let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
        let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        Some((line, String::from_utf8_lossy(&before[start..]).chars().count() + 1))
    }
}

/// Mistakes that are told of a scene: those after them are counted.
const MOST_TOLD: usize = 20;

impl SceneError {
    /// The mistakes that are told, and the number of the others.
    #[must_use]
    pub fn told(&self) -> (&[Mistake], usize) {
        let told = &self.mistakes[..self.mistakes.len().min(MOST_TOLD)];
        (told, self.mistakes.len() - told.len())
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (told, more) = self.told();
        for (i, mistake) in told.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{}", self.file(mistake).0)?;
            if let Some((line, column)) = self.line_column(mistake) {
                write!(f, ":{line}:{column}")?;
            }
            write!(f, ": ")?;
            if !mistake.place.is_empty() {
                write!(f, "{}: ", mistake.place)?;
            }
            write!(f, "{}", mistake.message)?;
        }
        if more > 0 { write!(f, "\n... and {more} more") } else { Ok(()) }
    }
}

impl std::error::Error for SceneError {}
