//! Rings: scars all around a stem, as leaves leave on palms.

use schemars::JsonSchema;
use serde::Deserialize;

use super::expr::{Expr, Wave, waves};
use super::figure::Figure;
use crate::math::Colour;

/// Scars all around the stem.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rings {
    /// Colour of the scars.
    pub colour: Colour,
    /// Distance from ring to ring along the stem, in scene units; stems thinner than half of it have none.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub size: f64,
    /// How deep scars are, in sizes.
    #[serde(default = "depth")]
    #[schemars(range(min = 0.0, max = 5.0))]
    pub depth: f64,
}

fn depth() -> f64 {
    0.12
}

/// No ring is level all around, nor as far from the next as others.
const UNEVEN: [Wave; 2] = [
    Wave { along: [0.5, 0.9, 0.4], phase: 0.9, bend: 0.7, by: [0.6, 0.3, -0.5] },
    Wave { along: [-0.6, 1.7, 0.7], phase: 2.6, bend: 0.6, by: [0.3, 0.8, 0.5] },
];
const BEND: f64 = 0.6;
/// How sharp a scar is, and where it begins.
const SHARP: f64 = 2.2;
const LEAST: f64 = 0.5;

impl Figure for Rings {
    fn name(&self) -> &'static str {
        "rings"
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

    fn height(&self) -> f64 {
        -self.depth
    }

    /// The mean of 200,000 places.
    fn mean(&self) -> f64 {
        0.26
    }

    fn share(&self) -> Expr {
        let turns = Expr::from(std::f64::consts::TAU) * Expr::Y + waves(&UNEVEN) * BEND;
        ((turns.sin() - LEAST) * SHARP).share()
    }
}
