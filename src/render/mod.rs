//! Driving outside programs: they are started, watched, and stopped with us.

mod povray;

pub use povray::{Povray, PovrayError, Rendered};
