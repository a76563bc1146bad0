//! Shapes, strokes and round cones.
//!
//! Later stages need never handle a shape with a negative size or a name that leads nowhere.

mod bounds;
mod closed_mesh;
mod marching_cubes;
mod occupancy;
mod outline;
mod profile;
mod round_cone;
mod sampled;
mod shape;
mod shape_spec;
mod strokes;
mod voxels;

pub use bounds::Bounds;
pub use closed_mesh::ClosedMesh;
pub use marching_cubes::{Surface, fill, vertex_normals};
pub use occupancy::Occupancy;
pub use outline::{Outline, simplified};
pub use profile::Profile;
pub use round_cone::{Frustum, frustum};
pub use sampled::Sampled;
pub use shape::{Shape, Solid};
pub use shape_spec::{MeshParts, Rings, ShapeFiles, ShapeSpec, SketchLines, SolidSpec};
pub use strokes::Strokes;
pub use voxels::Voxels;
