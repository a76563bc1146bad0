//! The advancing front: settling the nodes of a bucket and relaxing their edges.

use super::PlanError;
use super::buckets::{Buckets, CHUNK, MOST_BUCKETS};
use super::cells::{Cells, slot_mask};
use crate::graph::{Graph, Node, WeightRange};

/// Advance of costs, in the units of a cell, after which the list of wanted nodes is swept.
const SWEEP: u32 = (1 << 29) - 1;

/// The map from costs to buckets.
#[derive(Clone, Copy)]
pub(super) struct BucketWidth {
    /// A cell shifted right by this is the number of its bucket before wrapping.
    shift: u32,
    /// The number of buckets less 1, a mask.
    wrap: u32,
}

impl BucketWidth {
    pub fn new(range: WeightRange, slot_bits: u32) -> Result<Self, PlanError> {
        let log = range.least.ilog2();
        // One bucket for the current one and one for rounding.
        let count = ((range.most >> log) + 2).next_power_of_two();
        if count > MOST_BUCKETS {
            return Err(PlanError::TooWide { ratio: range.most / range.least });
        }
        Ok(Self { shift: log + slot_bits, wrap: count - 1 })
    }

    /// The number of buckets.
    pub fn count(self) -> usize {
        self.wrap as usize + 1
    }

    /// The bucket of a cell.
    #[inline(always)]
    pub fn bucket(self, cell: u32) -> usize {
        (cell >> self.shift & self.wrap) as usize
    }

    /// The start of the bucket of `cell`, in the units of a cell.
    pub fn base(self, cell: u32) -> u32 {
        cell >> self.shift << self.shift
    }

    /// The bits of a cell below its bucket's number.
    pub fn within(self) -> u32 {
        (1 << self.shift) - 1
    }

    /// Is the list of wanted nodes swept at the bucket at `base`?
    pub fn is_swept(self, base: u32) -> bool {
        self.until_swept(base) == 0
    }

    /// How many buckets there are from the one at `base` to the next at which the list of wanted nodes is swept.
    pub fn until_swept(self, base: u32) -> usize {
        ((base.wrapping_neg() & SWEEP) >> self.shift) as usize
    }

    /// The start of the bucket after the one at `base`.
    pub fn next(self, base: u32) -> u32 {
        self.skip(base, 1)
    }

    /// The start of the bucket `count` after the one at `base`.
    pub fn skip(self, base: u32, count: usize) -> u32 {
        base.wrapping_add((count as u32) << self.shift)
    }
}

/// The graph and the state of a search.
pub(super) struct Front<'a, G> {
    pub graph: &'a G,
    pub cells: &'a Cells,
    pub width: BucketWidth,
    /// The cell of a generator: the least cost.
    pub start: u32,
    /// [`BucketWidth::within`] where a node whose cost falls within its bucket is in that bucket already; 0 where it may not be,
    /// since its cost is that of an earlier search.
    pub waiting: u32,
}

/// The wanted nodes that are not known to be settled.
pub(super) struct WantedNodes(Option<Vec<Node>>);

impl WantedNodes {
    pub fn new(nodes: Option<&[Node]>) -> Self {
        Self(nodes.map(<[_]>::to_vec))
    }

    /// Are all settled, given that all costs below `base` are final?
    pub fn is_done<G: Graph>(&mut self, front: &Front<'_, G>, base: u32) -> bool {
        let Some(wanted) = &mut self.0 else { return false };
        let is_settled = |node: &Node| {
            let cell = front.cells.get(front.graph.cell(*node));
            cell != 0 && (cell.wrapping_sub(base) as i32) < 0
        };
        while wanted.pop_if(|node| is_settled(node)).is_some() {}
        // Costs are compared modulo 2^32, so settled nodes must leave the list before they wrap.
        if front.width.is_swept(base) {
            wanted.retain(|node| !is_settled(node));
        }
        wanted.is_empty()
    }
}

impl<G: Graph> Front<'_, G> {
    /// Settles the nodes of a chunk that still belong to the bucket at `base` and relaxes their edges, in two passes
    /// without unpredictable branches; returns the number of nodes settled. With `SHARED` other threads may do the same.
    #[inline(always)]
    pub fn advance<const SHARED: bool>(&self, base: u32, nodes: &[u32], buckets: &mut Buckets) -> usize {
        let Self { graph, cells, width, waiting, .. } = *self;
        let current = width.bucket(base);
        let mut live = [(Node(0), 0_usize, 0_u32); CHUNK];
        let mut lives = 0;
        for &node in nodes {
            let node = Node(node);
            let cell = graph.cell(node);
            let value = cells.get(cell);
            live[lives] = (node, cell, value);
            // The others are stale entries.
            lives += usize::from(width.bucket(value) == current);
        }
        for &(_, cell, _) in &live[..lives] {
            graph.ahead(cell, |cell| cells.prefetch(cell));
        }
        let mut relax = |node: Node, value: u32, is_shared: bool| {
            let cost = value & !slot_mask(graph);
            graph.edges(node, |edge| {
                let new = cost.wrapping_add(edge.weight << graph.slot_bits()) | (edge.back + 1);
                let old = if is_shared { cells.lower_shared(edge.cell, new) } else { cells.lower(edge.cell, new) };
                // A node is pushed when its cost falls into a lower bucket.
                let above = old.wrapping_sub(new & !waiting) as i32 > waiting as i32;
                buckets.push_if(above, width.bucket(new), edge.node);
            });
        };
        for &(node, _, value) in &live[..lives] {
            // Cells that only this thread writes need no atomic exchange.
            if SHARED && !graph.is_inner(node) {
                relax(node, value, true);
            } else {
                relax(node, value, false);
            }
        }
        lives
    }
}
