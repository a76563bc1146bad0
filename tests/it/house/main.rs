//! Prints the circles, the edges against the order of folders, and the longest functions of `src/`, or of the folder given.

mod graph;
mod modules;
mod names;
mod tokens;

use std::path::PathBuf;

fn main() {
    let src = std::env::args().nth(1).map_or_else(|| PathBuf::from("src"), PathBuf::from);
    let house = modules::House::read(&src);
    print!("{}", graph::report(&house));
}
