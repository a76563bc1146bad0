//! Targets: from a step's endpoints to nodes of its graph, for any graph.

use super::endpoints::{Endpoints, Placement};
use super::error::{GrowError, Key, Problem};
use super::site::Site;
use super::step::{Context, Step};
use crate::graph::Node;
use crate::math::DVec3;

/// An endpoint on its way.
#[derive(Clone, Copy)]
pub(super) struct Endpoint<'a> {
    /// Its node.
    pub node: Node,
    /// Where exactly it is meant, where that is told.
    pub at: Option<DVec3>,
    /// Its set.
    pub set: &'a Endpoints,
}

/// A path that is to go through nodes in turn.
pub(super) struct Leg<'a> {
    /// The nodes with their places; the last is the endpoint.
    pub stops: Vec<(Node, DVec3)>,
    /// Its set.
    pub set: &'a Endpoints,
}

/// The endpoints of `step`, and its paths through given places.
pub(super) fn targets<'a>(
    step: &'a Step,
    site: &mut dyn Site,
    context: &Context<'_>,
) -> Result<(Vec<Endpoint<'a>>, Vec<Leg<'a>>), GrowError> {
    let mut targets = Vec::new();
    let mut legs = Vec::new();
    for set in &step.endpoints {
        let wrong = |problem: Problem| step.error(Key::Set(set.name.clone()), problem);
        let at = |site: &mut dyn Site, points: &[DVec3]| -> Result<Vec<(Node, DVec3)>, GrowError> {
            let nodes = site.within(points).into_iter().zip(points);
            let nodes =
                nodes.map(|(node, &p)| node.map(|node| (node, p)).ok_or_else(|| wrong(Problem::EndpointOutside(p))));
            let nodes: Vec<_> = nodes.collect::<Result<_, _>>()?;
            nodes.iter().for_each(|&(node, _)| site.take(node));
            Ok(nodes)
        };
        let chosen = match &set.placement {
            Placement::At(points) => {
                let placed = at(site, points)?;
                targets.extend(placed.into_iter().map(|(node, p)| Endpoint { node, at: Some(p), set }));
                continue;
            }
            Placement::Through(lists) => {
                for points in lists {
                    legs.push(Leg { stops: at(site, points)?, set });
                }
                continue;
            }
            Placement::Random(random) => site.choose(random, context.seed).map_err(wrong)?,
            Placement::Near(near) => site.choose_near(near, context).map_err(wrong)?,
        };
        targets.extend(chosen.into_iter().map(|node| Endpoint { node, at: None, set }));
    }
    Ok((targets, legs))
}
