//! Lichtenberg
pub mod export;
pub mod files;
pub mod geom;
pub mod graph;
pub mod grow;
pub mod math;
pub mod model;
pub mod plan;
pub mod raster;
pub mod render;
pub mod scene;
pub mod skeleton;
#[cfg(feature = "cli")]
pub mod cli;
