//! How much memory a recipe takes.

use super::{AssembleError, Recipe};
use crate::grow::Step;

/// Bytes that growing `recipe` takes at its peak, step after step.
#[must_use]
pub fn bytes_needed(recipe: &Recipe) -> u64 {
    recipe.steps.iter().map(Step::bytes_needed).max().unwrap_or(0)
}

/// Refuses what needs more than `limit` bytes.
pub(super) fn within(needed: u64, limit: u64) -> Result<(), AssembleError> {
    if needed > limit { Err(AssembleError::Memory { needed, limit }) } else { Ok(()) }
}
