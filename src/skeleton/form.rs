//! Natural limbs: what belongs together is one limb, kinks become curves, forks blend, roots flare.

use schemars::JsonSchema;
use serde::Deserialize;

use super::plant::{Plant, PlantNode, way};
use super::{SkeletonNode, Width};
use crate::math::DVec3;

/// A limb turns by at most about this much from one segment to the next: cosine of 9 degrees.
const TURN_COS: f64 = 0.987_688_340_595_138;
/// A node is left out where the limb turns by less than this since the last one kept: cosine of 4 degrees.
const STRAIGHT_COS: f64 = 0.997_564_050_259_824;
/// And where its radius has changed by less than this share.
const SAME_RADIUS: f64 = 0.12;
/// Most pieces that a segment is cut into for its bend.
const MOST_BENDS: u32 = 6;

/// How natural limbs are.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FormSpec {
    /// Positions are averaged along limbs over about this many nodes to either side; 0 leaves the kinks of the graph.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub smoothness: f64,
    /// How near limbs that run side by side are taken for one: less than this share of their radii together. 0 joins none.
    #[schemars(range(min = 0.0, max = 4.0))]
    pub merge: f64,
    /// How much thicker a limb is where it leaves another, as a share of its radius.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub collar: f64,
    /// Radius at the foot over what it would be.
    #[schemars(range(min = 1.0, max = 5.0))]
    pub flare: f64,
}

impl Default for FormSpec {
    fn default() -> Self {
        Self { smoothness: 1.5, merge: 1.35, collar: 0.35, flare: 1.5 }
    }
}

/// How natural limbs are.
pub type Form = FormSpec;

/// Limbs are averaged over this many of their radii.
const THICK: f64 = 1.3;
/// But over no more nodes than this to either side.
const MOST_SPREAD: f64 = 5.0;
/// A collar reaches this many radii of the limb out of the one that it leaves.
const COLLAR_REACH: f64 = 3.0;
/// A flare reaches this many radii of the root up.
const FLARE_REACH: f64 = 3.5;

impl Form {
    pub(super) fn apply(&self, plant: &mut Plant, width: &Width) {
        if self.merge > 0.0 {
            plant.merge(self.merge);
            plant.thicken(width);
        }
        plant.even_radii();
        plant.part_limbs();
        plant.smooth(self.smoothness);
        plant.swell(self);
        plant.resample();
    }
}

impl Plant {
    /// Radii never grow towards the tip, whatever merging has done.
    fn even_radii(&mut self) {
        for i in 0..self.nodes.len() {
            if let Some(parent) = self.nodes[i].node.parent {
                let most = self.nodes[parent as usize].node.radius;
                let radius = &mut self.nodes[i].node.radius;
                if *radius > most {
                    *radius = most;
                }
            }
        }
    }

    /// Every limb that leaves another starts with a node of its own where it does, as thin as it is itself: so the frustum
    /// to its next node stays within the other limb instead of beginning as wide as that.
    fn part_limbs(&mut self) {
        let main = self.main_children();
        let mut nodes: Vec<PlantNode> = Vec::with_capacity(self.nodes.len());
        let mut renamed: Vec<u32> = Vec::with_capacity(self.nodes.len());
        for (i, own) in self.nodes.iter().enumerate() {
            let mut own = *own;
            if let Some(p) = own.node.parent {
                let fork = self.nodes[p as usize].node;
                let mut parent = renamed[p as usize];
                if main[p as usize] != Some(i as u32) {
                    let start =
                        SkeletonNode { position: fork.position, parent: Some(parent), cost: fork.cost, ..own.node };
                    parent = nodes.len() as u32;
                    nodes.push(PlantNode { node: start, part: own.part, reach: own.reach + self.step(i) });
                }
                own.node.parent = Some(parent);
            }
            renamed.push(nodes.len() as u32);
            nodes.push(own);
        }
        self.nodes = nodes;
        for end in &mut self.ends {
            end.path.end = renamed[end.path.end as usize];
            end.path.root = renamed[end.path.root as usize];
        }
    }

    /// Does a limb start at node `i`, where it leaves another?
    fn is_start(&self, i: usize) -> bool {
        self.nodes[i].node.parent.is_some_and(|p| self.nodes[p as usize].node.position == self.nodes[i].node.position)
    }

    /// For each node the next of its limb.
    fn next_along(&self) -> Vec<Option<u32>> {
        let mut next = vec![None; self.nodes.len()];
        for i in 0..self.nodes.len() {
            if let Some(p) = self.nodes[i].node.parent
                && !self.is_start(i)
            {
                next[p as usize] = Some(i as u32);
            }
        }
        next
    }

