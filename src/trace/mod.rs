//! The preview: a ray tracer for models.
//!
//! [`World`] is a [`crate::model::Model`] with acceleration structures; [`render`] traces it to a [`Picture`] in linear light,
//! in tiles over all threads; the result does not depend on their number. [`Look::Exact`] is POV-Ray's shading;
//! [`Look::Studio`] has light from the whole sky and soft shadows.

mod film;
mod render;
mod sampling;
mod shade;
mod smooth;
mod world;

pub use film::{Data, Picture, RANKS, Ranks};
pub use render::{Look, RenderSettings, render};
pub use world::{SurfaceHit, World};
