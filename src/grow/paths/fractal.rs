//! Fractal placement: new endpoints again and again in the vicinity of all that has grown (Xu and Mould 2007, section 3.2,
//! Fig. 6).

use std::collections::VecDeque;

use rustc_hash::FxHashMap;

use super::fractal_spec::{FractalSpec, Vicinity};
use super::refine::refined;
use crate::graph::{Graph, Lattice, Node};
use crate::grow::choice::in_random_order;
use crate::grow::crowd::Crowd;
use crate::grow::endpoints::{Endpoints, Placement};
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::Grown;
use crate::grow::lookup::Lookup;
use crate::grow::rules::{MOST_DENSE, Needs, Rules};
use crate::grow::site::Site;
use crate::grow::spaces::{OnLattice, drawn_growth};
use crate::grow::spec::StepSpec;
use crate::grow::starts::{Placed, starts};
use crate::grow::step::{Context, Generators, Method, Step};
use crate::math::{DVec3, Stream, mix, power};
use crate::plan::{Goal, Plan, plan_delayed};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// What goes with fractal placement.
pub(in crate::grow) const FRACTAL: Rules = Rules {
    subject: "fractal placement has",
    needs: Needs::Lattice,
    repeats: false,
    most_nodes: MOST_DENSE,
    ..Rules::PATHS
};

impl FractalSpec {
    /// This, with what is wrong about the endpoints of `step` noted.
    pub(in crate::grow) fn resolve(&self, step: &StepSpec, lookup: &mut dyn Lookup) -> Self {
        for (key, set) in &step.to {
            if set.count.is_none() || set.near.is_some() || set.shell.is_some() {
                let message = "fractal placement places endpoints itself: it needs `count`, and no `near` or `shell`";
                lookup.wrong(&format!("to.{key}"), message.to_owned());
            }
        }
        *self
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
    fn grow(&mut self, lattice: &Lattice, grown: &[Node], most: u32) {
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

impl Method for FractalSpec {
    fn name(&self) -> &'static str {
        "fractal"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let space = step.lattice()?;
        let mut site = OnLattice::new(step, space, context)?;
        let starts = starts(step, &mut site, context)?;
        let mut growth = FractalGrowth::new(self, step, &site.lattice, &starts)?;
        let settled = growth.iterate(&starts, context)?;
        let mut marks = drawn_growth(step, &site, &growth.skeleton, context)?;
        let skeleton = refined(step, growth.skeleton, &mut marks, space, context)?;
        let [nodes, edges] = site.size();
        step.finish_with(Grown { nodes, edges, settled, marks, ..Grown::default() }, skeleton, context)
    }

    fn check_places(&self, step: &Step, context: &Context<'_>) -> Result<(), GrowError> {
        let mut site = OnLattice::new(step, step.lattice()?, context)?;
        let starts = match &step.source {
            Generators::Steps(..) => Vec::new(),
            _ => starts(step, &mut site, context)?,
        };
        FractalGrowth::new(self, step, &site.lattice, &starts).map(|_| ())
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        // The nearest node, how far it is, the list of those that have one, and the skeleton's node.
        step.lattice().map_or(0, |space| space.bytes_with_paths(step.count_paths(), 16))
    }
}

/// Fractal placement on its way; iterations are levels of the skeleton.
struct FractalGrowth<'a> {
    fractal: &'a FractalSpec,
    step: &'a Step,
    lattice: &'a Lattice,
    distances: Vec<f64>,
    near: Nearness,
    /// The skeleton's node at each cell, or none.
    known: Vec<u32>,
    exact: FxHashMap<Node, DVec3>,
    skeleton: Skeleton,
    /// What has grown since distances were measured.
    fresh: Vec<Node>,
}

impl<'a> FractalGrowth<'a> {
    fn new(
        fractal: &'a FractalSpec,
        step: &'a Step,
        lattice: &'a Lattice,
        starts: &[Placed],
    ) -> Result<Self, GrowError> {
        let spacing = lattice.window().spacing;
        let distances = fractal.distances(spacing);
        if distances.is_empty() {
            let problem = Problem::NoIteration(fractal.least.unwrap_or(2.0 * spacing));
            return Err(step.error(Key::MethodKey("distance", None), problem));
        }
        let nodes = lattice.open_nodes() as f64;
        let mut count = 0.0;
        for i in 0..distances.len() {
            let counts = step.endpoints.iter().map(|set| fractal.count(set.placement.count() as f64, i));
            count += counts.sum::<f64>();
            if count > nodes {
                return Err(step.error(Key::Method, Problem::TooManyIterations { iteration: i + 1, count, nodes }));
            }
        }
        Ok(Self {
            fractal,
            step,
            lattice,
            distances,
            near: Nearness::new(lattice.cells()),
            known: vec![u32::MAX; lattice.cells()],
            exact: starts.iter().filter_map(|&(node, at)| Some((node, at?))).collect(),
            skeleton: Skeleton::new(step.classes.clone()),
            fresh: starts.iter().map(|&(node, _)| node).collect(),
        })
    }