    /// Averages positions along limbs, over about so many `nodes` to either side, and where limbs are thicker than that over
    /// as many as their thickness takes: a limb does not wind within its own thickness. A limb that leaves another stays
    /// with it. The kernel is `[1 2 1] / 4`, whose variance is half a step.
    fn smooth(&mut self, nodes: f64) {
        if nodes <= 0.0 {
            return;
        }
        let starts: Vec<bool> = (0..self.nodes.len()).map(|i| self.is_start(i)).collect();
        let next = self.next_along();
        let passes: Vec<u32> = (0..self.nodes.len())
            .map(|i| {
                let thick = self.nodes[i].node.radius * THICK / self.step(i).max(f64::MIN_POSITIVE);
                let spread = nodes.max(thick.min(MOST_SPREAD));
                libm::round(2.0 * spread * spread) as u32
            })
            .collect();
        let mut before: Vec<DVec3> = self.nodes.iter().map(|n| n.node.position).collect();
        for pass in 0..passes.iter().copied().max().unwrap_or(0) {
            for i in 0..self.nodes.len() {
                let Some(p) = self.nodes[i].node.parent else { continue };
                if starts[i] {
                    self.nodes[i].node.position = self.nodes[p as usize].node.position;
                } else if let Some(n) = next[i].filter(|_| pass < passes[i]) {
                    self.nodes[i].node.position = (before[p as usize] + before[i] * 2.0 + before[n as usize]) * 0.25;
                }
            }
            before.iter_mut().zip(&self.nodes).for_each(|(to, node)| *to = node.node.position);
        }
    }

    /// Collars and the flare of the root: both fall off to nothing, and keep radii from growing towards the tip.
    fn swell(&mut self, form: &Form) {
        // For each node: how far along its limb, the radius where that starts, and that of the limb it leaves.
        let mut along: Vec<(f64, f64, f64)> = Vec::with_capacity(self.nodes.len());
        let fall = |x: f64| if x < 1.0 { (1.0 - x) * (1.0 - x) } else { 0.0 };
        // Level at first: the ball at the foot must not stand out.
        let bell = |x: f64| fall(x * x);
        for i in 0..self.nodes.len() {
            let node = self.nodes[i].node;
            let here = match node.parent {
                None => (0.0, node.radius, 0.0),
                Some(p) if self.is_start(i) => {
                    let other = self.nodes[p as usize].node.radius;
                    (0.0, node.radius, other)
                }
                Some(p) => {
                    let (length, start, other) = along[p as usize];
                    (length + self.step(i), start, other)
                }
            };
            along.push(here);
        }
        let roots: Vec<bool> = {
            let mut roots: Vec<bool> = Vec::with_capacity(self.nodes.len());
            for i in 0..self.nodes.len() {
                let is_root = match self.nodes[i].node.parent {
                    None => true,
                    Some(p) => roots[p as usize] && !self.is_start(i),
                };
                roots.push(is_root);
            }
            roots
        };
        for i in 0..self.nodes.len() {
            let (length, start, other) = along[i];
            let extra = if roots[i] {
                start * (form.flare - 1.0) * bell(length / (FLARE_REACH * start).max(f64::MIN_POSITIVE))
            } else {
                start * form.collar * fall(length / (other + COLLAR_REACH * start).max(f64::MIN_POSITIVE))
            };
            let parent = self.nodes[i].node.parent.map_or(f64::INFINITY, |p| self.nodes[p as usize].node.radius);
            let radius = self.nodes[i].node.radius + extra;
            self.nodes[i].node.radius = if radius < parent { radius } else { parent };
        }
    }

