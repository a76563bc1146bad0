//! Grass as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::Colour;

/// Grass on a level ground, as far as the camera sees it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GrassSpec {
    /// Length of its blades, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e4))]
    pub height: f64,
    /// The darkest and the lightest blades.
    pub colours: [Colour; 2],
    /// How far from the camera it goes, in lengths of a blade; it thins out before.
    #[serde(default = "reach")]
    #[schemars(range(min = 1.0, max = 2000.0))]
    pub reach: f64,
}

fn reach() -> f64 {
    400.0
}
