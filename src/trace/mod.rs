//! The preview: a ray tracer for models.
//!
//! [`World`] puts a [`crate::model::Model`] into trees; [`render`] traces it to a [`Picture`] in linear light, tile by
//! tile over all threads, the same on any number of them. [`Look::Exact`] computes what POV-Ray computes;
//! [`Look::Studio`] has light from the whole sky and soft sunlight.

mod film;
mod render;
mod sampling;
mod shade;
mod smooth;
mod world;

pub use film::{Data, Picture, RANKS, Ranks};
pub use render::{Look, View, render};
pub use world::{Surface, World};
