//! The search: least costs from generators, by buckets that are final when they are popped.

use super::buckets::Buckets;
use super::cells::Cells;
use super::front::{Front, MOST_BUCKETS, Wanted, Width};
use super::shared;
use super::tree::Plan;
use crate::graph::{Graph, Node};
use crate::math::{Cancelled, Progress};

/// More threads than this wait for each other more than they work.
const MOST_THREADS: usize = 8;

/// Cells of costs above this, in the units of a cell, cannot be told from lower ones by more than a bucket.
const FARTHEST: u64 = 1 << 31;

/// How far a search goes.
#[derive(Clone, Copy, Debug)]
pub enum Goal<'a> {
    /// To every node that can be reached.
    Everything,
    /// Until all of these are settled, or nothing is left.
    Nodes(&'a [Node]),
    /// To every node that costs no more than this (fixed-point), and perhaps a few more.
    Within(u64),
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

/// Bytes that a search over `cells` cells may take at its peak: what is compared with the memory limit.
#[must_use]
pub fn bytes_needed(cells: u64) -> u64 {
    // Four bytes a cell, and the nodes on the frontier with stale entries: measured below 1.5 bytes a cell
    // (benches/README.md), more for small lattices, where it does not matter.
    cells * 6 + (1 << 20)
}

/// Least costs from `generators` over `graph`.
///
/// Wide fronts are shared among the threads of the current rayon pool ([`Graph::is_wide`]); the result is the same.
///
/// ```
/// use lichtenberg::graph::{Lattice, Window};
/// use lichtenberg::math::{DVec3, Progress, Stream, Weights};
/// use lichtenberg::plan::{Goal, plan};
///
/// let window = Window::new(DVec3::ZERO, DVec3::splat(20.0), 1.0, 3)?;
/// let lattice: Lattice<6> = Lattice::plain(window, &Stream::new(7, "air"), Weights::default())?;
/// let (root, end) = (lattice.node([0, 0, 0]), lattice.node([20, 20, 20]));
/// let plan = plan(&lattice, &[root], Goal::Nodes(&[end]), &Progress::default())?;
/// let path: Vec<_> = plan.path(end).collect();
/// assert_eq!((path[0], path[path.len() - 1]), (end, root));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PlanError::TooWide`] when weights span too wide a range, [`PlanError::Cancelled`] when `progress` says stop.
pub fn plan<'g, G: Graph>(
    graph: &'g G,
    generators: &[Node],
    goal: Goal<'_>,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
    let threads = if graph.is_wide() { rayon::current_num_threads().min(MOST_THREADS) } else { 1 };
    plan_on(graph, generators, Later::NONE, goal, threads, progress)
}

/// [`plan`] from `generators` and from `later` ones, each of which starts with the cost (fixed-point, up to 2^25) beside it. Paths
/// end at either, and [`Plan::cost`] counts from there.
///
/// # Errors
/// As [`plan`].
pub fn plan_delayed<'g, G: Graph>(
    graph: &'g G,
    generators: &[Node],
    later: &[(Node, u64)],
    goal: Goal<'_>,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
    plan_on(graph, generators, Later { nodes: later, gives_way: false }, goal, 1, progress)
}

/// Least costs where each node of `starts` costs no more than the fixed-point cost (up to 2^25) beside it: one that is reached
/// for less is no generator.
///
/// # Errors
/// As [`plan`].
pub fn plan_from<'g, G: Graph>(
    graph: &'g G,
    starts: &[(Node, u64)],
    goal: Goal<'_>,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
    plan_on(graph, &[], Later { nodes: starts, gives_way: true }, goal, 1, progress)
}

/// Nodes that start later than others.
#[derive(Clone, Copy)]
pub(super) struct Later<'a> {
    /// Each with its cost.
    pub nodes: &'a [(Node, u64)],
    /// Do those that were reached for less by then stay as they are?
    pub gives_way: bool,
}

impl Later<'_> {
    /// No node.
    pub const NONE: Self = Self { nodes: &[], gives_way: false };
}

