//! Decoders and encoders, and writing that leaves a whole file or none.
//!
//! Later stages need never handle a truncated picture or one too large for memory: sizes are checked first.

mod cryptomatte;
mod exr;
mod folder;
mod mesh;
mod picture;
mod seal;
mod sketch;
mod whole;

pub use self::exr::{decode_exr, decode_panorama, encode_exr};
pub use cryptomatte::add_mattes;
pub use folder::{Folder, embedded_scenes};
pub use mesh::decode_obj;
pub use picture::{Rgba, decode_grey, decode_linear, decode_png, encode_png, encode_png16, png_texts, resize};
pub use seal::{is_edited, seal};
pub use sketch::{Page, decode_sketch, draw_svg};
pub use whole::{write_bytes, write_whole};
