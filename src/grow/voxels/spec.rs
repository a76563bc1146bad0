//! Growth by voxels as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::ShapeSpec;
use crate::math::{Degrees, Point};

/// A voxel space automaton (Greene 1989, as Amin tells of it): each round every limb tries a few directions, takes the one that
/// has the most light and room, and stops where there is none. Steps in the same space grow together and compete; what grew
/// there before is in their way.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VoxelsSpec {
    /// How far a limb grows in a round, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub step: f64,
    /// Rounds.
    #[schemars(range(min = 1, max = 100_000))]
    pub rounds: u32,
    /// Nodes at most.
    #[serde(default = "many")]
    #[schemars(range(min = 1, max = 10_000_000))]
    pub nodes: u32,
    /// Directions that a limb tries each round.
    #[serde(default = "eight")]
    #[schemars(range(min = 1, max = 1000))]
    pub tries: u32,
    /// Least and greatest angle of what it tries from the way it came.
    #[serde(default = "turns")]
    #[schemars(inner(range(min = 0.0, max = 180.0)))]
    pub turn: [Degrees; 2],
    /// How limbs branch; by default they do not.
    #[serde(default)]
    pub branches: Option<AgeBranchesSpec>,
    /// Least distance from other growth, in scene units; by default half of a step.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub apart: Option<f64>,
    /// What it counts to be far from other growth: all of it at four times `apart`.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub room: f64,
    /// What it counts to go straight on.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub straight: f64,
    /// What light counts.
    #[serde(default)]
    pub light: LightSenseSpec,
    /// Leaves around every node take up the voxels, and the light, within this distance, in scene units; limbs grow through
    /// them.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e3))]
    pub foliage: f64,
    /// A surface to cling to.
    #[serde(default)]
    pub cling: Option<ClingSpec>,
    /// A shape to keep from.
    #[serde(default)]
    pub keep_from: Option<KeepFromSpec>,
    /// The way of limbs that start at points; by default up.
    #[serde(default)]
    pub heading: Option<Point>,
}

/// Branching by age (Greene's `branch_age_range`).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AgeBranchesSpec {
    /// Least and greatest number of rounds from a limb's start, or its last branch, to its next one; drawn for each.
    #[schemars(inner(range(min = 1, max = 100_000)))]
    pub age: [u32; 2],
    /// Least and greatest angle of what a branch tries first from the limb that it leaves.
    #[serde(default = "branch_angle")]
    #[schemars(inner(range(min = 0.0, max = 180.0)))]
    pub angle: [Degrees; 2],
}

/// How growth senses light: by rays through the voxels. A ray that is free counts by how much the limb heads for it: as
/// `(1 + cos) / 2` of the angle between.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightSenseSpec {
    /// What the sky counts.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub sky: f64,
    /// Rays to the sky.
    #[serde(default = "twelve")]
    #[schemars(range(min = 1, max = 1000))]
    pub rays: u32,
    /// The sun.
    #[serde(default)]
    pub sun: Option<SunSpec>,
}

impl Default for LightSenseSpec {
    fn default() -> Self {
        Self { sky: whole(), rays: twelve(), sun: None }
    }
}

/// Where the sun stands.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SunSpec {
    /// What it counts, if it shines all the time.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub counts: f64,
    /// Latitude, north of the equator.
    #[schemars(range(min = -90.0, max = 90.0))]
    pub latitude: Degrees,
    /// Day of the year: 80 is the equinox in spring, 172 the solstice in June.
    #[schemars(range(min = 1.0, max = 366.0))]
    pub day: f64,
    /// From when to when, in hours of solar time; rays go to where the sun is each hour.
    #[schemars(inner(range(min = 0.0, max = 24.0)))]
    pub hours: [f64; 2],
    /// Where north is: the angle from y, counterclockwise from above.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub north: Degrees,
}

/// A surface that growth clings to.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClingSpec {
    /// The shape whose surface it is.
    pub to: ShapeSpec,
    /// Least and greatest distance from it, in scene units: points where limbs start, and
    /// directions that lead elsewhere, are bent to there.
    #[schemars(inner(range(min = 0.0, max = 1e6)))]
    pub within: [f64; 2],
}

/// A shape that growth keeps from.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeepFromSpec {
    /// The shape.
    pub shape: ShapeSpec,
    /// Least distance from it, in scene units.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub by: f64,
}

fn many() -> u32 {
    100_000
}

fn eight() -> u32 {
    8
}

fn twelve() -> u32 {
    12
}

fn whole() -> f64 {
    1.0
}

fn turns() -> [Degrees; 2] {
    [Degrees(0.0), Degrees(35.0)]
}

fn branch_angle() -> [Degrees; 2] {
    [Degrees(30.0), Degrees(70.0)]
}
