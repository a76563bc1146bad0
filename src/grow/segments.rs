//! Amin's Growth module: nodes of a queue grow on their own, so that any number of threads gives the same plant.

use rand::RngExt;
use rayon::prelude::*;

use super::starts::{Start, branch_name};
use super::step::MOST_NODES;
use super::{GrowError, Source, Step};
use crate::geom::Shape;
use crate::math::{DVec3, Progress, Stream, frame_along};
use crate::skeleton::{Path, Skeleton, SkeletonNode};

/// Limbs that grow together: enough that handing them out costs nothing.
const CHUNK: usize = 1024;

/// Growth by segments, with its names resolved; angles are in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Segments {
    /// How far a limb grows at a time, in scene units.
    pub step: f64,
    /// How many times limbs grow.
    pub depth: u32,
    /// Least and greatest angle by which a limb strays from its way.
    pub jitter: [f64; 2],
    /// How limbs branch.
    pub branches: Option<Branches>,
    /// How they leave the step that they grow from.
    pub sprout: Option<Branches>,
    /// The way of limbs that start at points, of length 1.
    pub heading: DVec3,
    /// Where they stay.
    pub inside: Option<Shape>,
    /// What they tend to.
    pub toward: Option<Attractor>,
    /// How many starts are to be expected.
    pub starts: f64,
}

/// Branches of one node; angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches {
    /// How many at most.
    pub most: u32,
    /// The probability of each.
    pub chance: f64,
    /// Least and greatest angle from the limb.
    pub angle: [f64; 2],
    /// The arc about the limb in which the next branch lies, opposite to the last.
    pub arc: f64,
}

/// A point that limbs tend to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attractor {
    /// Where it is.
    pub at: DVec3,
    /// How strong it is, from 0 to 1.
    pub strength: f64,
}

/// How much is expected to grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Nodes, those where limbs start left out.
    pub nodes: f64,
    /// Ends.
    pub ends: f64,
}

impl Expected {
    /// From so many starts, with so many branches of a node on the average: `(1 + branches)^depth` ends for each, and what lies
    /// between. Where limbs sprout, the first time there are so many in place of what grows on.
    #[must_use]
    pub fn new(starts: f64, depth: u32, sprout: Option<f64>, branches: f64) -> Self {
        let mut all = Self { nodes: 0.0, ends: starts };
        for place in 0..depth {
            all.ends = f64::min(all.ends * sprout.filter(|_| place == 0).unwrap_or(1.0 + branches), f64::MAX);
            all.nodes = f64::min(all.nodes + all.ends, f64::MAX);
        }
        all
    }
}

/// An entry of the queue: a node that is to grow.
#[derive(Clone, Copy, Default)]
struct Tip {
    start: Start,
    node: u32,
    limb: u32,
}

/// What a few tips grew. Limbs and nodes of their own count from where theirs start.
#[derive(Default)]
struct Growth {
    nodes: Vec<SkeletonNode>,
    tips: Vec<Tip>,
    /// The limbs that begin, by name.
    limbs: Vec<u64>,
}

/// A direction at `angle` from `way`, and `turn` about it.
fn turned(way: DVec3, angle: f64, turn: f64) -> DVec3 {
    let (across, along) = (libm::sin(angle), libm::cos(angle));
    frame_along(way) * DVec3::new(across * libm::cos(turn), across * libm::sin(turn), along)
}

/// A number between the two.
pub(super) fn between([least, most]: [f64; 2], random: &mut Stream) -> f64 {
    least + (most - least) * random.random::<f64>()
}

