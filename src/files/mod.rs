//! Decoders, encoders and atomic writes.
//!
//! Later stages need never handle a truncated picture or one too large for memory: sizes are checked first.

mod atomic_write;
mod checksum;
mod cryptomatte;
mod draft;
mod exr;
mod exr_header;
mod extent;
mod folder;
mod inputs;
mod mesh;
mod picture;
mod plate;
mod scratch;
mod shape_files;
mod sketch;
mod temporary;

pub use self::exr::{ExrError, ExrHead, PanoramaError, decode_exr, decode_panorama, encode_exr, encode_exr_rows};
pub use atomic_write::{write_atomic, write_bytes};
pub use checksum::{is_edited, seal};
pub use cryptomatte::add_mattes;
pub use extent::{Extent, picture_extent};
pub use folder::{
    FileRead, Folder, ReadError, Reads, Unreadable, embedded_scenes, embedded_stage, leaf_names, stage_names,
};
pub use inputs::Inputs;
pub use mesh::{MeshError, decode_mesh, decode_obj, decode_ply};
pub use picture::{
    PictureError, PngHead, Rgba, decode_grey, decode_light, decode_linear, decode_png, encode_png, encode_png_rows,
    encode_png16, resize,
};
pub use plate::{ACESCG, PlateError, REC709, decode_plate, resize_grey, resize_plate, set_chromaticities};
pub use scratch::Scratch;
pub use sketch::{Page, SketchError, decode_sketch, draw_svg, letter_outlines};
pub use temporary::{Temporary, exit};
