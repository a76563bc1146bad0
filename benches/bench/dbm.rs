//! Lightning by path planning beside the dielectric breakdown model, on a lattice of 512 by 512.
//!
//! `cargo bench -- dbm` prints the seconds of each, for bolts of about as many segments: ours, the model on the grid of Kim and
//! Lin (2004) as `by.dbm` solves it, and the fastest solver that is known for it, point charges without a grid (Kim et al.
//! 2007), which knows no ground.

use std::time::Instant;

use lichtenberg::files::Folder;
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{Source, grow, load};

/// Grows a scene of one space of 512 by 512 nodes; returns the median seconds and the nodes that grew.
fn time(steps: &str, runs: usize) -> (f64, usize) {
    let text = format!(
        r#"
title = "Bench"
[shape.square]
box = {{ min = [0, 0], max = [511, 511] }}
[space.near]
shape = "square"
nodes.lattice = {{ spacing = 1, neighbours = 8 }}
weights = {{ max = 10, alpha = 3 }}
[space.far]
like = "near"
{steps}
[object.bolt]
grow = ["bolt"]
"#
    );
    let source = Source { name: "bench".to_owned(), text, folder: Folder::Disk(".".into()) };
    let scene = load(&source, &[]).expect("a scene");
    let mut seconds = Vec::new();
    let mut nodes = 0;
    for _ in 0..runs {
        let begun = Instant::now();
        let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).expect("it grows");
        seconds.push(begun.elapsed().as_secs_f64());
        nodes = grown.iter().map(|step| step.skeleton.nodes.len()).sum();
    }
    seconds.sort_by(f64::total_cmp);
    (seconds[runs / 2], nodes)
}

pub fn run() {
    let width = "width.constant = 1";
    let ground = "to.ground = { count = 500, inside = { box = { min = [0, 0], max = [511, 0] } } }";
    let (simulated, nodes) = time(
        &format!("[grow.bolt]\nby.dbm = {{ eta = 3 }}\nspace = \"near\"\nfrom.at = [[256, 511]]\n{ground}\n{width}"),
        1,
    );
    let (charges, charged) = time(
        &format!(
            "[grow.bolt]\nby.dbm = {{ eta = 3, solver = \"charges\", nodes = {nodes} }}\nspace = \"near\"\nfrom.at = [[256, 511]]\n{ground}\n{width}"
        ),
        3,
    );
    // Forks are added until there are as many nodes.
    let planned = |forks: usize| {
        time(
            &format!(
                "[grow.bolt]\nspace = \"near\"\nfrom.at = [[256, 511]]\nto.ground = {{ at = [[256, 0]] }}\n{width}\n\
                 [grow.forks]\nspace = \"far\"\nfrom.all = \"bolt\"\nto.low = {{ count = {forks}, near = {{ step = \"bolt\", reach = 80, lower = 0.6 }} }}\n{width}"
            ),
            5,
        )
    };
    let (own, own_nodes) =
        (1..=200).step_by(4).map(planned).find(|(_, count)| *count >= nodes).unwrap_or_else(|| planned(200));
    println!("path planning                 {own:8.4} s, {own_nodes} nodes");
    println!("dielectric breakdown, grid    {simulated:8.3} s, {nodes} nodes: {:.0} times as long", simulated / own);
    println!("dielectric breakdown, charges {charges:8.4} s, {charged} nodes: {:.1} times as long", charges / own);
}
