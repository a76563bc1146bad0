//! Repeated steps, and the plants that steps make together: what they name is looked up, and checked.

use super::resolve::Resolver;
use crate::grow::{
    Influence, InfluenceSpec, LifespanSpec, Loss, Rank, RankSpec, Repeat, RepeatSpec, Space, Step, StepSpec, Target,
    Turn, TurnSpec, Upright,
};
use crate::math::DVec3;
use crate::skeleton::Width;

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
        if space?.lattice().is_some() {
            let message = "a repeated step needs scattered nodes (`nodes.scatter`) in its space".to_owned();
            self.wrong(&format!("{place}.space"), message);
        }
        if let Space::Scatter(scatter) = space?
            && scatter.clusters.is_some()
        {
            self.wrong(&format!("{place}.space"), "a repeated step's space has no clusters".to_owned());
        }
        if step.smooth > 0.0 {
            let message = "the limbs of a repeated step are smoothed by `form`, where the plant starts".to_owned();
            self.wrong(&format!("{place}.smooth"), message);
        }
        if !spec.size.is_within(spec.times, 1e-6, 1e6) {
            self.wrong(&at("size"), "sizes are above 0 in every round".to_owned());
        }
        let up = if matches!(space?, Space::Scatter(s) if s.is_plane) { DVec3::Y } else { DVec3::Z };
        let turns: Vec<_> = spec
            .turn
            .iter()
            .map(|(name, turn)| self.turn(&at(&format!("turn.{name}")), turn, spec.times, up))
            .collect();
        let influences: Vec<_> = spec
            .influence
            .iter()
            .map(|(name, influence)| self.influence(&at(&format!("influence.{name}")), name, influence))
            .collect();
        let lifespan = spec.lifespan.clone().unwrap_or(LifespanSpec { first: spec.times, loss: Loss::default() });
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

    fn influence(&mut self, place: &str, name: &str, spec: &InfluenceSpec) -> Option<Influence> {
        let rank = match &spec.rank {
            RankSpec::Angle(to) => {
                let to = to.0.try_normalize().ok_or("light and wind need a direction, not the zero vector");
                Rank::Angle(self.note(&format!("{place}.rank.angle"), to)?)
            }
            RankSpec::Near(shape) => Rank::Near(self.shape(&format!("{place}.rank.near"), shape)?),
            RankSpec::Far(shape) => Rank::Far(self.shape(&format!("{place}.rank.far"), shape)?),
            RankSpec::Shade(shade) => Rank::Shade(*shade),
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

    /// Widths of whole plants and their form belong together.
    pub(super) fn plant_width(&mut self, place: &str, spec: &StepSpec) {
        if spec.form.is_some() && spec.width.starts_plant() != Some(true) {
            let message =
                "`form` belongs where a plant starts: with a width by `length` or `pipe` that gives `root`".to_owned();
            self.wrong(&format!("{place}.form"), message);
        }
    }

    /// A step whose width carries on a plant grows from a step of one, by the same rule.
    pub(super) fn plants(&mut self, steps: &[Option<Step>]) {
        for step in steps.iter().flatten().filter(|step| step.width.starts_plant() == Some(false)) {
            let is_same = |i: &usize| {
                steps[*i].as_ref().is_none_or(|from| {
                    matches!(
                        (&from.width, &step.width),
                        (Width::Length(_), Width::Length(_)) | (Width::Pipe(_), Width::Pipe(_))
                    )
                })
            };
            if step.sources().is_empty() || !step.sources().iter().all(is_same) {
                let message = "a width without `root` carries on that of the step that this one grows from, by the same rule: give a `root`, or let that step have the same kind".to_owned();
                self.wrong(&format!("grow.{}.width", step.name), message);
            }
        }
    }
}
