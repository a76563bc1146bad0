//! Bark: fissures that run along the limb.

use schemars::JsonSchema;
use serde::Deserialize;

use super::expr::{Expr, Wave, waves};
use super::figure::Figure;
use crate::math::Colour;

/// Fissures that run along the limb and part and meet again.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bark {
    /// Colour of the fissures.
    pub colour: Colour,
    /// Distance from fissure to fissure, in scene units; thinner limbs have none.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub size: f64,
    /// How deep fissures are, in sizes.
    #[serde(default = "depth")]
    #[schemars(range(min = 0.0, max = 5.0))]
    pub depth: f64,
}

fn depth() -> f64 {
    0.15
}

/// Fissures are where this sum is near 0: nets drawn out along the limb.
const NET: [Wave; 4] = [
    Wave { along: [3.1, 0.16, 1.2], phase: 0.4, bend: 1.1, by: [0.6, 0.31, -0.7] },
    Wave { along: [-1.4, 0.13, 2.9], phase: 1.9, bend: 1.0, by: [-0.8, 0.27, 0.5] },
    Wave { along: [1.9, -0.19, -2.6], phase: 4.1, bend: 1.2, by: [0.4, -0.36, 0.8] },
    Wave { along: [5.3, 0.43, 4.7], phase: 2.7, bend: 0.9, by: [-1.3, 0.71, 1.1] },
];
/// How narrow fissures are.
const FISSURE: f64 = 0.9;

impl Figure for Bark {
    fn name(&self) -> &'static str {
        "bark"
    }

    fn colour(&self) -> Colour {
        self.colour
    }

    fn size(&self) -> f64 {
        self.size
    }

    fn least_radius(&self) -> f64 {
        self.size * 1.5
    }

    fn height(&self) -> f64 {
        -self.depth
    }

    fn mean(&self) -> f64 {
        0.3
    }

    fn share(&self) -> Expr {
        Expr::from(0.0).max(Expr::from(1.0) - waves(&NET).abs() * FISSURE)
    }
}
