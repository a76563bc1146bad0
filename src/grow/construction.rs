//! What the papers' construction figures draw: nodes, edges, endpoints, shapes and contours of cost.

use super::error::Problem;
use super::site::PathTree;
use super::space::Space;
use super::step::{Generators, Step};
use crate::geom::{Mark, MarkKind, Shape};
use crate::graph::{Graph, Lattice, Node, Scatter};
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
fn middle(step: &Step) -> DVec3 {
    match &step.source {
        Generators::At(points) => points[0],
        Generators::Inside(shape) => shape.bounds().centre(),
        Generators::Steps(..) | Generators::Spread(_) => {
            step.space.as_ref().map_or(DVec3::ZERO, |space| space.shape().bounds().centre())
        }
    }
}

/// The marks of a step on a lattice, of the kinds in `show`.
///
/// # Errors
/// [`Problem::TooManyMarks`].
pub(super) fn lattice_marks(
    step: &Step,
    lattice: &Lattice,
    tree: &dyn PathTree,
    endpoints: &[Node],
    show: &[MarkKind],
) -> Result<Vec<Mark>, Problem> {
    let mut marks = Vec::new();
    for &kind in show {
        let mut add = |line: Vec<DVec3>| marks.push(Mark { kind, line });
        match kind {
            MarkKind::Nodes | MarkKind::Edges => {
                let is_edges = kind == MarkKind::Edges;
                let count = if is_edges { lattice.count_edges() } else { lattice.open_nodes() };
                few_enough(count, is_edges)?;
                for node in lattice.nodes() {
                    let from = lattice.position(node);
                    if !is_edges {
                        add(vec![from]);
                        continue;
                    }
                    // Each edge once: from the end with the lower name.
                    lattice.edges(node, |edge| {
                        if node < edge.node {
                            add(vec![from, lattice.position(edge.node)]);
                        }
                    });
                }
            }
            MarkKind::Endpoints => endpoints.iter().for_each(|&node| add(vec![lattice.position(node)])),
            MarkKind::Shapes => {
                let shapes = drawn_shapes(step, &[]);
                shapes.iter().flat_map(|shape| sections(shape, lattice.is_plane())).for_each(add);
            }
            MarkKind::Contours => {
                let lines = tree.contours(middle(step)).ok_or(Problem::NoContours)?;
                lines.into_iter().for_each(add);
            }
        }
    }
    Ok(marks)
}

/// The marks of a scattered graph; `shapes` are those that its nodes and endpoints were placed in.
///
/// # Errors
/// [`Problem::TooManyMarks`], [`Problem::NoContours`].
pub(super) fn scattered_marks(
    graph: &Scatter,
    shapes: &[&Shape],
    endpoints: &[Node],
    show: &[MarkKind],
) -> Result<Vec<Mark>, Problem> {
    let mut marks = Vec::new();
    let nodes = || (0..graph.len() as u32).map(Node);
    for &kind in show {
        let mut add = |line: Vec<DVec3>| marks.push(Mark { kind, line });
        match kind {
            MarkKind::Nodes => {
                few_enough(graph.len() as u64, false)?;
                graph.positions().iter().for_each(|&p| add(vec![p]));
            }
            MarkKind::Edges => {
                few_enough(graph.count_edges(), true)?;
                for node in nodes() {
                    let ends = graph.ends(graph.edges(node)).iter().filter(|end| node < **end);
                    ends.for_each(|&end| add(vec![graph.position(node), graph.position(end)]));
                }
            }
            MarkKind::Endpoints => endpoints.iter().for_each(|&node| add(vec![graph.position(node)])),
            MarkKind::Shapes => {
                let is_plane = graph.positions().iter().all(|p| p.z == 0.0);
                shapes.iter().flat_map(|shape| sections(shape, is_plane)).for_each(add);
            }
            MarkKind::Contours => return Err(Problem::NoContours),
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
