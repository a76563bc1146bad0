//! Planning by size and neighbourhood: time a node, on one thread and on all.

use std::hint::black_box;

use crate::clock::median;
use lichtenberg::geom::Neighbours;
use lichtenberg::graph::{Lattice, Window};
use lichtenberg::math::Weights;
use lichtenberg::math::{DVec3, Progress, Stream};
use lichtenberg::plan::{Goal, plan};

/// Each is run this often, and the median told.
const RUNS: usize = 9;

fn time(count: u32, side: u32, alpha: f64, threads: usize) {
    let neighbours = Neighbours::try_from(count).expect("it is a neighbourhood");
    let window =
        Window::new(DVec3::ZERO, DVec3::splat(f64::from(side - 1)), 1.0, neighbours.dimensions()).expect("it fits");
    let lattice = Lattice::plain(window, neighbours, &Stream::new(1, "bench"), Weights { max: 10.0, alpha })
        .expect("weights fit");
    let root = lattice.node(window.size.map(|s| s / 2));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    let go = || plan(&lattice, &[root], Goal::Everything, &Progress::default());
    let seconds = median(|| _ = black_box(pool.install(go).expect("it plans").settled()), RUNS);
    let per_node = seconds * 1e9 / window.nodes() as f64;
    println!("{count:>2} neighbours, {side:>4} a side, alpha {alpha}, {threads} thread(s): {per_node:>6.1} ns/node");
}

pub fn run() {
    for side in [512, 2048] {
        time(4, side, 3.0, 1);
        time(8, side, 3.0, 1);
    }
    for alpha in [0.3, 1.0, 3.0] {
        time(6, 80, alpha, 1);
    }
    time(18, 80, 3.0, 1);
    time(26, 80, 3.0, 1);
    for threads in [1, 2] {
        time(6, 160, 3.0, threads);
        time(6, 256, 3.0, threads);
        time(26, 160, 3.0, threads);
    }
}
