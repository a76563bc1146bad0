//! The light of strokes: the channel itself, the glow about it, the halo that the air makes, light thrown on clouds; and
//! all of that over a photograph.
//!
//! Layers are kept apart as one number a pixel, in linear light; colours come in when pixels are written. Later stages
//! need never handle light that is negative or not finite.

mod canvas;
mod composite;
mod convolve;
mod coverage;
mod fourier;
mod near;
mod scatter;
mod shine;
mod temperature;

pub use canvas::Canvas;
pub use composite::Composite;
pub use scatter::Scattering;
pub use shine::{Layer, Pass, ShineError, shine};
pub use temperature::black_body;
