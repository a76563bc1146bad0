//! Growth: the steps of a scene, each from a space and endpoints to a skeleton.
//!
//! Later stages need never handle an endpoint without a path: unreached ones are an error or dropped and counted.

mod construction;
mod dbm;
mod endpoints;
mod laplace;
mod refine;
mod space;
mod spec;
mod step;

pub use construction::{Mark, MarkKind};
pub use dbm::{Dbm, DbmSpec, SIDE, Solver};
pub use endpoints::{Endpoints, Near, Placement};
pub use refine::{Refine, RefineSpec};
pub use space::Space;
pub use spec::{
    EndpointSpec, FromSpec, LatticeSpec, MethodSpec, NearSpec, NodesSpec, SpaceSpec, StepSpec, Toward, Unreached,
};
pub use step::{GrowError, Grown, Method, Part, Source, Step};
