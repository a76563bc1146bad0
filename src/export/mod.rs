//! Exporters: from a [`crate::model::Model`] to text, written to any [`std::io::Write`]. They open no files.

mod buffer;
mod decimal;
mod identifier;
mod mesh;
mod origin;
mod pov;
mod pov_body;
mod pov_text;
mod pov_values;
mod rib;
mod rib_body;
mod rib_limbs;
mod rib_options;
mod rib_sheets;
mod rib_stage;
mod rib_surface;
mod rib_text;
mod rib_values;
mod svg;
mod templates;

pub use identifier::identifier;
pub use mesh::{NoMesh, obj_bytes_needed, ply_bytes_needed, write_obj, write_ply};
pub use origin::Origin;
pub use pov::Pov;
pub use rib::{Rib, RibPart};
pub use rib_options::{RibOptions, RibShadows};
pub use svg::{SvgOptions, write_svg};
pub use templates::{TemplateError, Templates};
