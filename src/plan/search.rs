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
/// use lichtenberg::graph::{Lattice, Weights, Window};
/// use lichtenberg::math::{DVec3, Progress, Stream};
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
    plan_on(graph, generators, goal, threads, progress)
}

/// [`plan`] on so many threads.
pub(super) fn plan_on<'g, G: Graph>(
    graph: &'g G,
    generators: &[Node],
    goal: Goal<'_>,
    threads: usize,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
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
    let wanted = match goal {
        Goal::Everything => None,
        Goal::Nodes(nodes) => Some(nodes),
    };
    let front = Front { graph, cells: &cells, width, start };
    let settled = if threads > 1 {
        // Rounded down to a power of two.
        shared::run(front, buckets, wanted, 1 << threads.ilog2(), progress)?
    } else {
        run_alone(&front, buckets, Wanted::new(wanted), progress)?
    };
    Ok(Plan::new(graph, cells, settled))
}

/// The search on one thread; returns how many nodes were settled.
fn run_alone<G: Graph>(
    front: &Front<'_, G>,
    mut buckets: Buckets,
    mut wanted: Wanted,
    progress: &Progress,
) -> Result<usize, Cancelled> {
    let Front { graph, cells, width, start } = *front;
    let mut settled = 0;
    let mut base = width.base(start);
    // Nothing waits once a whole round of buckets was empty.
    let mut idle = 0;
    for turn in 0_u32.. {
        let mut taken = buckets.take(width.bucket(base));
        idle += 1;
        while let Some((places, len)) = buckets.next_chunk(&mut taken) {
            idle = 0;
            for &node in buckets.upcoming(&taken) {
                cells.prefetch(graph.cell(Node(node)));
            }
            settled += front.advance::<false>(base, &places[1..len], &mut buckets);
        }
        base = width.next(base);
        if idle >= width.count() || wanted.is_done(front, base) {
            break;
        }
        if turn.is_multiple_of(1024) {
            progress.report("plan", settled as f64 / graph.cells() as f64)?;
        }
    }
    Ok(settled)
}
