//! Decoders and encoders, and writing that leaves a whole file or none.
//!
//! Later stages need never handle a truncated picture or one too large for memory: sizes are checked first.

mod folder;
mod picture;
mod seal;
mod sketch;
mod whole;

pub use folder::{Folder, embedded_scenes};
pub use picture::{Rgba, decode_grey, decode_png, encode_png, resize};
pub use seal::{is_edited, seal};
pub use sketch::{Page, decode_sketch, draw_svg};
pub use whole::{write_bytes, write_whole};
