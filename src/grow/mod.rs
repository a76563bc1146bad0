//! Growth: the steps of a scene, each to a skeleton: by least-cost paths in its space, by segments, in voxels, or as solids.
//!
//! A method is a folder; [`Method`] is what it offers. Later stages need never handle an endpoint without a path:
//! unreached ones are an error or dropped and counted.

mod baselines;
mod choice;
mod colonise;
mod construction;
mod crowd;
mod endpoints;
mod error;
mod finish;
mod grown;
mod limb_starts;
mod lookup;
mod method_spec;
mod methods;
mod near;
mod paths;
mod placement;
mod plants;
mod regions;
mod resolve;
mod rounds;
mod rules;
mod rules_check;
mod segments;
mod site;
mod space;
mod spaces;
mod spec;
mod starts;
mod step;
mod targets;
mod trial;
mod voxels;
mod weber_penn;

pub use baselines::{DbmSpec, DlaSpec, SIDE, Solver, Walk};
pub use colonise::{Colonise, ColoniseSpec};
pub use endpoints::{Endpoints, Placement, RandomPlaces};
pub use error::{GrowError, Key, Problem};
pub use grown::{Grown, MOST_NODES, Part};
pub use lookup::{Lookup, Sketched};
pub use method_spec::MethodSpec;
pub use near::{Near, Toward};
pub use paths::{FractalSpec, GrammarError, GrammarSpec, Paths, Refine, RefineError, RefineSpec, Vicinity};
pub use plants::check_plants;
pub use regions::{Regions, RegionsSpec};
pub use resolve::{resolve_step, waits_for_itself};
pub use rounds::{
    Canopy, Index, Influence, InfluenceSpec, LifespanSpec, Loss, Orient, Rank, RankSpec, Repeat, RepeatSpec, Rounds,
    ShadeSpec, Target, Turn, TurnSpec, Upright, sky,
};
pub use segments::{
    Attractor, AttractorSpec, Branches, BranchesSpec, Expected, Segments, SegmentsSpec, TooMany, expected_of,
};
pub use space::{NodesSpec, Space, SpaceSpec};
pub use spaces::{
    Clusters, ClustersSpec, LatticeSpace, LatticeSpec, ScatterSpace, ScatterSpec, VoxelError, VoxelNodesSpec,
    VoxelSpace, resolve_space,
};
pub use spec::{EndpointSpec, FromSpec, NearSpec, SpreadSpec, StepSpec};
pub use step::{Context, Generators, Method, Step, Unreached, Yield};
pub use voxels::{
    AgeBranchesSpec, Automaton, Cling, ClingSpec, KeepFromSpec, LightSense, LightSenseSpec, SunSpec, VoxelsSpec,
};
pub use weber_penn::{CrownShape, StemSpec, WeberPennSpec};
