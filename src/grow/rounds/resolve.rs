//! Repeated steps: what they name is looked up, and checked.

use super::influence::{Influence, Rank};
use super::repeat::{Repeat, Target, Turn};
use super::spec::{Index, InfluenceSpec, LifespanSpec, Loss, Orient, RankSpec, RepeatSpec, TurnSpec, Upright};
use crate::graph::Measure;
use crate::grow::lookup::{Lookup, note};
use crate::grow::space::Space;
use crate::grow::spec::{FromSpec, StepSpec};
use crate::math::{DVec3, Point};

/// How many numbers by round a repeated step may ask for.
pub(in crate::grow) fn indices(spec: &RepeatSpec) -> u32 {
    let lifespan = spec.lifespan.as_ref().map_or(spec.times, |lifespan| lifespan.first);
    if spec.by == Index::Lifespan { spec.times.max(lifespan) } else { spec.times }
}

/// How `step` is repeated; what is wrong with it is noted.
pub(in crate::grow) fn resolve(
    spec: &RepeatSpec,
    step: &StepSpec,
    space: Option<&Space>,
    lookup: &mut dyn Lookup,
) -> Option<Repeat> {
    let at = |key: &str| format!("repeat.{key}");
    let space = space?;
    check(spec, step, space, lookup);
    let is_plane = space.up() == 1;
    let lifespan = spec.lifespan.clone().unwrap_or(LifespanSpec { first: spec.times, loss: Loss::default() });
    let rounds = indices(spec);
    if !spec.size.is_within(rounds, 1e-6, 1e6) {
        lookup.wrong(&at("size"), "sizes are above 0 in every round".to_owned());
    }
    let up = if is_plane { DVec3::Y } else { DVec3::Z };
    let turns: Vec<_> =
        spec.turn.iter().map(|(name, spec)| turn(lookup, &at(&format!("turn.{name}")), spec, rounds, up)).collect();
    let influences: Vec<_> = spec
        .influence
        .iter()
        .map(|(name, spec)| influence(lookup, &at(&format!("influence.{name}")), name, spec, is_plane))
        .collect();
    check_chances(&lifespan.loss, &at("lifespan.loss.chances"), lookup);
    Some(Repeat {
        times: spec.times,
        size: spec.size.clone(),
        by: spec.by,
        orient: spec.orient,
        turns: turns.into_iter().collect::<Option<_>>()?,
        lifespan,
        influences: influences.into_iter().collect::<Option<_>>()?,
    })
}

/// Notes keys of `step` that do not go with rounds.
fn check(spec: &RepeatSpec, step: &StepSpec, space: &Space, lookup: &mut dyn Lookup) {
    if !matches!(space, Space::Scatter(_)) {
        let message = "a repeated step needs scattered nodes (`nodes.scatter`) in its space".to_owned();
        lookup.wrong("space", message);
    }
    if let Space::Scatter(scatter) = space
        && scatter.clusters.is_some()
    {
        lookup.wrong("space", "a repeated step's space has no clusters".to_owned());
    }
    if let Space::Scatter(scatter) = space
        && scatter
            .fields
            .iter()
            .any(|f| matches!(f.measure, Measure::Height { .. } | Measure::Map { .. } | Measure::Sketch { .. }))
    {
        let message =
            "heights, maps and sketches are stretched over a space: those around ends have none of the scene's places";
        lookup.wrong("space", message.to_owned());
    }
    if matches!(step.from, FromSpec::All(_)) {
        let message = "a repeated step grows from ends: use `from.ends` or `from.every_end`".to_owned();
        lookup.wrong("from.all", message);
    }
    for (name, _) in step.to.iter().filter(|(_, set)| set.stream.is_some()) {
        let message = "endpoints around ends have streams of their own".to_owned();
        lookup.wrong(&format!("to.{name}.stream"), message);
    }
    let is_plane = space.up() == 1;
    if let Orient::Along(Point(along)) = spec.orient
        && (along == DVec3::ZERO || (is_plane && along.z != 0.0))
    {
        lookup.wrong("repeat.orient.along", "a direction is not zero, and in a flat scene has no z".to_owned());
    }
    if step.smooth > 0.0 {
        let message = "the limbs of a repeated step are smoothed by `form`, where the plant starts".to_owned();
        lookup.wrong("smooth", message);
    }
}

