//! The result of a search: the shortest-path forest, walked back from any node by predecessors.

use super::cells::{Cells, slot_mask};
use crate::graph::{Graph, Node};

/// Least-cost paths over a graph: four bytes a node.
pub struct Plan<'g, G> {
    graph: &'g G,
    cells: Cells,
    settled: usize,
    /// Upper bound of all costs, in the units of a cell.
    farthest: u64,
}

impl<'g, G: Graph> Plan<'g, G> {
    pub(super) fn new(graph: &'g G, cells: Cells, settled: usize, farthest: u64) -> Self {
        Self { graph, cells, settled, farthest }
    }

    pub(super) fn parts(&self) -> (&'g G, &Cells, u64) {
        (self.graph, &self.cells, self.farthest)
    }

    /// The graph that was searched.
    #[must_use]
    pub fn graph(&self) -> &'g G {
        self.graph
    }

    /// The number of nodes with final costs.
    #[must_use]
    pub fn settled(&self) -> usize {
        self.settled
    }

    /// Is there a path to `node`? After an early end the answer is final only for wanted nodes and cheaper ones.
    #[must_use]
    pub fn is_reached(&self, node: Node) -> bool {
        self.cells.get(self.graph.cell(node)) != 0
    }

    /// The predecessor of `node`, one step nearer to its generator, and the weight of the edge; `None` at a generator or an
    /// unreached node.
    #[must_use]
    pub fn predecessor(&self, node: Node) -> Option<(Node, u32)> {
        let slot = self.cells.get(self.graph.cell(node)) & slot_mask(self.graph);
        if slot == 0 {
            return None;
        }
        Some(self.graph.follow(node, slot - 1))
    }

    /// The nodes of the path from `node` back to its generator, both included.
    pub fn path(&self, node: Node) -> impl Iterator<Item = Node> + '_ {
        std::iter::successors(Some(node), |&at| self.predecessor(at).map(|(to, _)| to))
    }

    /// The least cost of `node`, fixed-point ([`crate::graph::WeightRange::real`]), or `None` if it was not reached.
    #[must_use]
    pub fn cost(&self, node: Node) -> Option<u64> {
        if !self.is_reached(node) {
            return None;
        }
        let mut cost = 0;
        let mut at = node;
        while let Some((to, weight)) = self.predecessor(at) {
            cost += u64::from(weight);
            at = to;
        }
        Some(cost)
    }

    /// A fold along each path: for each cell of `nodes`, the value of `start` at its generator, changed by `step` with the
    /// weight of every edge from there; `unreached` where there is no path. Each edge is walked at most twice.
    #[must_use]
    pub fn carry<T: Copy>(
        &self,
        nodes: impl Iterator<Item = Node>,
        unreached: T,
        start: impl Fn(Node) -> T,
        step: impl Fn(T, u32) -> T,
    ) -> Vec<T> {
        let mut values = vec![unreached; self.graph.cells()];
        let mut known = vec![false; self.graph.cells()];
        let mut path = Vec::new();
        for node in nodes.filter(|&node| self.is_reached(node)) {
            let mut at = node;
            let mut value = loop {
                if known[self.graph.cell(at)] {
                    break values[self.graph.cell(at)];
                }
                let Some((to, weight)) = self.predecessor(at) else {
                    let value = start(at);
                    (values[self.graph.cell(at)], known[self.graph.cell(at)]) = (value, true);
                    break value;
                };
                path.push((at, weight));
                at = to;
            };
            for (at, weight) in path.drain(..).rev() {
                value = step(value, weight);
                (values[self.graph.cell(at)], known[self.graph.cell(at)]) = (value, true);
            }
        }
        values
    }

    /// The distance field: the least cost of each of `nodes` by cell, `None` where there is no path.
    #[must_use]
    pub fn costs(&self, nodes: impl Iterator<Item = Node>) -> Vec<Option<u64>> {
        self.carry(nodes, None, |_| Some(0), |cost, weight| cost.map(|c| c + u64::from(weight)))
    }

    /// The nearest generator of each of `nodes` by cell (2007, section 3.4), `None` where there is no path.
    #[must_use]
    pub fn labels(&self, nodes: impl Iterator<Item = Node>) -> Vec<Option<Node>> {
        self.carry(nodes, None, Some, |label, _| label)
    }
}
