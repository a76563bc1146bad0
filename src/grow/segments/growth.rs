//! Amin's Growth module: nodes of a queue grow on their own, so that any number of threads gives the same plant.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use rand::RngExt;
use rayon::prelude::*;

use super::values::{Attractor, Branches, Segments};
use crate::geom::Shape;
use crate::grow::error::{GrowError, Key, Problem};
use crate::grow::grown::{Grown, MOST_NODES, Part};
use crate::grow::limb_starts::{Start, branch_name};
use crate::grow::step::{Context, Generators, Method, Step, Yield};
use crate::math::{DVec3, Stream, frame_along, from_polar};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// Limbs that grow together: enough that handing them out costs nothing.
const CHUNK: usize = 1024;

/// An entry of the queue: a node that is to grow.
#[derive(Clone, Copy)]
struct Tip {
    start: Start,
    node: u32,
    limb: u32,
    root: u32,
}

/// A node that grew.
#[derive(Clone, Copy)]
struct Made {
    at: DVec3,
    /// The node before it; none at a root.
    parent: Option<u32>,
    /// Its limb, or [`NEW`] and the place among those that begin in its growth.
    limb: u32,
}

/// What the next time needs of a node.
#[derive(Clone, Copy)]
struct Bud {
    way: DVec3,
    last: DVec3,
    name: u64,
    root: u32,
}

/// Limbs from this number on are new.
const NEW: u32 = 1 << 31;

/// What a few tips grew at one time.
#[derive(Default)]
struct Growth {
    /// How often they had grown.
    age: u32,
    /// The numbers of its first node and of the first limb that begins in it.
    first: u32,
    limb: u32,
    made: Vec<Made>,
    /// A bud for each node, but for the last time.
    buds: Vec<Bud>,
    /// The limbs that begin.
    limbs: Vec<Path>,
}

impl Growth {
    /// Counts its roots from `first` on.
    fn count_roots_from(&mut self, first: u32) {
        for made in &mut self.made {
            made.parent = made.parent.map(|root| root + first);
            made.limb += if made.limb < NEW { first } else { 0 };
        }
        self.buds.iter_mut().for_each(|bud| bud.root += first);
        self.limbs.iter_mut().for_each(|limb| limb.root += first);
    }

    fn new(age: u32, tips: usize) -> Self {
        Self { age, made: Vec::with_capacity(2 * tips), buds: Vec::with_capacity(2 * tips), ..Self::default() }
    }

    fn named(&self, limb: u32) -> u32 {
        if limb >= NEW { limb - NEW + self.limb } else { limb }
    }

    /// The entry of its node with this place.
    fn tip(&self, place: usize) -> Tip {
        let (Made { at, limb, .. }, Bud { way, last, name, root }) = (self.made[place], self.buds[place]);
        Tip { start: Start { at, way, last, name }, node: self.first + place as u32, limb: self.named(limb), root }
    }

    /// Adds a node with its bud, of a limb or of a new one.
    fn add(&mut self, made: Made, bud: Bud) {
        let limb = if made.limb == NEW {
            self.limbs.push(Path { root: bud.root, name: bud.name, last: bud.last, ..Path::default() });
            NEW + self.limbs.len() as u32 - 1
        } else {
            made.limb
        };
        self.made.push(Made { limb, ..made });
        self.buds.push(bud);
    }
}

/// A direction at `angle` from `way`, and `turn` about it.
fn turned(way: DVec3, angle: f64, turn: f64) -> DVec3 {
    frame_along(way) * from_polar(angle, turn)
}

/// A number between the two.
fn between([least, most]: [f64; 2], random: &mut Stream) -> f64 {
    least + (most - least) * random.random::<f64>()
}

/// A direction at an angle between two from `way`, anywhere about it.
pub(in crate::grow) fn strayed(way: DVec3, angles: [f64; 2], random: &mut Stream) -> DVec3 {
    let angle = between(angles, random);
    turned(way, angle, std::f64::consts::TAU * random.random::<f64>())
}

