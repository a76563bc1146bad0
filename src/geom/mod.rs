//! Shapes as signed distance functions, strokes, round cones, triangle surfaces.
//!
//! Later stages need never handle a shape with a negative size or an unresolved name.

mod bounds;
mod closed_mesh;
mod marching_cubes;
mod mark;
mod neighbours;
mod occupancy;
mod outline;
mod polygon;
mod profile;
mod round_cone;
mod sampled;
mod segment;
mod shape;
mod shape_error;
mod shape_spec;
mod strokes;
mod surface;
mod voxels;

pub use bounds::Bounds;
pub use closed_mesh::{ClosedMesh, ClosedMeshError};
pub use mark::{Mark, MarkKind};
pub use neighbours::{Neighbours, NeighboursError};
pub use occupancy::Occupancy;
pub use outline::{Outline, OutlineError, simplified};
pub use polygon::fill;
pub use profile::{Profile, ProfileError};
pub use round_cone::{Frustum, frustum};
pub use sampled::{Sampled, SignedDistance};
pub use segment::{segment_distance, segment_distance_squared, segment_parameter};
pub use shape::{Shape, Solid};
pub use shape_error::ShapeError;
pub use shape_spec::{MeshParts, Rings, ShapeFiles, ShapeSpec, SketchLines, SolidSpec};
pub use strokes::Strokes;
pub use surface::{Surface, vertex_normals};
pub use voxels::Voxels;
