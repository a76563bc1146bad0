//! Driving outside programs: they are started, watched, and stopped with us.

mod child;
mod povray;
mod rib;

pub use povray::{Povray, PovrayError, Rendered};
pub use rib::{RibError, RibRenderer};
