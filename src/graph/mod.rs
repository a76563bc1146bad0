//! Randomly weighted graphs: regular lattices, whose weights are computed and never stored, and scattered ones, which
//! keep theirs.
//!
//! Later stages need never handle a weight of zero, a negative one or one that is not finite: every weight is a
//! fixed-point integer; on a lattice it is between [`WeightRange::least`] and [`WeightRange::most`].

mod cost_field;
mod field;
mod field_spec;
mod joined;
mod lattice;
mod mask;
mod poisson;
mod scatter;
mod sectors;
mod weights;

pub use cost_field::{CostField, Measure};
pub use field::{FieldTable, FieldValue};
pub use field_spec::{FieldSpec, FieldUse, HeightEnd, MeasureSpec};
pub use lattice::{Lattice, LatticeError, Window};
pub use mask::Mask;
pub use poisson::{Region, poisson_points};
pub use scatter::{EdgeWeights, Joining, Scatter, ScatterError, ScatterPlan, scatter_bytes, scatter_estimate};
pub use sectors::Sectors;
pub use weights::{WeightError, WeightRange, WeightTable};

/// A node of a graph: a compact name that its graph can turn into a place ([`Graph::cell`]) and neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Node(pub u32);

/// One edge as seen from the node that is being expanded.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// The node at the other end.
    pub node: Node,
    /// Its cell, in `0..graph.cells()`.
    pub cell: usize,
    /// The slot by which the other end leads back here.
    pub back: u32,
    /// Fixed-point weight, within the graph's [`WeightRange`].
    pub weight: u32,
}

/// What a least-cost search needs of a graph.
pub trait Graph: Sync {
    /// How many bits hold the number of a slot plus one.
    const SLOT_BITS: u32;

    /// Number of cells; a node's cell is below it, and no two nodes share one.
    fn cells(&self) -> usize;

    /// The cell of `node`.
    fn cell(&self, node: Node) -> usize;

    /// Calls `visit` with every edge from `node` to an open node.
    fn edges(&self, node: Node, visit: impl FnMut(Edge));

    /// Calls `visit` with cells that edges of the node at `cell` lead to, one in each cache line or so; they may be out
    /// of range.
    fn ahead(&self, cell: usize, visit: impl FnMut(usize));

    /// The node behind the edge in `slot` of `node`, and that edge's weight. `slot` comes from [`Edge::back`].
    fn follow(&self, node: Node, slot: u32) -> (Node, u32);

    /// Does a search have many nodes of nearly the same cost at a time, so that threads may share them?
    fn is_wide(&self) -> bool;

    /// The slab of the graph that holds `node`: nodes and cells of one are near each other, and edges seldom leave it.
    fn slab(&self, node: Node) -> u32;

    /// Is every neighbour of `node` one that no edge from another slab reaches?
    fn is_inner(&self, node: Node) -> bool;

    /// Bounds of the weights and their fixed-point scale.
    fn weight_range(&self) -> WeightRange;
}
