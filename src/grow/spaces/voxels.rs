//! Spaces of voxels.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::{Occupancy, Shape};

/// More voxels along an axis than this are refused.
const MOST_ACROSS: f64 = 4096.0;

/// Voxels: the space is kept where something is in it, so that a large one costs little.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VoxelNodesSpec {
    /// Side of a voxel, in scene units: no more than half as wide as the thinnest wall is thick.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub side: f64,
}

/// Voxels in a shape, with nothing stored where nothing is.
#[derive(Clone, Debug)]
pub struct VoxelSpace {
    /// Where growth stays.
    pub shape: Shape,
    /// What takes up voxels, and light.
    pub forbid: Option<Shape>,
    /// Side of a voxel, in scene units.
    pub side: f64,
}

/// Why voxels cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VoxelError {
    /// A flat shape.
    #[error("voxels need a shape with a thickness")]
    Flat,
    /// Too many along an axis.
    #[error(
        "{:.0} x {:.0} x {:.0} voxels are too many ({MOST_ACROSS:.0} along an axis at most): use a wider side or a smaller shape",
        .0[0], .0[1], .0[2]
    )]
    TooMany([f64; 3]),
}

impl VoxelSpace {
    /// Every shape in it, to change.
    pub(in crate::grow) fn shapes_mut(&mut self) -> Vec<&mut Shape> {
        std::iter::once(&mut self.shape).chain(&mut self.forbid).collect()
    }

    /// Is it of a size that can be handled?
    ///
    /// # Errors
    /// [`VoxelError`].
    pub fn check(&self) -> Result<(), VoxelError> {
        let bounds = self.shape.bounds();
        if bounds.is_empty() || bounds.size().min_element() <= 0.0 {
            return Err(VoxelError::Flat);
        }
        let size = Occupancy::size(bounds, self.side);
        if size.iter().any(|&n| n.is_nan() || n > MOST_ACROSS) {
            return Err(VoxelError::TooMany(size));
        }
        Ok(())
    }

    /// The voxels, with what is forbidden in them.
    #[must_use]
    pub fn voxels(&self) -> Occupancy {
        let mut voxels = Occupancy::new(self.shape.bounds(), self.side);
        if let Some(forbid) = &self.forbid {
            voxels.insert_shape(forbid);
        }
        voxels
    }

    /// Bytes that the voxels take, nearly: those around surfaces as large as all sides of the space.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        let [x, y, z] = Occupancy::size(self.shape.bounds(), self.side);
        let sides = 2.0 * (x * y + y * z + z * x);
        (x * y * z / 65_536.0 + sides * 16.0) as u64
    }
}
