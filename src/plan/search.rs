//! The search: least costs from generators, by buckets that are final when they are popped.

use super::buckets::{Buckets, CHUNK};
use super::cells::{Cells, slot_mask};
use super::tree::Plan;
use crate::graph::{Graph, Node, WeightRange};
use crate::math::{Cancelled, Progress};

/// More buckets than this would cost more to walk than the nodes in them.
const MOST_BUCKETS: u32 = 1 << 20;

/// The list of wanted nodes is swept each time costs have advanced by this much, in the units of a cell.
const SWEEP: u32 = (1 << 29) - 1;

/// How far a search goes.
#[derive(Clone, Copy, Debug)]
pub enum Goal<'a> {
    /// To every node that can be reached.
    Everything,
    /// Until all of these are settled, or nothing is left.
    Nodes(&'a [Node]),
}

/// Why a search gave no plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The weights span too wide a range for buckets as narrow as the least of them.
    #[error(
        "the largest weight is {ratio} times the least; at most {MOST_BUCKETS} can be planned with: lower alpha, max or the cost fields"
    )]
    TooWide {
        /// Largest weight over least.
        ratio: u32,
    },
    /// Stopped by its [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// How costs fall into buckets.
#[derive(Clone, Copy)]
struct Width {
    /// A cell shifted right by this is the number of its bucket, before it is wrapped.
    shift: u32,
    /// Number of buckets less one: a mask.
    wrap: u32,
}

impl Width {
    fn new(range: WeightRange, slot_bits: u32) -> Result<Self, PlanError> {
        let log = range.least.ilog2();
        // One bucket for the current one and one for rounding.
        let count = ((range.most >> log) + 2).next_power_of_two();
        if count > MOST_BUCKETS {
            return Err(PlanError::TooWide {
                ratio: range.most / range.least,
            });
        }
        Ok(Self {
            shift: log + slot_bits,
            wrap: count - 1,
        })
    }

    #[inline(always)]
    fn bucket(self, cell: u32) -> u32 {
        cell >> self.shift & self.wrap
    }
}

/// Bytes that a search over `cells` cells may take at its peak: what is compared with the memory limit.
#[must_use]
pub fn bytes_needed(cells: u64) -> u64 {
    // Four bytes a cell, and the nodes on the frontier with stale entries: measured below 1.5 bytes a cell
    // (benches/README.md), more for small lattices, where it does not matter.
    cells * 6 + (1 << 20)
}

/// Least costs from `generators` over `graph`.
///
/// # Errors
/// [`PlanError::TooWide`] when weights span too wide a range, [`PlanError::Cancelled`] when `progress` says stop.
pub fn plan<'g, G: Graph>(
    graph: &'g G,
    generators: &[Node],
    goal: Goal<'_>,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
    let range = graph.weight_range();
    let width = Width::new(range, G::SLOT_BITS)?;
    let cells = Cells::new(graph.cells());
    let mut buckets = Buckets::new(width.wrap as usize + 1);
    // Cost 1, since a cell of 0 means unreached.
    let start = 1 << G::SLOT_BITS;
    for &generator in generators {
        let cell = graph.cell(generator);
        if cells.get(cell) == 0 {
            cells.set(cell, start);
            buckets.push_if(true, width.bucket(start) as usize, generator);
        }
    }
    let mut wanted = match goal {
        Goal::Everything => None,
        Goal::Nodes(nodes) => Some(nodes.to_vec()),
    };

    let mut live = [(Node(0), 0_usize, 0_u32); CHUNK];
    let mut settled = 0_usize;
    // Where the current bucket starts, in the units of a cell.
    let mut base = start >> width.shift << width.shift;
    let mut turn = 0_u32;
    let within = (1 << width.shift) - 1;
    // Nothing waits once a whole round of buckets was empty.
    let mut idle = 0;
    while idle <= width.wrap {
        let current = width.bucket(base);
        let mut taken = buckets.take(current as usize);
        idle += 1;
        while let Some((places, len)) = buckets.next_chunk(&mut taken) {
            idle = 0;
            for &node in buckets.upcoming(&taken) {
                cells.prefetch(graph.cell(Node(node)));
            }
            // First the entries that still belong to this bucket: the others were settled earlier.
            let mut lives = 0;
            for &node in &places[1..len] {
                let node = Node(node);
                let cell = graph.cell(node);
                let value = cells.get(cell);
                live[lives] = (node, cell, value);
                lives += usize::from(width.bucket(value) == current);
            }
            for &(_, cell, _) in &live[..lives] {
                graph.ahead(cell, |cell| cells.prefetch(cell));
            }
            settled += lives;
            for &(node, _, value) in &live[..lives] {
                let cost = value & !slot_mask::<G>();
                graph.edges(node, |edge| {
                    let new = cost.wrapping_add(edge.weight << G::SLOT_BITS) | (edge.back + 1);
                    let old = cells.lower(edge.cell, new);
                    // A node is pushed when it comes down from a higher bucket.
                    let above = old.wrapping_sub(new & !within) as i32 > within as i32;
                    buckets.push_if(above, width.bucket(new) as usize, edge.node);
                });
            }
        }
        base = base.wrapping_add(1 << width.shift);
        if let Some(wanted) = &mut wanted {
            let is_settled = |node: &Node| {
                let cell = cells.get(graph.cell(*node));
                cell != 0 && (cell.wrapping_sub(base) as i32) < 0
            };
            while wanted.pop_if(|node| is_settled(node)).is_some() {}
            // Costs are compared modulo 2^32, so nothing may stay on the list for long once it is settled.
            if base & SWEEP < 1 << width.shift {
                wanted.retain(|node| !is_settled(node));
            }
            if wanted.is_empty() {
                break;
            }
        }
        turn = turn.wrapping_add(1);
        if turn.is_multiple_of(1024) {
            progress.report("plan", settled as f64 / graph.cells() as f64)?;
        }
    }
    Ok(Plan::new(graph, cells, settled))
}
