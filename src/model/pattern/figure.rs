//! What a pattern offers.

use super::expr::Expr;
use crate::math::Colour;

/// A kind of pattern.
pub trait Figure {
    /// Its name, as scenes have it and shaders are called.
    fn name(&self) -> &'static str;

    /// The colour drawn over the material's own.
    fn colour(&self) -> Colour;

    /// The unit of its coordinates, in scene units.
    fn size(&self) -> f64;

    /// Limbs below this radius, in scene units, show the pattern's mean alone.
    fn least_radius(&self) -> f64;

    /// Its mean share, from 0 to 1.
    fn mean(&self) -> f64;

    /// The share of its colour at a place, from 0 to 1.
    fn share(&self) -> Expr;

    /// Has it a direction, along limbs, so that a mesh without any shows its mean alone?
    fn follows_limbs(&self) -> bool {
        true
    }
}