    /// Leaves out nodes where limbs are straight, and adds some along a spline where they bend.
    fn resample(&mut self) {
        let next = self.next_along();
        let mut forks = vec![false; self.nodes.len()];
        for i in 0..self.nodes.len() {
            if let Some(p) = self.nodes[i].node.parent
                && self.is_start(i)
            {
                forks[p as usize] = true;
                forks[i] = true;
            }
        }
        for end in &self.ends {
            forks[end.path.end as usize] = true;
            forks[end.path.root as usize] = true;
        }
        // Which are kept, and for each the last one kept before it and the way it came from there.
        let mut last: Vec<u32> = Vec::with_capacity(self.nodes.len());
        let mut came: Vec<DVec3> = Vec::with_capacity(self.nodes.len());
        let mut kept: Vec<bool> = Vec::with_capacity(self.nodes.len());
        for i in 0..self.nodes.len() {
            let node = self.nodes[i].node;
            let Some(p) = node.parent else {
                last.push(i as u32);
                came.push(DVec3::ZERO);
                kept.push(true);
                continue;
            };
            let before = if kept[p as usize] { p } else { last[p as usize] };
            let from = self.nodes[before as usize].node;
            let first = if kept[p as usize] || came[p as usize] == DVec3::ZERO {
                way(self.nodes[p as usize].node.position, node.position)
            } else {
                came[p as usize]
            };
            let is_straight = next[i].is_some_and(|n| {
                let on = way(node.position, self.nodes[n as usize].node.position);
                first.dot(on) > STRAIGHT_COS
            });
            let is_same = from.radius - node.radius < SAME_RADIUS * from.radius;
            let is_other = next[i].is_some_and(|n| {
                let (own, n) = (&self.nodes[i], &self.nodes[n as usize]);
                own.part != n.part || own.node.level != n.node.level
            });
            kept.push(forks[i] || is_other || !is_straight || !is_same || self.is_start(i));
            last.push(before);
            came.push(first);
        }
        let mut nodes: Vec<PlantNode> = Vec::new();
        let mut renamed: Vec<u32> = vec![u32::MAX; self.nodes.len()];
        let after = |mut i: usize| loop {
            let n = next[i]?;
            if kept[n as usize] {
                return Some(self.nodes[n as usize].node.position);
            }
            i = n as usize;
        };
        for i in 0..self.nodes.len() {
            if !kept[i] {
                continue;
            }
            let mut own = self.nodes[i];
            if own.node.parent.is_some() {
                let from_index = last[i] as usize;
                let from = self.nodes[from_index].node;
                let mut parent = renamed[from_index];
                if !self.is_start(i) {
                    let (a, b) = (from.position, own.node.position);
                    // A limb that leaves another begins in the direction of both.
                    let mut back = from_index;
                    if self.is_start(back) {
                        back = self.nodes[back].node.parent.map_or(back, |p| p as usize);
                    }
                    let before = self.nodes[back].node.parent.map(|_| self.nodes[last[back] as usize].node.position);
                    let before = before.filter(|&p| p != a).unwrap_or(a + a - b);
                    let after = after(i).unwrap_or(b + b - a);
                    let turn = |x: DVec3, y: DVec3| x.dot(y);
                    let on = way(a, b);
                    let sharpest = turn(way(before, a), on).min(turn(on, way(b, after)));
                    let pieces = libm::ceil(libm::sqrt((1.0 - sharpest.clamp(-1.0, 1.0)) / (1.0 - TURN_COS))) as u32;
                    let pieces = pieces.clamp(1, MOST_BENDS);
                    for piece in 1..pieces {
                        let t = f64::from(piece) / f64::from(pieces);
                        let mix = |x: f64, y: f64| x * (1.0 - t) + y * t;
                        let node = SkeletonNode {
                            position: hermite([before, a, b, after], t),
                            parent: Some(parent),
                            cost: mix(from.cost, own.node.cost),
                            radius: mix(from.radius, own.node.radius).clamp(own.node.radius, from.radius),
                            ..own.node
                        };
                        parent = nodes.len() as u32;
                        nodes.push(PlantNode { node, ..own });
                    }
                }
                own.node.parent = Some(parent);
            }
            renamed[i] = nodes.len() as u32;
            nodes.push(own);
        }
        self.nodes = nodes;
        for end in &mut self.ends {
            end.path.end = renamed[end.path.end as usize];
            end.path.root = renamed[end.path.root as usize];
        }
    }
}

/// A cubic from p1 (t = 0) to p2 (t = 1) whose ends are directed as a Catmull-Rom spline's, but no longer than the piece
/// itself: neighbours may be near or far.
fn hermite([p0, p1, p2, p3]: [DVec3; 4], t: f64) -> DVec3 {
    let length = (p2 - p1).length();
    let tangent =
        |before: DVec3, at: DVec3, after: DVec3| (way(before, at) + way(at, after)).normalize_or_zero() * length;
    let (m1, m2) = (tangent(p0, p1, p2), tangent(p1, p2, p3));
    let (t2, t3) = (t * t, t * t * t);
    p1 * (2.0 * t3 - 3.0 * t2 + 1.0) + m1 * (t3 - 2.0 * t2 + t) + p2 * (3.0 * t2 - 2.0 * t3) + m2 * (t3 - t2)
}
