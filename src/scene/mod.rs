//! What the artist writes: scene files, parsed with every mistake reported, names and files resolved to a recipe.
//!
//! Later stages need never handle an unknown key, a name that leads nowhere, or a number out of range.

mod animation;
mod claim;
mod document;
mod findings;
mod include;
mod load;
mod loaded;
mod looks;
mod mistake;
mod objects;
mod resolve;
mod resolver;
mod schema;
mod set_stage;
mod source;
mod tree;
mod validate;

pub use animation::TrackSpec;
pub use claim::{Claim, Claimed, Quantity};
pub use document::{CopySpec, ObjectSpec, Scene, TileSpec};
pub use findings::{Finding, check_claims};
pub use load::{load, load_frame};
pub use loaded::{Loaded, Stage, check, grow, model};
pub use mistake::{Included, Mistake, SceneError, Span};
pub use schema::{schema, schema_markdown};
pub use source::Source;
pub use tree::Override;
