//! Limbs grow towards the points that are nearest to them.

use std::sync::Arc;

use rand::RngExt;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::spec::Colonise;
use crate::geom::Shape;
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::{Grown, MOST_NODES, NODE_BYTES, places};
use crate::grow::near::MOST_REJECTIONS;
use crate::grow::starts::source_places;
use crate::grow::step::{Context, Generators, Method, Step};
use crate::math::{DVec3, Stream};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// A limb that would grow as near to where it has grown before, in steps, is drawn to and fro by points on both sides.
const AGAIN: f64 = 1e-3;

/// Points that are tried between two questions whether to stop.
const BETWEEN_CHECKS: usize = 4096;

/// Bytes of a point, with what it draws.
const POINT_BYTES: u64 = 64;

impl Method for Colonise {
    fn name(&self) -> &'static str {
        "colonise"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let starts = match &step.source {
            Generators::At(points) => points.clone(),
            _ => source_places(step, context)?,
        };
        if starts.is_empty() {
            return Err(step.error(Key::From, Problem::NoEnds));
        }
        let inside = |problem: Problem| step.error(Key::MethodKey("inside", None), problem);
        let mut points =
            self.scatter(Stream::new(context.seed, &format!("colonise/{}", step.name)), context, &inside)?;
        let mut plant = Plant::new(self, &starts, step.classes.clone());
        let overgrown = || step.error(Key::Method, Problem::Colonised(MOST_NODES));
        plant.reach_out(&points, context, &overgrown)?;
        for round in 0..self.rounds {
            points = plant.grow(points, context)?;
            if plant.skeleton.nodes.len() as u64 > MOST_NODES {
                return Err(overgrown());
            }
            context.progress.report("grow", f64::from(round + 1) / f64::from(self.rounds))?;
            if points.is_empty() || !plant.is_growing {
                break;
            }
        }
        let skeleton = plant.finish();
        step.finish_with(Grown { settled: skeleton.nodes.len() as u64, ..Grown::default() }, skeleton, context)
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        let starts = if let Generators::At(points) = &step.source { points.len() } else { 0 };
        self.bytes(step, starts)
    }

    fn bytes_needed_from(&self, step: &Step, grown: &[Option<&Skeleton>]) -> u64 {
        let Generators::Steps(steps, part) = &step.source else { return self.bytes_needed(step) };
        let starts = steps.iter().filter_map(|&i| grown[i]).map(|skeleton| places(skeleton, *part).len()).sum();
        self.bytes(step, starts)
    }

    fn shapes(&self) -> Vec<&Shape> {
        vec![&self.inside]
    }

    fn with_shapes(&self, change: &dyn Fn(&Shape) -> Shape) -> Option<Arc<dyn Method>> {
        Some(Arc::new(Self { inside: change(&self.inside), ..self.clone() }))
    }
}

impl Colonise {
    /// The attraction points, uniform in the shape.
    fn scatter(
        &self,
        mut stream: Stream,
        context: &Context<'_>,
        wrong: &dyn Fn(Problem) -> GrowError,
    ) -> Result<Vec<DVec3>, GrowError> {
        let bounds = self.inside.bounds();
        let mut points = Vec::with_capacity(self.points as usize);
        let mut rejections = 0;
        while points.len() < self.points as usize {
            let [u, v, w]: [f64; 3] = std::array::from_fn(|_| stream.random());
            let p = bounds.min + bounds.size() * DVec3::new(u, v, w);
            if self.inside.contains(p) {
                points.push(p);
                rejections = 0;
            } else {
                rejections += 1;
                if rejections == MOST_REJECTIONS {
                    return Err(wrong(Problem::NoPoints { placed: points.len(), count: self.points }));
                }
            }
            if (points.len() + rejections as usize).is_multiple_of(BETWEEN_CHECKS) {
                context.progress.check()?;
            }
        }
        Ok(points)
    }

    /// Bytes of a plant with so many starts. From one point that is reached to the next a limb grows as far as they are apart, or as
    /// points are reached from, but no farther than they draw; the trunk is as long as the farthest start is from the shape.
    fn bytes(&self, step: &Step, starts: usize) -> u64 {
        let bounds = self.inside.bounds();
        let away = match &step.source {
            Generators::At(points) => {
                points.iter().map(|p| p.distance(p.clamp(bounds.min, bounds.max))).fold(0.0, f64::max)
            }
            _ => 0.0,
        };
        let size = bounds.size();
        let apart = libm::cbrt(size.element_product() / f64::from(self.points));
        let each = apart.max(self.kill).min(self.influence);
        let limbs = (size.max_element() + away + f64::from(self.points) * each) / self.step;
        let nodes = (limbs + starts as f64).min(MOST_NODES as f64);
        nodes as u64 * NODE_BYTES * u64::from(step.parts()) + u64::from(self.points) * POINT_BYTES
    }
}

/// A plant while it grows.
struct Plant<'a> {
    own: &'a Colonise,
    skeleton: Skeleton,
    /// Nodes by cells as wide as points draw.
    cells: FxHashMap<[i64; 3], Vec<u32>>,
    /// The last place that each node grew to.
    last: Vec<Option<DVec3>>,
    is_growing: bool,
}

