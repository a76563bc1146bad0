//! Resampling along a spline through the nodes.

use super::{Skeleton, SkeletonNode};
use crate::math::DVec3;

/// Greatest turn from one segment to the next, about: cosine of 10 degrees.
const BEND_COS: f64 = 0.984_807_753_012_208;
/// Most pieces of a segment.
const MOST_BENDS: u32 = 6;

/// Adds nodes where limbs bend, so that no turn between segments is sharper than about 10 degrees.
#[must_use]
pub fn bend(skeleton: &Skeleton) -> Skeleton {
    let main = skeleton.main_children();
    resample(
        skeleton,
        |from, to, i| {
            let turn = |a: DVec3, b: DVec3| {
                let (a, b) = (a.normalize_or_zero(), b.normalize_or_zero());
                a.dot(b).clamp(-1.0, 1.0)
            };
            let on = to.position - from.position;
            let before = from.parent.map(|p| turn(from.position - skeleton.nodes[p as usize].position, on));
            let after = main[i].map(|n| turn(on, skeleton.nodes[n as usize].position - to.position));
            let sharpest = before.unwrap_or(1.0).min(after.unwrap_or(1.0));
            // The angle in units of ten degrees, by 1 - cos t = t^2 / 2.
            libm::ceil(libm::sqrt((1.0 - sharpest) / (1.0 - BEND_COS))) as u32
        },
        MOST_BENDS,
    )
}

/// Adds nodes so that neighbours are no further apart than `share` of the smaller radius: spheres that overlap to a limb. A
/// segment has at most `most` pieces.
#[must_use]
pub fn overlap(skeleton: &Skeleton, share: f64, most: u32) -> Skeleton {
    resample(skeleton, |from, to, _| overlap_pieces(from, to, share, most), most)
}

/// How many nodes [`overlap`] yields.
#[must_use]
pub fn overlap_count(skeleton: &Skeleton, share: f64, most: u32) -> u64 {
    let pieces = |node: &SkeletonNode| {
        let from = node.parent.map(|parent| &skeleton.nodes[parent as usize]);
        u64::from(from.map_or(1, |from| overlap_pieces(from, node, share, most).clamp(1, most)))
    };
    skeleton.nodes.iter().map(pieces).sum()
}

/// Pieces of a segment that are no longer than `share` of the lesser radius.
fn overlap_pieces(from: &SkeletonNode, to: &SkeletonNode, share: f64, most: u32) -> u32 {
    let gap = from.radius.min(to.radius) * share;
    let pieces = (to.position - from.position).length() / gap;
    if pieces.is_finite() { libm::ceil(pieces).min(f64::from(most)) as u32 } else { most }
}

/// Divides the segment to each node into `pieces` pieces, along a Catmull-Rom spline through the nodes of its limb; cost and
/// radius are interpolated linearly.
fn resample(skeleton: &Skeleton, pieces: impl Fn(&SkeletonNode, &SkeletonNode, usize) -> u32, most: u32) -> Skeleton {
    let main = skeleton.main_children();
    let mut renamed: Vec<u32> = Vec::with_capacity(skeleton.nodes.len());
    let mut nodes = Vec::with_capacity(skeleton.nodes.len());
    for (i, node) in skeleton.nodes.iter().enumerate() {
        let mut parent = node.parent.map(|p| renamed[p as usize]);
        if let Some(p) = node.parent {
            let from = &skeleton.nodes[p as usize];
            let count = pieces(from, node, i).clamp(1, most);
            let (a, b) = (from.position, node.position);
            // Beyond an end the limb is extrapolated.
            let before = from.parent.map_or(a + a - b, |g| skeleton.nodes[g as usize].position);
            let after = main[i].map_or(b + b - a, |n| skeleton.nodes[n as usize].position);
            for piece in 1..count {
                let t = f64::from(piece) / f64::from(count);
                let lerp = |x: f64, y: f64| x * (1.0 - t) + y * t;
                nodes.push(SkeletonNode {
                    position: catmull_rom([before, a, b, after], t),
                    parent,
                    cost: lerp(from.cost, node.cost),
                    radius: lerp(from.radius, node.radius),
                    ..*node
                });
                parent = Some(nodes.len() as u32 - 1);
            }
        }
        renamed.push(nodes.len() as u32);
        nodes.push(SkeletonNode { parent, ..*node });
    }
    let mut paths = skeleton.paths.clone();
    for path in &mut paths {
        path.end = renamed[path.end as usize];
        path.root = renamed[path.root as usize];
    }
    Skeleton { nodes, paths, classes: skeleton.classes.clone() }
}

/// The uniform Catmull-Rom spline from p1 (t = 0) to p2 (t = 1) (Catmull and Rom 1974).
fn catmull_rom([p0, p1, p2, p3]: [DVec3; 4], t: f64) -> DVec3 {
    let (t2, t3) = (t * t, t * t * t);
    (p1 * 2.0 + (p2 - p0) * t + (p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3) * t2 + (p1 * 3.0 - p0 - p2 * 3.0 + p3) * t3) * 0.5
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::*;

    #[test]
    fn spheres_overlap() {
        let mut s = skeleton(&[&[(0, 3), (0, 2), (1, 1), (0, 0)], &[(3, 3), (2, 2), (1, 1), (0, 0)]]);
        s.nodes.iter_mut().for_each(|n| n.radius = 0.1);
        let dense = overlap(&s, 0.5, 100);
        assert_eq!(dense.paths.len(), 2);
        for (from, to) in dense.segments() {
            assert!((to.position - from.position).length() < 0.06);
        }
        for path in &s.paths {
            let end = s.nodes[path.end as usize].position;
            assert!(dense.paths.iter().any(|p| dense.nodes[p.end as usize].position == end));
        }
    }

    #[test]
    fn bends_are_rounded() {
        let s = skeleton(&[&[(2, 2), (1, 2), (0, 2), (0, 1), (0, 0)]]);
        let round = bend(&s);
        assert!(round.nodes.len() > s.nodes.len());
        assert!(round.nodes.iter().enumerate().all(|(i, n)| n.parent.is_none_or(|p| (p as usize) < i)));
    }
}
