//! All steps are grown, round after round.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rayon::prelude::*;

use super::memory::bytes_of;
use super::plants::shape_plants;
use super::related::related;
use super::{AssembleError, Recipe, bytes_needed};
use crate::geom::MarkKind;
use crate::grow::{Canopy, Context, GrowError, Grown, Regions, Rounds, Step};
use crate::math::{Memory, Progress};
use crate::skeleton::Skeleton;

/// Grows every step of `recipe` within `memory`; `show` lists what construction drawings need.
///
/// # Errors
/// [`AssembleError`].
pub fn grow(
    recipe: &Recipe,
    show: &[MarkKind],
    memory: &Memory,
    progress: &Progress,
) -> Result<Vec<Grown>, AssembleError> {
    grow_related(recipe, &(0..recipe.steps.len()).collect::<Vec<_>>(), show, memory, progress)
}

/// Grows the steps `wanted` and all that have to do with them, as [`grow`] does; the others grow nothing.
///
/// # Errors
/// [`AssembleError`].
pub fn grow_related(
    recipe: &Recipe,
    wanted: &[usize],
    show: &[MarkKind],
    memory: &Memory,
    progress: &Progress,
) -> Result<Vec<Grown>, AssembleError> {
    recipe.check()?;
    recipe.check_camera()?;
    memory.ask(bytes_needed(recipe))?;
    let nothing = |step: &Step| Grown { name: step.name.clone(), ..Grown::default() };
    let steps = recipe.steps.iter().zip(related(&recipe.steps, wanted));
    let grown = steps.map(|(step, is_wanted)| (!is_wanted).then(|| nothing(step))).collect();
    let mut scene = Schedule { recipe, show, memory, progress, grown, repeated: BTreeMap::new() };
    while scene.grown.iter().any(Option::is_none) {
        scene.grow_round()?;
    }
    let mut grown: Vec<Grown> = scene.grown.into_iter().flatten().collect();
    shape_plants(&recipe.steps, &mut grown, memory)?;
    Ok(grown)
}

/// All steps on their way. A round holds all that wait for nothing that has not grown, and one repetition of each that is
/// under way; it reads only what the rounds before made.
struct Schedule<'a> {
    recipe: &'a Recipe,
    show: &'a [MarkKind],
    memory: &'a Memory,
    progress: &'a Progress,
    /// What has grown, by step.
    grown: Vec<Option<Grown>>,
    /// Repeated steps under way.
    repeated: BTreeMap<usize, Rounds<'a>>,
}

