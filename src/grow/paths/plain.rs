//! Least-cost paths from generators to endpoints, on any graph (Xu and Mould 2007, section 3; 2008; 2012, section 3.1).

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::refine::refined;
use crate::geom::MarkKind;
use crate::graph::Node;
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::Grown;
use crate::grow::site::{PathSite, PathTree};
use crate::grow::space::Space;
use crate::grow::spaces::{OnScatter, on_lattice};
use crate::grow::starts::{delayed, starts};
use crate::grow::step::{Context, Generators, Method, Step, Unreached};
use crate::grow::targets::{Endpoint, Leg, targets};
use crate::grow::trial::try_places;
use crate::math::DVec3;
use crate::skeleton::Skeleton;

/// Growth by least-cost paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Paths;

impl Paths {
    /// The method of most steps.
    #[must_use]
    pub fn method() -> Arc<dyn Method> {
        Arc::new(Self)
    }
}

impl Method for Paths {
    fn name(&self) -> &'static str {
        "paths"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        match &step.space {
            Some(Space::Lattice(space)) => {
                let mut site = on_lattice(step, space, context)?;
                let (mut grown, skeleton) = grow(step, site.as_mut(), context)?;
                let skeleton = refined(step, skeleton, &mut grown.marks, space, context)?;
                step.finish_with(grown, skeleton, context)
            }
            Some(Space::Scatter(space)) => {
                let mut site = OnScatter::new(step, space, context)?;
                let (grown, skeleton) = grow(step, &mut site, context)?;
                step.finish_with(grown, skeleton, context)
            }
            Some(Space::Voxels(_)) => Err(step.error(Key::Space, Problem::WrongSpace("nodes to plan among"))),
            None => Err(step.error(Key::Space, Problem::NoSpace)),
        }
    }

    fn check_places(&self, step: &Step, context: &Context<'_>) -> Result<(), GrowError> {
        match &step.space {
            Some(Space::Lattice(space)) => try_places(step, on_lattice(step, space, context)?.as_mut(), context),
            // Other steps decide where nodes lie.
            Some(Space::Scatter(_)) if matches!(step.source, Generators::Steps(..)) => Ok(()),
            Some(Space::Scatter(space)) => try_places(step, &mut OnScatter::new(step, space, context)?, context),
            Some(Space::Voxels(_)) | None => Ok(()),
        }
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        match &step.space {
            Some(Space::Lattice(space)) => space.bytes_with_paths(step.count_paths(), 0),
            Some(Space::Scatter(space)) => {
                // A repeated step keeps sets of nodes, and makes some at a time.
                let graphs = if step.repeat.is_some() { 20 } else { 1 };
                space.bytes_needed().saturating_mul(graphs)
            }
            Some(Space::Voxels(_)) | None => 0,
        }
    }
}

/// Paths on their way into a skeleton.
struct PathUnion<'a> {
    step: &'a Step,
    site: &'a dyn PathSite,
    /// Where nodes are that were told exactly.
    exact: FxHashMap<Node, DVec3>,
    known: FxHashMap<Node, u32>,
    skeleton: Skeleton,
    settled: u64,
    dropped: usize,
}

impl PathUnion<'_> {
    /// Adds the path to `end`, whose generator starts with the cost `before`; false where there is none and that is allowed.
    fn add(&mut self, tree: &dyn PathTree, end: Node, class: u16, before: f64, set: &str) -> Result<bool, GrowError> {
        if !tree.is_reached(end) {
            if self.step.unreached == Unreached::Error {
                let problem = Problem::Unreached(self.site.position(end));
                return Err(self.step.error(Key::Set(set.to_owned()), problem));
            }
            self.dropped += 1;
            return Ok(false);
        }
        let path = tree.path(end).into_iter().map(|(node, cost)| {
            let p = self.exact.get(&node).copied().unwrap_or_else(|| self.site.position(node));
            (node, p, before + cost)
        });
        self.skeleton.add_path(&mut self.known, class, path);
        Ok(true)
    }

    /// Goes through given places, leg by leg; each leg starts where the one before ended.
    fn go_through(
        &mut self,
        leg: &Leg<'_>,
        generators: &[(Node, u64)],
        context: &Context<'_>,
    ) -> Result<(), GrowError> {
        let mut from = generators.to_vec();
        let mut before = 0.0;
        let kept = self.skeleton.paths.len();
        for &(node, _) in &leg.stops {
            let plan = self.site.plan(&from, Some(&[node]), context.progress);
            let tree = plan.map_err(|error| self.step.plan_error(error))?;
            self.settled += tree.settled();
            if !self.add(tree.as_ref(), node, leg.set.class, before, &leg.set.name)? {
                // What comes after it would hang in the air.
                break;
            }
            before += tree.path(node).first().map_or(0.0, |&(_, cost)| cost);
            from = vec![(node, 0)];
        }
        // Only the last place is an endpoint.
        let last = self.skeleton.paths.pop();
        self.skeleton.paths.truncate(kept);
        self.skeleton.paths.extend(last);
        Ok(())
    }
}

/// What grows on `site`, and its skeleton, which has no radii yet.
fn grow(step: &Step, site: &mut dyn PathSite, context: &Context<'_>) -> Result<(Grown, Skeleton), GrowError> {
    let starts = starts(step, site, context)?;
    let (targets, legs) = targets(step, site, context)?;
    let site: &dyn PathSite = site;
    let generators = delayed(step, site, &starts, context)?;
    // Generators have the last word.
    let told = targets.iter().filter_map(|target| Some((target.node, target.at?)));
    let stops = legs.iter().flat_map(|leg| leg.stops.iter().copied());
    let told = told.chain(stops).chain(starts.iter().filter_map(|&(node, at)| Some((node, at?))));
    let mut growing = PathUnion {
        step,
        site,
        exact: told.collect(),
        known: FxHashMap::default(),
        skeleton: Skeleton::new(step.classes.clone()),
        settled: 0,
        dropped: 0,
    };
    for leg in &legs {
        growing.go_through(leg, &generators, context)?;
    }
    let nodes: Vec<Node> = targets.iter().map(|target| target.node).collect();
    let mut marks = Vec::new();
    if !nodes.is_empty() || legs.is_empty() || !context.show.is_empty() {
        let everywhere = context.show.contains(&MarkKind::Contours);
        let plan = site.plan(&generators, (!everywhere).then_some(&nodes[..]), context.progress);
        let tree = plan.map_err(|error| step.plan_error(error))?;
        growing.settled += tree.settled();
        for &Endpoint { node, set, .. } in &targets {
            growing.add(tree.as_ref(), node, set.class, 0.0, &set.name)?;
        }
        if !context.show.is_empty() {
            let ends = legs.iter().filter_map(|leg| Some(leg.stops.last()?.0));
            let ends: Vec<Node> = nodes.iter().copied().chain(ends).collect();
            marks =
                site.marks(step, tree.as_ref(), &ends, context).map_err(|problem| step.error(Key::Nodes, problem))?;
        }
    }
    let [nodes, edges] = site.size();
    let PathUnion { skeleton, settled, dropped, .. } = growing;
    Ok((Grown { nodes, edges, settled, dropped, marks, ..Grown::default() }, skeleton))
}
