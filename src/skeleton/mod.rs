//! Skeletons: the union of paths as a forest of nodes with costs and radii.
//!
//! Later stages need never handle a cycle or a dangling parent: parents precede their children, positions are finite,
//! radii are finite and above 0 once a width has been given.

mod allometry;
mod build;
mod dimension;
mod form;
mod measure;
mod merge;
mod order;
mod plant;
mod relate;
mod resample;
mod smooth;
mod spline;
mod strands;
mod symmetry;
mod width;

pub use allometry::width_exponent;
pub use build::{Limb, Path, Skeleton, SkeletonNode};
pub use dimension::dimension;
pub use form::{Form, FormSpec};
pub use measure::{Measurement, measure, measure_from};
pub use order::Orders;
pub use plant::{Plant, PlantPart};
pub use relate::{apart, crossings, floating, nearest, shared_ends};
pub use smooth::smooth;
pub use spline::{bend, overlap, overlap_count};
pub use symmetry::SymmetrySpec;
pub use width::{ByLength, PerClass, Pipe, Taper, Width, WidthError};