impl Schedule<'_> {
    fn grow_round(&mut self) -> Result<(), AssembleError> {
        let steps = &self.recipe.steps;
        let is_ready = |i: &usize| {
            self.grown[*i].is_none()
                && !self.repeated.contains_key(i)
                && steps[*i].after().all(|before| self.grown[before].is_some())
        };
        let ready: Vec<usize> = (0..steps.len()).filter(is_ready).collect();
        let earlier: Vec<Option<&Skeleton>> = self.grown.iter().map(|g| g.as_ref().map(|g| &g.skeleton)).collect();
        let memory = &self.memory.beside(self.bytes());
        let context =
            Context { seed: self.recipe.seed, grown: &earlier, show: self.show, memory, progress: self.progress };
        let mut round = Vec::new();
        for i in ready {
            match Rounds::begin(&steps[i], &context)? {
                Some(rounds) => drop(self.repeated.insert(i, rounds)),
                None => round.push(i),
            }
        }
        let world: Vec<&Skeleton> =
            earlier.iter().copied().flatten().chain(self.repeated.values().map(Rounds::skeleton)).collect();
        let canopies: Vec<Vec<Canopy>> = self
            .repeated
            .values()
            .map(|rounds| rounds.clumps().map(|clump| Canopy::new(&world, clump)).collect())
            .collect();
        let groups = groups(steps, round);
        let finished = self.grow_groups(&groups, &context)?;
        for (rounds, canopies) in self.repeated.values_mut().zip(&canopies) {
            rounds.advance(canopies, self.show, memory, self.progress)?;
        }
        let finished = groups.into_iter().flatten().zip(finished.into_iter().flatten());
        let finished: Vec<(usize, Grown)> = finished.collect();
        finished.into_iter().for_each(|(i, step)| self.grown[i] = Some(step));
        self.finish_repeated()
    }

    /// Grows groups of steps, side by side where memory allows; the result is the same.
    fn grow_groups(&self, groups: &[Vec<usize>], context: &Context<'_>) -> Result<Vec<Vec<Grown>>, AssembleError> {
        let solids = groups.iter().flatten().flat_map(|&i| self.recipe.steps[i].solids());
        let solids = solids.filter_map(|i| Some(self.grown[i].as_ref()?.regions.as_ref()?.solid_bytes_needed() as u64));
        context.memory.ask(solids.max().unwrap_or(0))?;
        let groups: Vec<Vec<Cow<'_, Step>>> =
            groups.iter().map(|group| group.iter().map(|&i| self.with_solids(i)).collect()).collect();
        let needed = |group: &Vec<Cow<'_, Step>>| group.iter().map(|s| s.bytes_needed_from(context.grown)).sum::<u64>();
        let mut needed: Vec<u64> = groups.iter().map(needed).collect();
        // No more at a time than there are threads.
        needed.sort_unstable_by(|a, b| b.cmp(a));
        needed.truncate(rayon::current_num_threads());
        let grow = |group: &Vec<Cow<'_, Step>>| self.grow_group(group, context);
        let grown: Result<_, GrowError> = if context.memory.ask(needed.iter().sum()).is_ok() {
            groups.par_iter().map(grow).collect()
        } else {
            context.memory.ask(needed.first().copied().unwrap_or(0))?;
            groups.iter().map(grow).collect()
        };
        Ok(grown?)
    }

    /// Bytes of all that has grown so far.
    fn bytes(&self) -> u64 {
        let under_way = self.repeated.values().map(|rounds| rounds.skeleton().bytes() as u64);
        bytes_of(self.grown.iter().flatten()) + under_way.sum::<u64>()
    }

    /// A step with the solids that have grown in its shapes.
    fn with_solids(&self, step: usize) -> Cow<'_, Step> {
        let solids = |i: usize| self.grown[i].as_ref()?.regions.as_ref().map(Regions::solid);
        let step = &self.recipe.steps[step];
        if step.solids().is_empty() { Cow::Borrowed(step) } else { Cow::Owned(step.with_solids(&solids)) }
    }

    /// Grows steps that belong together.
    fn grow_group(&self, steps: &[Cow<'_, Step>], context: &Context<'_>) -> Result<Vec<Grown>, GrowError> {
        let all = &self.recipe.steps;
        let steps: Vec<&Step> = steps.iter().map(AsRef::as_ref).collect();
        let before = (0..all.len()).filter(|&i| all[i].shares_space(steps[0]));
        let before: Vec<(&Step, &Skeleton)> = before.filter_map(|i| Some((&all[i], context.grown[i]?))).collect();
        steps[0].method.grow_together(&steps, &before, context)
    }

    /// Takes repeated steps that are done out of the rounds.
    fn finish_repeated(&mut self) -> Result<(), AssembleError> {
        let done: Vec<usize> = self.repeated.iter().filter(|(_, rounds)| rounds.is_done()).map(|(&i, _)| i).collect();
        for i in done {
            if let Some(rounds) = self.repeated.remove(&i) {
                let earlier: Vec<Option<&Skeleton>> =
                    self.grown.iter().map(|g| g.as_ref().map(|g| &g.skeleton)).collect();
                self.grown[i] = Some(rounds.finish(&earlier)?);
            }
        }
        Ok(())
    }
}

/// Those in the same voxels grow together, the others alone.
fn groups(steps: &[Step], round: Vec<usize>) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in round {
        match groups.iter_mut().find(|group| steps[group[0]].shares_space(&steps[i])) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}
