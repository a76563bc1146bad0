//! Growth by segments: what it names is looked up, and how much will grow is told before it does.

use std::collections::BTreeMap;

use super::expected::Expected;
use super::spec::{AttractorSpec, BranchesSpec, SegmentsSpec};
use super::values::{Attractor, Branches, Segments};
use crate::grow::lookup::{Lookup, given_shape, note};
use crate::grow::method_spec::MethodSpec;
use crate::grow::rules::{Needs, Rules};
use crate::grow::spec::{EndpointSpec, FromSpec, StepSpec};
use crate::math::{DVec3, Degrees, PerRound, Point};

/// What goes with growth by segments.
pub(in crate::grow) const RULES: Rules = Rules {
    subject: "growth by segments has",
    needs: Needs::Nothing,
    repeats: false,
    has_endpoints: false,
    has_attractor: true,
    class: Some(MAIN),
    ..Rules::PATHS
};

/// The class of limbs that have no endpoints.
pub(in crate::grow) const MAIN: &str = "main";
/// More points to start from are refused.
const MOST_STARTS: usize = 1_000_000;

/// Least and greatest, in order and in radians.
pub(in crate::grow) fn angles(lookup: &mut dyn Lookup, key: &str, [least, most]: [Degrees; 2]) -> [f64; 2] {
    in_order(lookup, key, [least.0, most.0]);
    [least.radians(), most.radians()]
}

/// Notes a range whose least is above its greatest.
pub(in crate::grow) fn in_order(lookup: &mut dyn Lookup, key: &str, [least, most]: [f64; 2]) {
    if least > most {
        lookup.wrong(key, format!("the least comes first: [{most}, {least}]"));
    }
}

/// The direction of limbs that start at points; up by default.
pub(in crate::grow) fn heading(lookup: &mut dyn Lookup, key: &str, heading: Option<Point>) -> DVec3 {
    let direction = heading.map_or(DVec3::Z, |p| p.0);
    if direction.try_normalize().is_none() {
        lookup.wrong(key, "a heading is a direction, not the zero vector".to_owned());
    }
    direction.normalize_or(DVec3::Z)
}

/// What limbs tend to.
pub(in crate::grow) fn attractor(spec: &AttractorSpec) -> Attractor {
    Attractor { at: spec.at.0, strength: spec.strength }
}

/// Notes what does not hold where no graph carries limbs.
pub(in crate::grow) fn check_free(lookup: &mut dyn Lookup, step: &StepSpec) {
    if let FromSpec::Inside(_) | FromSpec::Spread(_) = &step.from {
        let message =
            "a graph has nodes in a shape or at random: without one limbs start at points (`from.at`) or ends";
        lookup.wrong("from", message.to_owned());
    }
    if lookup.is_flat() {
        lookup.wrong("by", "this grows in space, not in a flat scene".to_owned());
    }
}

fn branches(lookup: &mut dyn Lookup, key: &str, spec: Option<BranchesSpec>) -> Option<Branches> {
    let BranchesSpec { most, chance, angle, arc } = spec?;
    let angle = angles(lookup, &format!("{key}.angle"), angle);
    Some(Branches { most, chance, angle, arc: arc.radians() })
}

/// Growth by segments of `step`.
pub(in crate::grow) fn resolve(spec: &SegmentsSpec, step: &StepSpec, lookup: &mut dyn Lookup) -> Option<Segments> {
    let is_along = matches!(step.from, FromSpec::All(_));
    if is_along && spec.sprout.is_none() {
        let message = "how many limbs start along a step is told by `by.segments.sprout`; or grow `from.ends`";
        lookup.wrong("from.all", message.to_owned());
    } else if !is_along && spec.sprout.is_some() {
        lookup.wrong("by.segments.sprout", "limbs sprout along a step: this needs `from.all`".to_owned());
    }
    if matches!(&step.from, FromSpec::At(points) if points.len() > MOST_STARTS) {
        lookup.wrong("from.at", "a million starts at most".to_owned());
    }
    check_free(lookup, step);
    let along = match &step.from {
        FromSpec::All(from) => lookup.steps().get(&from.name).and_then(|before| match &before.by {
            MethodSpec::Segments(before) => Some(before.step),
            _ => None,
        }),
        _ => None,
    };
    let segments = Segments {
        step: spec.step,
        depth: spec.depth,
        jitter: angles(lookup, "by.segments.jitter", spec.jitter),
        branches: branches(lookup, "by.segments.branches", spec.branches),
        sprout: branches(lookup, "by.segments.sprout", spec.sprout),
        along,
        heading: heading(lookup, "by.segments.heading", spec.heading),
        inside: given_shape(lookup, "by.segments.inside", spec.inside.as_ref())?,
        toward: step.toward.as_ref().map(attractor),
        starts: starts(step, &mut |name| lookup.expected(name)),
    };
    let expected = segments.check(segments.starts);
    note(lookup, "by.segments", expected)?;
    Some(segments)
}

/// How many limbs of a step are expected to start.
fn starts(step: &StepSpec, expected: &mut dyn FnMut(&str) -> Expected) -> f64 {
    match &step.from {
        FromSpec::At(points) => points.len() as f64,
        FromSpec::Ends(from) => expected(&from.name).ends,
        FromSpec::EveryEnd(all) => all.iter().map(|from| expected(&from.name).ends).sum(),
        FromSpec::All(from) => {
            let Expected { nodes, ends } = expected(&from.name);
            (nodes - ends).max(0.0)
        }
        FromSpec::Inside(_) | FromSpec::Spread(_) => 0.0,
    }
}

/// How much each of `steps` is expected to grow; of a plan only its ends are known before.
#[must_use]
pub fn expected_of(steps: &BTreeMap<String, StepSpec>) -> BTreeMap<String, Expected> {
    fn visit(name: &str, steps: &BTreeMap<String, StepSpec>, known: &mut BTreeMap<String, Expected>) -> Expected {
        if let Some(&known) = known.get(name) {
            return known;
        }
        // Nothing is expected of steps that wait for each other.
        known.insert(name.to_owned(), Expected::default());
        let Some(step) = steps.get(name) else { return Expected::default() };
        let one = match &step.by {
            MethodSpec::Segments(spec) => {
                let starts = starts(step, &mut |from| visit(from, steps, known));
                spec.expected(starts)
            }
            _ => {
                let ends = |set: &EndpointSpec| {
                    let at = set.at.as_ref().map_or(0, Vec::len) as f64;
                    set.count.as_ref().and_then(PerRound::once).unwrap_or(at)
                };
                Expected { ends: step.to.values().map(ends).sum(), ..Expected::default() }
            }
        };
        let parts = step.symmetry.map_or(1.0, |symmetry| f64::from(symmetry.parts()));
        let all = Expected { nodes: one.nodes * parts, ends: one.ends * parts };
        known.insert(name.to_owned(), all);
        all
    }
    let mut known = BTreeMap::new();
    for name in steps.keys() {
        visit(name, steps, &mut known);
    }
    known
}
