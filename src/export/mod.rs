//! Exporters: from a [`crate::model::Model`] to text, written to any [`std::io::Write`]. They open no files.

mod buffer;
mod decimal;
mod identifier;
mod mesh;
mod pov;
mod pov_body;
mod rib;
mod rib_body;
mod rib_sheets;
mod svg;
mod templates;

pub use identifier::identifier;
pub use mesh::{NoMesh, write_obj, write_ply};
pub use pov::{Origin, Pov};
pub use rib::{Rib, RibOptions, RibShadows};
pub use svg::{SvgOptions, write_svg};
pub use templates::{TemplateError, Templates};
