//! The neutral description of a scene that exporters and renderers read.
//!
//! World space is right-handed with z up. Later stages need never handle a number that is not finite, a radius of 0,
//! or a number with more digits than are written: all are rounded once, on entering a body.

mod air;
mod appearance;
mod background;
mod body;
mod body_error;
mod camera;
mod clouds;
mod daylight;
mod detail;
mod digits;
mod dome;
mod frame;
mod grass;
mod instance;
mod lens;
mod look;
mod object;
pub mod pattern;
mod relief;
mod scene_model;
mod sky_picture;
mod sky_spec;
mod stroke;
mod tips;
mod view;

pub use air::Air;
pub use appearance::{FADE, Ground, GroundSpec, Light, LightSpec, Material, Sky};
pub use background::BackgroundSpec;
pub use body::{Ball, Body, Limbs, Mesh, Pose, Thorns};
pub use body_error::BodyError;
pub use camera::{Camera, CameraError, CameraSpec, Projected, Projection};
pub use daylight::{Daylight, DaylightError};
pub use digits::Digits;
pub use dome::Dome;
pub use frame::{LimbFrame, limb_frames};
pub use grass::GrassSpec;
pub use instance::Instance;
pub use lens::{Film, Lens};
pub use look::Look;
pub use object::Object;
pub use pattern::Pattern;
pub use relief::{Relief, ReliefSpec};
pub use scene_model::{Model, to_world};
pub use sky_picture::SkyPicture;
pub use sky_spec::{DaylightSpec, SkySpec};
pub use stroke::{CORE, CloudLight, GlowSpec, Halo, NearGlow, Piece, Stroke};
pub use tips::Tips;
pub use view::{BEYOND, ViewFrame, ViewSpec};
