//! Endpoints placed by a grammar: an L-system's turtle leaves them, and paths make the branches (Xu and Mould 2008, section 6,
//! with Lindenmayer and Prusinkiewicz 1990).

use std::collections::{BTreeMap, HashSet};

use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::{DMat3, DVec3, Degrees, Point, rotation};

/// An L-system. Its string is read as a turtle: `F` and `G` move it forward, other letters do nothing, `+` and `-`
/// turn it left and right, `&` and `^` pitch it down and up, `\` and `/` roll it, `|` turns it around, `[` remembers where
/// it is, and `]` goes back there. Endpoints are the tips: where it is before each `]` and at the end of the string, if it
/// has moved since the last fork.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GrammarSpec {
    /// What it begins with.
    #[schemars(length(min = 1, max = 10_000))]
    pub axiom: String,
    /// What each letter becomes, by the letter.
    pub rules: BTreeMap<char, String>,
    /// How often letters are replaced.
    #[schemars(range(min = 0, max = 30))]
    pub iterations: u32,
    /// The angle of a turn.
    #[schemars(range(min = 0.0, max = 180.0))]
    pub angle: Degrees,
    /// Length of a step, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub step: f64,
    /// Step of a branch over that of what it leaves: each `[` multiplies by it.
    #[serde(default = "one")]
    #[schemars(range(min = 0.01, max = 10.0))]
    pub ratio: f64,
    /// Where the turtle starts, upwards; by default at the origin.
    #[serde(default)]
    pub at: Option<Point>,
}

fn one() -> f64 {
    1.0
}

/// Longer strings are refused.
const MOST_SYMBOLS: f64 = 1e7;

/// Why an L-system has no endpoints.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GrammarError {
    /// The string explodes.
    #[error(
        "within {iterations} iterations there would be {symbols:.1e} symbols, more than {MOST_SYMBOLS:.0e}: use fewer"
    )]
    TooLong {
        /// How often letters are replaced.
        iterations: u32,
        /// The longest string.
        symbols: f64,
    },
    /// A bracket alone.
    #[error("its brackets do not match: each `[` needs a `]`")]
    Unmatched,
    /// A turtle that stays.
    #[error("its turtle never moves: there is no `F`")]
    Still,
}

impl GrammarSpec {
    /// How many symbols the string will have at most on its way.
    fn length(&self) -> f64 {
        // Counts of each letter are all that matters.
        let count = |text: &str| {
            let mut counts: BTreeMap<char, f64> = BTreeMap::new();
            text.chars().for_each(|c| *counts.entry(c).or_default() += 1.0);
            counts
        };
        let mut counts = count(&self.axiom);
        let mut longest: f64 = counts.values().sum();
        for _ in 0..self.iterations {
            let mut next: BTreeMap<char, f64> = BTreeMap::new();
            for (c, number) in &counts {
                match self.rules.get(c) {
                    Some(rule) => count(rule).into_iter().for_each(|(c, n)| *next.entry(c).or_default() += n * number),
                    None => *next.entry(*c).or_default() += number,
                }
            }
            counts = next;
            longest = longest.max(counts.values().sum());
        }
        longest
    }

    /// The string after all iterations.
    fn string(&self) -> String {
        (0..self.iterations).fold(self.axiom.clone(), |text, _| {
            let mut next = String::with_capacity(text.len() * 2);
            for c in text.chars() {
                match self.rules.get(&c) {
                    Some(rule) => next.push_str(rule),
                    None => next.push(c),
                }
            }
            next
        })
    }

