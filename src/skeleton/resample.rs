//! Adaptive resampling of a plant's limbs: nodes go where limbs are straight, and come along a spline where they bend.

use super::SkeletonNode;
use super::plant::{Plant, PlantNode, direction};
use crate::math::DVec3;

/// Greatest turn from one segment to the next, about: cosine of 9 degrees.
const TURN_COS: f64 = 0.987_688_340_595_138;
/// Greatest turn since the last kept node at which a node is dropped: cosine of 4 degrees.
const STRAIGHT_COS: f64 = 0.997_564_050_259_824;
/// Greatest relative change of the radius since the last kept node at which a node is dropped.
const SAME_RADIUS: f64 = 0.12;
/// Most pieces of a segment.
const MOST_BENDS: u32 = 6;

/// Which nodes are kept.
#[derive(Default)]
struct Kept {
    is_kept: Vec<bool>,
    /// The last kept node before each.
    last: Vec<u32>,
    /// The direction in which the limb left that node.
    leaving: Vec<DVec3>,
}

impl Plant {
    /// Resamples all limbs by their curvature and change of radius.
    pub(super) fn resample(&mut self) {
        let next = self.next_along();
        let kept = self.kept(&next);
        let mut nodes: Vec<PlantNode> = Vec::new();
        let mut renamed: Vec<u32> = vec![u32::MAX; self.nodes.len()];
        for i in (0..self.nodes.len()).filter(|&i| kept.is_kept[i]) {
            let mut own = self.nodes[i];
            if own.node.parent.is_some() {
                let mut parent = renamed[kept.last[i] as usize];
                if !self.is_start(i) {
                    for node in self.bend(i, &next, &kept) {
                        let node = SkeletonNode { parent: Some(parent), ..node };
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

    /// Nodes that must be kept: forks, first nodes of limbs, ends and roots of paths.
    fn fixed(&self) -> Vec<bool> {
        let mut fixed = vec![false; self.nodes.len()];
        for i in 0..self.nodes.len() {
            if let Some(p) = self.nodes[i].node.parent
                && self.is_start(i)
            {
                fixed[p as usize] = true;
                fixed[i] = true;
            }
        }
        for end in &self.ends {
            fixed[end.path.end as usize] = true;
            fixed[end.path.root as usize] = true;
        }
        fixed
    }

    /// Decides, from the roots outwards, which nodes are kept.
    fn kept(&self, next: &[Option<u32>]) -> Kept {
        let fixed = self.fixed();
        let mut kept = Kept::default();
        for i in 0..self.nodes.len() {
            let node = self.nodes[i].node;
            let Some(p) = node.parent else {
                kept.last.push(i as u32);
                kept.leaving.push(DVec3::ZERO);
                kept.is_kept.push(true);
                continue;
            };
            let is_parent_kept = kept.is_kept[p as usize];
            let before = if is_parent_kept { p } else { kept.last[p as usize] };
            let from = self.nodes[before as usize].node;
            let first = if is_parent_kept || kept.leaving[p as usize] == DVec3::ZERO {
                direction(self.nodes[p as usize].node.position, node.position)
            } else {
                kept.leaving[p as usize]
            };
            let is_straight = next[i].is_some_and(|n| {
                let on = direction(node.position, self.nodes[n as usize].node.position);
                first.dot(on) > STRAIGHT_COS
            });
            let is_same = from.radius - node.radius < SAME_RADIUS * from.radius;
            let is_other = next[i].is_some_and(|n| {
                let (own, n) = (&self.nodes[i], &self.nodes[n as usize]);
                own.part != n.part || own.node.level != n.node.level
            });
            kept.is_kept.push(fixed[i] || is_other || !is_straight || !is_same || self.is_start(i));
            kept.last.push(before);
            kept.leaving.push(first);
        }
        kept
    }

    /// The nodes to be added before node `i`, along the spline from the last kept one; parents are not set.
    fn bend(&self, i: usize, next: &[Option<u32>], kept: &Kept) -> Vec<SkeletonNode> {
        let own = self.nodes[i].node;
        let from_index = kept.last[i] as usize;
        let from = self.nodes[from_index].node;
        let (a, b) = (from.position, own.position);
        // A limb that leaves another starts in the mean direction of both.
        let mut back = from_index;
        if self.is_start(back) {
            back = self.nodes[back].node.parent.map_or(back, |p| p as usize);
        }
        let before = self.nodes[back].node.parent.map(|_| self.nodes[kept.last[back] as usize].node.position);
        let before = before.filter(|&p| p != a).unwrap_or(a + a - b);
        let mut following = std::iter::successors(next[i], |&n| next[n as usize]);
        let after = following.find(|&n| kept.is_kept[n as usize]);
        let after = after.map_or(b + b - a, |n| self.nodes[n as usize].node.position);
        let on = direction(a, b);
        let sharpest = direction(before, a).dot(on).min(on.dot(direction(b, after)));
        // The angle in units of 9 degrees, by 1 - cos t = t^2 / 2.
        let pieces = libm::ceil(libm::sqrt((1.0 - sharpest.clamp(-1.0, 1.0)) / (1.0 - TURN_COS))) as u32;
        let pieces = pieces.clamp(1, MOST_BENDS);
        let node = |piece: u32| {
            let t = f64::from(piece) / f64::from(pieces);
            let lerp = |x: f64, y: f64| x * (1.0 - t) + y * t;
            SkeletonNode {
                position: hermite([before, a, b, after], t),
                cost: lerp(from.cost, own.cost),
                radius: lerp(from.radius, own.radius).clamp(own.radius, from.radius),
                ..own
            }
        };
        (1..pieces).map(node).collect()
    }
}

/// The cubic Hermite spline from p1 (t = 0) to p2 (t = 1) with tangents in the directions of a Catmull-Rom spline's, but as
/// long as the piece itself: neighbours may be near or far.
fn hermite([p0, p1, p2, p3]: [DVec3; 4], t: f64) -> DVec3 {
    let length = (p2 - p1).length();
    let tangent = |before: DVec3, at: DVec3, after: DVec3| {
        (direction(before, at) + direction(at, after)).normalize_or_zero() * length
    };
    let (m1, m2) = (tangent(p0, p1, p2), tangent(p1, p2, p3));
    let (t2, t3) = (t * t, t * t * t);
    p1 * (2.0 * t3 - 3.0 * t2 + 1.0) + m1 * (t3 - 2.0 * t2 + t) + p2 * (3.0 * t2 - 2.0 * t3) + m2 * (t3 - t2)
}
