//! A lattice as a site: places become its nodes, paths are planned on it.

use rand::RngExt;
use rustc_hash::FxHashSet;

use super::LatticeSpace;
use crate::geom::{Mark, Shape};
use crate::graph::{Graph, Lattice, LatticeError, Node};
use crate::grow::construction::{Construction, cost_contours, drawn_shapes, middle};
use crate::grow::crowd::Crowd;
use crate::grow::endpoints::RandomPlaces;
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::near::{MOST_REJECTIONS, Near};
use crate::grow::site::{PathSite, PathTree, Site};
use crate::grow::step::{Context, Step};
use crate::math::{DVec3, Progress, Stream};
use crate::plan::{Goal, Plan, PlanError, mean_cost, plan, plan_delayed};
use crate::skeleton::Skeleton;

/// A lattice in its space.
pub(in crate::grow) struct OnLattice<'a> {
    pub lattice: Lattice,
    pub space: &'a LatticeSpace,
}

/// Marks of a step whose `skeleton` grew on the lattice by more than one plan: contours are of those steps that have one.
///
/// # Errors
/// [`GrowError::Step`] where there are too many, or none of a kind.
pub(in crate::grow) fn drawn_growth(
    step: &Step,
    site: &OnLattice<'_>,
    skeleton: &Skeleton,
    context: &Context<'_>,
) -> Result<Vec<Mark>, GrowError> {
    let ends = skeleton.paths.iter().map(|path| skeleton.nodes[path.end as usize].position).collect();
    site.drawn(step, ends, &|| Some(Vec::new()), context).map_err(|problem| step.error(Key::Nodes, problem))
}

/// The lattice of `space`.
pub(in crate::grow) fn on_lattice<'a>(
    step: &Step,
    space: &'a LatticeSpace,
    context: &Context<'_>,
) -> Result<Box<dyn PathSite + 'a>, GrowError> {
    Ok(Box::new(OnLattice::new(step, space, context)?))
}

/// What is told of a lattice that cannot be made.
fn lattice_error(step: &Step, error: LatticeError) -> GrowError {
    let key = if matches!(error, LatticeError::Weights(_)) { Key::Weights } else { Key::Nodes };
    step.error(key, Problem::Lattice(error))
}

impl<'a> OnLattice<'a> {
    /// The lattice of `space`.
    pub fn new(step: &Step, space: &'a LatticeSpace, context: &Context<'_>) -> Result<Self, GrowError> {
        let lattice = space.lattice(context.seed).map_err(|error| lattice_error(step, error))?;
        Ok(Self { lattice, space })
    }

    /// Draws places until there are enough that fit: on nodes of their own, apart from each other (2007, section 3).
    fn reject(
        &self,
        count: u32,
        apart: f64,
        mut stream: Stream,
        fits: &dyn Fn(DVec3) -> bool,
        draw: &dyn Fn(&mut Stream) -> DVec3,
    ) -> Result<Vec<Node>, Problem> {
        let mut placed = Crowd::new(apart);
        let mut taken: FxHashSet<Node> = FxHashSet::default();
        let mut nodes = Vec::new();
        let mut rejections = 0;
        while nodes.len() < count as usize {
            let p = draw(&mut stream);
            let node = if fits(p) { self.lattice.nearest(p) } else { None };
            let Some(node) = node.filter(|node| !taken.contains(node) && placed.has_room(p)) else {
                rejections += 1;
                if rejections == MOST_REJECTIONS {
                    return Err(Problem::NoRoom { placed: nodes.len(), count, apart });
                }
                continue;
            };
            rejections = 0;
            taken.insert(node);
            placed.add(p);
            nodes.push(node);
        }
        Ok(nodes)
    }

    /// Marks of a step that grew to `ends`, as construction drawings show it.
    ///
    /// # Errors
    /// Those of [`Construction::marks`].
    pub fn drawn(
        &self,
        step: &Step,
        ends: Vec<DVec3>,
        contours: &dyn Fn() -> Option<Vec<Vec<DVec3>>>,
        context: &Context<'_>,
    ) -> Result<Vec<Mark>, Problem> {
        let shapes = drawn_shapes(step, &[]);
        let is_plane = self.lattice.is_plane();
        let graph = &self.lattice;
        Construction { graph, shapes, ends, is_plane, contours, sectors: Vec::new() }.marks(context.show)
    }
}