    /// The endpoints, in the order of the string, each place once; in the plane with y up, else with z up.
    ///
    /// # Errors
    /// [`GrammarError`].
    pub fn endpoints(&self, is_plane: bool) -> Result<Vec<DVec3>, GrammarError> {
        let symbols = self.length();
        if symbols > MOST_SYMBOLS {
            return Err(GrammarError::TooLong { iterations: self.iterations, symbols });
        }
        // Columns: forward, left and up of the turtle.
        let (forward, left) = if is_plane { (DVec3::Y, DVec3::NEG_X) } else { (DVec3::Z, DVec3::NEG_X) };
        let start = DMat3::from_cols(forward, left, forward.cross(left));
        let mut turtle = (self.at.map_or(DVec3::ZERO, |p| p.0), start, self.step);
        let mut stack = Vec::new();
        let mut ends: Vec<DVec3> = Vec::new();
        let mut known: HashSet<[u64; 3]> = HashSet::new();
        // Since the last fork.
        let mut has_moved = false;
        let angle = self.angle.radians();
        let text = self.string();
        let symbols = text.chars().count();
        for (i, c) in (0..).zip(text.chars().chain([']'])) {
            let (at, axes, step) = &mut turtle;
            let turn = |axes: DMat3, axis: DVec3, angle: f64| rotation(axis, angle) * axes;
            match c {
                '+' => *axes = turn(*axes, axes.z_axis, angle),
                '-' => *axes = turn(*axes, axes.z_axis, -angle),
                '&' => *axes = turn(*axes, axes.y_axis, angle),
                '^' => *axes = turn(*axes, axes.y_axis, -angle),
                '\\' => *axes = turn(*axes, axes.x_axis, angle),
                '/' => *axes = turn(*axes, axes.x_axis, -angle),
                '|' => *axes = turn(*axes, axes.z_axis, std::f64::consts::PI),
                '[' => {
                    stack.push((turtle, has_moved, ends.len()));
                    turtle.2 *= self.ratio;
                    has_moved = false;
                }
                ']' => {
                    if has_moved && known.insert(at.to_array().map(f64::to_bits)) {
                        ends.push(*at);
                    }
                    match stack.pop() {
                        Some((before, moved, count)) => {
                            turtle = before;
                            // A branch of nothing is no fork.
                            has_moved = moved && !has_moved && ends.len() == count;
                        }
                        None if i < symbols => return Err(GrammarError::Unmatched),
                        None => {}
                    }
                }
                'F' | 'G' => {
                    *at += axes.x_axis * *step;
                    has_moved = true;
                }
                _ => {}
            }
        }
        if text.matches('[').count() != text.matches(']').count() {
            return Err(GrammarError::Unmatched);
        }
        if ends.is_empty() {
            return Err(GrammarError::Still);
        }
        Ok(ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(rule: &str, iterations: u32) -> GrammarSpec {
        GrammarSpec {
            axiom: "F".to_owned(),
            rules: [('F', rule.to_owned())].into(),
            iterations,
            angle: Degrees(90.0),
            step: 1.0,
            ratio: 1.0,
            at: None,
        }
    }

    #[test]
    fn tips_are_endpoints() {
        let ends = spec("F[+F][-F]F", 1).endpoints(true).unwrap();
        let near = |a: DVec3, b: DVec3| (a - b).length() < 1e-12;
        assert_eq!(ends.len(), 3);
        for (end, expected) in ends.iter().zip([[-1.0, 1.0], [1.0, 1.0], [0.0, 2.0]]) {
            assert!(near(*end, DVec3::new(expected[0], expected[1], 0.0)), "{end}");
        }
        // In space it starts upwards, and `&` turns it towards its front.
        let ends = spec("F&F", 1).endpoints(false).unwrap();
        assert!(near(ends[0].with_x(0.0).with_y(0.0), DVec3::Z) && ends[0].truncate().length() > 0.99);
        // 5 symbols a letter: exactly counted.
        assert_eq!(spec("F[+F]F", 4).length(), spec("F[+F]F", 4).string().len() as f64);
    }

    #[test]
    fn mistakes_are_named() {
        assert!(spec("FFFFFF", 30).endpoints(true).unwrap_err().to_string().contains("symbols"));
        assert!(spec("F[F", 1).endpoints(true).unwrap_err().to_string().contains("brackets"));
        assert!(spec("F]F", 1).endpoints(true).unwrap_err().to_string().contains("brackets"));
        assert!(spec("x", 1).endpoints(true).unwrap_err().to_string().contains("never moves"));
    }
}
