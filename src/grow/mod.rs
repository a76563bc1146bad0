//! Growth: the steps of a scene, each from a space and endpoints to a skeleton.
//!
//! Later stages need never handle an endpoint without a path: unreached ones are an error or dropped and counted.

mod construction;
mod endpoints;
mod space;
mod spec;
mod step;

pub use construction::{Mark, MarkKind};
pub use endpoints::{Endpoints, Placement};
pub use space::Space;
pub use spec::{EndpointSpec, FromSpec, LatticeSpec, NodesSpec, SpaceSpec, StepSpec, Unreached};
pub use step::{GrowError, Grown, Source, Step};
