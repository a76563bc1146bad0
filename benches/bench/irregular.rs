//! Irregular trees: Table 1 of Xu and Mould 2012 beside the paper's times, and how scattering a graph and planning in it
//! grows with its nodes. `--plot FILE` draws the latter.

use std::time::Instant;

use crate::Failure;
use crate::clock::median;
use lichtenberg::files::Folder;
use lichtenberg::graph::{Joining, Node, Region, Scatter, ScatterPlan, Sectors, WeightTable};
use lichtenberg::math::Weights;
use lichtenberg::math::{DVec3, Memory, Progress, Stream};
use lichtenberg::plan::routes;
use lichtenberg::scene::{Source, grow, load};

/// Each is run this often, and the median told.
const RUNS: usize = 9;

struct Cube(f64);

impl Region for Cube {
    fn margin(&self, p: DVec3) -> f64 {
        ((p - self.0 * 0.5).abs() - self.0 * 0.5).max_element()
    }

    fn bounds(&self) -> [DVec3; 2] {
        [DVec3::ZERO, DVec3::splat(self.0)]
    }
}

/// A scene's text without its claims, and without the step `other` and its object: what it is held against is not in the table.
fn without(text: &str, other: &str) -> String {
    let is_kept = |section: &&str| {
        let header = section.split(']').next().unwrap_or_default();
        !header.starts_with("claim.") && !header.ends_with(&format!(".{other}"))
    };
    text.split("\n[").filter(is_kept).collect::<Vec<_>>().join("\n[")
}

pub fn run() -> Result<(), Failure> {
    println!("Table 1 of Xu and Mould 2012: growth, widths included, on {} threads", rayon::current_num_threads());
    println!("{:<10} {:>9} {:>9} {:>10} {:>9} {:>8}", "figure", "nodes", "endpoints", "the paper", "ours", "ratio");
    for (figure, other, paper) in [("20", "even", 32.4), ("25", "elm", 4.5), ("27", "colonised", 20.0)] {
        let name = format!("scenes/papers/2012-fig{figure}.toml");
        let text = without(&std::fs::read_to_string(&name)?, other);
        let scene = load(&Source { name, text, folder: Folder::Disk("scenes/papers".into()) }, &[])?;
        let mut nodes = 0;
        let mut endpoints = 0;
        let seconds = median(
            || {
                let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).expect("it grows");
                nodes = grown.iter().map(|g| g.nodes).sum::<u64>();
                endpoints = grown.iter().map(|g| g.skeleton.paths.len()).sum::<usize>();
            },
            RUNS,
        );
        let ratio = paper / seconds;
        println!("Fig. {figure:<5} {nodes:>9} {endpoints:>9} {paper:>8.1} s {seconds:>7.3} s {ratio:>7.0}x");
    }
    println!("\nOne graph in a cube: Poisson-disc nodes, Yao graph, weights, paths to every node");
    println!("{:>10} {:>9} {:>9} {:>9} {:>10}", "nodes", "edges/n", "seconds", "us/node", "routes us");
    let table = WeightTable::new(Weights::default(), 1.0, 0.0)?;
    let mut points = Vec::new();
    for side in [24.0, 51.0, 110.0, 237.0] {
        let joining = Joining::Yao { sectors: Sectors::Orthants, longest: f64::INFINITY };
        let plan = ScatterPlan { spacing: 1.0, keep: 1.0, is_plane: false, joining: &joining, fixed: &[], owner: None };
        let stream = Stream::new(1, "bench");
        let mut told = (0, 0, 0.0);
        let runs = if side > 200.0 { 1 } else { 3 };
        let seconds = median(
            || {
                let graph = Scatter::new(&plan, &Cube(side), &stream).expect("it fits");
                let weights = graph.weigh(&table, &[], |p| p, &stream);
                let begun = Instant::now();
                routes(&graph, &weights, &[(Node(0), 0)], &[], &Progress::default()).expect("nothing cancels it");
                told = (graph.len(), graph.count_edges(), begun.elapsed().as_secs_f64());
            },
            runs,
        );
        let (nodes, edges, routed) = told;
        let each = |seconds: f64| seconds * 1e6 / nodes as f64;
        let edges = edges as f64 / nodes as f64;
        println!("{nodes:>10} {edges:>9.2} {seconds:>9.3} {:>9.2} {:>10.2}", each(seconds), each(routed));
        points.push((nodes as f64, seconds));
    }
    let mut args = std::env::args().skip_while(|arg| arg != "--plot").skip(1);
    if let Some(file) = args.next() {
        std::fs::write(file, plot(&points))?;
    }
    Ok(())
}

/// Seconds over nodes on logarithmic axes, with a line of slope 1 through the first.
fn plot(points: &[(f64, f64)]) -> String {
    let x = |nodes: f64| 60.0 + (libm::log10(nodes) - 4.0) * 120.0;
    let y = |seconds: f64| 300.0 - (libm::log10(seconds) + 3.0) * 60.0;
    let mut svg = String::from(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 460 340" font-family="sans-serif" font-size="12"><rect width="460" height="340" fill="white"/>"#,
    );
    for power in 4..=7 {
        let at = x(libm::pow(10.0, f64::from(power)));
        svg += &format!(
            r##"<path d="M{at} 20V300" stroke="#ddd"/><text x="{at}" y="318" text-anchor="middle">10^{power}</text>"##
        );
    }
    for power in -3..=1 {
        let at = y(libm::pow(10.0, f64::from(power)));
        svg += &format!(
            r##"<path d="M60 {at}H420" stroke="#ddd"/><text x="52" y="{}" text-anchor="end">10^{power} s</text>"##,
            at + 4.0
        );
    }
    let (n, s) = points[0];
    svg += &format!(
        r##"<path d="M{} {}L{} {}" stroke="#999" stroke-dasharray="4 4"/><text x="240" y="334" text-anchor="middle">nodes (dashed: linear)</text>"##,
        x(n),
        y(s),
        x(1e7),
        y(s * 1e7 / n)
    );
    for &(nodes, seconds) in points {
        svg += &format!(r##"<circle cx="{}" cy="{}" r="4" fill="#356"/>"##, x(nodes), y(seconds));
    }
    svg + "</svg>\n"
}
