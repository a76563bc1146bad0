//! Comparison of pictures: FLIP and per-pixel errors, and reports of many pairs.
//!
//! Pictures are decoded ([`crate::raster::Layers`]); files and folders are the command's.

mod flip;
mod measure;
mod rank;
mod report;
mod scene_change;

pub use flip::{PIXELS_PER_DEGREE, Tile, Tiles, flip_hdr, flip_ldr};
pub use measure::{CompareError, Measures, Metric, bytes_needed, measure};
pub use report::{Outcome, Pair, Panel, html, junit, summary};
pub use scene_change::changes;
