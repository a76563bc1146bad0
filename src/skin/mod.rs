//! Skins: from skeletons to bodies, and what stands on them.
//!
//! Later stages need never handle a skeleton: limbs are round cones or triangles, leaves are posed meshes.

mod cones;
mod distant;
mod isosurface;
mod leaf_mesh;
mod leaf_tints;
mod leaves;
mod levels;
mod paint;
mod spec;
mod strokes;
mod terrain;
mod thorns;
mod tubes;
mod turf;

pub use cones::{cones, foot, spheres};
pub use distant::{distant_leaves, distant_limbs, distant_step, distant_triangles};
pub use isosurface::{Distance, IsosurfaceError, IsosurfaceSpec, isosurface};
pub use leaf_mesh::{LeafError, ball_mesh, leaf_mesh};
pub use leaf_tints::LeafTints;
pub use leaves::{LeafLight, LeavesSpec};
pub use levels::by_level;
pub use paint::{PaintSpec, Painting, painted};
pub use spec::{Skin, surface_mesh};
pub use strokes::{shining, stroke};
pub use terrain::{terrain, terrain_bytes};
pub use thorns::ThornsSpec;
pub use tubes::tubes;
pub use turf::turf;
