//! Fractal placement: new endpoints again and again in the vicinity of all that has grown (Xu and Mould 2007, section 3.2,
//! Fig. 6).

use std::collections::VecDeque;

use rustc_hash::FxHashMap;
use schemars::JsonSchema;
use serde::Deserialize;

use super::choice::in_random_order;
use super::endpoints::Crowd;
use super::{GrowError, Placement, Step};
use crate::graph::{Graph, Lattice, Node};
use crate::math::{DVec3, Progress, Stream, mix, power};
use crate::plan::{Goal, plan_delayed};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// Paths are planned again from all that has grown to `count` times `branching` new endpoints at a distance that is divided by
/// `attenuation`, until that is below `least` or all iterations are done. The first iteration has the counts that the endpoints
/// give.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FractalSpec {
    /// Distance d of the first endpoints from the generators, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub distance: f64,
    /// The attenuation factor alpha: what the distance is divided by from one iteration to the next.
    #[serde(default = "two")]
    #[schemars(range(min = 1.0, max = 100.0))]
    pub attenuation: f64,
    /// The branching factor beta: what the counts are multiplied by.
    #[serde(default = "two")]
    #[schemars(range(min = 0.1, max = 100.0))]
    pub branching: f64,
    /// Where endpoints are, seen from what has grown.
    #[serde(default)]
    pub place: Vicinity,
    /// Iterations at most.
    #[serde(default)]
    #[schemars(range(min = 1, max = 100))]
    pub iterations: Option<u32>,
    /// The epsilon below which no distance is used, in scene units: by default two steps of the lattice.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub least: Option<f64>,
}

fn two() -> f64 {
    2.0
}

/// Where endpoints are, seen from what has grown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Vicinity {
    /// No farther than the distance (the paper's text).
    #[default]
    Within,
    /// At the distance, to half a step of the lattice (its pseudocode).
    At,
}

impl FractalSpec {
    /// The distance of each iteration, in scene units, on a lattice with this spacing.
    pub(super) fn distances(&self, spacing: f64) -> Vec<f64> {
        let least = self.least.unwrap_or(2.0 * spacing);
        let most = self.iterations.unwrap_or(100);
        (0..most)
            .map(|i| self.distance / power(self.attenuation, f64::from(i)))
            .take_while(|&distance| distance >= least)
            .collect()
    }

    /// The endpoints of an iteration that starts with `count`.
    pub(super) fn count(&self, count: f64, iteration: usize) -> f64 {
        libm::round(count * power(self.branching, iteration as f64))
    }
}

/// For each cell the nearest node of what has grown, as far as was asked: one field that grows with it.
struct Nearness {
    nearest: Vec<Node>,
    /// Squared distance in steps.
    squared: Vec<u32>,
    /// The nodes that have one.
    met: Vec<Node>,
}

impl Nearness {
    fn new(cells: usize) -> Self {
        Self { nearest: vec![Node(0); cells], squared: vec![u32::MAX; cells], met: Vec::new() }
    }

    /// Takes in what has `grown` since, up to a squared distance. Each node hands on which node is nearest to it, along
    /// edges, so that what is forbidden is gone around.
    fn grow<const N: usize>(&mut self, lattice: &Lattice<N>, grown: &[Node], most: u32) {
        let mut queue: VecDeque<Node> = VecDeque::new();
        for &node in grown {
            let cell = lattice.cell(node);
            if self.squared[cell] == u32::MAX {
                self.met.push(node);
            }
            (self.nearest[cell], self.squared[cell]) = (node, 0);
            queue.push_back(node);
        }
        while let Some(node) = queue.pop_front() {
            let nearest = self.nearest[lattice.cell(node)];
            let from = lattice.coordinates(nearest);
            lattice.edges(node, |edge| {
                let to = lattice.coordinates(edge.node);
                let squared = (0..3)
                    .map(|axis| from[axis].abs_diff(to[axis]))
                    .fold(0_u32, |sum, d| sum.saturating_add(d.saturating_mul(d)));
                if squared < self.squared[edge.cell] && squared <= most {
                    if self.squared[edge.cell] == u32::MAX {
                        self.met.push(edge.node);
                    }
                    (self.nearest[edge.cell], self.squared[edge.cell]) = (nearest, squared);
                    queue.push_back(edge.node);
                }
            });
        }
    }
}

