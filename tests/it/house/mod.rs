//! Reads the sources as text: which file uses which, where they use each other in circles, how long functions are.
//!
//! `rustc --edition 2024 -o /tmp/house tests/it/house/main.rs && /tmp/house` prints it without building the library.

pub mod graph;
pub mod modules;
pub mod names;
pub mod tokens;
