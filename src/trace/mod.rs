//! The preview: a ray tracer for models.
//!
//! [`World`] is a [`crate::model::Model`] with acceleration structures; [`render`] traces it to a [`Picture`] in linear light,
//! in tiles over all threads; the result does not depend on their number. [`Look::Exact`] is POV-Ray's shading;
//! [`Look::Studio`] has light from the whole sky and soft shadows; in [`Look::Natural`] light goes on from surface to surface and through
//! leaves.

mod denoise;
mod eye;
mod film;
mod laid;
mod natural;
mod posed;
mod render;
mod sample;
mod sampling;
mod settings;
mod shade;
mod smooth;
mod standing;
mod world;

pub use film::{Data, Picture, RANKS, Ranks};
pub use render::render;
pub use settings::RenderSettings;

pub use crate::model::Look;
pub use world::{SurfaceHit, World};
