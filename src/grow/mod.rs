//! Growth: the steps of a scene, each from a space and endpoints to a skeleton.
//!
//! Later stages need never handle an endpoint without a path: unreached ones are an error or dropped and counted.

mod choice;
mod construction;
mod dbm;
mod dla;
mod endpoints;
mod fractal;
mod grammar;
mod influence;
mod isosurface;
mod laplace;
mod refine;
mod regions;
mod repeat;
mod rounds;
mod scatter_space;
mod scattered;
mod solids;
mod space;
mod spec;
mod step;

pub use construction::{Mark, MarkKind};
pub use dbm::{Dbm, DbmSpec, SIDE, Solver};
pub use dla::{DlaSpec, Walk};
pub use endpoints::{Endpoints, Near, Placement};
pub use fractal::{FractalSpec, Vicinity};
pub use grammar::GrammarSpec;
pub use influence::{Canopy, Influence, Rank, sky};
pub use isosurface::{Distance, IsosurfaceSpec, isosurface};
pub use refine::{Refine, RefineSpec};
pub use regions::{Regions, RegionsSpec};
pub use repeat::{
    ClustersSpec, Index, InfluenceSpec, LifespanSpec, Loss, Orient, RankSpec, RepeatSpec, ShadeSpec, TurnSpec, Upright,
};
pub use rounds::{Repeat, Rounds, Target, Turn};
pub use scatter_space::{Clusters, ScatterSpace};
pub use space::{LatticeSpace, Space};
pub use spec::{
    EndpointSpec, FromSpec, LatticeSpec, MethodSpec, NearSpec, NodesSpec, ScatterSpec, SpaceSpec, SpreadSpec, StepSpec,
    Toward, Unreached,
};
pub use step::{GrowError, Grown, Method, Part, Source, Step};
