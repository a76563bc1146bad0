//! Growth by segments and by voxels: a plant of a million nodes, and ivy of 50,000, on one thread and on two. Times are of
//! growth with its widths, medians.

use crate::Failure;
use crate::clock::median;
use lichtenberg::files::Folder;
use lichtenberg::grow::Grown;
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{Loaded, Source, grow, load};

/// Each is run this often, and the median told.
const RUNS: usize = 11;

fn scene(text: &str) -> Result<Loaded, Failure> {
    let folder = Folder::Disk(env!("CARGO_MANIFEST_DIR").into());
    Ok(load(&Source { name: "bench".to_owned(), text: text.to_owned(), folder }, &[])?)
}

fn grown(scene: &Loaded) -> Vec<Grown> {
    grow(scene, &[], &Memory::default(), &Progress::default()).expect("it grows")
}

pub fn run() -> Result<(), Failure> {
    println!("{:<34} {:>9} {:>10} {:>10} {:>7}", "model", "nodes", "one", "two", "ratio");
    for (what, text) in [
        ("plant by segments", include_str!("../scenes/million-plant.toml")),
        ("ivy by voxels", include_str!("../scenes/ivy-50k.toml")),
    ] {
        let scene = scene(text)?;
        let nodes: usize = grown(&scene).iter().map(|g| g.skeleton.nodes.len()).sum();
        let on = |threads: usize| -> Result<f64, Failure> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            Ok(pool.install(|| median(|| drop(grown(&scene)), RUNS)))
        };
        let (one, two) = (on(1)?, on(2)?);
        println!("{what:<34} {nodes:>9} {:>7.1} ms {:>7.1} ms {:>7.2}", one * 1e3, two * 1e3, one / two);
    }
    Ok(())
}
