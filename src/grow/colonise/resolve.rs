//! Space colonisation: what it names is looked up, and checked.

use super::spec::{Colonise, ColoniseSpec};
use crate::grow::lookup::Lookup;
use crate::grow::rules::{Needs, Rules};
use crate::grow::spec::{FromSpec, StepSpec};

/// What goes with space colonisation.
pub(in crate::grow) const RULES: Rules = Rules {
    subject: "space colonisation has",
    needs: Needs::Nothing,
    repeats: false,
    has_endpoints: false,
    class: Some("main"),
    ..Rules::PATHS
};

/// Space colonisation of `step`.
pub(in crate::grow) fn resolve(spec: &ColoniseSpec, step: &StepSpec, lookup: &mut dyn Lookup) -> Option<Colonise> {
    if let FromSpec::Inside(_) | FromSpec::Spread(_) = &step.from {
        let message = "without a graph limbs start at points (`from.at`) or on a step".to_owned();
        lookup.wrong("from", message);
    }
    if spec.kill > spec.influence {
        let message = "points are reached from nearer than they draw: `kill` is at most `influence`".to_owned();
        lookup.wrong("by.colonise.kill", message);
    }
    if lookup.is_flat() {
        lookup.wrong("by", "this grows in space, not in a flat scene".to_owned());
    }
    let inside = lookup.shape("by.colonise.inside", &spec.inside)?;
    let (influence, kill) = (spec.influence * spec.step, spec.kill * spec.step);
    Some(Colonise { inside, points: spec.points, step: spec.step, influence, kill, rounds: spec.rounds })
}
