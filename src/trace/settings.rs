//! What is asked for of a picture.

use crate::model::Look;

/// The parameters of a rendering.
#[derive(Clone, Copy, Debug)]
pub struct RenderSettings {
    /// Size of the whole picture, in pixels.
    pub size: [u32; 2],
    /// The crop window: left, top, width, height, in pixels.
    pub crop: [u32; 4],
    /// The look.
    pub look: Look,
    /// Samples a pixel. In the exact look, 1 is the pixel's centre; n is POV-Ray's `+AM1` with `+R` the square root of n: a grid and
    /// the centre.
    pub samples: u32,
    /// Omit the sky: alpha is the coverage by objects and ground.
    pub transparent: bool,
    /// Record [`super::Data`].
    pub data: bool,
}

impl RenderSettings {
    /// A whole picture of this size.
    #[must_use]
    pub fn new(size: [u32; 2], look: Look, samples: u32) -> Self {
        Self { size, crop: [0, 0, size[0], size[1]], look, samples, transparent: false, data: false }
    }
}