impl Branches {
    /// How many there are at a node: each has its chance.
    fn count(&self, random: &mut Stream) -> u32 {
        (0..self.most).map(|_| u32::from(random.random::<f64>() < self.chance)).sum()
    }

    /// The way of the next one: opposite to the last, where there is one, but for half the arc to either side.
    fn way(&self, way: DVec3, last: DVec3, random: &mut Stream) -> DVec3 {
        let angle = between(self.angle, random);
        let share: f64 = random.random();
        let Some(opposite) = (way * last.dot(way) - last).try_normalize() else {
            return turned(way, angle, std::f64::consts::TAU * share);
        };
        let turn = self.arc * (share - 0.5);
        let round = opposite * libm::cos(turn) + way.cross(opposite) * libm::sin(turn);
        way * libm::cos(angle) + round * libm::sin(angle)
    }
}

impl Segments {
    /// `way`, drawn to the attractor: `strength * to it + (1 - strength) * way`, of length 1 again.
    fn attracted(&self, from: DVec3, way: DVec3) -> DVec3 {
        let Some(Attractor { at, strength }) = self.toward else { return way };
        let there = (at - from).try_normalize().unwrap_or(way);
        (there * strength + way * (1.0 - strength)).normalize_or(way)
    }

    fn is_open(&self, p: DVec3) -> bool {
        self.inside.as_ref().is_none_or(|inside| inside.contains(p))
    }

    /// Lets `tip` grow.
    fn grow_tip(&self, tip: &Tip, stream: &Stream, growth: &mut Growth) {
        let Start { at, way, last, name } = tip.start;
        let mut random = stream.nth(name).nth(u64::from(growth.age));
        let stem = self.attracted(at, strayed(way, self.jitter, &mut random));
        let end = at + stem * self.step;
        if !self.is_open(end) {
            return;
        }
        let place = growth.buds.len();
        let made = Made { at: end, parent: Some(tip.node), limb: tip.limb };
        growth.add(made, Bud { way: stem, last, name, root: tip.root });
        if let Some(branches) = &self.branches {
            growth.buds[place].last = self.branch(branches, tip, NEW, &mut random, growth);
        }
    }

    /// Lets branches grow from `tip`, the first of them of `limb`; the way of the last, before anything attracts it.
    fn branch(&self, branches: &Branches, tip: &Tip, mut limb: u32, random: &mut Stream, growth: &mut Growth) -> DVec3 {
        let Start { at, way, mut last, name } = tip.start;
        for index in 0..branches.count(random) {
            // What the box cuts off changes nothing else.
            last = branches.way(way, last, random);
            let branch = self.attracted(at, last);
            let end = at + branch * self.step;
            if self.is_open(end) {
                let name = if limb == NEW { branch_name(name, growth.age, index) } else { name };
                let bud = Bud { way: branch, last: DVec3::ZERO, name, root: tip.root };
                growth.add(Made { at: end, parent: Some(tip.node), limb }, bud);
                limb = NEW;
            }
        }
        last
    }

    /// What sprouts along some limbs, and the roots that it sprouts from; sprouts of a limb avoid each other as branches do.
    /// The first at each root is of that root's own limb. Roots are counted from 0.
    fn sprouts(&self, sprout: &Branches, limbs: &[Vec<Start>], stream: &Stream) -> (Vec<Start>, Growth) {
        let (mut roots, mut growth) = (Vec::new(), Growth::default());
        for limb in limbs {
            let mut last = DVec3::ZERO;
            for start in limb {
                let root = roots.len() as u32;
                let tip = Tip { start: Start { last, ..*start }, node: root, limb: root, root };
                let before = growth.made.len();
                last = self.branch(sprout, &tip, root, &mut stream.nth(start.name).nth(0), &mut growth);
                if growth.made.len() > before {
                    roots.push(*start);
                }
            }
        }
        (roots, growth)
    }
}

