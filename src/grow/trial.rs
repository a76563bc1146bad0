//! Whether a step has places for what it starts from and leads to, before anything grows.

use super::endpoints::Placement;
use super::error::GrowError;
use super::site::Site;
use super::starts::starts;
use super::step::{Context, Generators, Step};
use super::targets::targets;

/// Finds nodes for the generators of `step` and its endpoints, but for those that other steps decide.
pub(super) fn try_places(step: &Step, site: &mut dyn Site, context: &Context<'_>) -> Result<(), GrowError> {
    if !matches!(step.source, Generators::Steps(..)) {
        starts(step, site, context)?;
    }
    try_targets(step, site, context)
}

/// Finds nodes for the endpoints of `step`, but for those that are near other steps.
pub(super) fn try_targets(step: &Step, site: &mut dyn Site, context: &Context<'_>) -> Result<(), GrowError> {
    let mut own = step.clone();
    own.endpoints.retain(|set| !matches!(set.placement, Placement::Near(_)));
    targets(&own, site, context).map(|_| ())
}
