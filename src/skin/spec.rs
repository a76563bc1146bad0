//! Skins as a scene names them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::IsosurfaceSpec;
use super::cones::count_overlapping;
use crate::geom::Surface;
use crate::math::DVec3;
use crate::model::{Ball, Mesh, to_world};
use crate::skeleton::{Skeleton, SkeletonNode};

/// Bytes that a ring of a tube takes while its mesh is rounded: 10 corners with normals, two triangles each with places.
const RING_BYTES: u64 = 10 * 2 * (2 * 24 + 2 * (12 + 48));

/// How a skeleton becomes solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Skin {
    /// A sphere at each node, with more between them until they overlap (Xu and Mould 2008, section 4).
    Spheres,
    /// A round cone along each segment: the frustum tangent to the spheres at its ends, and these.
    #[default]
    Cones,
    /// One smooth surface of triangles around limbs that are joined where one leaves another, with places for a texture
    /// around and along them. Copies share it, and its leaves, which a union of cones does not in POV-Ray.
    Mesh,
    /// One surface around all that is no farther from the limbs than their width (2007, section 3.3).
    Isosurface(IsosurfaceSpec),
    /// Of steps by regions: their borders, an object each (2007, section 3.4).
    Surface,
}

impl Skin {
    /// Are limbs and leaves triangles of one mesh each?
    #[must_use]
    pub fn is_mesh(&self) -> bool {
        match self {
            Self::Mesh => true,
            Self::Spheres | Self::Cones | Self::Isosurface(_) | Self::Surface => false,
        }
    }

    /// Bytes that it takes around `skeletons` at its peak; an isosurface asks itself, a surface is there already.
    #[must_use]
    pub fn bytes_needed(&self, skeletons: &[&Skeleton]) -> u64 {
        let nodes = skeletons.iter().map(|s| s.nodes.len() as u64).sum::<u64>();
        // Parts by level or colour are copies.
        let ball = 2 * (size_of::<Ball>() + size_of::<[u32; 2]>()) as u64;
        match self {
            Self::Cones => nodes * ball,
            Self::Spheres => {
                let balls = skeletons.iter().map(|s| count_overlapping(s)).sum::<u64>();
                balls * (ball + size_of::<SkeletonNode>() as u64)
            }
            Self::Mesh => nodes * RING_BYTES,
            Self::Isosurface(_) | Self::Surface => 0,
        }
    }

    /// Are levels of growth bodies of their own?
    #[must_use]
    pub fn has_levels(&self) -> bool {
        match self {
            Self::Spheres | Self::Cones | Self::Surface => true,
            Self::Mesh | Self::Isosurface(_) => false,
        }
    }
}

/// A closed surface as a mesh from `foot`, with smooth normals; in a flat scene its filled area.
#[must_use]
pub fn surface_mesh(surface: &Surface, foot: DVec3, is_flat: bool) -> Mesh {
    let points = surface.points.iter().map(|&p| to_world(p - foot, is_flat)).collect();
    let normals = if is_flat { Vec::new() } else { surface.normals() };
    Mesh { points, normals, triangles: surface.triangles.clone(), uvs: Vec::new() }
}
