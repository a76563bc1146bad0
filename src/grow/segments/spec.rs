//! Growth by segments as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use super::expected::Expected;
use crate::geom::ShapeSpec;
use crate::math::{Degrees, Point};

/// Amin's Growth module: every limb grows a step at a time, a little off the way it came, and branches by chance. A step of
/// the scene is one of his segments - trunk, limbs, twigs, any number - and the next one grows `from.ends` of it; with
/// `sprout` it grows from all along it, so that branches are a segment of their own.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SegmentsSpec {
    /// How far a limb grows at a time, in scene units (GROWTH_SIZE).
    #[serde(default = "five")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub step: f64,
    /// How many times limbs grow.
    #[schemars(range(min = 1, max = 100_000))]
    pub depth: u32,
    /// Least and greatest angle by which a limb strays from its way each time; round about it anywhere.
    #[serde(default = "ten")]
    #[schemars(inner(range(min = 0.0, max = 180.0)))]
    pub jitter: [Degrees; 2],
    /// How limbs branch, each time they grow.
    #[serde(default)]
    pub branches: Option<BranchesSpec>,
    /// How limbs leave the step that this one grows from, with `from.all`: at every node of it where it grew on.
    #[serde(default)]
    pub sprout: Option<BranchesSpec>,
    /// The way of limbs that start at points; by default up.
    #[serde(default)]
    pub heading: Option<Point>,
    /// The bounding box, or any other shape: limbs stop where they would leave it. By default they never do.
    #[serde(default)]
    pub inside: Option<ShapeSpec>,
}

impl SegmentsSpec {
    /// How much grows from so many starts, on the average.
    #[must_use]
    pub fn expected(&self, starts: f64) -> Expected {
        let mean = |branches: BranchesSpec| f64::from(branches.most) * branches.chance;
        Expected::new(starts, self.depth, self.sprout.map(mean), self.branches.map_or(0.0, mean))
    }
}

/// Branches of one node.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BranchesSpec {
    /// How many at most.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 1000))]
    pub most: u32,
    /// The probability of each: 2 at 0.5 are none in a quarter of all nodes, one in half of them, two in a quarter
    /// (BRANCH_PROBABILITY).
    #[schemars(range(min = 0.0, max = 1.0))]
    pub chance: f64,
    /// Least and greatest angle from the limb that they leave.
    #[serde(default = "forty_to_sixty")]
    #[schemars(inner(range(min = 0.0, max = 180.0)))]
    pub angle: [Degrees; 2],
    /// Branch avoidance: the next branch of a limb lies in an arc of this angle about the limb, whose middle is opposite
    /// to the last one. 180 keeps them 90 degrees apart; 360 is anywhere.
    #[serde(default = "half")]
    #[schemars(range(min = 0.0, max = 360.0))]
    pub arc: Degrees,
}

/// A point that limbs tend to, usually outside of where they grow.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AttractorSpec {
    /// Where it is.
    pub at: Point,
    /// How strong it is. By segments limbs grow along `strength * to it + (1 - strength) * as they would`; by voxels it is
    /// what heading for it counts.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub strength: f64,
}

fn five() -> f64 {
    5.0
}

fn one() -> u32 {
    1
}

fn ten() -> [Degrees; 2] {
    [Degrees(0.0), Degrees(10.0)]
}

fn forty_to_sixty() -> [Degrees; 2] {
    [Degrees(40.0), Degrees(60.0)]
}

fn half() -> Degrees {
    Degrees(180.0)
}
