//! Generators: from what a step grows from to nodes of its graph, for any graph.

use std::collections::HashMap;

use super::error::{GrowError, Key, Problem};
use super::grown::{bits, places};
use super::site::{PathSite, Site};
use super::step::{Context, Generators, Step};
use crate::graph::Node;
use crate::math::DVec3;

/// A node, and where exactly it is meant where that is told.
pub(super) type Placed = (Node, Option<DVec3>);

/// Where the steps that `step` grows from are; in order.
pub(super) fn source_places(step: &Step, context: &Context<'_>) -> Result<Vec<DVec3>, GrowError> {
    let mut all = Vec::new();
    if let Generators::Steps(steps, part) = &step.source {
        for &source in steps {
            let skeleton = context.grown[source].ok_or_else(|| step.error(Key::From, Problem::NotGrown))?;
            all.extend(places(skeleton, *part));
        }
    }
    Ok(all)
}

/// The generators of `step`. No node is named twice: of several places about a node the nearest counts, then the first.
pub(super) fn starts(step: &Step, site: &mut dyn Site, context: &Context<'_>) -> Result<Vec<Placed>, GrowError> {
    let wrong = |problem: Problem| step.error(Key::From, problem);
    let starts: Vec<Placed> = match &step.source {
        Generators::At(points) => {
            let nodes = site.within(points).into_iter().zip(points);
            let node = |(node, &p): (Option<Node>, &DVec3)| match node {
                Some(node) => Ok((node, Some(p))),
                None => Err(wrong(Problem::GeneratorOutside(p))),
            };
            nodes.map(node).collect::<Result<_, _>>()?
        }
        Generators::Inside(shape) => {
            let nodes = site.inside(shape);
            nodes.iter().for_each(|&node| site.take(node));
            // They differ.
            return if nodes.is_empty() {
                Err(wrong(Problem::NoNodeInShape))
            } else {
                Ok(nodes.into_iter().map(|node| (node, None)).collect())
            };
        }
        Generators::Spread(random) => {
            site.choose(random, context.seed).map_err(wrong)?.into_iter().map(|node| (node, None)).collect()
        }
        Generators::Steps(..) => {
            let places = source_places(step, context)?;
            let nodes = site.carried(&places).into_iter().zip(places);
            nodes.filter_map(|(node, p)| Some((node?, Some(p)))).collect()
        }
    };
    if starts.is_empty() {
        let is_steps = matches!(step.source, Generators::Steps(..));
        return Err(wrong(if is_steps { Problem::NothingInSpace } else { Problem::NoNodeInShape }));
    }
    let far = |&(node, p): &Placed| p.map_or(0.0, |p| (p - site.position(node)).length_squared());
    let mut best: HashMap<Node, usize> = HashMap::new();
    for (i, start) in starts.iter().enumerate() {
        let kept = best.entry(start.0).or_insert(i);
        if far(start) < far(&starts[*kept]) {
            *kept = i;
        }
    }
    let starts: Vec<Placed> =
        starts.iter().enumerate().filter(|(i, start)| best[&start.0] == *i).map(|(_, start)| *start).collect();
    starts.iter().for_each(|&(node, _)| site.take(node));
    Ok(starts)
}

/// Each of `starts` with the cost that it starts at: that of going to it along the step that this one grows from.
pub(super) fn delayed(
    step: &Step,
    site: &dyn PathSite,
    starts: &[Placed],
    context: &Context<'_>,
) -> Result<Vec<(Node, u64)>, GrowError> {
    let along = lengths_along(step, context);
    let (Some(&(first, _)), false) = (starts.first(), along.is_empty()) else {
        return Ok(starts.iter().map(|&(node, _)| (node, 0)).collect());
    };
    let [cost, length] = site.cost_over_length(first, context.progress)?;
    let scale = step.along * cost / length;
    let delay = |p: DVec3| along.get(&bits(p)).map_or(0, |length| (length * scale) as u64);
    Ok(starts.iter().map(|&(node, at)| (node, at.map_or(0, delay))).collect())
}

/// How far each place of the steps that `step` grows from is along them; nothing where that costs nothing.
fn lengths_along(step: &Step, context: &Context<'_>) -> HashMap<[u64; 3], f64> {
    let mut along: HashMap<[u64; 3], f64> = HashMap::new();
    if step.along <= 0.0 {
        return along;
    }
    for skeleton in step.sources().iter().filter_map(|&source| context.grown[source]) {
        let mut lengths: Vec<f64> = Vec::with_capacity(skeleton.nodes.len());
        for node in &skeleton.nodes {
            lengths.push(node.parent.map_or(0.0, |parent| {
                lengths[parent as usize] + (node.position - skeleton.nodes[parent as usize].position).length()
            }));
            along.entry(bits(node.position)).or_insert(lengths[lengths.len() - 1]);
        }
    }
    along
}
