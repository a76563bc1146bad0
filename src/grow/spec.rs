//! Spaces and steps as a scene writes them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{DbmSpec, RefineSpec, Space, Step};
use crate::geom::ShapeSpec;
use crate::graph::{FieldSpec, Neighbours, Weights};
use crate::math::{Point, Ref};
use crate::skeleton::Width;

/// A randomly weighted graph in a shape, where paths are planned.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpaceSpec {
    /// Take everything that is not given here from the space of this name. The random weights are this space's own.
    #[serde(default)]
    pub like: Option<Ref<Space>>,
    /// Where nodes are.
    pub shape: ShapeSpec,
    /// A shape that no path enters.
    #[serde(default)]
    pub forbid: Option<ShapeSpec>,
    /// How nodes are laid out and joined.
    pub nodes: NodesSpec,
    /// The random part of the weights.
    #[serde(default)]
    pub weights: Weights,
    /// Cost fields, by name.
    #[serde(default)]
    pub field: BTreeMap<String, FieldSpec>,
    /// The name of the random stream: spaces with the same one have the same random weights. By default the space's
    /// own name.
    #[serde(default)]
    pub stream: Option<String>,
}

/// How the nodes of a graph are laid out.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum NodesSpec {
    /// A regular lattice.
    Lattice(LatticeSpec),
}

/// A regular lattice: its nodes are the multiples of the spacing within the shape.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LatticeSpec {
    /// Distance between neighbours along an axis, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub spacing: f64,
    /// 4 or 8 neighbours in the plane, 6, 18 or 26 in space; longer edges cost in proportion.
    pub neighbours: Neighbours,
}

/// One growth step: paths from generators to endpoints.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepSpec {
    /// Take everything that is not given here from the step of this name.
    #[serde(default)]
    pub like: Option<Ref<Step>>,
    /// The space to plan in.
    pub space: Ref<Space>,
    /// Where paths start.
    pub from: FromSpec,
    /// Where paths go: sets of endpoints, by name.
    pub to: BTreeMap<String, EndpointSpec>,
    /// How limbs come about: by least-cost paths, unless said otherwise.
    #[serde(default)]
    pub by: MethodSpec,
    /// Radii along the paths; limbs that start on another step are nowhere wider than that is there.
    pub width: Width,
    /// What it costs to go along the step that this one grows from, over what it costs elsewhere: at 0 branches leave at
    /// right angles, at 0.7 at about half of one.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 0.95))]
    pub along: f64,
    /// Plan again on finer lattices around the paths.
    #[serde(default)]
    pub refine: Option<RefineSpec>,
    /// Positions are averaged along limbs over about this many steps of the (last refined) lattice to either side; 0
    /// leaves every step of the lattice to be seen.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 20.0))]
    pub smooth: f64,
    /// What to do about endpoints that no path reaches.
    #[serde(default)]
    pub unreached: Unreached,
}

/// The generators of a step: the nodes at cost 0.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FromSpec {
    /// The nodes nearest to these points.
    At(#[schemars(length(min = 1))] Vec<Point>),
    /// All nodes in a shape.
    Inside(ShapeSpec),
    /// Everywhere on what this step grew: carried to the nearest nodes, and joined where it is.
    All(Ref<Step>),
    /// At the ends of the paths of this step.
    Ends(Ref<Step>),
}

/// How limbs come about.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MethodSpec {
    /// By least-cost paths (Xu and Mould 2007, section 3).
    #[default]
    Paths,
    /// By the dielectric breakdown model, as a baseline.
    Dbm(DbmSpec),
}

/// Endpoints in the vicinity of what a step grew (Xu and Mould 2007, section 4: side branches of lightning).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NearSpec {
    /// The step.
    pub step: Ref<Step>,
    /// Distance from it, at most (and three tenths of it at least), in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub reach: f64,
    /// What `lower` is a bias towards.
    #[serde(default)]
    pub toward: Toward,
    /// Bias of the direction: 0 is any direction, 0.5 the lower half, 1 straight down.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub lower: f64,
    /// By how much the reach has shrunk where the step ends: 0 not at all, 1 to nothing.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub shorten: f64,
}

/// Where side branches tend to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Toward {
    /// Down.
    #[default]
    Down,
    /// The way that the step goes, from its root to the end of its first path.
    Along,
}

/// A set of endpoints: exactly one of `count`, `at` and `sketch`. Adding to `count` keeps those already placed.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EndpointSpec {
    /// How many to place at random.
    #[serde(default)]
    #[schemars(range(min = 1, max = 1_000_000))]
    pub count: Option<u32>,
    /// Where to place them at random; by default anywhere in the space.
    #[serde(default)]
    pub inside: Option<ShapeSpec>,
    /// Place those at random in the vicinity of a step, which has then grown before.
    #[serde(default)]
    pub near: Option<NearSpec>,
    /// Least distance between those placed at random, in scene units.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub apart: f64,
    /// Endpoints by hand.
    #[serde(default)]
    pub at: Option<Vec<Point>>,
    /// Endpoints from an SVG file, its page stretched over the space's shape: the middle of each closed outline and
    /// the end of each open stroke.
    #[serde(default)]
    pub sketch: Option<String>,
    /// The class of their paths, for widths that differ by class.
    #[serde(default = "main_class")]
    #[schemars(length(min = 1))]
    pub class: String,
    /// The name of the random stream: sets with the same one draw the same places. By default the step's and the set's
    /// own names.
    #[serde(default)]
    pub stream: Option<String>,
}

fn main_class() -> String {
    "main".to_owned()
}

/// What to do about endpoints that no path reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Unreached {
    /// Refuse the scene.
    #[default]
    Error,
    /// Leave them out, with a warning that counts them.
    Drop,
}
