//! What a camera does to the light that comes to it.

use schemars::JsonSchema;
use serde::Deserialize;

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Width of its opening, in scene units; 0 shows everything sharp.
    pub aperture: f64,
    /// Distance along the view of what is sharp, in scene units.
    pub focus: f64,
}

impl Lens {
    /// Everything is sharp.
    pub const PINHOLE: Self = Self { aperture: 0.0, focus: 1.0 };

    /// Is everything sharp?
    #[must_use]
    pub fn is_pinhole(&self) -> bool {
        self.aperture == 0.0
    }
}

/// How light becomes a picture for the screen, besides the exact look and drawings, which show it as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Film {
    /// Highlights roll off towards white.
    #[default]
    Soft,
    /// What is brighter than white is white, as in POV-Ray.
    Plain,
}
