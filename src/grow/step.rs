//! One growth step: a space is planned, and the paths to its endpoints become a skeleton.

use std::collections::HashMap;

use rustc_hash::FxHashMap;

use super::automaton::grow_together;
use super::construction::{Mark, MarkKind, construction};
use super::{
    Automaton, Dbm, DlaSpec, Endpoints, FractalSpec, LatticeSpace, Near, Placement, Refine, Regions, RegionsSpec,
    Repeat, SIDE, Segments, Solver, Space, Unreached, VoxelSpace,
};
use crate::geom::Shape;
use crate::graph::{Graph, Lattice, LatticeError, Node};
use crate::math::{Cancelled, DVec3, Progress, Stream};
use crate::plan::{Goal, Plan, PlanError, mean_cost, plan, plan_delayed};
use crate::skeleton::{Form, Skeleton, SymmetrySpec, Width};

/// A step whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its name in the scene.
    pub name: String,
    /// The space to grow in; segments have none.
    pub space: Option<Space>,
    /// The name of that space, for errors.
    pub space_name: String,
    /// Where paths start.
    pub source: Source,
    /// Where they go.
    pub endpoints: Vec<Endpoints>,
    /// Names of the endpoints' classes.
    pub classes: Vec<String>,
    /// How limbs come about.
    pub method: Method,
    /// How it is repeated, around every end.
    pub repeat: Option<Repeat>,
    /// Radii.
    pub width: Width,
    /// Natural limbs.
    pub form: Option<Form>,
    /// Of how many pieces a strand is, where every path is one.
    pub strands: Option<u32>,
    /// How often what grew stands around an axis.
    pub symmetry: Option<SymmetrySpec>,
    /// What it costs to go along the step that this one grows from, over what it costs elsewhere.
    pub along: f64,
    /// How paths are planned again.
    pub refine: Option<Refine>,
    /// Lattice steps to average over.
    pub smooth: f64,
    /// What to do about unreached endpoints.
    pub unreached: Unreached,
}

/// The generators of a step.
#[derive(Clone, Debug)]
pub enum Source {
    /// The nodes nearest to these points.
    At(Vec<DVec3>),
    /// All nodes in a shape.
    Inside(Shape),
    /// Nodes at random.
    Spread(Placement),
    /// What the steps with these indices have grown.
    Steps(Vec<usize>, Part),
}

/// Which part of a step others grow from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    All,
    /// The ends of its paths, but for those that grew on.
    Ends,
    /// The ends of all its paths, of every round.
    EveryEnd,
}

/// How limbs come about.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// By least-cost paths.
    Paths,
    /// By least-cost paths to endpoints near all that has grown.
    Fractal(FractalSpec),
    /// As solids.
    Regions(RegionsSpec),
    /// By diffusion-limited aggregation.
    Dla(DlaSpec),
    /// By segments, without a graph.
    Segments(Segments),
    /// By a voxel space automaton.
    Voxels(Automaton),
    /// By the dielectric breakdown model.
    Dbm(Dbm),
}

/// An endpoint on its way: its node, where exactly it is meant, and its set.
type Wanted<'a> = (Node, Option<DVec3>, &'a Endpoints);

/// What a step yields.
#[derive(Clone, Debug, Default)]
pub struct Grown {
    /// The step's name.
    pub name: String,
    /// The union of its paths, with radii.
    pub skeleton: Skeleton,
    /// Where the plant starts that it belongs to, if it is a part of one.
    pub foot: Option<DVec3>,
    /// The level of its first round, counted through all steps before.
    pub first_level: u16,
    /// Nodes of the graph, or voxels that something is in.
    pub nodes: u64,
    /// Edges of the graph, each counted once.
    pub edges: u64,
    /// Nodes whose cost was settled.
    pub settled: u64,
    /// Endpoints that no path reached and that were dropped.
    pub dropped: usize,
    /// What construction drawings show, where asked for.
    pub marks: Vec<Mark>,
    /// What it grew in place of limbs.
    pub regions: Option<Regions>,
}

/// Why a step did not grow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GrowError {
    /// Something in the scene makes it impossible.
    #[error("{message}")]
    Scene {
        /// Where in the scene: a dotted path of keys.
        place: String,
        /// What is wrong and what would be right.
        message: String,
    },
    /// Stopped by its [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// More nodes of a skeleton than this are not made of fewer.
pub const MOST_NODES: u64 = 40_000_000;
/// Bytes that a node of a skeleton takes, with what is made of it.
pub(super) const NODE_BYTES: u64 = 256;