/// [`plan`] on so many threads; those that start later need one.
pub(super) fn plan_on<'g, G: Graph>(
    graph: &'g G,
    generators: &[Node],
    later: Later<'_>,
    goal: Goal<'_>,
    threads: usize,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
    debug_assert!(later.nodes.is_empty() || threads == 1);
    let width = Width::new(graph.weight_range(), G::SLOT_BITS)?;
    let cells = Cells::new(graph.cells());
    let mut buckets = Buckets::new(width.count());
    // Cost 1, since a cell of 0 means unreached.
    let start = 1 << G::SLOT_BITS;
    for &generator in generators {
        let cell = graph.cell(generator);
        if cells.get(cell) == 0 {
            cells.set(cell, start);
            buckets.push_if(true, width.bucket(start), generator);
        }
    }
    let (wanted, most) = match goal {
        Goal::Everything => (None, u64::MAX),
        Goal::Nodes(nodes) => (Some(nodes), u64::MAX),
        Goal::Within(most) => (None, most),
    };
    let front = Front { graph, cells: &cells, width, start, waiting: width.within() };
    let (settled, farthest) = if threads > 1 && most == u64::MAX {
        // Rounded down to a power of two.
        (shared::run(front, buckets, wanted, 1 << threads.ilog2(), progress)?, u64::MAX)
    } else {
        // Costs are compared modulo 2^32: none may start farther from its neighbours than that allows.
        let latest = 1_u64 << (30 - G::SLOT_BITS);
        let mut nodes: Vec<(Node, u64)> = later.nodes.iter().map(|&(node, cost)| (node, cost.min(latest))).collect();
        nodes.sort_unstable_by_key(|&(node, cost)| (cost, node));
        run_alone(&front, buckets, Later { nodes: &nodes, ..later }, (Wanted::new(wanted), most), progress)?
    };
    Ok(Plan::new(graph, cells, settled, farthest))
}

impl<G: Graph> Plan<'_, G> {
    /// Makes all of `generators`, those of the search among them, generators, after a search for [`Goal::Everything`]: what
    /// [`plan`] from them would give, but only nodes that become cheaper are visited (2007, section 3.2: every iteration
    /// plans to the whole structure that the one before made).
    ///
    /// # Errors
    /// As [`plan`].
    pub fn extend(&mut self, generators: &[Node], progress: &Progress) -> Result<(), PlanError> {
        let (graph, cells, farthest) = self.parts();
        if farthest >= FARTHEST {
            *self = plan_on(graph, generators, Later::NONE, Goal::Everything, 1, progress)?;
            return Ok(());
        }
        let width = Width::new(graph.weight_range(), G::SLOT_BITS)?;
        let mut buckets = Buckets::new(width.count());
        let start = 1 << G::SLOT_BITS;
        for &generator in generators {
            let cell = graph.cell(generator);
            if cells.get(cell) != start {
                cells.set(cell, start);
                buckets.push_if(true, width.bucket(start), generator);
            }
        }
        let front = Front { graph, cells, width, start, waiting: 0 };
        run_alone(&front, buckets, Later::NONE, (Wanted::new(None), u64::MAX), progress)?;
        Ok(())
    }
}

/// The search on one thread, until all of `until` are settled or everything up to that cost is; returns how many nodes
/// were settled, and where the last bucket ended.
fn run_alone<G: Graph>(
    front: &Front<'_, G>,
    mut buckets: Buckets,
    later: Later<'_>,
    until: (Wanted, u64),
    progress: &Progress,
) -> Result<(usize, u64), Cancelled> {
    let (mut wanted, most) = until;
    let Later { nodes: mut later, gives_way } = later;
    let Front { graph, cells, width, start, .. } = *front;
    let mut settled = 0;
    let mut base = width.base(start);
    // Where the bucket after this one starts, not wrapped.
    let mut end = u64::from(width.next(base));
    // Nothing waits once a whole round of buckets was empty.
    let mut idle = 0;
    let limit = most.saturating_mul(1 << G::SLOT_BITS).saturating_add(u64::from(start));
    for turn in 0_u32.. {
        while let Some((&(node, cost), rest)) =
            later.split_first().filter(|(first, _)| u64::from(start) + (first.1 << G::SLOT_BITS) < end)
        {
            later = rest;
            // 0 would mean unreached.
            let value = (u64::from(start) + (cost << G::SLOT_BITS)) as u32;
            let old = cells.get(graph.cell(node));
            if gives_way && old != 0 && (old.wrapping_sub(value) as i32) < 0 {
                continue;
            }
            cells.set(graph.cell(node), if value == 0 { start } else { value });
            buckets.push_if(true, width.bucket(value), node);
        }
        end += u64::from(width.next(0));
        let mut taken = buckets.take(width.bucket(base));
        idle = if later.is_empty() { idle + 1 } else { 0 };
        while let Some((places, len)) = buckets.next_chunk(&mut taken) {
            idle = 0;
            for &node in buckets.upcoming(&taken) {
                cells.prefetch(graph.cell(Node(node)));
            }
            settled += front.advance::<false>(base, &places[1..len], &mut buckets);
        }
        base = width.next(base);
        if idle >= width.count() || end - u64::from(width.next(0)) > limit || wanted.is_done(front, base) {
            break;
        }
        if turn.is_multiple_of(1024) {
            progress.report("plan", settled as f64 / graph.cells() as f64)?;
        }
    }
    Ok((settled, end))
}
