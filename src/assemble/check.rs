//! What can be known of a recipe before it grows.

use super::{AssembleError, Recipe, bytes_needed};
use crate::grow::Context;
use crate::math::{Memory, Progress};

/// Everything that keeps `recipe` from growing within `memory`, as far as that is known before: what growth itself
/// decides is not - whether paths reach their endpoints, whether there is room beside what has grown.
pub fn check(recipe: &Recipe, memory: &Memory, progress: &Progress) -> Vec<AssembleError> {
    if let Err(error) = recipe.check().and_then(|()| Ok(memory.ask(bytes_needed(recipe))?)) {
        return vec![error];
    }
    let grown = vec![None; recipe.steps.len()];
    let context = Context { seed: recipe.seed, grown: &grown, show: &[], memory, progress };
    let checked = recipe.steps.iter().map(|step| {
        progress.check()?;
        Ok(step.check_places(&context)?)
    });
    checked.chain([recipe.check_camera()]).filter_map(Result::err).collect()
}
