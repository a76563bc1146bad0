//! Limbs grow towards the points that are nearest to them.

use std::sync::Arc;

use rand::RngExt;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::spec::Colonise;
use crate::geom::Shape;
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::{Grown, MOST_NODES, NODE_BYTES};
use crate::grow::near::MOST_REJECTIONS;
use crate::grow::starts::source_places;
use crate::grow::step::{Context, Generators, Method, Step};
use crate::math::{DVec3, Stream};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// A limb that would grow as near to where it has grown before, in steps, is drawn to and fro by points on both sides.
const AGAIN: f64 = 1e-3;

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
        let stream = Stream::new(context.seed, &format!("colonise/{}", step.name));
        let points = self.scatter(stream).map_err(|problem| step.error(Key::MethodKey("inside", None), problem))?;
        let mut plant = Plant::new(self, &starts, step.classes.clone());
        plant.reach_out(&points);
        let mut left = points;
        for round in 0..self.rounds {
            left = plant.grow(left);
            if plant.skeleton.nodes.len() as u64 > MOST_NODES {
                return Err(step.error(Key::Method, Problem::Overgrown(MOST_NODES)));
            }
            context.progress.report("grow", f64::from(round + 1) / f64::from(self.rounds))?;
            if left.is_empty() || !plant.is_growing {
                break;
            }
        }
        let skeleton = plant.finish();
        step.finish_with(Grown { settled: skeleton.nodes.len() as u64, ..Grown::default() }, skeleton, context)
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        // A limb is about as long as the shape is wide for every few points; each node is there once.
        let across = self.inside.bounds().size().max_element() / self.step;
        let nodes = (f64::from(self.points) * self.influence / self.step + across).min(MOST_NODES as f64);
        nodes as u64 * NODE_BYTES * u64::from(step.parts()) + u64::from(self.points) * 64
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
    fn scatter(&self, mut stream: Stream) -> Result<Vec<DVec3>, Problem> {
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
                    return Err(Problem::NoRoom { placed: points.len(), count: self.points, apart: 0.0 });
                }
            }
        }
        Ok(points)
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

    /// Grows straight from the node that is nearest to any of `points` until some can draw it: the trunk.
    fn reach_out(&mut self, points: &[DVec3]) {
        let mut all =
            self.skeleton.nodes.iter().zip(0..).flat_map(|(n, i)| points.iter().map(move |&p| (i, n.position, p)));
        let Some(first) = all.next() else { return };
        let nearer = |a: (u32, DVec3, DVec3), b: (u32, DVec3, DVec3)| {
            if b.1.distance_squared(b.2) < a.1.distance_squared(a.2) { b } else { a }
        };
        let (mut from, start, goal) = all.fold(first, nearer);
        let steps = libm::ceil((start.distance(goal) - self.own.influence) / self.own.step).max(0.0) as u32;
        let way = (goal - start).normalize_or_zero();
        for i in 1..=steps {
            self.add(start + way * (f64::from(i) * self.own.step), Some(from));
            from = self.skeleton.nodes.len() as u32 - 1;
        }
    }

    /// Grows a round; the points that are left.
    fn grow(&mut self, points: Vec<DVec3>) -> Vec<DVec3> {
        let drawn: Vec<Option<(u32, f64)>> = points.par_iter().map(|&p| self.nearest(p)).collect();
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
        points.into_par_iter().filter(is_left).collect()
    }

    /// What grew, a path to every tip.
    fn finish(self) -> Skeleton {
        let mut skeleton = self.skeleton;
        let counts = skeleton.child_counts();
        let tips = (0..skeleton.nodes.len() as u32).filter(|&i| counts[i as usize] == 0);
        let paths = tips.zip(0..).map(|(end, name)| Path { end, name, ..Path::default() });
        skeleton.paths = paths.collect();
        skeleton
    }
}
