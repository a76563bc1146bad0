//! Claims: what a figure shows, as numbers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geom::{Shape, ShapeSpec};
use crate::grow::Step;
use crate::math::Ref;

/// A claim about a step: one quantity, and what it is held against.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// The claim in words.
    pub says: String,
    /// What is measured.
    pub measure: Quantity,
    /// The step that it is measured of.
    pub of: Ref<Step>,
    /// It is at least this.
    #[serde(default)]
    pub at_least: Option<f64>,
    /// It is at most this.
    #[serde(default)]
    pub at_most: Option<f64>,
    /// It is more than the same quantity of this step.
    #[serde(default)]
    pub more_than: Option<Ref<Step>>,
    /// It is as much as the same quantity of this step, to `within`.
    #[serde(default)]
    pub as_of: Option<Ref<Step>>,
    /// The greatest difference from that of `as_of`.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub within: f64,
    /// It is more than the other by at least this factor.
    #[serde(default = "one")]
    #[schemars(range(min = 1.0, max = 1e6))]
    pub times: f64,
    /// For `shared`, `floating`, `crossings`, `apart`, `nearest`, `dimension`, `endpoints` and `graph_nodes`: the other step.
    #[serde(default)]
    pub with: Option<Ref<Step>>,
    /// For `nearest`, `farthest` and `inside`: the shape.
    #[serde(default)]
    pub shape: Option<ShapeSpec>,
    /// What is a matter of chance is claimed of the mean over so many seeds: the scene's, and those after it.
    #[serde(default = "once")]
    #[schemars(range(min = 1, max = 64))]
    pub seeds: u32,
    /// The frame of the animation that is claimed of, in place of the one that the scene is grown for.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub frame: Option<f64>,
}

/// A claim whose shape is resolved.
#[derive(Clone, Debug)]
pub struct Claimed {
    /// The claim.
    pub claim: Claim,
    /// Its shape.
    pub shape: Option<Shape>,
}

fn one() -> f64 {
    1.0
}

fn once() -> u32 {
    1
}

/// What a claim measures: fields of [`crate::skeleton::Measurement`], and how two steps lie to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Number of paths, with those of the step `with` where there is one.
    Endpoints,
    /// Total length of all limbs.
    Length,
    /// Mean length of a path over the straight distance between its ends.
    Tortuosity,
    /// Mean distance of the limbs from the upright line through the root.
    Offset,
    /// Mean height of the limbs, as a share of the greatest.
    Height,
    /// Mean height of the forks, as a share of the greatest height.
    ForkHeight,
    /// Greatest distance from the upright line through the root, over the greatest height.
    Spread,
    /// Length up to the first fork, as a share of the greatest height.
    Trunk,
    /// Number of nodes of the skeleton.
    Nodes,
    /// How far the lowest end lies below the root.
    Depth,
    /// Share of the paths that end lower than they start.
    Falling,
    /// The greatest radius.
    Radius,
    /// The greatest radius over the mean one at the ends.
    Taper,
    /// Box-counting dimension, with the step `with` where there is one.
    Dimension,
    /// Share of the step's endpoints that are endpoints of the step `with` too.
    Shared,
    /// Number of limbs that do not start on the step `with`.
    Floating,
    /// How often limbs cross those of the step `with`; without it, each other.
    Crossings,
    /// The greatest distance from the limbs of the step `with`.
    Apart,
    /// The least distance of a node from `shape`, negative inside of it, or from the limbs of the step `with`.
    Nearest,
    /// The greatest distance of a node from `shape`.
    Farthest,
    /// The share of the nodes that lie in `shape`.
    Inside,
    /// How many directions limbs take in the plane.
    Directions,
    /// How different ways to the ends are in length.
    LengthVariation,
    /// How much room there is between ends: 1 for ends at random in a ball (in the plane, a disc), more where they form clusters.
    Gaps,
    /// How long the paths of a level are, over those of the level before.
    LevelRatio,
    /// Exponent of the width of limbs over the length of the longest path to a tip; trees have about 1.5.
    WidthExponent,
    /// How far to the right (along x) ends are, as a share of how far they spread.
    Lean,
    /// The order of Strahler.
    Strahler,
    /// Limbs of an order over those of the next (Horton).
    Bifurcation,
    /// Mean length of the limbs of the first order.
    Twig,
    /// Nodes of the graph, with those of the step `with` where there is one.
    GraphNodes,
    /// Edges of the graph for each of its nodes.
    EdgesPerNode,
    /// Endpoints that no path reached.
    Dropped,
    /// Number of trees: nodes where growth began.
    Trees,
    /// The share of all nodes that the largest tree has.
    LargestShare,
    /// How far it is from looking the same after a sixth of a turn about its middle, as a share of its greatest extent.
    SixfoldError,
    /// Of regions: their number.
    Surfaces,
    /// Of regions: 1 where all their surfaces are closed, consistently oriented 2-manifolds, else 0.
    Closed,
    /// Of regions: the least share that one has of the ball around it.
    Compactness,
    /// Of regions: the mean of the surface of one over that of a ball with its volume.
    Roughness,
}
