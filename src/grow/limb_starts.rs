//! Where limbs start that no graph carries: at points, at the ends of what grew, or all along it.

use super::error::{GrowError, Key, Problem};
use super::grown::Part;
use super::step::{Context, Generators, Step};
use crate::math::{DVec3, name_of};
use crate::skeleton::Skeleton;

/// Where a limb starts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Start {
    /// Where it is.
    pub at: DVec3,
    /// The way it grows, of length 1.
    pub way: DVec3,
    /// The way of the last branch of the limb that it carries on; zero where it has none.
    pub last: DVec3,
    /// What tells it from all others, whatever else grows: its random numbers depend on it.
    pub name: u64,
}

/// The name of a limb that carries on one with this name, of the source with this index; no branch has it.
fn next_name(limb: u64, source: u64) -> u64 {
    name_of(limb, u64::MAX - source)
}

/// The name of a branch: of a limb's node, counted from where the limb starts, the one with this index.
pub(super) fn branch_name(limb: u64, node: u32, index: u32) -> u64 {
    name_of(limb, u64::from(node) << 32 | u64::from(index))
}

impl Step {
    /// Where limbs start that grow from points (along `heading`) or from ends.
    pub(super) fn starts_of_limbs(&self, heading: DVec3, context: &Context<'_>) -> Result<Vec<Start>, GrowError> {
        let wrong = |problem: Problem| self.error(Key::From, problem);
        match &self.source {
            Generators::At(points) => {
                let start = |(&at, name)| Start { at, way: heading, last: DVec3::ZERO, name };
                Ok(points.iter().zip(0..).map(start).collect())
            }
            Generators::Steps(steps, part @ (Part::Ends | Part::EveryEnd)) => {
                let mut starts = Vec::new();
                for (&step, i) in steps.iter().zip(0..) {
                    let skeleton = context.grown[step].ok_or_else(|| wrong(Problem::NotGrown))?;
                    let last = last_branches(skeleton);
                    starts.extend(skeleton.end_paths(*part == Part::EveryEnd).map(|path| {
                        let end = skeleton.paths[path].end;
                        Start {
                            at: skeleton.nodes[end as usize].position,
                            way: skeleton.direction_into(end).unwrap_or(heading),
                            last: last[path],
                            name: next_name(skeleton.paths[path].name, i),
                        }
                    }));
                }
                Ok(starts)
            }
            Generators::Inside(_) | Generators::Spread(_) | Generators::Steps(_, Part::All) => {
                Err(wrong(Problem::NoLimbs))
            }
        }
    }

    /// The limbs of the steps that this one sprouts from, each as the places where it grew on, from its start: their
    /// starts have the way of the limb there. Where it grew by steps of a length, nodes that smoothing added between are
    /// no such places.
    pub(super) fn limbs_before(&self, step: Option<f64>, context: &Context<'_>) -> Vec<Vec<Start>> {
        let is_place = |cost: f64| step.is_none_or(|step| (cost / step - libm::round(cost / step)).abs() < 1e-6);
        let mut limbs = Vec::new();
        for (skeleton, i) in self.sources().iter().filter_map(|&step| context.grown[step]).zip(0..) {
            for (path, limb) in skeleton.paths.iter().zip(skeleton.limbs()) {
                let name = next_name(path.name, i);
                let places = limb.nodes.windows(2).filter(|pair| is_place(skeleton.nodes[pair[0] as usize].cost));
                let on = places.zip(0..).map(|(pair, place)| {
                    let [at, next] = [pair[0], pair[1]].map(|n| skeleton.nodes[n as usize].position);
                    let way = skeleton.direction_into(pair[0]).unwrap_or((next - at).normalize_or(DVec3::Z));
                    Start { at, way, last: DVec3::ZERO, name: branch_name(name, place, 0) }
                });
                limbs.push(on.collect());
            }
        }
        limbs
    }
}

/// For each path the way of the last branch of its limb, or of the limb that this carries on; zero where it has none.
fn last_branches(skeleton: &Skeleton) -> Vec<DVec3> {
    let mut last: Vec<(f64, DVec3)> = skeleton.paths.iter().map(|path| (f64::NEG_INFINITY, path.last)).collect();
    let at = |node: u32| skeleton.nodes[node as usize];
    for limb in skeleton.limbs() {
        let (Some((from, path)), Some(&first)) = (limb.leaves, limb.nodes.first()) else { continue };
        let slot = &mut last[path as usize];
        if at(from).cost >= slot.0 {
            *slot = (at(from).cost, (at(first).position - at(from).position).normalize_or_zero());
        }
    }
    last.into_iter().map(|(_, way)| way).collect()
}
