//! Growth by segments with its names resolved.

use crate::geom::Shape;
use crate::math::DVec3;

/// Growth by segments, with its names resolved; angles are in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Segments {
    /// How far a limb grows at a time, in scene units.
    pub step: f64,
    /// How many times limbs grow.
    pub depth: u32,
    /// Least and greatest angle by which a limb strays from its way.
    pub jitter: [f64; 2],
    /// How limbs branch.
    pub branches: Option<Branches>,
    /// How they leave the step that they grow from.
    pub sprout: Option<Branches>,
    /// How far the limbs that it sprouts from grew at a time, where they grew by segments.
    pub along: Option<f64>,
    /// The way of limbs that start at points, of length 1.
    pub heading: DVec3,
    /// Where they stay.
    pub inside: Option<Shape>,
    /// What they tend to.
    pub toward: Option<Attractor>,
    /// How many starts are to be expected.
    pub starts: f64,
}

/// Branches of one node; angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches {
    /// How many at most.
    pub most: u32,
    /// The probability of each.
    pub chance: f64,
    /// Least and greatest angle from the limb.
    pub angle: [f64; 2],
    /// The arc about the limb in which the next branch lies, opposite to the last.
    pub arc: f64,
}

/// A point that limbs tend to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attractor {
    /// Where it is.
    pub at: DVec3,
    /// How strong it is, from 0 to 1.
    pub strength: f64,
}
