//! The kinds of spaces, a file each, and the sites that paths are planned in.

mod lattice;
mod on_lattice;
mod on_scatter;
mod resolve;
mod scatter;
mod voxels;

pub use lattice::{LatticeSpace, LatticeSpec};
pub(super) use on_lattice::{OnLattice, drawn_growth, on_lattice};
pub(super) use on_scatter::OnScatter;
pub use resolve::resolve_space;
pub use scatter::{Clusters, ClustersSpec, ScatterSpace, ScatterSpec};
pub(super) use scatter::{Scattered, SubgraphPlace};
pub use voxels::{VoxelError, VoxelNodesSpec, VoxelSpace};
