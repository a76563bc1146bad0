//! Vectors (re-exported from `glam`), counter-based random streams, names, and the handles by which
//! long work reports progress, is cancelled, and asks for memory.
//!
//! Later stages need never handle platform differences: everything here gives the same bits everywhere.

mod checksum;
mod colour;
mod direction;
mod memory;
mod name;
mod per_round;
mod power;
mod prefetch;
mod progress;
mod random;
mod rotation;
mod slope;
mod solar;
mod srgb;
pub mod tolerance;
mod weights;

pub use glam::{DMat3, DVec2, DVec3};

pub use checksum::fnv1a;
pub use colour::Colour;
pub use direction::{GOLDEN_ANGLE, from_height, from_polar, from_sin_cos};
pub use memory::{Memory, OutOfMemory};
pub use name::{Degrees, Point, Ref, unknown};
pub use per_round::PerRound;
pub use power::power;
pub(crate) use prefetch::prefetch;
pub use progress::{Cancelled, Progress};
pub use random::{Stream, mix, name_of};
pub use rotation::{frame_along, rotated_toward, rotation};
pub use slope::slope;
pub use solar::solar_direction;
pub use srgb::{from_srgb, srgb_byte, to_srgb};
pub use weights::Weights;
