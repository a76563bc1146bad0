//! Repeated steps, and the plants that steps make together: what they name is looked up, and checked.

use std::collections::BTreeSet;

use super::resolve::Resolver;
use crate::graph::Measure;
use crate::grow::{
    FromSpec, Index, Influence, InfluenceSpec, LifespanSpec, Loss, Orient, Rank, RankSpec, Repeat, RepeatSpec, Space,
    Step, StepSpec, Target, Turn, TurnSpec, Upright,
};
use crate::math::{DVec3, Point};
use crate::skeleton::{ByLength, Pipe, Width};

/// How many numbers by round a repeated step may ask for.
pub(super) fn indices(spec: &RepeatSpec) -> u32 {
    let lifespan = spec.lifespan.as_ref().map_or(spec.times, |lifespan| lifespan.first);
    if spec.by == Index::Lifespan { spec.times.max(lifespan) } else { spec.times }
}

impl Resolver<'_> {
    /// How the step at `place` is repeated.
    pub(super) fn repeat(
        &mut self,
        place: &str,
        spec: &RepeatSpec,
        step: &StepSpec,
        space: Option<&Space>,
    ) -> Option<Repeat> {
        let at = |key: &str| format!("{place}.repeat.{key}");
        if !matches!(space?, Space::Scatter(_)) {
            let message = "a repeated step needs scattered nodes (`nodes.scatter`) in its space".to_owned();
            self.wrong(&format!("{place}.space"), message);
        }
        if let Space::Scatter(scatter) = space?
            && scatter.clusters.is_some()
        {
            self.wrong(&format!("{place}.space"), "a repeated step's space has no clusters".to_owned());
        }
        if let Space::Scatter(scatter) = space?
            && scatter
                .fields
                .iter()
                .any(|f| matches!(f.measure, Measure::Height { .. } | Measure::Map { .. } | Measure::Sketch { .. }))
        {
            let message = "heights, maps and sketches are stretched over a space: those around ends have none of the scene's places";
            self.wrong(&format!("{place}.space"), message.to_owned());
        }
        if matches!(step.from, FromSpec::All(_)) {
            let message = "a repeated step grows from ends: use `from.ends` or `from.every_end`".to_owned();
            self.wrong(&format!("{place}.from.all"), message);
        }
        for (name, _) in step.to.iter().filter(|(_, set)| set.stream.is_some()) {
            let message = "endpoints around ends have streams of their own".to_owned();
            self.wrong(&format!("{place}.to.{name}.stream"), message);
        }
        let is_plane = matches!(space?, Space::Scatter(scatter) if scatter.is_plane);
        if let Orient::Along(Point(along)) = spec.orient
            && (along == DVec3::ZERO || (is_plane && along.z != 0.0))
        {
            self.wrong(&at("orient.along"), "a direction is not zero, and in a flat scene has no z".to_owned());
        }
        if step.smooth > 0.0 {
            let message = "the limbs of a repeated step are smoothed by `form`, where the plant starts".to_owned();
            self.wrong(&format!("{place}.smooth"), message);
        }
        let lifespan = spec.lifespan.clone().unwrap_or(LifespanSpec { first: spec.times, loss: Loss::default() });
        let rounds = indices(spec);
        if !spec.size.is_within(rounds, 1e-6, 1e6) {
            self.wrong(&at("size"), "sizes are above 0 in every round".to_owned());
        }
        let up = if matches!(space?, Space::Scatter(s) if s.is_plane) { DVec3::Y } else { DVec3::Z };
        let turns: Vec<_> =
            spec.turn.iter().map(|(name, turn)| self.turn(&at(&format!("turn.{name}")), turn, rounds, up)).collect();
        let influences: Vec<_> = spec
            .influence
            .iter()
            .map(|(name, influence)| self.influence(&at(&format!("influence.{name}")), name, influence, is_plane))
            .collect();
        if let Loss::Chances(chances) = &lifespan.loss {
            let sum: f64 = chances.iter().map(|[chance, _]| chance).sum();
            let is_fine = chances.iter().all(|&[chance, loss]| chance >= 0.0 && (1.0..=64.0).contains(&loss));
            if !is_fine || (sum - 1.0).abs() > 1e-6 {
                let message = format!(
                    "chances are from 0 to 1 and add up to 1 (not {sum}), each with a loss from 1 to 64 rounds"
                );
                self.wrong(&at("lifespan.loss.chances"), message);
            }
        }
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

    fn turn(&mut self, place: &str, spec: &TurnSpec, times: u32, up: DVec3) -> Option<Turn> {
        if !spec.by.is_within(times, 0.0, 180.0) {
            self.wrong(&format!("{place}.by"), "turns are from 0 to 180 degrees".to_owned());
        }
        if spec.within.is_some() && spec.from.is_none() {
            self.wrong(&format!("{place}.within"), "`within` is a distance from a shape: it needs `from`".to_owned());
        }
        let target = match (spec.toward, spec.along, &spec.from) {
            (Some(Upright::Up), None, None) => Target::Along(up),
            (Some(Upright::Down), None, None) => Target::Along(-up),
            (None, Some(along), None) => {
                let along = along.0.try_normalize().ok_or("a turn needs a direction, not the zero vector");
                Target::Along(self.note(&format!("{place}.along"), along)?)
            }
            (None, None, Some(shape)) => {
                let shape = self.shape(&format!("{place}.from"), shape)?;
                Target::From(shape, spec.within.unwrap_or(f64::INFINITY))
            }
            _ => {
                let message = "a turn has exactly one of `toward` (up, down), `along` (a vector) and `from` (a shape)";
                self.wrong(place, message.to_owned());
                return None;
            }
        };
        Some(Turn { target, by: spec.by.clone() })
    }

    fn influence(&mut self, place: &str, name: &str, spec: &InfluenceSpec, is_plane: bool) -> Option<Influence> {
        let rank = match &spec.rank {
            RankSpec::Angle(to) => {
                let to = to.0.try_normalize().ok_or("light and wind need a direction, not the zero vector");
                Rank::Angle(self.note(&format!("{place}.rank.angle"), to)?)
            }
            RankSpec::Near(shape) => Rank::Near(self.shape(&format!("{place}.rank.near"), shape)?),
            RankSpec::Far(shape) => Rank::Far(self.shape(&format!("{place}.rank.far"), shape)?),
            RankSpec::Shade(shade) => {
                if is_plane {
                    self.wrong(&format!("{place}.rank.shade"), "shade needs a sky: a flat scene has none".to_owned());
                }
                Rank::Shade(*shade)
            }
        };
        let is_reversed = [spec.count, spec.loss].into_iter().flatten().any(|[least, most]| least > most)
            || spec.size.is_some_and(|[least, most]| least > most);
        if is_reversed {
            self.wrong(place, "ranges are from the least to the greatest number".to_owned());
            return None;
        }
        let dies = matches!(&spec.rank, RankSpec::Shade(shade) if shade.dies < 1.0);
        if spec.count.is_none() && spec.loss.is_none() && spec.size.is_none() && !dies {
            self.wrong(place, "an influence changes nothing without `count`, `loss` or `size`".to_owned());
        }
        Some(Influence { name: name.to_owned(), rank, count: spec.count, loss: spec.loss, size: spec.size })
    }

    /// Numbers by round are in range, and those that belong to a whole plant are given where it starts.
    fn plant_numbers(&mut self, place: &str, width: &Width, rounds: u32) {
        if let Width::Length(ByLength { z, .. }) = width
            && !z.is_within(rounds, 0.01, 5.0)
        {
            self.wrong(&format!("{place}.width.length.z"), "z is from 0.01 to 5".to_owned());
        }
        let given = match width {
            Width::Length(ByLength { root: None, tip, unit, .. }) => {
                [("length.tip", tip.is_some()), ("length.unit", unit.is_some())]
            }
            Width::Pipe(Pipe { root: None, tip, power }) => {
                [("pipe.tip", tip.is_some()), ("pipe.power", power.is_some())]
            }
            Width::Length(_) | Width::Pipe(_) | Width::Taper(_) | Width::Constant(_) => return,
        };
        for (key, _) in given.iter().filter(|(_, is_given)| *is_given) {
            let message = "this belongs to the whole plant: give it where that starts, beside `root`".to_owned();
            self.wrong(&format!("{place}.width.{key}"), message);
        }
    }

    /// Widths of whole plants and their form belong together.
    pub(super) fn plant_width(&mut self, place: &str, spec: &StepSpec) {
        let Some(width) = &spec.width else { return };
        self.plant_numbers(place, width, spec.repeat.as_ref().map_or(1, indices));
        if spec.form.is_some() && width.starts_plant() != Some(true) {
            let message =
                "`form` belongs where a plant starts: with a width by `length` or `pipe` that gives `root`".to_owned();
            self.wrong(&format!("{place}.form"), message);
        }
    }

    /// A step whose width carries on a plant grows from a step of one, by the same rule.
    pub(super) fn plants(&mut self, steps: &[Option<Step>]) {
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
                self.wrong(&format!("grow.{}.from", step.name), message.to_owned());
            }
            if step.sources().is_empty() || !step.sources().iter().all(is_same) {
                let message = "a width without `root` carries on that of the step that this one grows from, by the same rule: give a `root`, or let that step have the same kind".to_owned();
                self.wrong(&format!("grow.{}.width", step.name), message);
            }
        }
    }
}
