//! Growth by voxels: what it names is looked up.

use super::automaton::{Automaton, Cling};
use super::light::LightSense;
use super::spec::VoxelsSpec;
use crate::geom::Shape;
use crate::grow::lookup::Lookup;
use crate::grow::rules::{Needs, Rules};
use crate::grow::segments::{self, angles, attractor, check_free, heading, in_order};
use crate::grow::space::Space;
use crate::grow::spec::{FromSpec, StepSpec};

/// What goes with growth by voxels.
pub(in crate::grow) const RULES: Rules =
    Rules { subject: "growth by voxels has", needs: Needs::Voxels, ..segments::RULES };

/// Foliage that reaches farther, in voxels, is refused: every node fills so many to all sides.
const MOST_FOLIAGE: f64 = 24.0;

/// Growth by voxels of `step`.
pub(in crate::grow) fn resolve(
    spec: &VoxelsSpec,
    step: &StepSpec,
    space: Option<&Space>,
    lookup: &mut dyn Lookup,
) -> Option<Automaton> {
    if let FromSpec::All(_) = &step.from {
        lookup.wrong("from.all", "limbs in voxels start at points or at ends".to_owned());
    }
    check_free(lookup, step);
    let side = match space {
        Some(Space::Voxels(space)) => Some(space.side),
        _ => None,
    };
    if let Some(side) = side.filter(|side| spec.foliage > MOST_FOLIAGE * side) {
        let message = format!("foliage reaches {MOST_FOLIAGE} voxels at most: {}", MOST_FOLIAGE * side);
        lookup.wrong("by.voxels.foliage", message);
    }
    let branches = spec.branches.map(|branches| {
        in_order(lookup, "by.voxels.branches.age", branches.age.map(f64::from));
        (branches.age, angles(lookup, "by.voxels.branches.angle", branches.angle))
    });
    check_sun(spec, lookup);
    // Meshes are sampled at every voxel.
    let sampled = |shape: Shape| side.map_or(shape.clone(), |side| shape.sampled(side));
    let cling = match &spec.cling {
        Some(cling) => {
            in_order(lookup, "by.voxels.cling.within", cling.within);
            Some(Cling { to: sampled(lookup.shape("by.voxels.cling.to", &cling.to)?), within: cling.within })
        }
        None => None,
    };
    let keep_from = match &spec.keep_from {
        Some(keep) => Some((sampled(lookup.shape("by.voxels.keep_from.shape", &keep.shape)?), keep.by)),
        None => None,
    };
    Some(Automaton {
        step: spec.step,
        rounds: spec.rounds,
        nodes: spec.nodes,
        tries: spec.tries,
        turn: angles(lookup, "by.voxels.turn", spec.turn),
        branches,
        apart: spec.apart.unwrap_or(spec.step * 0.5),
        room: spec.room,
        straight: spec.straight,
        light: LightSense::new(&spec.light),
        foliage: spec.foliage,
        cling,
        keep_from,
        heading: heading(lookup, "by.voxels.heading", spec.heading),
        toward: step.toward.as_ref().map(attractor),
    })
}

fn check_sun(spec: &VoxelsSpec, lookup: &mut dyn Lookup) {
    let Some(sun) = &spec.light.sun else { return };
    in_order(lookup, "by.voxels.light.sun.hours", sun.hours);
    if sun.directions().is_empty() {
        let message = "the sun is below the horizon at these hours of that day".to_owned();
        lookup.wrong("by.voxels.light.sun", message);
    }
}
