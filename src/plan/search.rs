//! The search: Dijkstra's algorithm (1959) with a bucket queue.

use super::PlanError;
use super::buckets::Buckets;
use super::cells::Cells;
use super::front::{BucketWidth, Front, WantedNodes};
use super::shared;
use super::tree::Plan;
use crate::graph::{Graph, GraphVisitor, Node};
use crate::math::{Cancelled, Progress};

/// Most threads: more would wait for each other more than they work.
const MOST_THREADS: usize = 8;

/// Greatest cost, in the units of a cell, up to which cells can be compared modulo 2^32 with those of any other node.
const FARTHEST: u64 = 1 << 31;

/// Where a search ends.
#[derive(Clone, Copy, Debug)]
pub enum Goal<'a> {
    /// When every reachable node is settled.
    Everything,
    /// When all of these are settled, or every reachable node is.
    Nodes(&'a [Node]),
    /// When every node with at most this fixed-point cost is settled; a few more may be.
    Within(u64),
}

/// Upper bound of the peak memory, in bytes, of a search over `cells` cells.
#[must_use]
pub fn bytes_needed(cells: u64) -> u64 {
    // Four bytes a cell, and the frontier with stale entries: measured below 1.5 bytes a cell (`benches/README.md`), more for
    // small lattices, where it does not matter.
    cells * 6 + (1 << 20)
}

/// Least costs from `generators` over `graph`.
///
/// Wide fronts are shared among the threads of the current rayon pool ([`Graph::is_wide`]); the result is the same.
///
/// ```
/// use lichtenberg::geom::Neighbours;
/// use lichtenberg::graph::{Lattice, Window};
/// use lichtenberg::math::{DVec3, Progress, Stream, Weights};
/// use lichtenberg::plan::{Goal, plan};
///
/// let window = Window::new(DVec3::ZERO, DVec3::splat(20.0), 1.0, 3)?;
/// let six = Neighbours::try_from(6)?;
/// let lattice = Lattice::plain(window, six, &Stream::new(7, "air"), Weights::default())?;
/// let (root, end) = (lattice.node([0, 0, 0]), lattice.node([20, 20, 20]));
/// let plan = plan(&lattice, &[root], Goal::Nodes(&[end]), &Progress::default())?;
/// let path: Vec<_> = plan.path(end).collect();
/// assert_eq!((path[0], path[path.len() - 1]), (end, root));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PlanError::TooWide`] where the ratio of the weights is too large, [`PlanError::Cancelled`] by `progress`.
pub fn plan<'g, G: Graph>(
    graph: &'g G,
    generators: &[Node],
    goal: Goal<'_>,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
    let threads = if graph.is_wide() { rayon::current_num_threads().min(MOST_THREADS) } else { 1 };
    plan_on(graph, generators, Later::NONE, goal, threads, progress)
}

/// [`plan`] from `generators` and from `later` ones with their initial fixed-point costs, up to 2^25. Paths lead to either,
/// and [`Plan::cost`] counts from there.
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

/// Least costs from `starts` with their initial fixed-point costs, up to 2^25. A start that is reached at a lower cost from
/// another is no generator.
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

/// Generators with initial costs.
#[derive(Clone, Copy)]
pub(super) struct Later<'a> {
    /// Each with its initial cost.
    pub nodes: &'a [(Node, u64)],
    /// Do those that were reached at a lower cost keep that?
    pub gives_way: bool,
}

impl Later<'_> {
    /// No generators.
    pub const NONE: Self = Self { nodes: &[], gives_way: false };

    /// Takes those of costs below `end`, not wrapped, into the queue.
    fn join<G: Graph>(&mut self, front: &Front<'_, G>, end: u64, buckets: &mut Buckets) {
        let Front { graph, cells, width, start, .. } = *front;
        let cost_in_cell = |cost: u64| u64::from(start) + (cost << graph.slot_bits());
        while let Some((&(node, cost), rest)) =
            self.nodes.split_first().filter(|(first, _)| cost_in_cell(first.1) < end)
        {
            self.nodes = rest;
            // A wrapped cost; 0 would mean unreached.
            let value = cost_in_cell(cost) as u32;
            let old = cells.get(graph.cell(node));
            if self.gives_way && old != 0 && (old.wrapping_sub(value) as i32) < 0 {
                continue;
            }
            cells.set(graph.cell(node), if value == 0 { start } else { value });
            buckets.push_if(true, width.bucket(value), node);
        }
    }
}

/// [`plan`] on `threads` threads; on one only if there are `later` generators.
pub(super) fn plan_on<'g, G: Graph>(
    graph: &'g G,
    generators: &[Node],
    later: Later<'_>,
    goal: Goal<'_>,
    threads: usize,
    progress: &Progress,
) -> Result<Plan<'g, G>, PlanError> {
    debug_assert!(later.nodes.is_empty() || threads == 1);
    let (cells, settled, farthest) = graph.accept(Search { generators, later, goal, threads, progress })?;
    Ok(Plan::new(graph, cells, settled, farthest))
}

/// A search of a graph for cells, the number of nodes settled and an upper bound of all costs.
struct Search<'a> {
    generators: &'a [Node],
    later: Later<'a>,
    goal: Goal<'a>,
    threads: usize,
    progress: &'a Progress,
}

