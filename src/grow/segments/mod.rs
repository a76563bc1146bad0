//! Growth by segments, without a graph (Amin's Growth module).

mod expected;
mod growth;
mod resolve;
mod spec;
mod values;

pub use expected::{Expected, TooMany};
pub(super) use growth::strayed;
pub use resolve::expected_of;
pub(super) use resolve::{RULES, angles, attractor, check_free, heading, in_order, resolve};
pub use spec::{AttractorSpec, BranchesSpec, SegmentsSpec};
pub use values::{Attractor, Branches, Segments};