    /// Grows all iterations; how many nodes were settled at first.
    fn iterate(&mut self, starts: &[Placed], context: &Context<'_>) -> Result<u64, GrowError> {
        let progress = context.progress;
        let mut structure: Vec<Node> = starts.iter().map(|&(node, _)| node).collect();
        let mut plan = plan_delayed(self.lattice, &structure, &[], Goal::Everything, progress)
            .map_err(|error| self.step.plan_error(error))?;
        let settled = plan.settled() as u64;
        for iteration in 0..self.distances.len() {
            let room = self.room(self.distances[iteration]);
            self.fresh.clear();
            let mut taken = vec![false; if self.step.endpoints.len() > 1 { self.lattice.cells() } else { 0 }];
            let step = self.step;
            for set in &step.endpoints {
                let chosen = self.choose(set, iteration, &room, &taken, context.seed);
                if chosen.is_empty() && iteration == 0 {
                    return Err(step.error(Key::Set(set.name.clone()), Problem::NoNodeAtDistance));
                }
                for &end in &chosen {
                    if let Some(taken) = taken.get_mut(self.lattice.cell(end)) {
                        *taken = true;
                    }
                    self.add(&plan, end, set.class, iteration as u16);
                }
            }
            progress.report("grow", (iteration + 1) as f64 / self.distances.len() as f64)?;
            if iteration + 1 < self.distances.len() {
                structure.extend(&self.fresh);
                plan.extend(&structure, progress).map_err(|error| step.plan_error(error))?;
            }
        }
        Ok(settled)
    }

    /// The nodes at, or within, `distance` from all that has grown.
    fn room(&mut self, distance: f64) -> Vec<Node> {
        let steps = distance / self.lattice.window().spacing;
        let is_at = self.fractal.place == Vicinity::At;
        let reach = if is_at { steps + 0.5 } else { steps };
        let most = (reach * reach).min(f64::from(u32::MAX - 1));
        self.near.grow(self.lattice, &self.fresh, most as u32);
        let least = if is_at { ((steps - 0.5) * (steps - 0.5)).max(1.0) } else { 1.0 };
        let fits = |node: &Node| (least..=most).contains(&f64::from(self.near.squared[self.lattice.cell(*node)]));
        self.near.met.iter().copied().filter(fits).collect()
    }

    /// The endpoints of `set` in an iteration.
    fn choose(&self, set: &Endpoints, iteration: usize, room: &[Node], taken: &[bool], seed: u64) -> Vec<Node> {
        let Placement::Random(random) = &set.placement else { return Vec::new() };
        let lattice = self.lattice;
        let count = self.fractal.count(random.count.at(0), iteration) as usize;
        let stream = Stream::new(seed, &format!("endpoints/{}/{iteration}", random.stream));
        let apart = random.apart / power(self.fractal.attenuation, iteration as f64);
        let fits = |node: Node| {
            random.inside.as_ref().is_none_or(|shape| shape.contains(lattice.position(node)))
                && taken.get(lattice.cell(node)).is_none_or(|taken| !taken)
        };
        choose(lattice, room, count, apart, &fits, &stream)
    }

    /// Adds the path to `end`, up to where it meets what has grown.
    fn add(&mut self, plan: &Plan<'_, Lattice>, end: Node, class: u16, level: u16) {
        let lattice = self.lattice;
        let mut path: Vec<(Node, u32)> = Vec::new();
        let mut at = end;
        while self.known[lattice.cell(at)] == u32::MAX {
            let Some((to, weight)) = plan.predecessor(at) else { break };
            path.push((at, weight));
            at = to;
        }
        let skeleton = &mut self.skeleton;
        let cell = lattice.cell(at);
        if self.known[cell] == u32::MAX {
            // A generator, where exactly it is meant.
            let position = self.exact.get(&at).copied().unwrap_or_else(|| lattice.position(at));
            self.known[cell] = skeleton.nodes.len() as u32;
            skeleton.nodes.push(SkeletonNode { level, ..SkeletonNode::new(position, None, 0.0, class) });
        }
        let mut parent = self.known[cell];
        for &(node, weight) in path.iter().rev() {
            let cost = skeleton.nodes[parent as usize].cost + lattice.weight_range().real(u64::from(weight));
            let made = SkeletonNode::new(lattice.position(node), Some(parent), cost, class);
            parent = skeleton.nodes.len() as u32;
            self.known[lattice.cell(node)] = parent;
            skeleton.nodes.push(SkeletonNode { level, ..made });
            self.fresh.push(node);
        }
        let name = skeleton.paths.len() as u64;
        skeleton.paths.push(Path { end: parent, class, name, ..Path::default() });
    }
}

/// `count` of the nodes in `room` at random, no two nearer than `apart`, in random order; as many as there are.
fn choose(
    lattice: &Lattice,
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
    use crate::geom::Neighbours;
    use crate::graph::Window;
    use crate::math::Weights;

    /// In the open, what edges hand on is the distance itself.
    #[test]
    fn the_field_knows_what_is_near() {
        let window = Window { spacing: 1.0, origin: [0; 3], size: [40, 30, 1] };
        let lattice = Lattice::plain(window, Neighbours::EIGHT, &Stream::new(1, "near"), Weights::default()).unwrap();
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