impl<'a> Plant<'a> {
    fn new(own: &'a Colonise, starts: &[DVec3], classes: Vec<String>) -> Self {
        let skeleton = Skeleton::new(classes);
        let mut plant = Self { own, skeleton, cells: FxHashMap::default(), last: Vec::new(), is_growing: true };
        starts.iter().for_each(|&at| plant.add(at, None));
        plant
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        p.to_array().map(|c| libm::floor(c / self.own.influence) as i64)
    }

    fn add(&mut self, at: DVec3, parent: Option<u32>) {
        let cost = parent.map_or(0.0, |p| {
            let from = self.skeleton.nodes[p as usize];
            from.cost + from.position.distance(at)
        });
        let node = self.skeleton.nodes.len() as u32;
        self.skeleton.nodes.push(SkeletonNode::new(at, parent, cost, 0));
        self.last.push(None);
        let cell = self.cell(at);
        self.cells.entry(cell).or_default().push(node);
    }

    /// The node nearest to `p` and its distance, of those that it can draw; of equals the first.
    fn nearest(&self, p: DVec3) -> Option<(u32, f64)> {
        let [x, y, z] = self.cell(p);
        let around =
            (-1..=1).flat_map(|dx| (-1..=1).flat_map(move |dy| (-1..=1).map(move |dz| [x + dx, y + dy, z + dz])));
        let nodes = around.filter_map(|cell| self.cells.get(&cell)).flatten();
        let far = |&node: &u32| (node, self.skeleton.nodes[node as usize].position.distance(p));
        let nearer = |a: (u32, f64), b: (u32, f64)| if (b.1, b.0) < (a.1, a.0) { b } else { a };
        nodes.map(far).reduce(nearer).filter(|&(_, distance)| distance <= self.own.influence)
    }

    /// Where none of `points` draws a node: grows straight from the node nearest to any until one does. This is the trunk.
    fn reach_out(
        &mut self,
        points: &[DVec3],
        context: &Context<'_>,
        overgrown: &dyn Fn() -> GrowError,
    ) -> Result<(), GrowError> {
        if points.par_iter().any(|&p| self.nearest(p).is_some()) {
            return Ok(());
        }
        let Some((mut from, goal)) = self.nearest_pair(points, context)? else { return Ok(()) };
        let start = self.skeleton.nodes[from as usize].position;
        let steps = libm::ceil((start.distance(goal) - self.own.influence) / self.own.step).max(0.0);
        if steps > MOST_NODES as f64 {
            return Err(overgrown());
        }
        let direction = (goal - start).normalize_or_zero();
        for i in 1..=steps as u32 {
            self.add(start + direction * (f64::from(i) * self.own.step), Some(from));
            from = self.skeleton.nodes.len() as u32 - 1;
        }
        Ok(())
    }

    /// The node and the point that are nearest to each other; of equals the first node, then the first point.
    fn nearest_pair(&self, points: &[DVec3], context: &Context<'_>) -> Result<Option<(u32, DVec3)>, GrowError> {
        let nearest_point = |(i, node): (usize, &SkeletonNode)| {
            context.progress.check()?;
            let far = points.iter().map(|p| p.distance_squared(node.position));
            Ok(far.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(point, far)| (far, i as u32, point)))
        };
        let nodes = self.skeleton.nodes.par_iter().enumerate();
        let all: Vec<Option<(f64, u32, usize)>> = nodes.map(nearest_point).collect::<Result<_, GrowError>>()?;
        let first = all.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(first.map(|(_, node, point)| (node, points[point])))
    }

    /// Grows a round; the points that are left.
    fn grow(&mut self, points: Vec<DVec3>, context: &Context<'_>) -> Result<Vec<DVec3>, GrowError> {
        let draws = |&p: &DVec3| context.progress.check().map(|()| self.nearest(p));
        let drawn: Vec<Option<(u32, f64)>> = points.par_iter().map(draws).collect::<Result<_, _>>()?;
        let mut ways = vec![DVec3::ZERO; self.skeleton.nodes.len()];
        for (&p, &drawn) in points.iter().zip(&drawn) {
            if let Some((node, _)) = drawn {
                let way = p - self.skeleton.nodes[node as usize].position;
                ways[node as usize] += way.normalize_or_zero();
            }
        }
        self.is_growing = false;
        for (node, way) in ways.into_iter().enumerate().filter(|(_, way)| *way != DVec3::ZERO) {
            let Some(way) = way.try_normalize() else { continue };
            let at = self.skeleton.nodes[node].position + way * self.own.step;
            if self.last[node].is_some_and(|last| last.distance(at) < AGAIN * self.own.step) {
                continue;
            }
            self.last[node] = Some(at);
            self.add(at, Some(node as u32));
            self.is_growing = true;
        }
        let is_left = |p: &DVec3| self.nearest(*p).is_none_or(|(_, distance)| distance > self.own.kill);
        Ok(points.into_par_iter().filter(is_left).collect())
    }

    /// What grew, a path to every tip; starts that drew nothing have none.
    fn finish(self) -> Skeleton {
        let mut skeleton = self.skeleton;
        let counts = skeleton.child_counts();
        let tips = (0..skeleton.nodes.len() as u32)
            .filter(|&i| counts[i as usize] == 0 && skeleton.nodes[i as usize].parent.is_some());
        let paths = tips.zip(0..).map(|(end, name)| Path { end, name, ..Path::default() });
        skeleton.paths = paths.collect();
        skeleton
    }
}
