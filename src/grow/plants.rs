//! Widths of plants that several steps grow together: checked where they are written.

use std::collections::BTreeSet;

use super::error::Key;
use super::lookup::Lookup;
use super::rounds::indices;
use super::spec::StepSpec;
use super::step::Step;
use crate::skeleton::{ByLength, Pipe, Width};

/// Numbers by round are in range, and those that belong to a whole plant are given where it starts.
fn plant_numbers(lookup: &mut dyn Lookup, width: &Width, rounds: u32) {
    if let Width::Length(ByLength { z, .. }) = width
        && !z.is_within(rounds, 0.01, 5.0)
    {
        lookup.wrong("width.length.z", "z is from 0.01 to 5".to_owned());
    }
    let given = match width {
        Width::Length(ByLength { root: None, tip, unit, .. }) => {
            [("length.tip", tip.is_some()), ("length.unit", unit.is_some())]
        }
        Width::Pipe(Pipe { root: None, tip, power }) => [("pipe.tip", tip.is_some()), ("pipe.power", power.is_some())],
        Width::Length(_) | Width::Pipe(_) | Width::Taper(_) | Width::Constant(_) => return,
    };
    for (key, _) in given.iter().filter(|(_, is_given)| *is_given) {
        let message = "this belongs to the whole plant: give it where that starts, beside `root`".to_owned();
        lookup.wrong(&format!("width.{key}"), message);
    }
}

/// Widths of whole plants and their form belong together.
pub(super) fn check_width(lookup: &mut dyn Lookup, spec: &StepSpec) {
    let Some(width) = &spec.width else { return };
    plant_numbers(lookup, width, spec.repeat.as_ref().map_or(1, indices));
    if spec.form.is_some() && width.starts_plant() != Some(true) {
        let message =
            "`form` belongs where a plant starts: with a width by `length` or `pipe` that gives `root`".to_owned();
        lookup.wrong("form", message);
    }
}

/// A step whose width carries on a plant grows from a step of one, by the same rule.
pub fn check_plants(steps: &[Option<Step>], wrong: &mut dyn FnMut(&Step, Key, &str)) {
    // Where a step's plant starts; circles were told before.
    let base = |start: usize| {
        let next = |&i: &usize| {
            let step = steps[i].as_ref().filter(|step| step.width.starts_plant() == Some(false))?;
            step.sources().first().copied()
        };
        std::iter::successors(Some(start), next).take(steps.len() + 1).last()
    };
    for step in steps.iter().flatten().filter(|step| step.width.starts_plant() == Some(false)) {
        let is_same = |i: &usize| {
            steps[*i].as_ref().is_none_or(|from| {
                matches!(
                    (&from.width, &step.width),
                    (Width::Length(_), Width::Length(_)) | (Width::Pipe(_), Width::Pipe(_))
                )
            })
        };
        let bases: BTreeSet<Option<usize>> = step.sources().iter().map(|&i| base(i)).collect();
        if bases.len() > 1 {
            let message = "the steps that this one grows from belong to different plants: its width carries on one";
            wrong(step, Key::From, message);
        }
        if step.sources().is_empty() || !step.sources().iter().all(is_same) {
            let message = "a width without `root` carries on that of the step that this one grows from, by the same rule: give a `root`, or let that step have the same kind";
            wrong(step, Key::Width, message);
        }
    }
}
