//! Nodes and edges, and what a least-cost search needs of a graph.

use super::WeightRange;

/// A node of a graph: a compact identifier from which the graph computes its cell ([`Graph::cell`]) and neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Node(pub u32);

/// A directed edge from the node that a search expands.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// The node at the other end.
    pub node: Node,
    /// Its cell, in `0..graph.cells()`.
    pub cell: usize,
    /// The slot of the reverse edge at the other end.
    pub back: u32,
    /// Fixed-point weight, within the graph's [`WeightRange`].
    pub weight: u32,
}

/// What a least-cost search needs of a graph.
pub trait Graph: Sync {
    /// Bits that hold a slot's number plus 1.
    fn slot_bits(&self) -> u32;

    /// The number of cells: the exclusive upper bound of [`Graph::cell`].
    fn cells(&self) -> usize;

    /// The cell of `node`, a unique array index.
    fn cell(&self, node: Node) -> usize;

    /// Calls `visit` with every edge from `node` to an open node.
    fn edges(&self, node: Node, visit: impl FnMut(Edge));

    /// Calls `visit` with cells of neighbours of the node at `cell`, about one for each cache line, to be prefetched; they may
    /// be out of range.
    fn ahead(&self, cell: usize, visit: impl FnMut(usize));

    /// The other end of the edge in `slot` of `node`, and its weight. `slot` is an [`Edge::back`].
    fn follow(&self, node: Node, slot: u32) -> (Node, u32);

    /// Are search fronts wide enough to be shared among threads?
    fn is_wide(&self) -> bool;

    /// The slab (partition) of `node`: cells of a slab are contiguous, and few edges cross its border.
    fn slab(&self, node: Node) -> u32;

    /// Is every neighbour of `node` out of reach of edges from other slabs?
    fn is_inner(&self, node: Node) -> bool;

    /// Bounds of the weights and their fixed-point scale.
    fn weight_range(&self) -> WeightRange;

    /// Calls `visitor` with this graph, or with one that has the same nodes and edges and is faster to search.
    fn accept<V: GraphVisitor>(&self, visitor: V) -> V::Output
    where
        Self: Sized,
    {
        visitor.visit(self)
    }
}

/// A computation on a graph whose type it does not know.
pub trait GraphVisitor {
    /// What it computes.
    type Output;

    /// Computes it.
    fn visit<G: Graph>(self, graph: &G) -> Self::Output;
}
