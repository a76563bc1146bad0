//! What a pattern offers.

use super::expr::Expr;
use crate::math::Colour;

/// A pattern passes into its mean on thinner limbs in so many steps, so that renderers need no more textures.
pub const STEPS: u32 = 3;
/// Limbs below this share of the least radius show the mean alone.
const YOUNGEST: f64 = 0.6;

/// A kind of pattern.
pub trait Figure {
    /// Its name, as scenes have it and shaders are called.
    fn name(&self) -> &'static str;

    /// The colour drawn over the material's own.
    fn colour(&self) -> Colour;

    /// The unit of its coordinates, in scene units.
    fn size(&self) -> f64;

    /// Limbs from this radius on, in scene units, show all of it.
    fn least_radius(&self) -> f64;

    /// How much of it limbs of this radius show, in steps of one to [`STEPS`]: thinner ones are younger, and show its mean alone.
    fn clarity(&self, radius: f64) -> f64 {
        let least = self.least_radius();
        if radius >= least {
            return 1.0;
        }
        let steps = f64::from(STEPS);
        libm::floor(((radius / least - YOUNGEST) / (1.0 - YOUNGEST) * (steps - 1.0) + 1.0).max(0.0)) / steps
    }

    /// How much higher its colour lies than the material's own, in units of its size; below 0 it lies deeper.
    fn height(&self) -> f64 {
        0.0
    }

    /// Its mean share, from 0 to 1.
    fn mean(&self) -> f64;

    /// The share of its colour at a place, from 0 to 1.
    fn share(&self) -> Expr;

    /// Has it a direction, along limbs, so that a mesh without any shows its mean alone?
    fn follows_limbs(&self) -> bool {
        true
    }
}