/// A direction at an angle between two from `way`, anywhere about it.
pub(super) fn strayed(way: DVec3, angles: [f64; 2], random: &mut Stream) -> DVec3 {
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
    /// How much grows from so many starts, on the average.
    #[must_use]
    pub fn expected(&self, starts: f64) -> Expected {
        let mean = |branches: Branches| f64::from(branches.most) * branches.chance;
        Expected::new(starts, self.depth, self.sprout.map(mean), self.branches.map_or(0.0, mean))
    }

    /// A sentence where more nodes are expected than there may be.
    ///
    /// # Errors
    /// That sentence, with the figure.
    pub fn check(&self, starts: f64) -> Result<Expected, String> {
        let expected = self.expected(starts);
        if expected.nodes <= MOST_NODES as f64 {
            return Ok(expected);
        }
        let branching = self.branches.map_or_else(String::new, |b| {
            format!(" ({starts:.0} starts with (1 + {} * {})^{} ends each)", b.most, b.chance, self.depth)
        });
        Err(format!(
            "{:.2e} nodes are to be expected{branching}, more than {MOST_NODES}: lower `depth`, `most` or `chance`",
            expected.nodes
        ))
    }

    /// `way`, drawn to the attractor: `strength * to it + (1 - strength) * way`, of length 1 again.
    fn attracted(&self, from: DVec3, way: DVec3) -> DVec3 {
        let Some(Attractor { at, strength }) = self.toward else { return way };
        let there = (at - from).try_normalize().unwrap_or(way);
        (there * strength + way * (1.0 - strength)).normalize_or(way)
    }

    fn is_open(&self, p: DVec3) -> bool {
        self.inside.as_ref().is_none_or(|inside| inside.contains(p))
    }

    /// Lets `tip` grow for the time `age`.
    fn grow_tip(&self, tip: &Tip, age: u32, stream: &Stream, growth: &mut Growth) {
        let Start { at, way, last, name } = tip.start;
        let mut random = stream.nth(name).nth(u64::from(age));
        let stem = self.attracted(at, strayed(way, self.jitter, &mut random));
        if !self.is_open(at + stem * self.step) {
            return;
        }
        let first = growth.tips.len();
        self.add(tip, Start { at, way: stem, last, name }, Some(tip.limb), age, growth);
        let Some(branches) = &self.branches else { return };
        let last = self.branch(branches, tip, age, 0, &mut random, growth);
        growth.tips[first].start.last = last;
    }

    /// Lets branches grow from `tip`, the first of them with the index `from`; the way of the last.
    fn branch(
        &self,
        branches: &Branches,
        tip: &Tip,
        age: u32,
        from: u32,
        random: &mut Stream,
        growth: &mut Growth,
    ) -> DVec3 {
        let Start { at, way, mut last, name } = tip.start;
        for index in from..from + branches.count(random) {
            let branch = self.attracted(at, branches.way(way, last, random));
            if self.is_open(at + branch * self.step) {
                last = branch;
                let start = Start { at, way: branch, last: DVec3::ZERO, name: branch_name(name, age, index) };
                self.add(tip, start, None, age, growth);
            }
        }
        last
    }

    /// Adds the node a step along the way of `start`, of a limb or of a new one.
    fn add(&self, tip: &Tip, start: Start, limb: Option<u32>, age: u32, growth: &mut Growth) {
        let at = start.at + start.way * self.step;
        let cost = f64::from(age + 1) * self.step;
        // New limbs have their place among those of this growth until all are known.
        let limb = limb.unwrap_or_else(|| {
            growth.limbs.push(start.name);
            NEW + growth.limbs.len() as u32 - 1
        });
        let node = growth.nodes.len() as u32;
        growth.nodes.push(SkeletonNode { branch: limb, ..SkeletonNode::new(at, Some(tip.node), cost, 0) });
        growth.tips.push(Tip { start: Start { at, ..start }, node, limb });
    }
}

/// Limbs from this number on are new, counted within their growth.
const NEW: u32 = 1 << 31;

/// A plant while it grows.
struct Growing {
    skeleton: Skeleton,
    tips: Vec<Tip>,
}

impl Growing {
    /// Adds what chunks of tips grew, in order.
    fn join(&mut self, growths: Vec<Growth>) {
        let nodes = &mut self.skeleton.nodes;
        let (first, limb) = (nodes.len(), self.skeleton.paths.len() as u32);
        let total: usize = growths.iter().map(|growth| growth.nodes.len()).sum();
        nodes.resize(first + total, SkeletonNode::new(DVec3::ZERO, None, 0.0, 0));
        self.tips.clear();
        self.tips.resize(total, Tip::default());
        let mut slots = Vec::with_capacity(growths.len());
        let (mut nodes, mut tips) = (&mut nodes[first..], &mut self.tips[..]);
        let (mut at, mut begun) = (first as u32, limb);
        for growth in &growths {
            let (own_nodes, other_nodes) = nodes.split_at_mut(growth.nodes.len());
            let (own_tips, other_tips) = tips.split_at_mut(growth.tips.len());
            slots.push((growth, own_nodes, own_tips, at, begun));
            at += growth.nodes.len() as u32;
            begun += growth.limbs.len() as u32;
            (nodes, tips) = (other_nodes, other_tips);
        }
        slots.into_par_iter().for_each(|(growth, nodes, tips, at, begun)| {
            let named = |limb: u32| if limb >= NEW { limb - NEW + begun } else { limb };
            for (slot, node) in nodes.iter_mut().zip(&growth.nodes) {
                *slot = SkeletonNode { branch: named(node.branch), ..*node };
            }
            for (slot, tip) in tips.iter_mut().zip(&growth.tips) {
                *slot = Tip { node: tip.node + at, limb: named(tip.limb), ..*tip };
            }
        });
        let names = growths.iter().flat_map(|growth| &growth.limbs);
        self.skeleton.paths.extend(names.map(|&name| Path { end: 0, class: 0, root: 0, name }));
    }
}

