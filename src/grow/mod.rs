//! Growth: the steps of a scene, each to a skeleton: by least-cost paths in its space, by segments, in voxels, or as solids.
//!
//! Later stages need never handle an endpoint without a path: unreached ones are an error or dropped and counted.

mod automaton;
mod choice;
mod construction;
mod dbm;
mod dla;
mod endpoints;
mod finish;
mod fractal;
mod grammar;
mod influence;
mod isosurface;
mod laplace;
mod light;
mod neighbourhood;
mod refine;
mod regions;
mod repeat;
mod rounds;
mod scatter_space;
mod scattered;
mod segments;
mod segments_spec;
mod solids;
mod space;
mod spec;
mod starts;
mod step;
mod voxel_space;
mod voxels_spec;

pub use automaton::{Automaton, Cling};
pub use construction::{Mark, MarkKind};
pub use dbm::{Dbm, DbmSpec, SIDE, Solver};
pub use dla::{DlaSpec, Walk};
pub use endpoints::{Endpoints, Near, Placement};
pub use fractal::{FractalSpec, Vicinity};
pub use grammar::GrammarSpec;
pub use influence::{Canopy, Influence, Rank, sky};
pub use isosurface::{Distance, IsosurfaceSpec, isosurface};
pub use light::LightSense;
pub use refine::{Refine, RefineSpec};
pub use regions::{Regions, RegionsSpec};
pub use repeat::{
    ClustersSpec, Index, InfluenceSpec, LifespanSpec, Loss, Orient, RankSpec, RepeatSpec, ShadeSpec, TurnSpec, Upright,
};
pub use rounds::{Repeat, Rounds, Target, Turn};
pub use scatter_space::{Clusters, ScatterSpace};
pub use segments::{Attractor, Branches, Expected, Segments};
pub use segments_spec::{AttractorSpec, BranchesSpec, SegmentsSpec};
pub use space::{LatticeSpace, Space};
pub use spec::{
    EndpointSpec, FromSpec, LatticeSpec, MethodSpec, NearSpec, NodesSpec, ScatterSpec, SpaceSpec, SpreadSpec, StepSpec,
    Toward, Unreached, VoxelNodesSpec,
};
pub use step::{GrowError, Grown, MOST_NODES, Method, Part, Source, Step};
pub use voxel_space::VoxelSpace;
pub use voxels_spec::{AgeBranchesSpec, ClingSpec, KeepFromSpec, LightSenseSpec, SunSpec, VoxelsSpec};
