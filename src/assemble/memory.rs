//! How much memory a recipe takes.

use super::{ObjectRecipe, Recipe};
use crate::grow::{Grown, Step};
use crate::skeleton::Skeleton;

/// Bytes that growing `recipe` takes at its peak, step after step, as far as that is known before.
#[must_use]
pub fn bytes_needed(recipe: &Recipe) -> u64 {
    recipe.steps.iter().map(Step::bytes_needed).max().unwrap_or(0)
}

/// Bytes of what has grown.
pub(super) fn bytes_of<'a>(grown: impl IntoIterator<Item = &'a Grown>) -> u64 {
    grown.into_iter().map(|step| step.bytes() as u64).sum()
}

/// Bytes that making an object of `skeletons` takes at its peak; isosurfaces ask themselves.
pub(super) fn bytes_to_dress(object: &ObjectRecipe, grown: &[Grown], skeletons: &[&Skeleton]) -> u64 {
    let leaves = object.leaves.iter().map(|leaves| {
        let leaf = if object.skin.is_mesh() { leaves.mesh.bytes() as u64 } else { 0 };
        leaves.spec.bytes_needed(skeletons, leaf)
    });
    let borders = object.steps.iter().filter_map(|&step| grown[step].regions.as_ref());
    let borders =
        borders.map(|regions| regions.surfaces.iter().map(|s| s.bytes() as u64).sum::<u64>() * 4).sum::<u64>();
    let thorns = object.thorns.as_ref().map_or(0, |thorns| thorns.bytes_needed(skeletons));
    object.skin.bytes_needed(skeletons).saturating_add(borders).saturating_add(thorns).saturating_add(leaves.sum())
}
