//! The lines around a mistake, cut to what a person reads: a report printer fails beyond 65,535 columns, and long lines fill
//! a terminal.

use std::ops::Range;

use super::shown::lines;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Characters of a line that are shown, where it is longer.
const WIDTH: usize = 100;
/// Of those, the most before the mistake.
const BEFORE: usize = 40;
/// Most lines that are shown.
const LINES: usize = 16;

/// The lines of a mistake with their neighbours, or a part of the line where it begins where they are many or long.
pub struct Excerpt {
    name: String,
    data: String,
    /// Which bytes of the file are shown.
    shown: Range<usize>,
    /// Which of them are wrong.
    pub mistake: Range<usize>,
    /// Line and column of the first byte shown and of the mistake, from 0.
    places: [(usize, usize); 2],
}

impl Excerpt {
    /// Of the file `name` with this text, around the bytes `mistake`.
    pub fn new(name: &str, text: &str, mistake: &Range<usize>) -> Self {
        let start = text.floor_char_boundary(mistake.start);
        let end = text.ceil_char_boundary(mistake.end.clamp(start, text.len()));
        let line_start = |at: usize| text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = |at: usize| text[at..].find('\n').map_or(text.len(), |newline| at + newline);
        let before = line_start(line_start(start).saturating_sub(1));
        let after = line_end((line_end(end) + 1).min(text.len()));
        let is_short =
            text[before..after].lines().count() <= LINES && text[before..after].lines().all(|line| line.len() <= WIDTH);
        let shown = if is_short {
            before..after
        } else {
            let left = text[line_start(start)..start].char_indices().rev().take(BEFORE).last();
            let from = left.map_or(start, |(at, _)| line_start(start) + at);
            let right = text[from..line_end(start)].char_indices().nth(WIDTH);
            from..right.map_or(line_end(start), |(at, _)| from + at)
        };
        let place = |at: usize| (text[..at].matches('\n').count(), text[line_start(at)..at].chars().count());
        let places = [place(shown.start), place(start)];
        let mistake = start..end.min(shown.end).max(start);
        Self { name: name.to_owned(), data: lines(&text[shown.clone()]).into_owned(), shown, mistake, places }
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        _lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        // Without lines around it the span is asked for its place.
        let (line, column) = self.places[usize::from(lines_before == 0)];
        let span = if lines_before == 0 { *span } else { SourceSpan::from(self.shown.clone()) };
        let lines = self.data.lines().count();
        Ok(Box::new(MietteSpanContents::new_named(self.name.clone(), self.data.as_bytes(), span, line, column, lines)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_cut() {
        let text = format!("a = 1\nb = [{}]\nc = 2\n", "0, ".repeat(40_000));
        let excerpt = Excerpt::new("x", &text, &(90_000..90_001));
        assert_eq!(excerpt.data.chars().count(), WIDTH);
        assert_eq!((excerpt.mistake.clone(), excerpt.places[1]), (90_000..90_001, (1, 89_994)));
        assert!(excerpt.shown.contains(&90_000));
        // A mistake that goes on for long is cut with its line, and one beyond the text is none.
        assert_eq!(Excerpt::new("x", &text, &(10..120_000)).data.len(), WIDTH);
        assert_eq!(Excerpt::new("x", "", &(5..9)).mistake, 0..0);
    }

    #[test]
    fn short_lines_have_neighbours() {
        let text = "a = 1\n\u{f6} = 2\nc = 3\nd = 4";
        assert_eq!(Excerpt::new("x", text, &(6..8)).data, "a = 1\n\u{f6} = 2\nc = 3");
        // Within a letter: as far as its start.
        assert_eq!(Excerpt::new("x", text, &(7..7)).mistake.start, 6);
        assert_eq!(Excerpt::new("x", text, &(0..1)).data, "a = 1\n\u{f6} = 2");
    }
}
