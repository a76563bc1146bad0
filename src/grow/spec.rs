//! Steps as a scene writes them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::method_spec::MethodSpec;
use super::near::Toward;
use super::paths::{GrammarSpec, RefineSpec};
use super::rounds::RepeatSpec;
use super::segments::AttractorSpec;
use super::space::Space;
use super::step::{Step, Unreached};
use crate::geom::ShapeSpec;
use crate::math::{PerRound, Point, Ref};
use crate::skeleton::{FormSpec, SymmetrySpec, Width};

/// One growth step: from generators, by paths to endpoints or in other ways.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepSpec {
    /// Take everything that is not given here from the step of this name.
    #[serde(default)]
    pub like: Option<Ref<Step>>,
    /// The space to grow in; segments and space colonisation need none.
    #[serde(default)]
    pub space: Option<Ref<Space>>,
    /// Where paths start.
    pub from: FromSpec,
    /// Where paths go: sets of endpoints, by name. Aggregates and regions have none.
    #[serde(default)]
    pub to: BTreeMap<String, EndpointSpec>,
    /// How limbs come about: by least-cost paths, unless said otherwise.
    #[serde(default)]
    pub by: MethodSpec,
    /// A point that growth by segments and by voxels tends to, such as the sun.
    #[serde(default)]
    pub toward: Option<AttractorSpec>,
    /// Grow from every end again, round after round, each time in a space of its own: the shape of the space is then
    /// around the end, with its z along the way the limb came (Xu and Mould 2012, section 3.2).
    #[serde(default)]
    pub repeat: Option<RepeatSpec>,
    /// Radii along the paths; limbs that start on another step are nowhere wider than that is there. Regions have none.
    #[serde(default)]
    pub width: Option<Width>,
    /// Natural limbs, for widths by `length` and `pipe`: what belongs together becomes one limb, kinks become curves,
    /// forks blend. Steps that take their width from the step they grow from take this from it too.
    #[serde(default)]
    pub form: Option<FormSpec>,
    /// Every path becomes a strand of its own, of so many straight pieces: hair, fur, moss (2007, Fig. 15).
    #[serde(default)]
    #[schemars(range(min = 1, max = 1000))]
    pub strands: Option<u32>,
    /// What grew stands around an axis several times.
    #[serde(default)]
    pub symmetry: Option<SymmetrySpec>,
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
    /// Nodes at random, each a generator of its own (on a lattice): seeds of regions, or plants that compete for space.
    Spread(SpreadSpec),
    /// Everywhere on what this step grew: carried to the nearest nodes, and joined where it is.
    All(Ref<Step>),
    /// At the ends of the paths of this step; of a repeated one at those from which it did not grow on.
    Ends(Ref<Step>),
    /// At the ends of all paths of these steps, of every round (2012, Table 2: "at the final level around the endpoints
    /// from all previous levels").
    EveryEnd(#[schemars(length(min = 1))] Vec<Ref<Step>>),
}

/// Generators at random.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpreadSpec {
    /// How many.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub count: u32,
    /// Where; by default anywhere in the space.
    #[serde(default)]
    pub inside: Option<ShapeSpec>,
    /// Least distance between them, in scene units.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub apart: f64,
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

/// A set of endpoints: exactly one of `count`, `at`, `through`, `sketch`, `strokes` and `grammar`. Adding to `count` keeps those already placed.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EndpointSpec {
    /// How many to place at random, 1 to 1,000,000; in a repeated step around each end, and 0 in rounds that have none.
    #[serde(default)]
    pub count: Option<PerRound>,
    /// Where to place them at random; by default anywhere in the space. In a repeated step it lies in the space around
    /// each end.
    #[serde(default)]
    pub inside: Option<ShapeSpec>,
    /// Only those at random no deeper than this below the surface of `inside` (of a sector: its round part): the shell of
    /// thickness d_e (2012, Figs. 10 and 11).
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub shell: Option<f64>,
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
    /// Endpoints by hand, each reached through other places in turn: lists of points, the last of which is the
    /// endpoint.
    #[serde(default)]
    pub through: Option<Vec<Vec<Point>>>,
    /// Endpoints from a sketch, its page stretched over the space's shape: the middle of each closed outline and the end of each
    /// open stroke. SVG, or JSON as an editor of strokes writes it: `{ "size": [width, height], "strokes": [[[x, y], ...], ...],
    /// "points": [[x, y], ...] }`, from the upper left corner.
    #[serde(default)]
    pub sketch: Option<String>,
    /// Endpoints at the ends of a sketch's strokes, each reached along its whole stroke: paths go through places of it, two spacings
    /// of the graph apart.
    #[serde(default)]
    pub strokes: Option<String>,
    /// Endpoints from an L-system.
    #[serde(default)]
    pub grammar: Option<GrammarSpec>,
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
