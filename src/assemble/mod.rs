//! The way from a recipe to a model: steps are grown, skeletons get their skins, the camera is set.
//!
//! Later stages need never handle a scene's own units or names: the model stands on its own. Everything here can be
//! cancelled.

mod background;
mod check;
mod dress;
mod error;
mod grass;
mod ground;
mod grow;
mod lights;
mod memory;
mod model;
mod plants;
mod recipe;
mod related;
mod relief;
mod scattered;

pub use check::check;
pub use error::{AssembleError, ObjectKey, ObjectProblem};
pub use grow::{grow, grow_related};
pub use memory::bytes_needed;
pub use model::model;
pub use recipe::{Backdrop, LeavesRecipe, LightsSpec, ObjectRecipe, Recipe};
