//! Weber and Penn's parameters: what goes with them, and their checks.

use super::spec::WeberPennSpec;
use crate::grow::lookup::Lookup;
use crate::grow::rules::{Needs, Rules};
use crate::grow::spec::{FromSpec, StepSpec};

/// What goes with them.
pub(in crate::grow) const RULES: Rules = Rules {
    subject: "a tree by Weber and Penn's parameters has",
    needs: Needs::Nothing,
    repeats: false,
    has_endpoints: false,
    class: Some("main"),
    ..Rules::PATHS
};

/// The parameters of `step`, checked.
pub(in crate::grow) fn resolve(spec: &WeberPennSpec, step: &StepSpec, lookup: &mut dyn Lookup) -> WeberPennSpec {
    if !matches!(step.from, FromSpec::At(_)) {
        lookup.wrong("from", "these trees stand at points: `from.at`".to_owned());
    }
    if lookup.is_flat() {
        lookup.wrong("by", "this grows in space, not in a flat scene".to_owned());
    }
    if let Some(i) = spec.levels.iter().skip(1).position(|level| level.base_splits > 0) {
        let message = "the trunk alone splits at its base".to_owned();
        lookup.wrong(&format!("by.weber_penn.levels[{}].base_splits", i + 1), message);
    }
    spec.clone()
}
