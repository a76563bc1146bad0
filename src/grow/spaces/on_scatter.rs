//! Scattered nodes as a site: places become nodes, paths are planned between them.

use super::{ScatterSpace, Scattered};
use crate::geom::{Mark, Shape};
use crate::graph::{EdgeWeights, Joining, Node, Scatter};
use crate::grow::choice::choose;
use crate::grow::construction::{Construction, drawn_shapes, middle};
use crate::grow::endpoints::{Placement, RandomPlaces};
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::near::Near;
use crate::grow::site::{PathSite, PathTree, Site};
use crate::grow::starts::source_places;
use crate::grow::step::{Context, Generators, Step};
use crate::math::{DVec3, Progress, Stream};
use crate::plan::{PlanError, Routes, routes};

/// How long the rays between sectors are drawn, in spacings: beyond nearly every neighbour.
const SECTOR_RAY: f64 = 2.0;

/// Scattered nodes in their space.
pub(in crate::grow) struct OnScatter<'a> {
    space: &'a ScatterSpace,
    scattered: Scattered,
    taken: Vec<bool>,
}

/// Least-cost routes, with what turns their costs into those of the scene.
struct ScaledRoutes<'s> {
    found: Routes,
    weights: &'s EdgeWeights,
    spacing: f64,
}

impl<'a> OnScatter<'a> {
    /// Scatters nodes in `space`, with one at each place that `step` names.
    pub fn new(step: &Step, space: &'a ScatterSpace, context: &Context<'_>) -> Result<Self, GrowError> {
        let mut fixed = match &step.source {
            Generators::At(points) => points.clone(),
            _ => source_places(step, context)?,
        };
        for set in &step.endpoints {
            match &set.placement {
                Placement::At(points) => fixed.extend(points),
                Placement::Through(lists) => fixed.extend(lists.iter().flatten()),
                Placement::Random(_) | Placement::Near(_) => {}
            }
        }
        // What lies outside is refused, or left out, when it is looked up.
        fixed.retain(|&p| is_open(space, p));
        let table = space.table().map_err(|error| step.error(Key::Weights, Problem::Weights(error)))?;
        let scattered = space.scatter(&table, context.seed, &fixed);
        let scattered = scattered.map_err(|error| step.error(Key::Nodes, Problem::Scatter(error)))?;
        let taken = vec![false; scattered.graph.len()];
        Ok(Self { space, scattered, taken })
    }

    fn graph(&self) -> &Scatter {
        &self.scattered.graph
    }
}

/// Does `p` lie within a step of the space, where nodes are allowed?
fn is_open(space: &ScatterSpace, p: DVec3) -> bool {
    let volumes = space.clusters.as_ref().map_or(f64::INFINITY, |c| c.inside.margin(p) - c.radius);
    let margin = space.shape.margin(p).min(volumes);
    margin <= space.spacing && space.forbid.as_ref().is_none_or(|forbid| !forbid.contains(p))
}

impl Site for OnScatter<'_> {
    fn position(&self, node: Node) -> DVec3 {
        self.graph().position(node)
    }

    fn size(&self) -> [u64; 2] {
        [self.graph().len() as u64, self.graph().count_edges()]
    }

    fn within(&self, points: &[DVec3]) -> Vec<Option<Node>> {
        let nodes = self.graph().nearest(points).into_iter().zip(points);
        nodes.map(|(node, &p)| is_open(self.space, p).then_some(node)).collect()
    }

    fn carried(&self, points: &[DVec3]) -> Vec<Option<Node>> {
        self.within(points)
    }

    fn inside(&self, shape: &Shape) -> Vec<Node> {
        let nodes = (0..self.graph().len() as u32).map(Node);
        nodes.filter(|&node| shape.contains(self.graph().position(node))).collect()
    }

    fn take(&mut self, node: Node) {
        self.taken[node.0 as usize] = true;
    }

    fn choose(&mut self, random: &RandomPlaces, seed: u64) -> Result<Vec<Node>, Problem> {
        let (count, apart) = (random.count.at(0) as u32, random.apart);
        let spheres = &self.scattered.spheres;
        let inside = random.inside.as_ref().or(spheres.is_empty().then_some(&self.space.shape));
        let fits = |p: DVec3| match inside {
            Some(inside) => random.holds(inside, p),
            None => spheres.iter().any(|sphere| random.holds(sphere, p)),
        };
        let stream = Stream::new(seed, &format!("endpoints/{}", random.stream));
        let chosen = choose(&self.scattered.graph, &mut self.taken, count, apart, fits, &stream);
        if chosen.len() < count as usize {
            Err(Problem::NoRoom { placed: chosen.len(), count, apart })
        } else {
            Ok(chosen)
        }
    }

    fn choose_near(&mut self, near: &Near, context: &Context<'_>) -> Result<Vec<Node>, Problem> {
        let places = near.draw_places(context.seed, context.grown, self.space.is_plane)?;
        let mut nodes = self.graph().nearest(&places);
        nodes.retain(|node| !std::mem::replace(&mut self.taken[node.0 as usize], true));
        Ok(nodes)
    }
}

impl PathSite for OnScatter<'_> {
    fn cost_over_length(&self, first: Node, progress: &Progress) -> Result<[f64; 2], GrowError> {
        let graph = self.graph();
        let found = routes(graph, &self.scattered.weights, &[(first, 0)], &[], progress)?;
        let (mut cost, mut length) = (0.0, 0.0);
        for node in (0..graph.len() as u32).map(Node) {
            if let Some(paid) = found.cost(node) {
                cost += paid as f64;
                length += graph.position(node).distance(graph.position(first));
            }
        }
        Ok([cost, f64::max(length, f64::MIN_POSITIVE)])
    }

    fn plan<'s>(
        &'s self,
        generators: &[(Node, u64)],
        ends: Option<&[Node]>,
        progress: &Progress,
    ) -> Result<Box<dyn PathTree + 's>, PlanError> {
        let weights = &self.scattered.weights;
        let found = routes(self.graph(), weights, generators, ends.unwrap_or(&[]), progress)?;
        Ok(Box::new(ScaledRoutes { found, weights, spacing: self.space.spacing }))
    }

    fn marks(
        &self,
        step: &Step,
        _tree: &dyn PathTree,
        ends: &[Node],
        context: &Context<'_>,
    ) -> Result<Vec<Mark>, Problem> {
        let graph = self.graph();
        let sectors = match (&self.space.joining, &graph.nearest(&[middle(step)])[..]) {
            (Joining::Yao { sectors, .. }, &[node]) => {
                let at = graph.position(node);
                let reach = SECTOR_RAY * self.space.spacing;
                sectors.rays().iter().map(|ray| vec![at, at + ray.extend(0.0) * reach]).collect()
            }
            _ => Vec::new(),
        };
        let construction = Construction {
            graph: &(graph, &self.scattered.weights),
            shapes: drawn_shapes(step, &self.scattered.volumes),
            ends: ends.iter().map(|&node| graph.position(node)).collect(),
            is_plane: self.space.is_plane,
            contours: &|| None,
            sectors,
        };
        construction.marks(context.show)
    }
}

impl PathTree for ScaledRoutes<'_> {
    fn settled(&self) -> u64 {
        self.found.settled() as u64
    }

    fn is_reached(&self, node: Node) -> bool {
        self.found.cost(node).is_some()
    }

    fn path(&self, node: Node) -> Vec<(Node, f64)> {
        self.found.path(node).map(|(node, cost)| (node, self.weights.real(cost) * self.spacing)).collect()
    }
}