impl Site for OnLattice<'_> {
    fn position(&self, node: Node) -> DVec3 {
        self.lattice.position(node)
    }

    fn size(&self) -> [u64; 2] {
        [self.lattice.open_nodes(), self.lattice.count_edges()]
    }

    fn within(&self, points: &[DVec3]) -> Vec<Option<Node>> {
        points.iter().map(|&p| self.lattice.nearest_within(p)).collect()
    }

    fn carried(&self, points: &[DVec3]) -> Vec<Option<Node>> {
        points.iter().map(|&p| self.lattice.nearest(p)).collect()
    }

    fn inside(&self, shape: &Shape) -> Vec<Node> {
        self.lattice.nodes().filter(|&node| shape.contains(self.lattice.position(node))).collect()
    }

    /// Sets of endpoints may share nodes here.
    fn take(&mut self, _node: Node) {}

    fn choose(&mut self, random: &RandomPlaces, seed: u64) -> Result<Vec<Node>, Problem> {
        let inside = random.inside.as_ref().unwrap_or(&self.space.shape);
        let bounds = inside.bounds();
        let is_plane = self.lattice.is_plane();
        let draw = |stream: &mut Stream| {
            let [u, v, w]: [f64; 3] = std::array::from_fn(|_| stream.random());
            let p = bounds.min + bounds.size() * DVec3::new(u, v, w);
            if is_plane { p.with_z(0.0) } else { p }
        };
        let fits = |p: DVec3| random.holds(inside, p);
        let stream = Stream::new(seed, &format!("endpoints/{}", random.stream));
        self.reject(random.count.at(0) as u32, random.apart, stream, &fits, &draw)
    }

    fn choose_near(&mut self, near: &Near, context: &Context<'_>) -> Result<Vec<Node>, Problem> {
        let draw = near.draw(context.grown, self.lattice.is_plane())?;
        let fits = |p: DVec3| near.inside.contains(p);
        let stream = Stream::new(context.seed, &format!("endpoints/{}", near.stream));
        self.reject(near.count, near.apart, stream, &fits, &draw)
    }
}

impl PathSite for OnLattice<'_> {
    fn cost_over_length(&self, _first: Node, _progress: &Progress) -> Result<[f64; 2], GrowError> {
        // Weights that a lattice was made of are in range.
        let mean = mean_cost(self.space.neighbours, self.space.weights).unwrap_or(0.0);
        let unit = f64::from(1_u32 << self.lattice.weight_range().fraction);
        Ok([mean, self.space.window.spacing / unit])
    }

    fn plan<'s>(
        &'s self,
        generators: &[(Node, u64)],
        ends: Option<&[Node]>,
        progress: &Progress,
    ) -> Result<Box<dyn PathTree + 's>, PlanError> {
        let goal = ends.map_or(Goal::Everything, Goal::Nodes);
        let plan = if generators.iter().all(|&(_, cost)| cost == 0) {
            let nodes: Vec<Node> = generators.iter().map(|&(node, _)| node).collect();
            plan(&self.lattice, &nodes, goal, progress)?
        } else {
            plan_delayed(&self.lattice, &[], generators, goal, progress)?
        };
        Ok(Box::new(plan))
    }

    fn marks(
        &self,
        step: &Step,
        tree: &dyn PathTree,
        ends: &[Node],
        context: &Context<'_>,
    ) -> Result<Vec<Mark>, Problem> {
        let ends = ends.iter().map(|&node| self.lattice.position(node)).collect();
        self.drawn(step, ends, &|| tree.contours(middle(step)), context)
    }
}

impl PathTree for Plan<'_, Lattice> {
    fn settled(&self) -> u64 {
        Plan::settled(self) as u64
    }

    fn is_reached(&self, node: Node) -> bool {
        Plan::is_reached(self, node)
    }

    fn path(&self, node: Node) -> Vec<(Node, f64)> {
        let range = self.graph().weight_range();
        let steps = std::iter::successors(Some((node, 0)), |&(at, _)| self.predecessor(at));
        let steps: Vec<(Node, u32)> = steps.collect();
        let mut left: u64 = steps.iter().map(|&(_, weight)| u64::from(weight)).sum();
        let cost = |(node, weight): (Node, u32)| {
            left -= u64::from(weight);
            (node, range.real(left))
        };
        steps.into_iter().map(cost).collect()
    }

    fn contours(&self, through: DVec3) -> Option<Vec<Vec<DVec3>>> {
        Some(cost_contours(self, through))
    }
}
