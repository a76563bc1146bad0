//! Finished pictures: what was traced, and light over photographs, on their way to pixels, layers, passes and mattes.
//!
//! Writers take any `Write`; files and their names are the command's.

mod shone;
mod traced;

pub use shone::{Depth, Shone, ShoneError};
pub use traced::{Traced, trace};
