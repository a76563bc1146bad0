//! Places in a photograph, and what is told frame by frame.

use std::path::Path;

use super::error::Failure;
use super::shown;

/// A coordinate as it was typed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinate {
    Pixels(f64),
    Fraction(f64),
}

/// A place as it was typed: `2210,640px`, `50%,30%`, or fractions of width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place([Coordinate; 2]);

/// Reads a place.
pub fn parse_place(text: &str) -> Result<Place, String> {
    let wrong = || format!("{text:?} is no place in a picture: 2210,640px, 50%,30% or fractions as in 0.5,0.3");
    let (text_here, in_pixels) = match text.trim().strip_suffix("px") {
        Some(rest) => (rest, true),
        None => (text.trim(), false),
    };
    let (x, y) = text_here.split_once(',').ok_or_else(wrong)?;
    let read = |part: &str| -> Option<Coordinate> {
        let part = part.trim();
        let (part, pixels) = match part.strip_suffix("px") {
            Some(rest) => (rest, true),
            None => (part, in_pixels),
        };
        let (part, percent) = match part.strip_suffix('%') {
            Some(rest) => (rest, true),
            None => (part, false),
        };
        let number: f64 = part.parse().ok().filter(|x: &f64| x.is_finite())?;
        match (pixels, percent) {
            (true, true) => None,
            (true, false) => Some(Coordinate::Pixels(number)),
            (false, true) => Some(Coordinate::Fraction(number / 100.0)),
            (false, false) => Some(Coordinate::Fraction(number)),
        }
    };
    Ok(Place([read(x).ok_or_else(wrong)?, read(y).ok_or_else(wrong)?]))
}

impl Place {
    /// Fractions of the width from the left and of the height from the bottom, in a picture of `size`.
    ///
    /// # Errors
    /// Where it lies outside; the error calls it `what`.
    pub fn resolve(&self, size: [u32; 2], from_bottom: bool, what: &str) -> Result<[f64; 2], Failure> {
        let [x, y] = self.fractions(size, from_bottom);
        if !(0.0..=1.0).contains(&x) || !(0.0..=1.0).contains(&y) {
            // Whole numbers that would fit are pixels whose unit was forgotten.
            let hint = match self.0 {
                [Coordinate::Fraction(x), Coordinate::Fraction(y)] if x > 1.0 || y > 1.0 => {
                    format!(": numbers without a unit are fractions of its size; did you mean {x},{y}px?")
                }
                _ => String::new(),
            };
            return Err(Failure::Usage(format!(
                "{what} lies outside the picture of {} by {} pixels{hint}",
                size[0], size[1]
            )));
        }
        Ok([x, y])
    }

    /// [`Place::resolve`], also outside.
    pub fn fractions(&self, size: [u32; 2], from_bottom: bool) -> [f64; 2] {
        let fraction = |i: usize| match self.0[i] {
            Coordinate::Pixels(x) => x / f64::from(size[i]),
            Coordinate::Fraction(x) => x,
        };
        [fraction(0), if from_bottom { fraction(1) } else { 1.0 - fraction(1) }]
    }
}

impl Place {
    /// The place at a share of the way to another, told in the same way.
    pub fn towards(self, other: Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Self([0, 1].map(|i| match (self.0[i], other.0[i]) {
            (Coordinate::Pixels(a), Coordinate::Pixels(b)) => Coordinate::Pixels(mix(a, b)),
            (Coordinate::Fraction(a), Coordinate::Fraction(b)) => Coordinate::Fraction(mix(a, b)),
            (a, b) => {
                if share < 0.5 {
                    a
                } else {
                    b
                }
            }
        }))
    }
}

/// What a table of frames tells: `frame,value...` a line, between its frames evenly; `#` starts a comment, and a first
/// line of words is a heading.
#[derive(Clone, Debug)]
pub struct Table<T> {
    rows: Vec<(f64, T)>,
}

impl<T: Copy> Table<T> {
    /// Reads the file at `path`; `read` takes what follows the frame.
    pub fn read(path: &Path, read: impl Fn(&str) -> Result<T, String>) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|e| Failure::file("read", path, &e))?;
        let mut rows: Vec<(f64, T)> = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let line = line.split('#').next().unwrap_or("").trim();
            if line.is_empty() || (i == 0 && line.chars().all(|c| c.is_alphabetic() || ", _".contains(c))) {
                continue;
            }
            let wrong =
                |message: &str| Failure::Usage(format!("{}, line {}: {line:?}: {message}", shown::path(path), i + 1));
            let (frame, rest) =
                line.split_once(',').ok_or_else(|| wrong("a line is a frame, a comma, and its value"))?;
            let frame: f64 = frame.trim().parse().map_err(|_| wrong("a line begins with the number of a frame"))?;
            if !frame.is_finite() {
                return Err(wrong("a line begins with the number of a frame"));
            }
            if rows.last().is_some_and(|(before, _)| *before >= frame) {
                return Err(wrong("frames go upwards"));
            }
            rows.push((frame, read(rest.trim()).map_err(|message| wrong(&message))?));
        }
        if rows.is_empty() {
            return Err(Failure::Usage(format!("{} tells of no frame", shown::path(path))));
        }
        Ok(Self { rows })
    }

    /// The value at `frame`, `mix` giving what lies between two.
    pub fn at(&self, frame: f64, mix: impl Fn(T, T, f64) -> T) -> T {
        let after = self.rows.partition_point(|(f, _)| *f <= frame);
        let (low, high) = (&self.rows[after.saturating_sub(1)], &self.rows[after.min(self.rows.len() - 1)]);
        let share = if high.0 > low.0 { ((frame - low.0) / (high.0 - low.0)).clamp(0.0, 1.0) } else { 0.0 };
        mix(low.1, high.1, share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read() {
        let at = |text: &str| parse_place(text).unwrap().resolve([400, 200], false, "it").unwrap();
        assert_eq!(at("100,50px"), [0.25, 0.75]);
        assert_eq!(at("100px,50px"), [0.25, 0.75]);
        assert_eq!(at("25%, 25%"), [0.25, 0.75]);
        assert_eq!(at("0.25,0.25"), [0.25, 0.75]);
        assert_eq!(parse_place("0.25,0.25").unwrap().resolve([4, 2], true, "it").unwrap(), [0.25, 0.25]);
        for wrong in ["", "1", "a,b", "1%px,2px", "nan,0"] {
            assert!(parse_place(wrong).is_err(), "{wrong}");
        }
        assert!(parse_place("500,50px").unwrap().resolve([400, 200], false, "it").is_err());
    }
}
