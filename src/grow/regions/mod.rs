//! Regions: all that is nearest to each generator, as solids.

mod labels;
mod solid;
mod solids;
mod spec;

pub use solid::Regions;
pub(super) use spec::RULES;
pub use spec::RegionsSpec;
