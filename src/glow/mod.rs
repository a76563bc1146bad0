//! The light of strokes: the channel, the glow around it, the atmospheric halo, the illumination of clouds; composited over a
//! photograph.
//!
//! A layer is one intensity a pixel, in linear light; colours are applied when pixels are written. Later stages need never
//! handle light that is negative or not finite.

mod canvas;
mod composite;
mod convolve;
mod coverage;
mod near;
mod scatter;
mod shine;
mod temperature;

pub use canvas::Canvas;
pub use composite::Composite;
pub use scatter::Scattering;
pub use shine::{Layer, Pass, ShineError, shine};
pub use temperature::black_body;
