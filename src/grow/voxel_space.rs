//! Spaces of voxels.

use crate::geom::{Occupancy, Shape};

/// More voxels along an axis than this are refused.
const MOST_ACROSS: f64 = 4096.0;

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

impl VoxelSpace {
    /// Is it of a size that can be handled?
    ///
    /// # Errors
    /// A sentence where it is not.
    pub fn check(&self) -> Result<(), String> {
        let bounds = self.shape.bounds();
        if bounds.is_empty() || bounds.size().min_element() <= 0.0 {
            return Err("voxels need a shape with a thickness".to_owned());
        }
        let size = Occupancy::size(bounds, self.side);
        if size.iter().any(|&n| n.is_nan() || n > MOST_ACROSS) {
            let [x, y, z] = size;
            return Err(format!(
                "{x:.0} x {y:.0} x {z:.0} voxels are too many ({MOST_ACROSS:.0} along an axis at most): use a wider side or a smaller shape"
            ));
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