/// A plant while it grows: what grew, in order, and from which growth on it is to grow.
#[derive(Default)]
struct Growing {
    growths: Vec<Growth>,
    alive: usize,
    nodes: usize,
    limbs: u32,
}

impl Growing {
    /// Adds what grew at one time.
    fn join(&mut self, mut growths: Vec<Growth>) {
        self.alive = self.growths.len();
        growths.retain(|growth| !growth.made.is_empty());
        for growth in &mut growths {
            (growth.first, growth.limb) = (self.nodes as u32, self.limbs);
            self.nodes += growth.made.len();
            self.limbs += growth.limbs.len() as u32;
        }
        self.growths.extend(growths);
    }

    /// Roots, each with a limb of its own.
    fn plant(&mut self, starts: &[Start]) {
        let mut roots = Growth::new(0, starts.len());
        for (&Start { at, way, last, name }, root) in starts.iter().zip(0..) {
            roots.add(Made { at, parent: None, limb: NEW }, Bud { way, last, name, root });
        }
        self.join(vec![roots]);
    }

    /// Lets all that is alive grow once more; `is_last` where nothing grows after.
    fn grow(&mut self, segments: &Segments, age: u32, is_last: bool, stream: &Stream) {
        let alive = &self.growths[self.alive..];
        let pieces: Vec<(&Growth, std::ops::Range<usize>)> = alive
            .iter()
            .flat_map(|growth| {
                let count = growth.buds.len();
                (0..count).step_by(CHUNK).map(move |low| (growth, low..count.min(low + CHUNK)))
            })
            .collect();
        let growths = pieces
            .into_par_iter()
            .map(|(from, places)| {
                let mut growth = Growth::new(age, places.len());
                places.for_each(|place| segments.grow_tip(&from.tip(place), stream, &mut growth));
                if is_last {
                    growth.buds = Vec::new();
                }
                growth
            })
            .collect();
        self.growths[self.alive..].par_iter_mut().for_each(|growth| growth.buds = Vec::new());
        self.join(growths);
    }

    /// All that grew; a step is so long.
    fn finish(self, classes: Vec<String>, step: f64) -> Skeleton {
        // The growth that every so many nodes belong to: from there it is not far to any other.
        const EVERY: usize = 64;
        let mut at = 0;
        let near: Vec<usize> = (0..self.nodes)
            .step_by(EVERY)
            .map(|node| {
                while self.growths[at].first as usize + self.growths[at].made.len() <= node {
                    at += 1;
                }
                at
            })
            .collect();
        let node = |i: usize| {
            let mut growth = near[i / EVERY];
            while self.growths[growth].first as usize + self.growths[growth].made.len() <= i {
                growth += 1;
            }
            let growth = &self.growths[growth];
            let Made { at, parent, limb } = growth.made[i - growth.first as usize];
            let cost = if parent.is_some() { f64::from(growth.age + 1) * step } else { 0.0 };
            SkeletonNode { branch: growth.named(limb), ..SkeletonNode::new(at, parent, cost, 0) }
        };
        let nodes: Vec<SkeletonNode> = (0..self.nodes).into_par_iter().with_min_len(CHUNK).map(node).collect();
        // The last node of each limb is its end.
        let ends: Vec<AtomicU32> = (0..self.limbs).into_par_iter().map(|_| AtomicU32::new(0)).collect();
        nodes.par_iter().zip(0..nodes.len() as u32).for_each(|(node, i)| {
            ends[node.branch as usize].fetch_max(i, Ordering::Relaxed);
        });
        let limbs = self.growths.iter().flat_map(|growth| &growth.limbs);
        let paths = limbs.zip(ends).map(|(limb, end)| Path { end: end.into_inner(), ..*limb }).collect();
        // As much memory as they took is given back side by side.
        self.growths.into_par_iter().for_each(drop);
        Skeleton { nodes, paths, classes }
    }
}