/// Chances are from 0 to 1 and add up to 1.
fn check_chances(loss: &Loss, key: &str, lookup: &mut dyn Lookup) {
    let Loss::Chances(chances) = loss else { return };
    let sum: f64 = chances.iter().map(|[chance, _]| chance).sum();
    let is_fine = chances.iter().all(|&[chance, loss]| chance >= 0.0 && (1.0..=64.0).contains(&loss));
    if !is_fine || (sum - 1.0).abs() > 1e-6 {
        let message =
            format!("chances are from 0 to 1 and add up to 1 (not {sum}), each with a loss from 1 to 64 rounds");
        lookup.wrong(key, message);
    }
}

fn turn(lookup: &mut dyn Lookup, place: &str, spec: &TurnSpec, times: u32, up: DVec3) -> Option<Turn> {
    if !spec.by.is_within(times, 0.0, 180.0) {
        lookup.wrong(&format!("{place}.by"), "turns are from 0 to 180 degrees".to_owned());
    }
    if spec.within.is_some() && spec.from.is_none() {
        lookup.wrong(&format!("{place}.within"), "`within` is a distance from a shape: it needs `from`".to_owned());
    }
    let target = match (spec.toward, spec.along, &spec.from) {
        (Some(Upright::Up), None, None) => Target::Along(up),
        (Some(Upright::Down), None, None) => Target::Along(-up),
        (None, Some(along), None) => {
            let along = along.0.try_normalize().ok_or("a turn needs a direction, not the zero vector");
            Target::Along(note(lookup, &format!("{place}.along"), along)?)
        }
        (None, None, Some(shape)) => {
            let shape = lookup.shape(&format!("{place}.from"), shape)?;
            Target::From(shape, spec.within.unwrap_or(f64::INFINITY))
        }
        _ => {
            let message = "a turn has exactly one of `toward` (up, down), `along` (a vector) and `from` (a shape)";
            lookup.wrong(place, message.to_owned());
            return None;
        }
    };
    Some(Turn { target, by: spec.by.clone() })
}

fn influence(
    lookup: &mut dyn Lookup,
    place: &str,
    name: &str,
    spec: &InfluenceSpec,
    is_plane: bool,
) -> Option<Influence> {
    let rank = match &spec.rank {
        RankSpec::Angle(to) => {
            let to = to.0.try_normalize().ok_or("light and wind need a direction, not the zero vector");
            Rank::Angle(note(lookup, &format!("{place}.rank.angle"), to)?)
        }
        RankSpec::Near(shape) => Rank::Near(lookup.shape(&format!("{place}.rank.near"), shape)?),
        RankSpec::Far(shape) => Rank::Far(lookup.shape(&format!("{place}.rank.far"), shape)?),
        RankSpec::Shade(shade) => {
            if is_plane {
                lookup.wrong(&format!("{place}.rank.shade"), "shade needs a sky: a flat scene has none".to_owned());
            }
            Rank::Shade(*shade)
        }
    };
    let is_reversed = [spec.count, spec.loss].into_iter().flatten().any(|[least, most]| least > most)
        || spec.size.is_some_and(|[least, most]| least > most);
    if is_reversed {
        lookup.wrong(place, "ranges are from the least to the greatest number".to_owned());
        return None;
    }
    let dies = matches!(&spec.rank, RankSpec::Shade(shade) if shade.dies < 1.0);
    if spec.count.is_none() && spec.loss.is_none() && spec.size.is_none() && !dies {
        lookup.wrong(place, "an influence changes nothing without `count`, `loss` or `size`".to_owned());
    }
    Some(Influence { name: name.to_owned(), rank, count: spec.count, loss: spec.loss, size: spec.size })
}
