//! External renderers as child processes.

mod child;
mod povray;
mod rib;

pub use povray::{Povray, PovrayError, Rendered};
pub use rib::{RibError, RibRenderer};
