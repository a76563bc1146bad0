//! How far two pictures in memory are apart: `cargo run --example compare`.

#![allow(clippy::print_stdout, reason = "what it prints is its result")]

use std::error::Error;

use lichtenberg::compare::{Metric, measure};
use lichtenberg::raster::{Channel, Layers};

/// A picture of 64 by 64 pixels in linear light: a ramp, with a bright square at `corner`.
fn picture(corner: u32) -> Layers {
    let side = 64_u32;
    let value = |i: u32| {
        let (x, y) = (i % side, i / side);
        let is_square = (corner..corner + 8).contains(&x) && (corner..corner + 8).contains(&y);
        if is_square { 0.9 } else { x as f32 / side as f32 * 0.5 }
    };
    let values: Vec<f32> = (0..side * side).map(value).collect();
    let channel = |name: &str| Channel { name: name.to_owned(), values: values.clone(), is_half: false };
    Layers { width: side, height: side, channels: ["R", "G", "B"].map(channel).to_vec(), ..Layers::default() }
}

fn main() -> Result<(), Box<dyn Error>> {
    let [same, moved] =
        [measure(&picture(20), &picture(20), &[], false)?, measure(&picture(20), &picture(22), &[], false)?];
    println!("same: {}", Metric::Flip.of(&same));
    println!("moved: {:.4}, at most {:.4}", Metric::Flip.of(&moved), moved.flip_max);
    Ok(())
}