impl Step {
    /// Grows by fractal placement from `starts`, each with its exact place where that is told; the skeleton, with iterations as
    /// levels, and how many nodes were settled.
    pub(super) fn grow_fractal<const N: usize>(
        &self,
        fractal: &FractalSpec,
        lattice: &Lattice<N>,
        starts: &[(Node, Option<DVec3>)],
        seed: u64,
        progress: &Progress,
    ) -> Result<(Skeleton, u64), GrowError> {
        let wrong =
            |key: &str, message: String| GrowError::Scene { place: format!("grow.{}.{key}", self.name), message };
        let spacing = lattice.window().spacing;
        let distances = fractal.distances(spacing);
        if distances.is_empty() {
            let least = fractal.least.unwrap_or(2.0 * spacing);
            return Err(wrong(
                "by.fractal.distance",
                format!("no iteration: the distance starts below `least`, {least}"),
            ));
        }
        let open = lattice.open_nodes() as f64;
        let mut asked = 0.0;
        for i in 0..distances.len() {
            let counts = self.endpoints.iter().map(|set| fractal.count(set.placement.count() as f64, i));
            asked += counts.sum::<f64>();
            if asked > open {
                let message = format!(
                    "with iteration {} there would be {asked} endpoints, more than the {open} nodes: lower `branching`, or allow fewer iterations",
                    i + 1
                );
                return Err(wrong("by.fractal", message));
            }
        }
        let range = lattice.weight_range();
        let mut structure: Vec<Node> = starts.iter().map(|&(node, _)| node).collect();
        let mut plan = plan_delayed(lattice, &structure, &[], Goal::Everything, progress)
            .map_err(|error| self.plan_error(error))?;
        let settled = plan.settled() as u64;
        let mut skeleton = Skeleton::new(self.classes.clone());
        let mut known: Vec<u32> = vec![u32::MAX; lattice.cells()];
        let mut near = Nearness::new(lattice.cells());
        let mut fresh: Vec<Node> = structure.clone();
        let mut way: Vec<(Node, u32)> = Vec::new();
        let exact: FxHashMap<Node, DVec3> = starts.iter().filter_map(|&(node, at)| Some((node, at?))).collect();
        for (iteration, &distance) in distances.iter().enumerate() {
            let level = iteration as u16;
            let steps = distance / spacing;
            let reach = if fractal.place == Vicinity::At { steps + 0.5 } else { steps };
            let most = (reach * reach).min(f64::from(u32::MAX - 1));
            near.grow(lattice, &fresh, most as u32);
            fresh.clear();
            let least = if fractal.place == Vicinity::At { ((steps - 0.5) * (steps - 0.5)).max(1.0) } else { 1.0 };
            let fits = |node: &Node| (least..=most).contains(&f64::from(near.squared[lattice.cell(*node)]));
            let room: Vec<Node> = near.met.iter().copied().filter(fits).collect();
            let mut taken = vec![false; if self.endpoints.len() > 1 { lattice.cells() } else { 0 }];
            for set in &self.endpoints {
                let Placement::Random { count, inside, apart, stream, .. } = &set.placement else { continue };
                let count = fractal.count(count.at(0), iteration) as usize;
                let stream = Stream::new(seed, &format!("endpoints/{stream}/{iteration}"));
                let apart = apart / power(fractal.attenuation, iteration as f64);
                let fits = |node: Node| {
                    inside.as_ref().is_none_or(|shape| shape.contains(lattice.position(node)))
                        && taken.get(lattice.cell(node)).is_none_or(|taken| !taken)
                };
                let chosen = choose(lattice, &room, count, apart, &fits, &stream);
                if chosen.is_empty() && iteration == 0 {
                    let message = "no node lies at that distance: raise `by.fractal.distance`, or enlarge the space";
                    return Err(wrong(&format!("to.{}", set.name), message.to_owned()));
                }
                for &end in &chosen {
                    if let Some(taken) = taken.get_mut(lattice.cell(end)) {
                        *taken = true;
                    }
                    way.clear();
                    let mut at = end;
                    while known[lattice.cell(at)] == u32::MAX {
                        let Some((to, weight)) = plan.predecessor(at) else { break };
                        way.push((at, weight));
                        at = to;
                    }
                    let cell = lattice.cell(at);
                    if known[cell] == u32::MAX {
                        // A generator, where exactly it is meant.
                        let position = exact.get(&at).copied().unwrap_or_else(|| lattice.position(at));
                        known[cell] = skeleton.nodes.len() as u32;
                        skeleton
                            .nodes
                            .push(SkeletonNode { level, ..SkeletonNode::new(position, None, 0.0, set.class) });
                    }
                    let mut parent = known[cell];
                    for &(node, weight) in way.iter().rev() {
                        let cost = skeleton.nodes[parent as usize].cost + range.real(u64::from(weight));
                        let position = lattice.position(node);
                        let made = SkeletonNode::new(position, Some(parent), cost, set.class);
                        parent = skeleton.nodes.len() as u32;
                        known[lattice.cell(node)] = parent;
                        skeleton.nodes.push(SkeletonNode { level, ..made });
                        fresh.push(node);
                    }
                    let name = skeleton.paths.len() as u64;
                    skeleton.paths.push(Path { end: parent, class: set.class, name, ..Path::default() });
                }
            }
            progress.report("grow", (iteration + 1) as f64 / distances.len() as f64)?;
            if iteration + 1 < distances.len() {
                structure.extend(&fresh);
                plan.extend(&structure, progress).map_err(|error| self.plan_error(error))?;
            }
        }
        Ok((skeleton, settled))
    }
}

