//! Benchmarks, one program: `cargo bench -- plan trace` runs those two, without names it tells which there are.
#![allow(clippy::print_stdout, reason = "they are reports")]

mod clock;
mod dbm;
mod dendrites;
mod export;
mod growth;
mod irregular;
mod plan;
mod povray;
mod trace;
mod trees;

type Failure = Box<dyn std::error::Error>;
type Bench = fn() -> Result<(), Failure>;

/// The benchmarks by name. None is run unasked: some take minutes, some want other programs.
const BENCHES: [(&str, Bench); 8] = [
    ("plan", || told(plan::run)),
    ("export", || told(export::run)),
    ("trace", || told(trace::run)),
    ("povray", || told(povray::run)),
    ("irregular", irregular::run),
    ("dbm", || told(dbm::run)),
    ("growth", growth::run),
    ("dendrites", dendrites::run),
];

/// A benchmark that cannot fail.
fn told(run: fn()) -> Result<(), Failure> {
    run();
    Ok(())
}

fn main() -> Result<(), Failure> {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let mut has_run = false;
    for (name, run) in BENCHES {
        if asked.iter().any(|a| a == name) {
            println!("# {name}");
            run()?;
            has_run = true;
        }
    }
    if !has_run {
        println!("cargo bench -- NAME...: {}", BENCHES.map(|(name, _)| name).join(", "));
    }
    Ok(())
}
