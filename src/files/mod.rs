//! Decoders and encoders, and writing that leaves a whole file or none.
//!
//! Later stages need never handle a truncated picture or one too large for memory: sizes are checked first.

mod cryptomatte;
mod exr;
mod folder;
mod mesh;
mod picture;
mod plate;
mod seal;
mod shape_files;
mod sketch;
mod whole;

pub use self::exr::{ExrHead, decode_exr, decode_panorama, encode_exr, encode_exr_rows};
pub use cryptomatte::add_mattes;
pub use folder::{FileRead, Folder, Reads, embedded_scenes, leaf_names};
pub use mesh::{decode_mesh, decode_obj, decode_ply};
pub use picture::{
    PngHead, Rgba, decode_grey, decode_linear, decode_png, encode_png, encode_png_rows, encode_png16, png_texts, resize,
};
pub use plate::{ACESCG, REC709, decode_plate, resize_grey, resize_plate, set_chromaticities};
pub use seal::{is_edited, seal};
pub use sketch::{Page, decode_sketch, draw_svg, letter_outlines};
pub use whole::{write_bytes, write_whole};