/// `count` of the nodes in `room` at random, no two nearer than `apart`, in random order; as many as there are.
fn choose<const N: usize>(
    lattice: &Lattice<N>,
    room: &[Node],
    count: usize,
    apart: f64,
    fits: &dyn Fn(Node) -> bool,
    stream: &Stream,
) -> Vec<Node> {
    let origin = lattice.window().origin;
    let name = |node: Node| {
        let at = lattice.coordinates(node);
        let key = |axis: usize| u64::from(at[axis].wrapping_add_signed(origin[axis]));
        mix(stream.key() ^ mix(key(0) | key(1) << 32) ^ mix(!key(2)))
    };
    let order: Vec<(u64, Node)> = room.iter().map(|&node| (name(node), node)).collect();
    let mut crowd = Crowd::new(apart);
    in_random_order(order, count, |node| {
        let is_taken = fits(node) && crowd.has_room(lattice.position(node));
        if is_taken {
            crowd.add(lattice.position(node));
        }
        is_taken
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Weights, Window};

    #[test]
    fn distances_and_counts_are_the_pseudocodes() {
        let spec = FractalSpec {
            distance: 100.0,
            attenuation: 2.0,
            branching: 3.0,
            place: Vicinity::Within,
            iterations: None,
            least: None,
        };
        assert_eq!(spec.distances(1.0), [100.0, 50.0, 25.0, 12.5, 6.25, 3.125]);
        assert_eq!(FractalSpec { iterations: Some(3), ..spec }.distances(1.0), [100.0, 50.0, 25.0]);
        assert_eq!((spec.count(5.0, 0), spec.count(5.0, 2)), (5.0, 45.0));
    }

    /// In the open, what edges hand on is the distance itself.
    #[test]
    fn the_field_knows_what_is_near() {
        let window = Window { spacing: 1.0, origin: [0; 3], size: [40, 30, 1] };
        let lattice: Lattice<8> = Lattice::plain(window, &Stream::new(1, "near"), Weights::default()).unwrap();
        let mut near = Nearness::new(lattice.cells());
        let mut grown = Vec::new();
        for (round, at) in [[3, 4, 0], [30, 20, 0], [18, 9, 0]].into_iter().enumerate() {
            grown.push(lattice.node(at));
            near.grow(&lattice, &grown[round..], 400);
            for node in lattice.nodes() {
                let d = |g: &Node| (lattice.position(*g) - lattice.position(node)).length_squared();
                let nearest = grown.iter().map(d).fold(f64::INFINITY, f64::min);
                let found = f64::from(near.squared[lattice.cell(node)]);
                assert!(found == nearest || (nearest > 400.0 && found > 400.0), "{node:?} {found} {nearest}");
            }
        }
    }
}
