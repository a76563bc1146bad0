//! What the papers' construction figures draw: nodes, edges and their costs, sectors, endpoints, shapes and contours of cost.

use super::error::Problem;
use super::space::Space;
use super::step::{Generators, Step};
use crate::geom::{Mark, MarkKind, Shape};
use crate::graph::{EdgeWeights, Graph, Lattice, Node, Scatter};
use crate::math::DVec3;
use crate::plan::Plan;
use crate::raster::contours;

/// More nodes or edges than this make a drawing that is black all over.
const MOST_DRAWN: u64 = 250_000;
/// Lines of equal cost between the least and the greatest (2007, Fig. 2 left).
const CONTOURS: u32 = 16;
/// Samples along the longer side of a section through a shape.
const SECTION: u32 = 256;

/// The shapes that drawings of `step` outline: those of its space, `volumes`, those of its endpoints and generators.
pub(super) fn drawn_shapes<'a>(step: &'a Step, volumes: &'a [Shape]) -> Vec<&'a Shape> {
    let placed = step.endpoints.iter().filter_map(|set| set.placement.shape());
    let inside = if let Generators::Inside(shape) = &step.source { Some(shape) } else { None };
    step.space.iter().flat_map(Space::shapes).chain(volumes).chain(placed).chain(inside).collect()
}

/// The point that sections of `step` go through.
pub(super) fn middle(step: &Step) -> DVec3 {
    match &step.source {
        Generators::At(points) => points[0],
        Generators::Inside(shape) => shape.bounds().centre(),
        Generators::Steps(..) | Generators::Spread(_) => {
            step.space.as_ref().map_or(DVec3::ZERO, |space| space.shape().bounds().centre())
        }
    }
}

/// A graph as drawings show it.
pub(super) trait DrawnGraph {
    /// The number of its nodes and of its edges.
    fn counts(&self) -> [u64; 2];

    /// Calls `add` with the position of each node.
    fn each_node(&self, add: &mut dyn FnMut(DVec3));

    /// Calls `add` with the ends and the weight of each edge.
    fn each_edge(&self, add: &mut dyn FnMut([DVec3; 2], u32));
}

impl DrawnGraph for Lattice {
    fn counts(&self) -> [u64; 2] {
        [self.open_nodes(), self.count_edges()]
    }

    fn each_node(&self, add: &mut dyn FnMut(DVec3)) {
        self.nodes().for_each(|node| add(self.position(node)));
    }

    fn each_edge(&self, add: &mut dyn FnMut([DVec3; 2], u32)) {
        for node in self.nodes() {
            self.edges(node, |edge| {
                if node < edge.node {
                    add([node, edge.node].map(|n| self.position(n)), edge.weight);
                }
            });
        }
    }
}

impl DrawnGraph for (&Scatter, &EdgeWeights) {
    fn counts(&self) -> [u64; 2] {
        [self.0.len() as u64, self.0.count_edges()]
    }

    fn each_node(&self, add: &mut dyn FnMut(DVec3)) {
        self.0.positions().iter().for_each(|&p| add(p));
    }

    fn each_edge(&self, add: &mut dyn FnMut([DVec3; 2], u32)) {
        let (graph, weights) = self;
        for node in (0..graph.len() as u32).map(Node) {
            let edges = graph.edges(node);
            let ends = graph.ends(edges.clone()).iter().zip(weights.of(edges));
            let ends = ends.filter(|(end, _)| node < **end);
            ends.for_each(|(&end, &weight)| add([node, end].map(|n| graph.position(n)), weight));
        }
    }
}

/// What construction drawings show of a step.
pub(super) struct Construction<'a> {
    /// The graph that paths were planned in.
    pub graph: &'a dyn DrawnGraph,
    /// The shapes that its nodes and endpoints were placed in.
    pub shapes: Vec<&'a Shape>,
    /// The endpoints.
    pub ends: Vec<DVec3>,
    /// Does it lie in the plane?
    pub is_plane: bool,
    /// Lines of equal cost; `None` where the graph has no rows.
    pub contours: &'a dyn Fn() -> Option<Vec<Vec<DVec3>>>,
    /// The rays between the sectors of a Yao graph, as polylines; none where it has none in the plane.
    pub sectors: Vec<Vec<DVec3>>,
}

impl Construction<'_> {
    /// The marks of the kinds in `show`.
    ///
    /// # Errors
    /// [`Problem::TooManyMarks`], [`Problem::NoContours`], [`Problem::NoSectors`].
    pub(super) fn marks(&self, show: &[MarkKind]) -> Result<Vec<Mark>, Problem> {
        let mut marks = graph_marks(self.graph, show)?;
        for &kind in show {
            let lines = match kind {
                MarkKind::Nodes | MarkKind::Edges | MarkKind::Costs => continue,
                MarkKind::Endpoints => self.ends.iter().map(|&p| vec![p]).collect(),
                MarkKind::Shapes => self.shapes.iter().flat_map(|shape| sections(shape, self.is_plane)).collect(),
                MarkKind::Contours => (self.contours)().ok_or(Problem::NoContours)?,
                MarkKind::Sectors if self.sectors.is_empty() => return Err(Problem::NoSectors),
                MarkKind::Sectors => self.sectors.clone(),
            };
            marks.extend(lines.into_iter().map(|line| Mark { kind, line, cost: 0.0 }));
        }
        Ok(marks)
    }
}