impl Method for Segments {
    fn name(&self) -> &'static str {
        "segments"
    }

    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError> {
        let skeleton = grow_segments(self, step, context)?;
        step.finish_with(Grown { settled: skeleton.nodes.len() as u64, ..Grown::default() }, skeleton, context)
    }

    fn bytes_needed(&self, step: &Step) -> u64 {
        self.bytes_for(self.starts) * u64::from(step.parts())
    }

    fn bytes_needed_from(&self, step: &Step, grown: &[Option<&Skeleton>]) -> u64 {
        let before = step.sources().iter().filter_map(|&step| grown[step]);
        let starts: usize = match &step.source {
            Generators::Steps(_, Part::All) => before.map(|s| s.nodes.len()).sum(),
            Generators::Steps(_, part) => before.map(|s| s.end_paths(*part == Part::EveryEnd).count()).sum(),
            Generators::At(points) => points.len(),
            Generators::Inside(_) | Generators::Spread(_) => 0,
        };
        self.bytes_for(starts as f64) * u64::from(step.parts())
    }

    fn yields(&self) -> Yield {
        Yield::Limbs
    }

    fn shapes(&self) -> Vec<&Shape> {
        self.inside.iter().collect()
    }

    fn with_shapes(&self, change: &dyn Fn(&Shape) -> Shape) -> Option<Arc<dyn Method>> {
        Some(Arc::new(Self { inside: self.inside.as_ref().map(change), ..self.clone() }))
    }
}

/// What `step` sprouts along the steps that it grows from: roots, and what grew from each.
fn sprouted(
    segments: &Segments,
    sprout: &Branches,
    step: &Step,
    stream: &Stream,
    context: &Context<'_>,
) -> Result<Growing, GrowError> {
    let limbs = step.limbs_before(segments.along, context);
    let places: usize = limbs.iter().map(Vec::len).sum();
    segments.check(places as f64).map_err(|error| step.error(Key::Method, Problem::Expected(error)))?;
    let sprouted: Vec<(Vec<Start>, Growth)> =
        limbs.par_chunks(CHUNK).map(|limbs| segments.sprouts(sprout, limbs, stream)).collect();
    let (mut starts, mut growths) = (Vec::new(), Vec::new());
    for (roots, mut growth) in sprouted {
        growth.count_roots_from(starts.len() as u32);
        starts.extend(roots);
        growths.push(growth);
    }
    let mut plant = Growing::default();
    plant.plant(&starts);
    plant.join(growths);
    Ok(plant)
}

/// The roots of `step` where it grows from points or ends.
fn planted(segments: &Segments, step: &Step, context: &Context<'_>) -> Result<Growing, GrowError> {
    let starts = step.starts_of_limbs(segments.heading, context)?;
    segments.check(starts.len() as f64).map_err(|error| step.error(Key::Method, Problem::Expected(error)))?;
    if let Some(start) = starts.iter().find(|start| !segments.is_open(start.at))
        && matches!(step.source, Generators::At(_))
    {
        return Err(step.error(Key::FromAt, Problem::StartsOutside(start.at)));
    }
    let mut plant = Growing::default();
    plant.plant(&starts);
    Ok(plant)
}

/// Grows by segments.
fn grow_segments(segments: &Segments, step: &Step, context: &Context<'_>) -> Result<Skeleton, GrowError> {
    let stream = Stream::new(context.seed, &format!("segments/{}", step.name));
    let mut plant = match &segments.sprout {
        Some(sprout) => sprouted(segments, sprout, step, &stream, context)?,
        None => planted(segments, step, context)?,
    };
    for age in u32::from(segments.sprout.is_some())..segments.depth {
        plant.grow(segments, age, age + 1 == segments.depth, &stream);
        if plant.nodes as u64 > MOST_NODES {
            return Err(step.error(Key::Method, Problem::Overgrown(MOST_NODES)));
        }
        if plant.alive == plant.growths.len() {
            break;
        }
        context.progress.report("grow", f64::from(age + 1) / f64::from(segments.depth))?;
    }
    Ok(plant.finish(step.classes.clone(), segments.step))
}
