//! Patterns over a material's colour: expressions that the tracer evaluates and exporters print.
//!
//! A pattern follows the limb: x points to its upper side, y along it, z across, in units of the pattern's size.

mod bark;
mod expr;
mod figure;
mod lenticels;
mod moss;
mod mottle;

pub use bark::Bark;
pub use expr::Expr;
pub use figure::Figure;
pub use lenticels::Lenticels;
pub use moss::Moss;
pub use mottle::{Mottle, PATCH, patches, swells};

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
    /// Patches of another colour; also of the ground.
    Mottle(Mottle),
}

impl Pattern {
    /// The names of all.
    pub const NAMES: [&'static str; 4] = ["bark", "moss", "lenticels", "mottle"];

    /// What draws it: the one row of each pattern.
    #[must_use]
    pub fn figure(&self) -> &dyn Figure {
        match self {
            Self::Bark(bark) => bark,
            Self::Moss(moss) => moss,
            Self::Lenticels(lenticels) => lenticels,
            Self::Mottle(mottle) => mottle,
        }
    }
}
