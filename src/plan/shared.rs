//! The parallel search: threads share each bucket, with one barrier a bucket. The result is that of one thread, since a
//! minimum does not depend on the order of its operands.

use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::buckets::{Buckets, CHUNK};
use super::front::{Front, WantedNodes};
use crate::graph::{Graph, Node};
use crate::math::{Cancelled, Progress};

/// Spins before a waiting thread yields.
const SPINS: u32 = 4000;
/// Stands for no turn.
const NEVER: u32 = u32::MAX;

/// A spinning barrier.
struct Barrier {
    threads: usize,
    arrived: AtomicUsize,
    turn: AtomicUsize,
}

impl Barrier {
    fn wait(&self) {
        let turn = self.turn.load(Ordering::Acquire);
        if self.arrived.fetch_add(1, Ordering::AcqRel) + 1 == self.threads {
            self.arrived.store(0, Ordering::Relaxed);
            self.turn.store(turn + 1, Ordering::Release);
            return;
        }
        let mut spins = 0;
        while self.turn.load(Ordering::Acquire) == turn {
            spins += 1;
            // On a busy machine spinning would delay the thread that is waited for.
            if spins < SPINS { std::hint::spin_loop() } else { std::thread::yield_now() }
        }
    }
}

/// Nodes sent to the thread that owns them, by the parity of the turn.
type Inbox = [Mutex<Vec<u32>>; 2];

/// The state that the threads share.
struct Shared<'a, G> {
    front: Front<'a, G>,
    barrier: Barrier,
    inboxes: Vec<Inbox>,
    /// The number of nodes of three consecutive turns.
    counts: [AtomicUsize; 3],
    /// The turn at which all threads stop after cancellation.
    stop: AtomicU32,
    settled: AtomicUsize,
}

/// Runs the search from the contents of `buckets` on `threads` threads, a power of two; returns the number of nodes settled.
pub(super) fn run<G: Graph>(
    front: Front<'_, G>,
    buckets: Buckets,
    wanted: Option<&[Node]>,
    threads: usize,
    progress: &Progress,
) -> Result<usize, Cancelled> {
    let shared = Shared {
        front,
        barrier: Barrier { threads, arrived: AtomicUsize::new(0), turn: AtomicUsize::new(0) },
        inboxes: (0..threads).map(|_| Inbox::default()).collect(),
        counts: Default::default(),
        stop: AtomicU32::new(NEVER),
        settled: AtomicUsize::new(0),
    };
    std::thread::scope(|scope| {
        // The calling thread takes no part: where it did, the other waited for it a quarter of the time.
        let (mut first, mut progress) = (Some(buckets), Some(progress));
        for own in 0..threads {
            let shared = &shared;
            let buckets = first.take().unwrap_or_else(|| Buckets::new(shared.front.width.count()));
            let progress = progress.take();
            scope.spawn(move || shared.work(own, buckets, WantedNodes::new(wanted), progress));
        }
    });
    if shared.stop.into_inner() != NEVER {
        return Err(Cancelled);
    }
    Ok(shared.settled.into_inner())
}

impl<G: Graph> Shared<'_, G> {
    /// The work of thread `own`; the one with `progress` stops the others on cancellation.
    ///
    /// Threads own slabs of the graph, so that they seldom write to each other's cells: a node is pushed by the thread that
    /// reaches it, and sent to its owner when its bucket is popped.
    fn work(&self, own: usize, mut buckets: Buckets, mut wanted: WantedNodes, progress: Option<&Progress>) {
        let front = &self.front;
        let Front { graph, cells, width, start, .. } = *front;
        let mut base = width.base(start);
        let mut idle = 0;
        // A mask: the number of threads is a power of two.
        let others = self.inboxes.len() as u32 - 1;
        let mut sorted: Vec<Vec<u32>> = vec![Vec::new(); self.inboxes.len()];
        for turn in 0_u32.. {
            let parity = turn as usize % 2;
            let count = &self.counts[turn as usize % 3];
            let mut taken_nodes = 0;
            let mut taken = buckets.take(width.bucket(base));
            while let Some((places, len)) = buckets.next_chunk(&mut taken) {
                taken_nodes += len;
                for &node in &places[1..len] {
                    sorted[(graph.slab(Node(node)) & others) as usize].push(node);
                }
            }
            count.fetch_add(taken_nodes, Ordering::Relaxed);
            for (owner, nodes) in
                sorted.iter_mut().enumerate().filter(|(owner, nodes)| *owner != own && !nodes.is_empty())
            {
                lock(&self.inboxes[owner][parity]).append(nodes);
            }
            if let Some(progress) = progress
                && turn.is_multiple_of(1024)
            {
                let share = self.settled.load(Ordering::Relaxed) as f64 / graph.cells() as f64;
                if progress.report("plan", share).is_err() {
                    self.stop.store(turn, Ordering::Relaxed);
                }
            }
            self.barrier.wait();
            // Until the next barrier all threads see the same state: writes are for later turns.
            if progress.is_some() {
                self.counts[(turn as usize + 2) % 3].store(0, Ordering::Relaxed);
            }
            idle = if count.load(Ordering::Relaxed) == 0 { idle + 1 } else { 0 };
            let is_over = idle >= width.count() || self.stop.load(Ordering::Relaxed) <= turn;
            if is_over || wanted.is_done(front, base) {
                return;
            }
            sorted[own].append(&mut lock(&self.inboxes[own][parity]));
            let mut settled = 0;
            let mut upcoming = sorted[own].chunks(CHUNK).skip(1);
            for nodes in sorted[own].chunks(CHUNK) {
                for &node in upcoming.next().unwrap_or_default() {
                    cells.prefetch(graph.cell(Node(node)));
                }
                settled += front.advance::<true>(base, nodes, &mut buckets);
            }
            sorted[own].clear();
            self.settled.fetch_add(settled, Ordering::Relaxed);
            base = width.next(base);
        }
    }
}

/// Locks a list. No thread panics while it holds the lock.
fn lock(list: &Mutex<Vec<u32>>) -> MutexGuard<'_, Vec<u32>> {
    list.lock().unwrap_or_else(PoisonError::into_inner)
}
