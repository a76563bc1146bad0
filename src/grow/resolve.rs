//! Steps: their names are looked up, and what does not go together is told.

use super::endpoints::Endpoints;
use super::endpoints::RandomPlaces;
use super::grown::Part;
use super::lookup::{Lookup, given_shape, note};
use super::paths::Refine;
use super::placement::placement;
use super::plants::check_width;
use super::rounds::{self, indices};
use super::rules::Needs;
use super::space::Space;
use super::spec::{FromSpec, SpreadSpec, StepSpec};
use super::step::{Generators, Step};
use crate::math::{PerRound, Ref};
use crate::skeleton::Width;

/// The step called `name` in `space`, which is that of its own name if that is right; what is wrong is noted.
pub fn resolve_step(name: &str, spec: &StepSpec, space: Option<&Space>, lookup: &mut dyn Lookup) -> Option<Step> {
    let rules = spec.by.rules();
    let is_free = rules.needs == Needs::Nothing;
    rules.check_given(spec, lookup);
    let source = generators(name, spec, space, lookup);
    if spec.along > 0.0 && (is_first(&spec.from) || spec.repeat.is_some()) {
        let message =
            "`along` is about the step that this one grows from: it needs `from.all` or `from.ends`, and no `repeat`";
        lookup.wrong("along", message.to_owned());
    }
    rules.check(spec, space, lookup);
    let classes = classes(spec, rules.class);
    let method = spec.by.resolve(spec, space, lookup);
    let refine = refine(spec, space, lookup)?;
    // Regions have none.
    let width = spec.width.clone().unwrap_or(Width::Constant(0.0));
    note(lookup, "width", width.check(&classes));
    let repeat = match &spec.repeat {
        Some(repeat) => Some(rounds::resolve(repeat, spec, space, lookup)?),
        None => None,
    };
    check_width(lookup, spec);
    let count = spec.repeat.as_ref().map(indices);
    let mut sets = Vec::new();
    for (key, set) in &spec.to {
        let placement = placement(&format!("to.{key}"), &format!("{name}/{key}"), set, space, count, lookup);
        let class = classes.binary_search(&set.class).unwrap_or(0) as u16;
        sets.push(placement.map(|placement| Endpoints { name: key.clone(), class, placement }));
    }
    let step = Step {
        name: name.to_owned(),
        space: if is_free { None } else { Some(space?.clone()) },
        space_name: spec.space.as_ref().map_or_else(String::new, |space| space.name.clone()),
        source: source?,
        endpoints: sets.into_iter().collect::<Option<_>>()?,
        classes,
        method: method?,
        along: spec.along,
        refine,
        repeat,
        width,
        strands: spec.strands,
        symmetry: spec.symmetry,
        form: spec.form,
        smooth: spec.smooth,
        unreached: spec.unreached,
    };
    if step.repeat.is_some() && !step.solids().is_empty() {
        let message = "a repeated step cannot depend on what another step grew as a solid".to_owned();
        lookup.wrong("repeat", message);
    }
    Some(step)
}

/// The classes of a step's paths, sorted, with that of its method.
fn classes(spec: &StepSpec, own: Option<&str>) -> Vec<String> {
    let mut classes: Vec<String> = spec.to.values().map(|set| set.class.clone()).collect();
    classes.extend(own.map(str::to_owned));
    classes.sort();
    classes.dedup();
    classes
}

fn generators(name: &str, spec: &StepSpec, space: Option<&Space>, lookup: &mut dyn Lookup) -> Option<Generators> {
    let one = |key: &str, step: &Ref<Step>, part: Part, lookup: &mut dyn Lookup| {
        lookup.step(key, step).map(|step| Generators::Steps(vec![step], part))
    };
    match &spec.from {
        FromSpec::At(points) => Some(Generators::At(points.iter().map(|p| p.0).collect())),
        FromSpec::Inside(shape) => lookup.shape("from.inside", shape).map(Generators::Inside),
        FromSpec::Spread(spread) => spread_over(name, spread, space, lookup),
        FromSpec::All(step) => one("from.all", step, Part::All, lookup),
        FromSpec::Ends(step) => one("from.ends", step, Part::Ends, lookup),
        FromSpec::EveryEnd(steps) => {
            let mut found = Vec::new();
            for (i, step) in steps.iter().enumerate() {
                found.push(lookup.step(&format!("from.every_end.{i}"), step));
            }
            found.into_iter().collect::<Option<_>>().map(|steps| Generators::Steps(steps, Part::EveryEnd))
        }
    }
}

/// Generators at random.
fn spread_over(step: &str, spec: &SpreadSpec, space: Option<&Space>, lookup: &mut dyn Lookup) -> Option<Generators> {
    let inside = given_shape(lookup, "from.spread.inside", spec.inside.as_ref())?;
    if space.is_some_and(|space| space.lattice().is_none()) {
        let message = "random generators need a lattice: list them with `from.at`".to_owned();
        lookup.wrong("from.spread", message);
    }
    Some(Generators::Spread(RandomPlaces {
        count: PerRound::All(f64::from(spec.count)),
        inside,
        shell: None,
        apart: spec.apart,
        stream: format!("{step}/from"),
    }))
}

/// How paths are refined, if they are: `None` where that is wrong.
fn refine(spec: &StepSpec, space: Option<&Space>, lookup: &mut dyn Lookup) -> Option<Option<Refine>> {
    let Some(refine) = &spec.refine else { return Some(None) };
    if spec.to.values().any(|set| set.through.is_some()) {
        lookup.wrong("refine", "paths through given places are not refined: they would miss these".to_owned());
    }
    let Some(lattice) = space?.lattice() else {
        let message = "paths are refined on lattices: scattered nodes take a smaller spacing".to_owned();
        lookup.wrong("refine", message);
        return None;
    };
    let refine = refine.resolve(lattice.window.spacing, lookup.pixel());
    note(lookup, "refine", refine).map(Some)
}

/// Does `from` name no step?
fn is_first(from: &FromSpec) -> bool {
    matches!(from, FromSpec::At(_) | FromSpec::Inside(_) | FromSpec::Spread(_))
}

/// A step that waits for itself, if any does, by index. All steps that any waits for are there.
#[must_use]
pub fn waits_for_itself(steps: &[Step]) -> Option<usize> {
    let mut has_grown = vec![false; steps.len()];
    for _ in 0..steps.len() {
        for (i, step) in steps.iter().enumerate() {
            has_grown[i] |= step.after().all(|before| has_grown[before]);
        }
    }
    has_grown.iter().position(|grown| !grown)
}
