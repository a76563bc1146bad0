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

pub use bark::Bark;
pub use expr::Expr;
pub use figure::{Figure, STEPS};
pub use lenticels::Lenticels;
pub use moss::Moss;
pub use mottle::{Mottle, PATCH, patches, swells};
pub use plates::Plates;
pub use ribs::Ribs;
pub use rings::Rings;

use schemars::JsonSchema;
use serde::Deserialize;

/// What is drawn over a material's colour. Patterns follow the limb: their coordinates are along it, towards its upper
/// side, and across.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Pattern {
    /// Fissures that run along the limb and part and meet again.
    Bark(Bark),
    /// Moss on the upper side of the limb.
    Moss(Moss),
    /// Short bands across the limb.
    Lenticels(Lenticels),
    /// Plates with cracks between them.
    Plates(Plates),
    /// Scars all around the stem.
    Rings(Rings),
    /// Furrows between ribs that run along the stem.
    Ribs(Ribs),
    /// Patches of another colour; also of the ground.
    Mottle(Mottle),
}

impl Pattern {
    /// The names of all.
    pub const NAMES: [&'static str; 7] = ["bark", "moss", "lenticels", "plates", "rings", "ribs", "mottle"];

    /// What draws it: the one row of each pattern.
    #[must_use]
    pub fn figure(&self) -> &dyn Figure {
        match self {
            Self::Bark(bark) => bark,
            Self::Moss(moss) => moss,
            Self::Lenticels(lenticels) => lenticels,
            Self::Plates(plates) => plates,
            Self::Rings(rings) => rings,
            Self::Ribs(ribs) => ribs,
            Self::Mottle(mottle) => mottle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Colour, DVec3, GOLDEN_ANGLE};

    fn all() -> [Pattern; 7] {
        let (colour, size) = (Colour([0.0; 3]), 1.0);
        [
            Pattern::Bark(Bark { colour, size, depth: 0.1 }),
            Pattern::Moss(Moss { colour, size }),
            Pattern::Lenticels(Lenticels { colour, size }),
            Pattern::Plates(Plates { colour, size, depth: 0.1 }),
            Pattern::Rings(Rings { colour, size, depth: 0.1 }),
            Pattern::Ribs(Ribs { colour, size, depth: 0.1 }),
            Pattern::Mottle(Mottle { colour, size }),
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
        let bark = Bark { colour: Colour([0.0; 3]), size: 0.2, depth: 0.1 };
        let least = bark.least_radius();
        let steps: Vec<f64> = [0.5, 0.61, 0.81, 1.0, 3.0].map(|share| bark.clarity(least * share)).to_vec();
        assert_eq!(steps, [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 1.0]);
        assert_eq!(Moss { colour: Colour([0.0; 3]), size: 0.2 }.clarity(0.0), 1.0);
    }
}
