//! How many nodes a region holds, and what they take.

use crate::math::DVec3;

/// Mean number of nodes of a maximal Poisson-disc sample for each cubic spacing of volume, and for each square one of area.
const DENSITY: [f64; 2] = [0.75, 0.8];
/// Peak memory, in bytes a node, of the construction of a graph.
const NODE_BYTES: f64 = 420.0;
/// Bytes of the cells of a box where a node would have room: seven of them, as wide as the spacing over the root of 3.
const ROOM_BYTES: f64 = 7.0 * 4.0;

/// Larger estimates are refused: cells are counted by a `u32`.
pub(super) const MOST_NODES: f64 = 1e8;

/// Why nodes cannot be scattered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScatterError {
    /// No node lies in the region.
    #[error("no node fits in the shape: is it empty, or all of it forbidden?")]
    Empty,
    /// The estimate exceeds 1e8.
    #[error("about {0:.1e} nodes are too many (1e8 at most): use a wider spacing or a smaller shape")]
    TooMany(f64),
    /// The number of clusters is 0 or too large.
    #[error("`inside` holds {found} clusters that far apart, where 1 to {most} are possible: change `apart`")]
    Clusters {
        /// The number that `apart` yields.
        found: usize,
        /// The greatest possible number.
        most: usize,
    },
}

/// The estimated number of nodes with this spacing in the box with these corners.
#[must_use]
pub fn scatter_estimate(bounds: [DVec3; 2], spacing: f64, is_plane: bool) -> f64 {
    let extent = ((bounds[1] - bounds[0]) / spacing).max(DVec3::splat(-1.0)) + 1.0;
    if is_plane { extent.x * extent.y * DENSITY[1] } else { extent.x * extent.y * extent.z * DENSITY[0] }
}

/// The spacing of nodes that lie as densely as the kept share of those with this spacing.
#[must_use]
pub fn spacing_of_kept(spacing: f64, keep: f64, is_plane: bool) -> f64 {
    spacing / if is_plane { libm::sqrt(keep) } else { libm::cbrt(keep) }
}

/// Peak memory, in bytes, of the construction of a graph in a box with room for so many nodes, a share of which is open.
#[must_use]
pub fn scatter_bytes(nodes: f64, open: f64) -> u64 {
    (nodes * (open * NODE_BYTES + ROOM_BYTES)) as u64
}
