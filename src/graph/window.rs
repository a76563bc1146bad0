//! Windows onto the infinite lattice.

use super::WeightError;
use crate::math::DVec3;

/// The window of a lattice onto the infinite one, whose nodes are all multiples of the spacing.
///
/// A node's identity and an edge's weight do not depend on the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Distance between neighbours along an axis, in scene units.
    pub spacing: f64,
    /// Lattice coordinates of the lowest corner.
    pub origin: [i32; 3],
    /// Nodes along each axis; 1 along z for a plane lattice.
    pub size: [u32; 3],
}

/// Why a lattice cannot be constructed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The coordinates of a node do not fit into 32 bits.
    #[error(
        "a lattice of {} x {} x {} nodes is too large: its coordinates need {bits} bits of 32; use a wider spacing or a smaller shape",
        size[0], size[1], size[2]
    )]
    TooLarge {
        /// Nodes along each axis.
        size: [f64; 3],
        /// Bits that a node's coordinates need.
        bits: u32,
    },
    /// No node lies in the shape.
    #[error("no lattice node lies in the shape: use a smaller spacing or a larger shape")]
    Empty,
    /// The weights are out of range.
    #[error(transparent)]
    Weights(#[from] WeightError),
}

impl Window {
    /// The nodes with `min <= position <= max`, in two dimensions (z is 0) or three.
    ///
    /// # Errors
    /// [`LatticeError::TooLarge`] or [`LatticeError::Empty`].
    pub fn new(min: DVec3, max: DVec3, spacing: f64, dimensions: u32) -> Result<Self, LatticeError> {
        // In steps: a node on the border may be outside by rounding.
        let slack = 1e-6;
        let low = (min / spacing - DVec3::splat(slack)).to_array().map(libm::ceil);
        let high = (max / spacing + DVec3::splat(slack)).to_array().map(libm::floor);
        let mut size = [1.0_f64; 3];
        for axis in 0..dimensions as usize {
            size[axis] = high[axis] - low[axis] + 1.0;
        }
        if !size.iter().all(|&s| s >= 1.0) {
            return Err(LatticeError::Empty);
        }
        let bits = size.map(|s| libm::ceil(libm::log2(s.max(1.0))) as u32).iter().sum();
        let far = low.iter().chain(&high).any(|c| c.abs() > f64::from(i32::MAX / 2));
        if bits > 32 || far {
            return Err(LatticeError::TooLarge { size, bits });
        }
        let mut origin = low.map(|c| c as i32);
        if dimensions == 2 {
            origin[2] = 0;
        }
        Ok(Self { spacing, origin, size: size.map(|s| s as u32) })
    }

    /// The number of nodes.
    #[must_use]
    pub fn nodes(&self) -> u64 {
        self.size.iter().map(|&s| u64::from(s)).product()
    }

    /// The position, in scene units, of the node with coordinates `at` within the window.
    #[must_use]
    pub fn position(&self, at: [u32; 3]) -> DVec3 {
        let [x, y, z] = [0, 1, 2].map(|axis| (f64::from(self.origin[axis]) + f64::from(at[axis])) * self.spacing);
        DVec3::new(x, y, z)
    }

    /// The coordinates within the window of the node nearest to `position`, `None` if that is outside by more than half a
    /// step.
    #[must_use]
    pub fn nearest(&self, position: DVec3) -> Option<[u32; 3]> {
        let position = position.to_array();
        let mut at = [0; 3];
        for axis in 0..3 {
            let c = libm::round(position[axis] / self.spacing) - f64::from(self.origin[axis]);
            if !(c >= 0.0 && c < f64::from(self.size[axis])) {
                return None;
            }
            at[axis] = c as u32;
        }
        Some(at)
    }
}
