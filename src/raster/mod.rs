//! Picture buffers in memory; files are the business of [`crate::files`].
//!
//! Later stages need never handle a picture without pixels or a buffer of the wrong length.

mod contour;
mod grey;
mod layers;
mod panorama;
mod plate;
mod tone;

pub use contour::{contours, rings};
pub use grey::Grey;
pub use layers::{Channel, Layers};
pub use panorama::Panorama;
pub use plate::{DataWindow, Plate, Samples};
pub use tone::filmic;
