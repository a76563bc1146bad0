//! Writes a lattice as plain arrays, with the planner's costs and its time, for others to compare with.
//!
//! `cargo run --release --example graph -- NEIGHBOURS SIDE ALPHA FOLDER [THREADS]`: a square or cube of SIDE nodes a
//! side, planned from its middle. FOLDER gets `from.u32`, `to.u32` and `weight.u32` (each edge once, little-endian)
//! and `cost.u64` (by node); stdout gets the best of five times as JSON. Weights and costs are fixed-point integers.

#![allow(clippy::print_stdout, reason = "what it prints is its result")]

use std::error::Error;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

use lichtenberg::geom::Neighbours;
use lichtenberg::graph::{Graph, Lattice, Window};
use lichtenberg::math::{DVec3, Progress, Stream, Weights};
use lichtenberg::plan::{Goal, plan};

fn run(neighbours: Neighbours, side: u32, alpha: f64, folder: &Path) -> Result<(), Box<dyn Error>> {
    let window = Window::new(DVec3::ZERO, DVec3::splat(f64::from(side - 1)), 1.0, neighbours.dimensions())?;
    let lattice = Lattice::plain(window, neighbours, &Stream::new(1, "compare"), Weights { max: 10.0, alpha })?;
    let root = lattice.node(window.size.map(|s| s / 2));
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let clock = Instant::now();
        let plan = plan(&lattice, &[root], Goal::Everything, &Progress::default())?;
        best = best.min(clock.elapsed().as_secs_f64());
        assert_eq!(plan.settled() as u64, window.nodes());
    }

    fs::create_dir_all(folder)?;
    let file = |name: &str| File::create(folder.join(name)).map(BufWriter::new);
    let [mut from, mut to, mut weight] = [file("from.u32")?, file("to.u32")?, file("weight.u32")?];
    let mut failed = Ok(());
    for node in lattice.nodes() {
        let cell = lattice.cell(node);
        lattice.edges(node, |edge| {
            if cell < edge.cell && failed.is_ok() {
                failed = from
                    .write_all(&(cell as u32).to_le_bytes())
                    .and_then(|()| to.write_all(&(edge.cell as u32).to_le_bytes()))
                    .and_then(|()| weight.write_all(&edge.weight.to_le_bytes()));
            }
        });
    }
    failed?;
    let plan = plan(&lattice, &[root], Goal::Everything, &Progress::default())?;
    let mut cost = file("cost.u64")?;
    for value in plan.costs(lattice.nodes()) {
        cost.write_all(&value.ok_or("a node was not reached")?.to_le_bytes())?;
    }
    for mut file in [from, to, weight, cost] {
        file.flush()?;
    }
    println!(r#"{{ "seconds": {best}, "nodes": {}, "root": {} }}"#, window.nodes(), lattice.cell(root));
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [neighbours, side, alpha, folder, threads @ ..] = &args[..] else {
        return Err("graph NEIGHBOURS SIDE ALPHA FOLDER [THREADS]".into());
    };
    if let [threads] = threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.parse()?).build_global()?;
    }
    let (side, alpha, folder) = (side.parse()?, alpha.parse()?, Path::new(folder));
    run(Neighbours::try_from(neighbours.parse::<u32>()?)?, side, alpha, folder)
}
