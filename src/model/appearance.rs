//! Materials, lights, ground and sky.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::{Colour, DVec3, Point};

/// What an object is made of, in the terms of POV-Ray's finish.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Its colour.
    pub colour: Colour,
    /// Share of light that it shows without any lamp.
    #[serde(default = "ambient")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub ambient: f64,
    /// Share of the lamps' light that it scatters.
    #[serde(default = "diffuse")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub diffuse: f64,
    /// Light of its own, as a multiple of its colour.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub emission: f64,
    /// Strength of the highlight.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub specular: f64,
    /// Size of the highlight: 0.001 is a point, 1 is all over.
    #[serde(default = "roughness")]
    #[schemars(range(min = 0.0005, max = 1.0))]
    pub roughness: f64,
}

fn ambient() -> f64 {
    0.2
}

fn diffuse() -> f64 {
    0.8
}

fn roughness() -> f64 {
    0.05
}

impl Material {
    /// A matt material of this colour.
    #[must_use]
    pub fn matt(colour: Colour) -> Self {
        Self { colour, ambient: ambient(), diffuse: diffuse(), emission: 0.0, specular: 0.0, roughness: roughness() }
    }

    /// Drawing ink: its own colour under every light.
    #[must_use]
    pub fn ink(colour: Colour) -> Self {
        Self { ambient: 0.0, diffuse: 0.0, emission: 1.0, ..Self::matt(colour) }
    }
}

/// A light as a scene writes it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LightSpec {
    /// Parallel light from far away.
    Sun {
        /// A point in the direction where it comes from.
        from: Point,
        /// Its colour times its strength.
        colour: Colour,
        /// Angle across which the sun is seen, for soft shadows; 0 gives sharp ones.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 30.0))]
        size: f64,
        /// Does it cast shadows?
        #[serde(default = "yes")]
        shadow: bool,
    },
    /// Light from a point, without falloff.
    Point {
        /// Where it is.
        at: Point,
        /// Its colour times its strength.
        colour: Colour,
        /// Does it cast shadows?
        #[serde(default = "yes")]
        shadow: bool,
    },
}

fn yes() -> bool {
    true
}

/// A light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Parallel light.
    Sun {
        /// Direction to the light, of length 1.
        towards: DVec3,
        /// Its colour times its strength.
        colour: Colour,
        /// Angle across which it is seen, in radians.
        size: f64,
        /// Does it cast shadows?
        shadow: bool,
    },
    /// Light from a point.
    Point {
        /// Where it is.
        at: DVec3,
        /// Its colour times its strength.
        colour: Colour,
        /// Does it cast shadows?
        shadow: bool,
    },
}

/// A level ground.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroundSpec {
    /// Its colour.
    pub colour: Colour,
    /// Its height, in scene units.
    #[serde(default)]
    #[schemars(range(min = -1e6, max = 1e6))]
    pub height: f64,
}

/// A level ground in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Its material.
    pub material: Material,
    /// Its z.
    pub height: f64,
    /// Distance from the origin where it has faded into the horizon.
    pub reach: f64,
}

/// What is behind everything: a gradient from the horizon up.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sky {
    /// Colour at the horizon and below.
    pub horizon: Colour,
    /// Colour overhead.
    pub zenith: Colour,
}
