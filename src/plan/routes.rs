//! Least-cost paths over scattered graphs: Dijkstra's algorithm (1959) with a radix heap (Ahuja et al. 1990).

use crate::graph::{EdgeWeights, Node, Scatter};
use crate::math::{Cancelled, Progress};

/// The cost of an unreached node.
const FAR: u64 = u64::MAX;
/// The predecessor of a generator.
const NONE: u32 = u32::MAX;
/// Nodes settled between two tests for cancellation.
const PAUSE: usize = 1 << 16;

/// Least-cost paths over a scattered graph: the cost and the predecessor of each node.
pub struct Routes {
    costs: Vec<u64>,
    predecessors: Vec<u32>,
    settled: usize,
}

/// A monotone priority queue: no key is below the last one popped.
struct RadixHeap {
    last: u64,
    /// Keys by the highest bit in which they differ from `last`, 0 for equal ones.
    buckets: Vec<Vec<(u64, u32)>>,
}

impl RadixHeap {
    fn new() -> Self {
        Self { last: 0, buckets: vec![Vec::new(); 65] }
    }

    fn push(&mut self, key: u64, node: u32) {
        let bucket = 64 - (key ^ self.last).leading_zeros();
        self.buckets[bucket as usize].push((key, node));
    }

    fn pop(&mut self) -> Option<(u64, u32)> {
        if self.buckets[0].is_empty() {
            let first = self.buckets.iter().position(|bucket| !bucket.is_empty())?;
            let keys = std::mem::take(&mut self.buckets[first]);
            self.last = keys.iter().map(|&(key, _)| key).min()?;
            for (key, node) in keys {
                self.push(key, node);
            }
        }
        self.buckets[0].pop()
    }
}

/// Least costs over `graph` with `weights` from `generators`, each with its initial fixed-point cost, until all of `wanted`
/// are settled; to every node if `wanted` is empty. Of predecessors with equal costs the lowest number is chosen.
///
/// # Errors
/// [`Cancelled`] by `progress`.
pub fn routes(
    graph: &Scatter,
    weights: &EdgeWeights,
    generators: &[(Node, u64)],
    wanted: &[Node],
    progress: &Progress,
) -> Result<Routes, Cancelled> {
    let mut costs = vec![FAR; graph.len()];
    let mut predecessors = vec![NONE; graph.len()];
    let mut is_wanted = vec![false; if wanted.is_empty() { 0 } else { graph.len() }];
    let mut missing = 0_usize;
    for node in wanted {
        missing += usize::from(!std::mem::replace(&mut is_wanted[node.0 as usize], true));
    }
    let mut queue = RadixHeap::new();
    for &(node, cost) in generators {
        if cost < costs[node.0 as usize] {
            costs[node.0 as usize] = cost;
            queue.push(cost, node.0);
        }
    }
    let mut settled = 0;
    while let Some((cost, node)) = queue.pop() {
        if cost > costs[node as usize] {
            continue;
        }
        settled += 1;
        if !wanted.is_empty() && std::mem::take(&mut is_wanted[node as usize]) {
            missing -= 1;
            if missing == 0 {
                break;
            }
        }
        if settled % PAUSE == 0 {
            progress.report("plan", settled as f64 / graph.len() as f64)?;
        }
        let edges = graph.edges(Node(node));
        for (&Node(other), &weight) in graph.ends(edges.clone()).iter().zip(weights.of(edges)) {
            let new = cost + u64::from(weight);
            let old = &mut costs[other as usize];
            if new < *old {
                *old = new;
                predecessors[other as usize] = node;
                queue.push(new, other);
            } else if new == *old && predecessors[other as usize] != NONE && node < predecessors[other as usize] {
                predecessors[other as usize] = node;
            }
        }
    }
    Ok(Routes { costs, predecessors, settled })
}

impl Routes {
    /// The number of nodes with final costs.
    #[must_use]
    pub fn settled(&self) -> usize {
        self.settled
    }

    /// The least cost of `node`, fixed-point ([`EdgeWeights::real`]), or `None` if it was not reached.
    #[must_use]
    pub fn cost(&self, node: Node) -> Option<u64> {
        Some(self.costs[node.0 as usize]).filter(|&cost| cost != FAR)
    }

    /// The nodes of the path from `node` back to its generator, both included, with their costs.
    pub fn path(&self, node: Node) -> impl Iterator<Item = (Node, u64)> + '_ {
        let next = |&Node(at): &Node| Some(Node(self.predecessors[at as usize])).filter(|&Node(to)| to != NONE);
        std::iter::successors(Some(node), next).map(|at| (at, self.costs[at.0 as usize]))
    }
}
