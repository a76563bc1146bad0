//! Ribs along a stem, as columnar cacti have them.

use schemars::JsonSchema;
use serde::Deserialize;

use super::expr::Expr;
use super::figure::Figure;
use crate::math::Colour;

/// Furrows between ribs that run along the stem.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ribs {
    /// Colour of the furrows.
    pub colour: Colour,
    /// Width of a rib of a stem that has twelve, in scene units: its radius is about twice as much; stems thinner than it have none.
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub size: f64,
    /// How deep furrows are, in sizes.
    #[serde(default = "depth")]
    #[schemars(range(min = 0.0, max = 5.0))]
    pub depth: f64,
}

fn depth() -> f64 {
    0.5
}

impl Figure for Ribs {
    fn name(&self) -> &'static str {
        "ribs"
    }

    fn colour(&self) -> Colour {
        self.colour
    }

    fn size(&self) -> f64 {
        self.size
    }

    fn least_radius(&self) -> f64 {
        self.size
    }

    fn height(&self) -> f64 {
        -self.depth
    }

    /// Half of the mean of `(1 - cos)^2`.
    fn mean(&self) -> f64 {
        0.375
    }

    /// Twelve furrows around: `cos 12 a` of the angle around the stem, by two triplings of its cosine and sine.
    fn share(&self) -> Expr {
        let across = Expr::from(1e-6).max((Expr::X * Expr::X + Expr::Z * Expr::Z).sqrt());
        // cos 3a = 4 c^3 - 3 c; cos 6a = 2 (cos 3a)^2 - 1; cos 12a likewise.
        let c = Expr::X / across;
        let three = c.clone() * c.clone() * c.clone() * 4.0 - c * 3.0;
        let double = |x: Expr| x.clone() * x * 2.0 - 1.0;
        let twelve = double(double(three));
        let furrow = Expr::from(0.5) - twelve * 0.5;
        furrow.clone() * furrow
    }
}