impl GraphVisitor for Search<'_> {
    type Output = Result<(Cells, usize, u64), PlanError>;

    fn visit<G: Graph>(self, graph: &G) -> Self::Output {
        let Self { generators, later, goal, threads, progress } = self;
        let cells = Cells::new(graph.cells());
        let (front, buckets) = first_front(graph, &cells, generators)?;
        let front = Front { waiting: front.width.within(), ..front };
        let (wanted, most) = match goal {
            Goal::Everything => (None, u64::MAX),
            Goal::Nodes(nodes) => (Some(nodes), u64::MAX),
            Goal::Within(most) => (None, most),
        };
        let (settled, farthest) = if threads > 1 && most == u64::MAX {
            // Rounded down to a power of two.
            (shared::run(front, buckets, wanted, 1 << threads.ilog2(), progress)?, u64::MAX)
        } else {
            // Costs are compared modulo 2^32, which bounds the difference between a generator and its neighbours.
            let latest = 1_u64 << (30 - graph.slot_bits());
            let mut nodes: Vec<(Node, u64)> =
                later.nodes.iter().map(|&(node, cost)| (node, cost.min(latest))).collect();
            nodes.sort_unstable_by_key(|&(node, cost)| (cost, node));
            run_alone(&front, buckets, Later { nodes: &nodes, ..later }, (WantedNodes::new(wanted), most), progress)?
        };
        Ok((cells, settled, farthest))
    }
}

/// The front at `generators`, and the bucket of those that were none before.
fn first_front<'a, G: Graph>(
    graph: &'a G,
    cells: &'a Cells,
    generators: &[Node],
) -> Result<(Front<'a, G>, Buckets), PlanError> {
    let width = BucketWidth::new(graph.weight_range(), graph.slot_bits())?;
    let mut buckets = Buckets::new(width.count());
    // Cost 1, since a cell of 0 means unreached.
    let start = 1 << graph.slot_bits();
    for &generator in generators {
        let cell = graph.cell(generator);
        if cells.get(cell) != start {
            cells.set(cell, start);
            buckets.push_if(true, width.bucket(start), generator);
        }
    }
    Ok((Front { graph, cells, width, start, waiting: 0 }, buckets))
}

impl<G: Graph> Plan<'_, G> {
    /// Adds generators after a search for [`Goal::Everything`]; `generators` includes the earlier ones. The result is that of
    /// [`plan`], but only nodes whose cost decreases are visited (2007, section 3.2: every iteration plans to the whole
    /// structure that the one before made).
    ///
    /// # Errors
    /// As [`plan`].
    pub fn extend(&mut self, generators: &[Node], progress: &Progress) -> Result<(), PlanError> {
        let (graph, cells, farthest) = self.parts();
        if farthest >= FARTHEST {
            *self = plan_on(graph, generators, Later::NONE, Goal::Everything, 1, progress)?;
            return Ok(());
        }
        graph.accept(Extension { cells, generators, progress })
    }
}

/// A search that goes on in known cells.
struct Extension<'a> {
    cells: &'a Cells,
    generators: &'a [Node],
    progress: &'a Progress,
}

impl GraphVisitor for Extension<'_> {
    type Output = Result<(), PlanError>;

    fn visit<G: Graph>(self, graph: &G) -> Self::Output {
        let (front, buckets) = first_front(graph, self.cells, self.generators)?;
        run_alone(&front, buckets, Later::NONE, (WantedNodes::new(None), u64::MAX), self.progress)?;
        Ok(())
    }
}

/// The search on one thread, until the wanted nodes of `until` are settled or its cost is exceeded; returns the number of
/// nodes settled and the end of the last bucket.
fn run_alone<G: Graph>(
    front: &Front<'_, G>,
    mut buckets: Buckets,
    mut later: Later<'_>,
    until: (WantedNodes, u64),
    progress: &Progress,
) -> Result<(usize, u64), Cancelled> {
    let (mut wanted, most) = until;
    let Front { graph, cells, width, start, .. } = *front;
    let slot_bits = graph.slot_bits();
    let mut settled = 0;
    let mut base = width.base(start);
    // The start of the next bucket, not wrapped.
    let mut end = u64::from(width.next(base));
    // Consecutive empty buckets: after a full cycle the queue is empty.
    let mut idle = 0;
    let limit = most.saturating_mul(1 << slot_bits).saturating_add(u64::from(start));
    for turn in 0_u32.. {
        later.join(front, end, &mut buckets);
        end += u64::from(width.next(0));
        let mut taken = buckets.take(width.bucket(base));
        idle = if later.nodes.is_empty() { idle + 1 } else { 0 };
        while let Some((places, len)) = buckets.next_chunk(&mut taken) {
            idle = 0;
            for &node in buckets.upcoming(&taken) {
                cells.prefetch(graph.cell(Node(node)));
            }
            settled += front.advance::<false>(base, &places[1..len], &mut buckets);
        }
        base = width.next(base);
        // A field of costs can leave a million buckets between two nodes.
        if idle > 0 {
            let gap = buckets.empties(width.bucket(base), width.until_swept(base).min(width.count() - idle));
            base = width.skip(base, gap);
            end += (gap as u64) * u64::from(width.next(0));
            idle += gap;
        }
        // After an empty bucket no more are settled than before it.
        let is_done = (idle == 0 || width.is_swept(base)) && wanted.is_done(front, base);
        if is_done || idle >= width.count() || end - u64::from(width.next(0)) > limit {
            break;
        }
        if turn.is_multiple_of(1024) {
            progress.report("plan", settled as f64 / graph.cells() as f64)?;
        }
    }
    Ok((settled, end))
}
