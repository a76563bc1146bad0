//! The picture as a place to draw on: a flat scene's own rectangle, with or without a photograph in it.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::Bounds;
use crate::math::DVec3;

/// The picture of a flat scene as a rectangle of scene units, so that what is placed in it stays there at any size. The
/// shapes `view` (all of it) and `sky` (what is above the horizon, and a tenth of the height beyond the other edges, where
/// strokes may come from) come with it. Left and bottom are 0.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ViewSpec {
    /// Height of the picture in scene units, 1 by default; its width follows from its size in pixels.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub height: Option<f64>,
    /// A photograph beside the scene to shine over: JPEG, PNG, TIFF, WebP or OpenEXR. Without it all is black.
    pub plate: Option<String>,
    /// A picture as large as the photograph, white where it shows something nearer than the strokes.
    pub matte: Option<String>,
    /// Height of the horizon in scene units: the shape `sky` ends there.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub horizon: Option<f64>,
}

/// How far the sky goes on beyond the picture, as a share of its height.
pub const BEYOND: f64 = 0.1;

/// A view whose size is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewFrame {
    /// Width and height in scene units.
    pub extent: [f64; 2],
    /// Height of the horizon, in scene units.
    pub horizon: f64,
    /// Size of a pixel, in scene units.
    pub pixel: f64,
}

impl ViewFrame {
    /// The frame of `spec` for a picture of `size` pixels.
    #[must_use]
    pub fn new(spec: &ViewSpec, size: [u32; 2]) -> Self {
        let height = spec.height.unwrap_or(1.0);
        let pixel = height / f64::from(size[1]);
        Self { extent: [f64::from(size[0]) * pixel, height], horizon: spec.horizon.unwrap_or(0.0).min(height), pixel }
    }

    /// All of it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds { min: DVec3::ZERO, max: DVec3::new(self.extent[0], self.extent[1], 0.0) }
    }

    /// What is above the horizon, and a tenth of the height more to the sides and upwards.
    #[must_use]
    pub fn sky(&self) -> Bounds {
        let [width, height] = self.extent;
        let beyond = height * BEYOND;
        Bounds { min: DVec3::new(-beyond, self.horizon, 0.0), max: DVec3::new(width + beyond, height + beyond, 0.0) }
    }
}