impl Step {
    /// Grows by segments.
    pub(super) fn grow_segments(
        &self,
        segments: &Segments,
        seed: u64,
        grown: &[Option<&Skeleton>],
        progress: &Progress,
    ) -> Result<Skeleton, GrowError> {
        let wrong = |key: &str, message: String| GrowError::Scene { place: format!("grow.{}.{key}", self.name), message };
        let stream = Stream::new(seed, &format!("segments/{}", self.name));
        let mut plant = Growing { skeleton: Skeleton::new(self.classes.clone()), tips: Vec::new() };
        let root = |start: Start, plant: &mut Growing| {
            let number = plant.skeleton.nodes.len() as u32;
            plant.skeleton.nodes.push(SkeletonNode { branch: number, ..SkeletonNode::new(start.at, None, 0.0, 0) });
            plant.skeleton.paths.push(Path { end: number, class: 0, root: number, name: start.name });
            Tip { start, node: number, limb: number }
        };
        let mut age = 0;
        if let Some(sprout) = &segments.sprout {
            let limbs = self.limbs_before(grown);
            let places: usize = limbs.iter().map(Vec::len).sum();
            segments.check(places as f64).map_err(|message| wrong("by.segments", message))?;
            let sprouted: Vec<Vec<(Start, Growth)>> =
                limbs.into_par_iter().map(|limb| segments.sprouts(sprout, limb, &stream)).collect();
            let sprouted: Vec<(Start, Growth)> = sprouted.into_iter().flatten().collect();
            let mut growths = Vec::with_capacity(sprouted.len());
            for (start, mut growth) in sprouted {
                let tip = root(start, &mut plant);
                for (node, tip_of) in growth.nodes.iter_mut().zip(&mut growth.tips) {
                    node.parent = Some(tip.node);
                    // The first carries on the limb of the root.
                    let limb = |limb: u32| if limb == NEW { tip.limb } else { limb - 1 };
                    (node.branch, tip_of.limb) = (limb(node.branch), limb(tip_of.limb));
                }
                plant.skeleton.paths[tip.limb as usize].name = growth.limbs.remove(0);
                growths.push(growth);
            }
            plant.join(growths);
            age = 1;
        } else {
            let starts = self.starts_of_limbs(segments.heading, grown)?;
            segments.check(starts.len() as f64).map_err(|message| wrong("by.segments", message))?;
            for start in starts {
                if !segments.is_open(start.at) && matches!(self.source, Source::At(_)) {
                    return Err(wrong("from.at", format!("the limb at {} starts outside of `inside`", start.at)));
                }
                let tip = root(start, &mut plant);
                plant.tips.push(tip);
            }
        }
        for age in age..segments.depth {
            let growths: Vec<Growth> = plant
                .tips
                .par_chunks(CHUNK)
                .map(|tips| {
                    let mut growth = Growth::default();
                    tips.iter().for_each(|tip| segments.grow_tip(tip, age, &stream, &mut growth));
                    growth
                })
                .collect();
            plant.join(growths);
            if plant.skeleton.nodes.len() as u64 > MOST_NODES {
                let message = format!("more than {MOST_NODES} nodes grow: lower `depth`, `most` or `chance`");
                return Err(wrong("by.segments", message));
            }
            if plant.tips.is_empty() {
                break;
            }
            progress.report("grow", f64::from(age + 1) / f64::from(segments.depth))?;
        }
        let mut skeleton = plant.skeleton;
        let Skeleton { nodes, paths, .. } = &mut skeleton;
        // The last node of each limb is its end; a limb that branches off has the root of what it leaves.
        for (node, i) in nodes.iter().zip(0_u32..) {
            let path = &mut paths[node.branch as usize];
            path.end = i;
        }
        Ok(skeleton)
    }
}

impl Segments {
    /// The sprouts along one limb, at each place where there are any; they avoid each other as branches do.
    fn sprouts(&self, sprout: &Branches, limb: Vec<Start>, stream: &Stream) -> Vec<(Start, Growth)> {
        let mut last = DVec3::ZERO;
        let mut all = Vec::new();
        for start in limb {
            let start = Start { last, ..start };
            let mut random = stream.nth(start.name).nth(0);
            let mut growth = Growth::default();
            let tip = Tip { start, node: 0, limb: 0 };
            last = self.branch(sprout, &tip, 0, 0, &mut random, &mut growth);
            if !growth.nodes.is_empty() {
                all.push((start, growth));
            }
        }
        all
    }
}
