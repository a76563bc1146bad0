//! Ways to grow: which rules and which resolver belong to each, a row each.

use std::sync::Arc;

use super::lookup::Lookup;
use super::method_spec::MethodSpec;
use super::rules::Rules;
use super::space::Space;
use super::spec::StepSpec;
use super::step::Method;
use super::{baselines, colonise, paths, regions, segments, voxels, weber_penn};

impl MethodSpec {
    /// What goes with it.
    pub(super) fn rules(&self) -> &'static Rules {
        match self {
            Self::Paths => &Rules::PATHS,
            Self::Fractal(_) => &paths::FRACTAL,
            Self::Regions(_) => &regions::RULES,
            Self::Segments(_) => &segments::RULES,
            Self::Voxels(_) => &voxels::RULES,
            Self::Colonise(_) => &colonise::RULES,
            Self::WeberPenn(_) => &weber_penn::RULES,
            Self::Dbm(_) => &baselines::DBM,
            Self::Dla(_) => &baselines::DLA,
        }
    }

    /// The method with its names looked up; what is wrong with it is noted.
    pub(super) fn resolve(
        &self,
        step: &StepSpec,
        space: Option<&Space>,
        lookup: &mut dyn Lookup,
    ) -> Option<Arc<dyn Method>> {
        Some(match self {
            Self::Paths => paths::Paths::method(),
            Self::Fractal(fractal) => Arc::new(fractal.resolve(step, lookup)),
            Self::Regions(regions) => Arc::new(regions.clone()),
            Self::Segments(segments) => Arc::new(segments::resolve(segments, step, lookup)?),
            Self::Voxels(voxels) => Arc::new(voxels::resolve(voxels, step, space, lookup)?),
            Self::Colonise(spec) => Arc::new(colonise::resolve(spec, step, lookup)?),
            Self::WeberPenn(spec) => Arc::new(weber_penn::resolve(spec, step, lookup)),
            Self::Dbm(dbm) => Arc::new(dbm.resolve(step, lookup)),
            Self::Dla(dla) => Arc::new(dla.resolve(space, lookup)),
        })
    }
}
