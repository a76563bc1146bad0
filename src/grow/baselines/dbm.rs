//! The dielectric breakdown model, the baseline that the papers compare their lightning with (Niemeyer, Pietronero and
//! Wiesmann 1984; for pictures Kim and Lin 2004).

use std::collections::{HashMap, HashSet};

use rand::RngExt;

use super::laplace::Laplace;
use super::spec::{DbmSpec, SIDE, Solver};
use crate::graph::{Graph, Lattice, Node};
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::Grown;
use crate::grow::lookup::Lookup;
use crate::grow::paths::refined;
use crate::grow::site::Site;
use crate::grow::spaces::{OnLattice, drawn_growth};
use crate::grow::spec::StepSpec;
use crate::grow::starts::starts;
use crate::grow::step::{Context, Method, Step, Unreached};
use crate::grow::targets::targets;
use crate::grow::trial::try_places;
use crate::math::{Cancelled, DVec3, Progress, Stream, power};
use crate::skeleton::Skeleton;

/// A neighbour of what has grown.
struct Candidate {
    node: Node,
    parent: u32,
    potential: f64,
}

impl Method for DbmSpec {
    fn name(&self) -> &'static str {
        "dbm"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let space = step.lattice()?;
        let mut site = OnLattice::new(step, space, context)?;
        let generators: Vec<Node> = starts(step, &mut site, context)?.into_iter().map(|(node, _)| node).collect();
        let (targets, _) = targets(step, &mut site, context)?;
        let ends: Vec<(Node, u16)> = targets.iter().map(|target| (target.node, target.set.class)).collect();
        let random = Stream::new(context.seed, &format!("dbm/{}", step.name));
        let classes = step.classes.clone();
        let (skeleton, settled) =
            self.grow_cluster(&site.lattice, &generators, &ends, classes, random, context.progress)?;
        let has_end = skeleton.paths.first().is_some_and(|path| step.classes[path.class as usize] != SIDE);
        if !has_end && self.solver == Solver::Grid && step.unreached == Unreached::Error {
            return Err(step.error(Key::Method, Problem::NoTouch(self.nodes)));
        }
        let mut marks = drawn_growth(step, &site, &skeleton, context)?;
        let skeleton = refined(step, skeleton, &mut marks, space, context)?;
        let [nodes, edges] = site.size();
        step.finish_with(Grown { nodes, edges, settled, marks, ..Grown::default() }, skeleton, context)
    }

    fn check_places(&self, step: &Step, context: &Context<'_>) -> Result<(), GrowError> {
        try_places(step, &mut OnLattice::new(step, step.lattice()?, context)?, context)
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        step.lattice().map_or(0, |space| space.bytes_with_paths(step.count_paths(), 0))
    }
}

impl DbmSpec {
    /// This, with what is wrong about the endpoints of `step` noted.
    pub(in crate::grow) fn resolve(&self, step: &StepSpec, lookup: &mut dyn Lookup) -> Self {
        for (key, _) in step.to.iter().filter(|(_, set)| set.through.is_some()) {
            let message = "an aggregate grows to places, not through others: list them with `at`".to_owned();
            lookup.wrong(&format!("to.{key}.through"), message);
        }
        *self
    }

