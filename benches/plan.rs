//! Planning by size and neighbourhood: time a node, on one thread and on all.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lichtenberg::graph::{Lattice, Weights, Window};
use lichtenberg::math::{DVec3, Progress, Stream};
use lichtenberg::plan::{Goal, plan};

fn bench<const N: usize>(c: &mut Criterion, side: u32, alpha: f64, threads: usize) {
    let dimensions = if N == 4 || N == 8 { 2 } else { 3 };
    let window = Window::new(DVec3::ZERO, DVec3::splat(f64::from(side - 1)), 1.0, dimensions).expect("it fits");
    let lattice: Lattice<N> =
        Lattice::plain(window, &Stream::new(1, "bench"), Weights { max: 10.0, alpha }).expect("weights fit");
    let root = lattice.node(window.size.map(|s| s / 2));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    let mut group = c.benchmark_group(format!("plan/{N} neighbours"));
    group.throughput(Throughput::Elements(window.nodes())).sample_size(10);
    group.bench_function(BenchmarkId::new(format!("alpha {alpha}, {threads} threads"), side), |b| {
        let go = || plan(&lattice, &[root], Goal::Everything, &Progress::default());
        b.iter(|| black_box(pool.install(go).expect("it plans").settled()));
    });
    group.finish();
}

fn all(c: &mut Criterion) {
    for side in [512, 2048] {
        bench::<4>(c, side, 3.0, 1);
        bench::<8>(c, side, 3.0, 1);
    }
    for alpha in [0.3, 1.0, 3.0] {
        bench::<6>(c, 80, alpha, 1);
    }
    bench::<18>(c, 80, 3.0, 1);
    bench::<26>(c, 80, 3.0, 1);
    for threads in [1, 2] {
        bench::<6>(c, 160, 3.0, threads);
        bench::<6>(c, 256, 3.0, threads);
        bench::<26>(c, 160, 3.0, threads);
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
