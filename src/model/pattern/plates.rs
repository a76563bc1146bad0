//! Plates: bark that breaks into scales, as that of old pines, planes and pears.

use schemars::JsonSchema;
use serde::Deserialize;

use super::expr::{Expr, Wave, waves};
use super::figure::Figure;
use crate::math::Colour;

/// Bark that breaks into plates, longer than they are wide.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plates {
    /// Colour of the cracks between plates.
    pub colour: Colour,
    /// Width of a plate, in scene units; thinner limbs have none.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub size: f64,
    /// How deep cracks are, in sizes.
    #[serde(default = "depth")]
    #[schemars(range(min = 0.0, max = 5.0))]
    pub depth: f64,
}

fn depth() -> f64 {
    0.15
}

/// Cracks along the limb are where the first sum is near 0, those across it where the second is.
const ALONG: [Wave; 3] = [
    Wave { along: [2.6, 0.35, 0.9], phase: 0.3, bend: 1.2, by: [0.5, 1.1, -0.4] },
    Wave { along: [-1.1, 0.3, 2.5], phase: 2.2, bend: 1.1, by: [-0.6, 0.9, 0.7] },
    Wave { along: [1.7, -0.5, -2.2], phase: 4.4, bend: 1.0, by: [0.8, -1.3, 0.3] },
];
const ACROSS: [Wave; 2] = [
    Wave { along: [0.4, 1.5, 0.3], phase: 1.2, bend: 1.6, by: [1.7, 0.4, -1.4] },
    Wave { along: [-0.5, 1.9, 0.7], phase: 3.3, bend: 1.5, by: [-1.2, 0.5, 1.9] },
];
/// How narrow both are.
const CRACK: [f64; 2] = [2.0, 2.6];

impl Figure for Plates {
    fn name(&self) -> &'static str {
        "plates"
    }

    fn colour(&self) -> Colour {
        self.colour
    }

    fn size(&self) -> f64 {
        self.size
    }

    fn least_radius(&self) -> f64 {
        self.size * 1.2
    }

    fn height(&self) -> f64 {
        -self.depth
    }

    /// The mean of 200,000 places.
    fn mean(&self) -> f64 {
        0.28
    }

    fn share(&self) -> Expr {
        let crack = |sum: Expr, narrow: f64| Expr::from(1.0) - sum.abs() * narrow;
        Expr::from(0.0).max(crack(waves(&ALONG), CRACK[0]).max(crack(waves(&ACROSS), CRACK[1])))
    }
}