/// The marks of a graph alone: of `show` the nodes, the edges and what these cost.
///
/// # Errors
/// [`Problem::TooManyMarks`].
pub(super) fn graph_marks(graph: &dyn DrawnGraph, show: &[MarkKind]) -> Result<Vec<Mark>, Problem> {
    let mut marks = Vec::new();
    let [nodes, edges] = graph.counts();
    for &kind in show {
        match kind {
            MarkKind::Nodes => {
                few_enough(nodes, false)?;
                graph.each_node(&mut |p| marks.push(Mark { kind, line: vec![p], cost: 0.0 }));
            }
            MarkKind::Edges => {
                few_enough(edges, true)?;
                graph.each_edge(&mut |ends, _| marks.push(Mark { kind, line: ends.to_vec(), cost: 0.0 }));
            }
            MarkKind::Costs => {
                few_enough(edges, true)?;
                let mut sorted = Vec::with_capacity(edges as usize);
                graph.each_edge(&mut |_, weight| sorted.push(weight));
                sorted.sort_unstable();
                graph.each_edge(&mut |ends, weight| {
                    let less = sorted.partition_point(|&other| other < weight);
                    marks.push(Mark { kind, line: ends.to_vec(), cost: less as f64 / sorted.len() as f64 });
                });
            }
            MarkKind::Sectors | MarkKind::Endpoints | MarkKind::Shapes | MarkKind::Contours => {}
        }
    }
    Ok(marks)
}

fn few_enough(count: u64, is_edges: bool) -> Result<(), Problem> {
    let what = if is_edges { "edges" } else { "nodes" };
    if count > MOST_DRAWN { Err(Problem::TooManyMarks { what, count, most: MOST_DRAWN }) } else { Ok(()) }
}

/// Lines of equal cost on the plane, or on the upright plane through a point.
pub(super) fn cost_contours(plan: &Plan<'_, Lattice>, through: DVec3) -> Vec<Vec<DVec3>> {
    let lattice = plan.graph();
    let window = lattice.window();
    let range = lattice.weight_range();
    let up = if lattice.is_plane() { 1 } else { 2 };
    let depth = if up == 1 { 0 } else { window.nearest(through).map_or(window.size[1] / 2, |at| at[1]) };
    let size = [window.size[0], window.size[up]];
    let at = |x: u32, y: u32| if up == 1 { [x, y, 0] } else { [x, depth, y] };
    let nodes = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    let costs = plan.costs(nodes.map(|(x, y)| lattice.node(at(x, y))).filter(|&n| lattice.is_open(n)));
    let cost = |x: u32, y: u32| costs[lattice.cell(lattice.node(at(x, y)))].map_or(f64::NAN, |cost| range.real(cost));
    let most = costs.iter().flatten().max().map_or(0.0, |&cost| range.real(cost));
    let place = |x: f64, y: f64| {
        let low = window.position(at(0, 0));
        let mut p = low;
        p.x += x * window.spacing;
        p[up] += y * window.spacing;
        p
    };
    (1..=CONTOURS)
        .flat_map(|line| contours(size, |x, y| cost(x, y) - most * f64::from(line) / f64::from(CONTOURS + 1)))
        .map(|line| line.into_iter().map(|p| place(p.x, p.y)).collect())
        .collect()
}

/// Outlines of a shape: of itself in the plane, of its three middle sections in space.
fn sections(shape: &Shape, is_plane: bool) -> Vec<Vec<DVec3>> {
    let bounds = shape.bounds();
    let planes: &[[usize; 2]] = if is_plane { &[[0, 1]] } else { &[[0, 2], [1, 2], [0, 1]] };
    let middle = if is_plane { bounds.centre().with_z(0.0) } else { bounds.centre() };
    let mut lines = Vec::new();
    for &[across, up] in planes {
        let extent = [bounds.size()[across], bounds.size()[up]];
        let step = extent[0].max(extent[1]) / f64::from(SECTION);
        // A margin of two samples, so that every outline is closed.
        let size = extent.map(|e| libm::ceil(e / step) as u32 + 5);
        let place = |x: f64, y: f64| {
            let mut p = middle;
            p[across] = bounds.min[across] + (x - 2.0) * step;
            p[up] = bounds.min[up] + (y - 2.0) * step;
            p
        };
        let value = |x: u32, y: u32| shape.distance(place(f64::from(x), f64::from(y)));
        lines.extend(
            contours(size, value).into_iter().map(|line| line.into_iter().map(|p| place(p.x, p.y)).collect::<Vec<_>>()),
        );
    }
    lines
}