impl Step {
    /// Bytes that growing it takes at its peak.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        let paths: u64 = self.endpoints.iter().map(|set| set.placement.count() as u64).sum();
        match &self.space {
            None => match &self.method {
                Method::Segments(segments) => segments.bytes_needed(segments.starts) * u64::from(self.parts()),
                _ => 0,
            },
            Some(Space::Voxels(space)) => {
                let nodes = if let Method::Voxels(voxels) = &self.method { u64::from(voxels.nodes) } else { 0 };
                space.bytes_needed() + nodes * NODE_BYTES
            }
            Some(Space::Scatter(space)) => {
                // A repeated step keeps sets of nodes, and makes some at a time.
                let graphs = if self.repeat.is_some() { 20 } else { 1 };
                space.bytes_needed().saturating_mul(graphs)
            }
            Some(Space::Lattice(space)) => {
                let across: u64 = space.window.size.iter().map(|&s| u64::from(s)).sum();
                // Paths share most of their nodes; they can never have more than the lattice has.
                let skeleton = paths.saturating_mul(across).min(space.window.nodes()) * NODE_BYTES;
                // What methods keep of each node beside the search.
                let each = match &self.method {
                    Method::Paths | Method::Dbm(_) | Method::Segments(_) | Method::Voxels(_) => 0,
                    // The nearest node and how far it is, and the skeleton's node.
                    Method::Fractal(_) => 12,
                    Method::Dla(_) => 5,
                    // A region and a cost, carried along paths, and those of lattices twice as fine.
                    Method::Regions(regions) => 20_u64 << (space.neighbours.dimensions() * regions.refine),
                };
                let kept = space.window.nodes().saturating_mul(each);
                space.bytes_needed().saturating_add(skeleton).saturating_add(kept)
            }
        }
    }

    /// The same where it is known what has grown before: a step by segments may start from more than was expected.
    #[must_use]
    pub fn bytes_needed_from(&self, grown: &[Option<&Skeleton>]) -> u64 {
        let Method::Segments(segments) = &self.method else { return self.bytes_needed() };
        let before = self.sources().iter().filter_map(|&step| grown[step]);
        let starts: usize = match &self.source {
            Source::Steps(_, Part::All) => before.map(|s| s.nodes.len()).sum(),
            Source::Steps(_, part) => before.map(|s| s.end_paths(*part == Part::EveryEnd).count()).sum(),
            Source::At(points) => points.len(),
            Source::Inside(_) | Source::Spread(_) => 0,
        };
        segments.bytes_needed(starts as f64) * u64::from(self.parts())
    }

    /// How many times it is there, by its symmetry.
    pub(super) fn parts(&self) -> u32 {
        self.symmetry.map_or(1, |symmetry| symmetry.parts())
    }

    /// The steps that must have grown before, by index.
    pub fn after(&self) -> impl Iterator<Item = usize> + '_ {
        let near = |set: &Endpoints| match &set.placement {
            Placement::Near(Near { step, .. }) => Some(*step),
            Placement::At(_) | Placement::Through(_) | Placement::Random { .. } => None,
        };
        self.sources().iter().copied().chain(self.endpoints.iter().filter_map(near)).chain(self.solids())
    }

    /// The steps that this one grows from.
    #[must_use]
    pub fn sources(&self) -> &[usize] {
        if let Source::Steps(steps, _) = &self.source { steps } else { &[] }
    }

    /// Grows the step, which is not repeated, in the scene with this seed. `grown` has what the steps before it have grown, by index; `show`
    /// lists what construction drawings need.
    ///
    /// # Errors
    /// [`GrowError::Scene`] where endpoints cannot be placed or reached, the lattice is empty, or weights are out of
    /// range; [`GrowError::Cancelled`].
    pub fn grow(
        &self,
        seed: u64,
        grown: &[Option<&Skeleton>],
        show: &[MarkKind],
        progress: &Progress,
    ) -> Result<Grown, GrowError> {
        let space = match (&self.space, &self.method) {
            (_, Method::Segments(segments)) => {
                let skeleton = self.grow_segments(segments, seed, grown, progress)?;
                return self.free(skeleton, grown, 0);
            }
            (Some(Space::Scatter(space)), _) => return self.grow_scattered(space, seed, grown, show, progress),
            (Some(Space::Lattice(space)), _) => space,
            (Some(Space::Voxels(space)), _) => {
                let all = Self::grow_together(&[self], space, &[], seed, grown, progress)?;
                return all
                    .into_iter()
                    .next()
                    .ok_or_else(|| self.wrong_space("there only growth by voxels is possible"));
            }
            (None, _) => return Err(self.wrong_space("this way of growing needs a space")),
        };
        match space.neighbours.count() {
            4 => self.grow_in::<4>(space, seed, grown, show, progress),
            8 => self.grow_in::<8>(space, seed, grown, show, progress),
            6 => self.grow_in::<6>(space, seed, grown, show, progress),
            18 => self.grow_in::<18>(space, seed, grown, show, progress),
            _ => self.grow_in::<26>(space, seed, grown, show, progress),
        }
    }

    fn grow_in<const N: usize>(
        &self,
        space: &LatticeSpace,
        seed: u64,
        grown: &[Option<&Skeleton>],
        show: &[MarkKind],
        progress: &Progress,
    ) -> Result<Grown, GrowError> {
        let in_space =
            |key: &str, message: String| GrowError::Scene { place: format!("space.{}{key}", self.space_name), message };
        let lattice: Lattice<N> = space.lattice(seed).map_err(|error| {
            let key = if matches!(error, LatticeError::Weights(_)) { ".weights" } else { ".nodes" };
            in_space(key, error.to_string())
        })?;
        let starts = self.starts(&lattice, space, seed, grown)?;
        let mut wanted: Vec<Wanted<'_>> = Vec::new();
        for set in &self.endpoints {
            let nodes = set.placement.place(&lattice, &space.shape, seed, grown).map_err(|message| {
                GrowError::Scene { place: format!("grow.{}.to.{}", self.name, set.name), message }
            })?;
            wanted.extend(nodes.into_iter().map(|(node, at)| (node, at, set)));
        }
        let nodes: Vec<Node> = wanted.iter().map(|&(node, ..)| node).collect();
        let generators: Vec<Node> = starts.iter().map(|&(node, _)| node).collect();
        let mut regions = None;
        let (skeleton, dropped, settled, marks) = match &self.method {
            Method::Fractal(fractal) => {
                let (skeleton, settled) = self.grow_fractal(fractal, &lattice, &starts, seed, progress)?;
                (skeleton, 0, settled, Vec::new())
            }
            Method::Regions(spec) => {
                let (found, settled) = self.grow_regions(spec, space, &lattice, &generators, seed, progress)?;
                regions = Some(found);
                (Skeleton::new(self.classes.clone()), 0, settled, Vec::new())
            }
            Method::Dla(dla) => {
                let random = Stream::new(seed, &format!("dla/{}", self.name));
                let skeleton = dla.grow(&lattice, &generators, self.classes.clone(), random, progress)?;
                let settled = skeleton.nodes.len() as u64;
                (skeleton, 0, settled, Vec::new())
            }
            Method::Segments(_) | Method::Voxels(_) => {
                return Err(self.wrong_space("this way of growing needs no lattice"));
            }
            Method::Paths => {
                let goal = if show.contains(&MarkKind::Contours) { Goal::Everything } else { Goal::Nodes(&nodes) };
                let later = self.delays(space, &lattice, &starts, grown);
                let plan = if later.is_empty() {
                    plan(&lattice, &generators, goal, progress)
                } else {
                    plan_delayed(&lattice, &[], &later, goal, progress)
                };
                let plan = plan.map_err(|error| self.plan_error(error))?;
                let (skeleton, dropped) = self.paths(&plan, &starts, &wanted)?;
                let marks =
                    construction(self, space, &plan, &nodes, show).map_err(|message| in_space(".nodes", message))?;
                (skeleton, dropped, plan.settled() as u64, marks)
            }
            Method::Dbm(dbm) => {
                let ends: Vec<(Node, u16)> = wanted.iter().map(|&(node, _, set)| (node, set.class)).collect();
                let random = Stream::new(seed, &format!("dbm/{}", self.name));
                let (skeleton, settled) =
                    dbm.grow(&lattice, &generators, &ends, self.classes.clone(), random, progress)?;
                let has_end = skeleton.paths.first().is_some_and(|path| self.classes[path.class as usize] != SIDE);
                if !has_end && dbm.solver == Solver::Grid && self.unreached == Unreached::Error {
                    let message = format!(
                        "growth touches no endpoint within {} nodes: allow more, or set `unreached = \"drop\"`",
                        dbm.nodes
                    );
                    return Err(GrowError::Scene { place: format!("grow.{}.by", self.name), message });
                }
                (skeleton, 0, settled, Vec::new())
            }
        };
        let skeleton = match &self.refine {
            Some(refine) => refine.apply::<N>(skeleton, space, seed, progress).map_err(|error| match error {
                GrowError::Scene { message, .. } => in_space(".weights", message),
                cancelled @ GrowError::Cancelled(_) => cancelled,
            })?,
            None => skeleton,
        };
        Ok(Grown {
            name: self.name.clone(),
            foot: None,
            first_level: self.first_level(grown),
            nodes: lattice.open_nodes(),
            edges: lattice.count_edges(),
            settled,
            marks,
            skeleton: self.finish(skeleton, grown)?,
            dropped,
            regions,
        })
    }

    fn wrong_space(&self, message: &str) -> GrowError {
        GrowError::Scene { place: format!("grow.{}.space", self.name), message: message.to_owned() }
    }

    /// Do both grow in the voxels of one space?
    #[must_use]
    pub fn shares_voxels(&self, other: &Self) -> bool {
        matches!(self.space, Some(Space::Voxels(_))) && self.space_name == other.space_name
    }

    /// Grows `steps`, which are all by voxels in `space`, together, among what `before` grew there.
    ///
    /// # Errors
    /// [`GrowError::Scene`] where a limb starts outside of the space; [`GrowError::Cancelled`].
    pub fn grow_together(
        steps: &[&Self],
        space: &VoxelSpace,
        before: &[(&Self, &Skeleton)],
        seed: u64,
        grown: &[Option<&Skeleton>],
        progress: &Progress,
    ) -> Result<Vec<Grown>, GrowError> {
        let (skeletons, voxels) = grow_together(steps, space, before, seed, grown, progress)?;
        steps.iter().zip(skeletons).map(|(step, skeleton)| step.free(skeleton, grown, voxels)).collect()
    }

    /// What a step yields that no graph carries, in so many voxels.
    fn free(&self, skeleton: Skeleton, grown: &[Option<&Skeleton>], voxels: u64) -> Result<Grown, GrowError> {
        Ok(Grown {
            name: self.name.clone(),
            first_level: self.first_level(grown),
            nodes: voxels,
            settled: skeleton.nodes.len() as u64,
            skeleton: self.finish(skeleton, grown)?,
            ..Grown::default()
        })
    }

    /// What is told of a search that failed.
    pub(super) fn plan_error(&self, error: PlanError) -> GrowError {
        match error {
            PlanError::Cancelled(cancelled) => GrowError::Cancelled(cancelled),
            PlanError::TooWide { .. } => {
                let place = format!("space.{}.weights", self.space_name);
                GrowError::Scene { place, message: error.to_string() }
            }
        }
    }

    /// The generators, and where exactly each is meant where that is told. No node is named twice.
    fn starts<const N: usize>(
        &self,
        lattice: &Lattice<N>,
        space: &LatticeSpace,
        seed: u64,
        grown: &[Option<&Skeleton>],
    ) -> Result<Vec<(Node, Option<DVec3>)>, GrowError> {
        let wrong =
            |message: &str| GrowError::Scene { place: format!("grow.{}.from", self.name), message: message.to_owned() };
        let starts: Vec<(Node, Option<DVec3>)> = match &self.source {
            Source::At(points) => points
                .iter()
                .map(|&p| {
                    let node = lattice.nearest_within(p).ok_or_else(|| {
                        wrong(&format!("the generator at {p} is outside the space or where nodes are forbidden"))
                    })?;
                    Ok((node, Some(p)))
                })
                .collect::<Result<_, GrowError>>()?,
            Source::Inside(shape) => {
                lattice.nodes().filter(|&n| shape.contains(lattice.position(n))).map(|n| (n, None)).collect()
            }
            Source::Spread(placement) => {
                placement.place(lattice, &space.shape, seed, grown).map_err(|message| wrong(&message))?
            }
            Source::Steps(steps, part) => {
                let mut places = Vec::new();
                for &step in steps {
                    places.extend(grown[step].ok_or_else(|| wrong("the step has not grown"))?.places(*part));
                }
                places.into_iter().filter_map(|p| lattice.nearest(p).map(|node| (node, Some(p)))).collect()
            }
        };
        if starts.is_empty() {
            return Err(wrong(match self.source {
                Source::Steps(..) => "nothing of that step lies in the space",
                Source::At(_) | Source::Inside(_) | Source::Spread(_) => "no node of the space lies in this shape",
            }));
        }
        // Nodes of a shape differ.
        if matches!(self.source, Source::Inside(_)) {
            return Ok(starts);
        }
        // Of several places about a node the nearest, then the first.
        let far = |&(node, p): &(Node, Option<DVec3>)| p.map_or(0.0, |p| (p - lattice.position(node)).length_squared());
        let mut best: HashMap<Node, usize> = HashMap::new();
        for (i, start) in starts.iter().enumerate() {
            let kept = best.entry(start.0).or_insert(i);
            if far(start) < far(&starts[*kept]) {
                *kept = i;
            }
        }
        Ok(starts.iter().enumerate().filter(|(i, start)| best[&start.0] == *i).map(|(_, start)| *start).collect())
    }

    /// With what cost each generator starts, where going along the step before costs something.
    fn delays<const N: usize>(
        &self,
        space: &LatticeSpace,
        lattice: &Lattice<N>,
        starts: &[(Node, Option<DVec3>)],
        grown: &[Option<&Skeleton>],
    ) -> Vec<(Node, u64)> {
        let along = self.ways_along(grown);
        if along.is_empty() {
            return Vec::new();
        }
        // Weights that a lattice was made of are in range.
        let mean = mean_cost::<N>(space.weights).unwrap_or(0.0);
        let scale = self.along * mean / space.window.spacing * f64::from(1_u32 << lattice.weight_range().fraction);
        let delay = |p: DVec3| (along.get(&bits(p)).copied().unwrap_or(0.0) * scale) as u64;
        starts.iter().map(|&(node, at)| (node, at.map_or(0, delay))).collect()
    }

    /// How far each place of the steps that this one grows from is along them; nothing where that costs nothing.
    pub(super) fn ways_along(&self, grown: &[Option<&Skeleton>]) -> HashMap<[u64; 3], f64> {
        let mut along: HashMap<[u64; 3], f64> = HashMap::new();
        if self.along <= 0.0 {
            return along;
        }
        for skeleton in self.sources().iter().filter_map(|&step| grown[step]) {
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

    fn paths<const N: usize>(
        &self,
        plan: &Plan<'_, Lattice<N>>,
        starts: &[(Node, Option<DVec3>)],
        wanted: &[Wanted<'_>],
    ) -> Result<(Skeleton, usize), GrowError> {
        let lattice = plan.graph();
        let range = lattice.weight_range();
        let mut skeleton = Skeleton::new(self.classes.clone());
        let mut known: FxHashMap<Node, u32> = FxHashMap::default();
        let mut dropped = 0;
        // What was told exactly is there exactly; the rest is on nodes.
        let exact: FxHashMap<Node, DVec3> = wanted
            .iter()
            .filter_map(|&(node, at, _)| Some((node, at?)))
            .chain(starts.iter().filter_map(|&(node, at)| Some((node, at?))))
            .collect();
        let mut way: Vec<(Node, u32)> = Vec::new();
        for &(end, _, set) in wanted {
            if !plan.is_reached(end) {
                if self.unreached == Unreached::Error {
                    return Err(GrowError::Scene {
                        place: format!("grow.{}.to.{}", self.name, set.name),
                        message: format!(
                            "no path reaches the endpoint at {}: open a way, or set `unreached = \"drop\"`",
                            lattice.position(end)
                        ),
                    });
                }
                dropped += 1;
                continue;
            }
            way.clear();
            let mut next = Some((end, 0));
            while let Some((node, weight)) = next {
                next = plan.predecessor(node);
                way.push((node, weight));
            }
            let mut left: u64 = way.iter().map(|&(_, weight)| u64::from(weight)).sum();
            let path = way.iter().map(|&(node, weight)| {
                left -= u64::from(weight);
                (node, exact.get(&node).copied().unwrap_or_else(|| lattice.position(node)), range.real(left))
            });
            skeleton.add_path(&mut known, set.class, path);
        }
        Ok((skeleton, dropped))
    }
}

impl Skeleton {
    /// Where a part of it is.
    pub(super) fn places(&self, part: Part) -> Vec<DVec3> {
        match part {
            Part::All => self.nodes.iter().map(|n| n.position).collect(),
            Part::Ends | Part::EveryEnd => {
                self.ends(part == Part::EveryEnd).map(|(end, _)| self.nodes[end as usize].position).collect()
            }
        }
    }
}

/// What tells a place from any other.
pub(super) fn bits(p: DVec3) -> [u64; 3] {
    p.to_array().map(f64::to_bits)
}
