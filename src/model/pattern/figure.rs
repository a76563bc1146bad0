//! What a pattern offers.

use super::expr::Expr;
use crate::math::Colour;

/// A pattern passes into its mean on thinner limbs in so many steps, so that renderers need no more textures.
pub const STEPS: u32 = 3;
/// Limbs below this share of the least radius show the mean alone.
const YOUNGEST: f64 = 0.6;

/// A kind of pattern; lengths are in units of its size.
#[derive(Debug)]
pub(super) struct Kind {
    pub name: &'static str,
    /// Limbs from this radius on show all of it.
    pub least: f64,
    /// How much higher its colour lies than the material's own by default; below 0 it lies deeper.
    pub height: f64,
    /// Its mean share, as measured over many places, from 0 to 1.
    pub mean: f64,
    pub follows_limbs: bool,
    pub share: fn() -> Expr,
}

/// A pattern as renderers see it.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    pub(super) kind: &'static Kind,
    pub(super) colour: Colour,
    pub(super) size: f64,
    pub(super) height: f64,
}

impl Figure {
    /// Its name, as scenes have it and shaders are called.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.kind.name
    }

    /// The colour drawn over the material's own.
    #[must_use]
    pub fn colour(&self) -> Colour {
        self.colour
    }

    /// The unit of its coordinates, in scene units.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// How much of it limbs of this radius, in scene units, show, in steps of one to [`STEPS`]: thinner ones are younger, and show its
    /// mean alone.
    #[must_use]
    pub fn clarity(&self, radius: f64) -> f64 {
        let least = self.size * self.kind.least;
        if radius >= least {
            return 1.0;
        }
        let steps = f64::from(STEPS);
        libm::floor(((radius / least - YOUNGEST) / (1.0 - YOUNGEST) * (steps - 1.0) + 1.0).max(0.0)) / steps
    }

    /// How much higher its colour lies than the material's own, in units of its size; below 0 it lies deeper.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Its mean share, from 0 to 1.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.kind.mean
    }

    /// The share of its colour at a place, from 0 to 1.
    #[must_use]
    pub fn share(&self) -> Expr {
        (self.kind.share)()
    }

    /// Has it a direction, along limbs, so that a mesh without any shows its mean alone?
    #[must_use]
    pub fn follows_limbs(&self) -> bool {
        self.kind.follows_limbs
    }
}
