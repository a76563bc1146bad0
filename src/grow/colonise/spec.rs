//! Space colonisation as a scene writes it, and with its names resolved.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::{Shape, ShapeSpec};

/// Space colonisation (Runions, Lane and Prusinkiewicz 2007): points in a shape each draw the nearest limb, round after round,
/// until it reaches them. A baseline to hold planned trees against.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ColoniseSpec {
    /// Where attraction points are.
    pub inside: ShapeSpec,
    /// How many.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub points: u32,
    /// How far a limb grows in a round (D in the paper), in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub step: f64,
    /// A point draws limbs no farther away than so many steps (d_i over D).
    #[serde(default = "influence")]
    #[schemars(range(min = 1.0, max = 1e4))]
    pub influence: f64,
    /// A point is reached by a limb as near as so many steps (d_k over D).
    #[serde(default = "kill")]
    #[schemars(range(min = 0.5, max = 1e4))]
    pub kill: f64,
    /// Rounds at most.
    #[serde(default = "rounds")]
    #[schemars(range(min = 1, max = 100_000))]
    pub rounds: u32,
}

fn influence() -> f64 {
    17.0
}

fn kill() -> f64 {
    2.0
}

fn rounds() -> u32 {
    1000
}

/// Space colonisation with its names resolved; lengths in scene units.
#[derive(Clone, Debug, PartialEq)]
pub struct Colonise {
    /// Where attraction points are.
    pub inside: Shape,
    /// How many.
    pub points: u32,
    /// How far a limb grows in a round.
    pub step: f64,
    /// How far points draw.
    pub influence: f64,
    /// How near they are reached.
    pub kill: f64,
    /// Rounds at most.
    pub rounds: u32,
}
