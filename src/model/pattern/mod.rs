//! Patterns over a material's colour: expressions that the tracer evaluates and exporters print.
//!
//! A pattern follows the limb: x points to its upper side, y along it, z across, in units of the pattern's size.

mod bark;
mod expr;
mod figure;
mod lenticels;
mod moss;
mod mottle;
mod plates;
mod ribs;
mod rings;

pub use expr::Expr;
pub use figure::{Figure, STEPS};
pub use mottle::{PATCH, patches, swells};

use bark::BARK;
use figure::Kind;
use lenticels::LENTICELS;
use moss::MOSS;
use mottle::MOTTLE;
use plates::PLATES;
use ribs::RIBS;
use rings::RINGS;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::Colour;

/// What is drawn over a material's colour. Patterns follow the limb: their coordinates are along it, towards its upper
/// side, and across.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Pattern {
    /// Fissures that run along the limb and part and meet again; their size is the distance from one to the next.
    Bark(Carved),
    /// Moss on the upper side of the limb, in patches of this size.
    Moss(Painted),
    /// Short bands across the limb; their size is the distance from one to the next.
    Lenticels(Painted),
    /// Plates of this width, longer than wide, with cracks between them.
    Plates(Carved),
    /// Scars all around the stem; their size is the distance from one to the next.
    Rings(Carved),
    /// Furrows between ribs that run along the stem, twelve around; their size is the width of a rib of a stem twice as thick.
    Ribs(Carved),
    /// Patches of another colour, the larger ones of this size, that run into each other: soil, meadows, stained stone. Also of the
    /// ground.
    Mottle(Painted),
}

/// A pattern in a colour.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Painted {
    /// The other colour.
    pub colour: Colour,
    /// Its size, in scene units; limbs much thinner show the mean.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub size: f64,
}

/// A pattern that is cut into the surface.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Carved {
    /// The colour of what is cut.
    pub colour: Colour,
    /// Its size, in scene units; limbs much thinner show the mean.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub size: f64,
    /// How deep it is cut, in sizes; by default 0.15, rings 0.12, ribs 0.5.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 5.0))]
    pub depth: Option<f64>,
}

impl Pattern {
    /// The names of all.
    pub const NAMES: [&'static str; 7] = ["bark", "moss", "lenticels", "plates", "rings", "ribs", "mottle"];

    /// What it draws: the one row of each pattern.
    #[must_use]
    pub fn figure(&self) -> Figure {
        match self {
            Self::Bark(of) => of.figure(&BARK),
            Self::Moss(of) => of.figure(&MOSS),
            Self::Lenticels(of) => of.figure(&LENTICELS),
            Self::Plates(of) => of.figure(&PLATES),
            Self::Rings(of) => of.figure(&RINGS),
            Self::Ribs(of) => of.figure(&RIBS),
            Self::Mottle(of) => of.figure(&MOTTLE),
        }
    }
}

impl Painted {
    fn figure(&self, kind: &'static Kind) -> Figure {
        Figure { kind, colour: self.colour, size: self.size, height: kind.height }
    }
}

impl Carved {
    fn figure(&self, kind: &'static Kind) -> Figure {
        let height = self.depth.map_or(kind.height, |depth| -depth);
        Figure { kind, colour: self.colour, size: self.size, height }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DVec3, GOLDEN_ANGLE};

    fn all() -> [Pattern; 7] {
        let (colour, size) = (Colour([0.0; 3]), 1.0);
        let (painted, carved) = (Painted { colour, size }, Carved { colour, size, depth: None });
        [
            Pattern::Bark(carved),
            Pattern::Moss(painted),
            Pattern::Lenticels(painted),
            Pattern::Plates(carved),
            Pattern::Rings(carved),
            Pattern::Ribs(carved),
            Pattern::Mottle(painted),
        ]
    }

    /// What thin limbs show is what thick ones show on the whole, but for moss, which is on them or not.
    #[test]
    fn means_are_those_of_shares() {
        for (pattern, name) in all().iter().zip(Pattern::NAMES) {
            let figure = pattern.figure();
            assert_eq!(figure.name(), name);
            let share = figure.share();
            let at = |i: u32| {
                let turn = GOLDEN_ANGLE * f64::from(i);
                DVec3::new(2.0 * libm::cos(turn), 0.005 * f64::from(i), 2.0 * libm::sin(turn))
            };
            let shares: Vec<f64> = (0..50_000).map(|i| share.at(at(i))).collect();
            assert!(shares.iter().all(|x| (0.0..=1.0).contains(x)), "{name}");
            let mean = shares.iter().sum::<f64>() / shares.len() as f64;
            assert!(name == "moss" || (mean - figure.mean()).abs() < 0.05, "{name}: {mean}");
        }
    }

    #[test]
    fn thinner_limbs_show_less() {
        let (colour, size) = (Colour([0.0; 3]), 0.2);
        let bark = Pattern::Bark(Carved { colour, size, depth: Some(0.4) }).figure();
        let steps: Vec<f64> = [0.5, 0.61, 0.81, 1.0, 3.0].map(|share| bark.clarity(0.2 * 1.5 * share)).to_vec();
        assert_eq!(steps, [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 1.0]);
        assert_eq!((bark.height(), Pattern::Moss(Painted { colour, size }).figure().clarity(0.0)), (-0.4, 1.0));
    }
}