    /// Grows from `generators` until an end is touched: the skeleton, with the path to that end first, and how many
    /// nodes grew. Every tip ends a path, those in the open of class [`SIDE`].
    fn grow_cluster(
        &self,
        lattice: &Lattice,
        generators: &[Node],
        ends: &[(Node, u16)],
        classes: Vec<String>,
        mut random: Stream,
        progress: &Progress,
    ) -> Result<(Skeleton, u64), Cancelled> {
        let ends: HashMap<Node, u16> = ends.iter().copied().collect();
        let mut field = match self.solver {
            Solver::Grid => Some(Laplace::new(lattice, generators, ends.keys().copied())),
            Solver::Charges => None,
        };
        let spacing = lattice.window().spacing;
        let mut grown: Vec<(Node, Option<u32>)> = Vec::new();
        let mut known: HashMap<Node, u32> = HashMap::new();
        let mut candidates: Vec<Candidate> = Vec::new();
        let mut waiting: HashSet<Node> = HashSet::new();
        let mut fresh: Vec<(Node, Option<u32>)> = generators.iter().map(|&node| (node, None)).collect();
        let mut reached = None;
        while reached.is_none() && grown.len() < self.nodes as usize {
            if let Some(field) = &mut field {
                field.ground(&fresh.iter().map(|(node, _)| lattice.cell(*node)).collect::<Vec<_>>());
            }
            for (node, parent) in fresh.drain(..) {
                let at = grown.len() as u32;
                known.insert(node, at);
                grown.push((node, parent));
                if ends.contains_key(&node) {
                    reached = Some(at);
                }
                if waiting.remove(&node) {
                    candidates.retain(|c| c.node != node);
                }
                if self.solver == Solver::Charges {
                    let from = lattice.position(node);
                    candidates.iter_mut().for_each(|c| c.potential += charge(lattice.position(c.node), from, spacing));
                }
                lattice.edges(node, |edge| {
                    if !known.contains_key(&edge.node) && waiting.insert(edge.node) {
                        candidates.push(Candidate { node: edge.node, parent: at, potential: 0.0 });
                        if self.solver == Solver::Charges {
                            let place = lattice.position(edge.node);
                            let sum = grown.iter().map(|(n, _)| charge(place, lattice.position(*n), spacing)).sum();
                            candidates.last_mut().into_iter().for_each(|c| c.potential = sum);
                        }
                    }
                });
            }
            if reached.is_some() || candidates.is_empty() {
                break;
            }
            if let Some(field) = &field {
                candidates.iter_mut().for_each(|c| c.potential = field.potential(lattice.cell(c.node)));
            }
            let chosen = candidates.swap_remove(self.choose(&candidates, random.random()));
            fresh.push((chosen.node, Some(chosen.parent)));
            if grown.len().is_multiple_of(16) {
                progress.report("grow", grown.len() as f64 / f64::from(self.nodes))?;
            }
        }
        Ok((self.skeleton(lattice, &grown, reached, &ends, classes), grown.len() as u64))
    }

    /// The candidate that `u`, from 0 to 1, falls on.
    fn choose(&self, candidates: &[Candidate], u: f64) -> usize {
        let low = candidates.iter().map(|c| c.potential).fold(f64::INFINITY, f64::min);
        let high = candidates.iter().map(|c| c.potential).fold(f64::NEG_INFINITY, f64::max);
        let low = if self.solver == Solver::Charges { low } else { 0.0 };
        let weight = |c: &Candidate| {
            let share = if high > low { ((c.potential - low) / (high - low)).max(0.0) } else { 1.0 };
            power(share, self.eta)
        };
        let weights: Vec<f64> = candidates.iter().map(weight).collect();
        let mut left = u * weights.iter().sum::<f64>();
        for (i, weight) in weights.iter().enumerate() {
            left -= weight;
            if left < 0.0 {
                return i;
            }
        }
        candidates.len() - 1
    }

    fn skeleton(
        &self,
        lattice: &Lattice,
        grown: &[(Node, Option<u32>)],
        reached: Option<u32>,
        ends: &HashMap<Node, u16>,
        classes: Vec<String>,
    ) -> Skeleton {
        let side = classes.iter().position(|class| class == SIDE).unwrap_or(0) as u16;
        let mut skeleton = Skeleton::new(classes);
        let mut costs: Vec<f64> = Vec::with_capacity(grown.len());
        let mut is_tip = vec![true; grown.len()];
        for (node, parent) in grown {
            costs.push(parent.map_or(0.0, |p| {
                is_tip[p as usize] = false;
                let step = lattice.position(*node) - lattice.position(grown[p as usize].0);
                costs[p as usize] + step.length() / lattice.window().spacing
            }));
        }
        let tips = (0..grown.len() as u32).filter(|&i| is_tip[i as usize] && Some(i) != reached);
        let mut known = HashMap::new();
        for tip in reached.into_iter().chain(tips) {
            let class = ends.get(&grown[tip as usize].0).copied().unwrap_or(side);
            let way = std::iter::successors(Some(tip), |&i| grown[i as usize].1);
            let place = |i: u32| -> (u32, DVec3, f64) { (i, lattice.position(grown[i as usize].0), costs[i as usize]) };
            skeleton.add_path(&mut known, class, way.map(place));
        }
        skeleton
    }
}

/// What a charge at `from` adds to the potential at `at` (Kim et al. 2007, eq. 11): spheres as wide as a step.
fn charge(at: DVec3, from: DVec3, spacing: f64) -> f64 {
    1.0 - 0.5 * spacing / (at - from).length()
}
