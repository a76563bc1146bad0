//! Lenticels: short dark bands across the limb, as birches and cherries have them.

use schemars::JsonSchema;
use serde::Deserialize;

use super::expr::{Expr, Wave, waves};
use super::figure::Figure;
use crate::math::Colour;

/// Short bands across the limb.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lenticels {
    /// Colour of the bands.
    pub colour: Colour,
    /// Distance from band to band along the limb, in scene units; thinner limbs have none.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub size: f64,
}

/// Fast along the limb, slow around it: bands, which the slow parts break off.
const BANDS: [Wave; 3] = [
    Wave { along: [0.4, 6.3, 0.3], phase: 0.7, bend: 0.8, by: [1.1, 0.2, 0.9] },
    Wave { along: [-0.3, 9.1, 0.5], phase: 2.1, bend: 0.9, by: [-0.8, 0.3, 1.3] },
    Wave { along: [2.2, 0.9, -1.7], phase: 4.4, bend: 1.1, by: [0.7, 0.5, -0.6] },
];
/// How sharp a band ends, and where it begins.
const SHARP: f64 = 2.5;
const LEAST: f64 = 1.5;

impl Figure for Lenticels {
    fn name(&self) -> &'static str {
        "lenticels"
    }

    fn colour(&self) -> Colour {
        self.colour
    }

    fn size(&self) -> f64 {
        self.size
    }

    fn least_radius(&self) -> f64 {
        self.size * 0.5
    }

    /// The mean of 200,000 places.
    fn mean(&self) -> f64 {
        0.09
    }

    fn share(&self) -> Expr {
        Expr::from(1.0).min(Expr::from(0.0).max((waves(&BANDS) - LEAST) * SHARP))
    }
}
