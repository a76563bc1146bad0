//! Relations of two skeletons: crossings, distances, shared ends.

use std::collections::{HashMap, HashSet};

use super::Skeleton;
use crate::geom::segment_parameter;
use crate::math::DVec3;

/// The number of roots of `of` that coincide with no node of `on`.
#[must_use]
pub fn floating(of: &Skeleton, on: &Skeleton) -> usize {
    let bits = |p: DVec3| p.to_array().map(f64::to_bits);
    let places: HashSet<[u64; 3]> = on.nodes.iter().map(|n| bits(n.position)).collect();
    of.nodes.iter().filter(|n| n.parent.is_none() && !places.contains(&bits(n.position))).count()
}

/// The number of crossings of segments of `one` with segments of `other`, projected along z; for one and the same skeleton, of
/// its self-crossings, adjacent segments excepted.
#[must_use]
pub fn crossings(one: &Skeleton, other: &Skeleton) -> usize {
    let is_self = std::ptr::eq(one, other);
    let segments = |s: &Skeleton| -> Vec<(u32, u32)> {
        (0..).zip(&s.nodes).filter_map(|(i, n): (u32, _)| Some((n.parent?, i))).collect()
    };
    let (ours, theirs) = (segments(one), segments(other));
    let at = |s: &Skeleton, i: u32| s.nodes[i as usize].position;
    if ours.is_empty() || theirs.is_empty() {
        return 0;
    }
    let length = |s: &Skeleton, &(a, b): &(u32, u32)| (at(s, b) - at(s, a)).length();
    let longest = |s: &Skeleton, segments: &[(u32, u32)]| segments.iter().map(|e| length(s, e)).fold(0.0, f64::max);
    let cell = longest(one, &ours).max(longest(other, &theirs)).max(f64::MIN_POSITIVE);
    let key = |p: DVec3| [p.x, p.y].map(|c| libm::floor(c / cell) as i64);
    let mut cells: HashMap<[i64; 2], Vec<(u32, u32)>> = HashMap::new();
    for &(a, b) in &theirs {
        cells.entry(key((at(other, a) + at(other, b)) * 0.5)).or_default().push((a, b));
    }
    let mut count = 0;
    for &(a, b) in &ours {
        let (p, q) = (at(one, a), at(one, b));
        let (low, high) = (key(p.min(q) - cell), key(p.max(q) + cell));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for &(c, d) in cells.get(&[x, y]).into_iter().flatten() {
                    let is_near = is_self && (a == c || a == d || b == c || b == d);
                    count += usize::from(!is_near && cross(p, q, at(other, c), at(other, d)));
                }
            }
        }
    }
    if is_self { count / 2 } else { count }
}

/// Do the interiors of two segments cross, projected along z?
fn cross(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> bool {
    let side = |p: DVec3, q: DVec3, r: DVec3| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// The greatest distance of a node of `of` from the limbs of `from`; infinite where these are none.
#[must_use]
pub fn apart(of: &Skeleton, from: &Skeleton) -> f64 {
    of.nodes.iter().map(|n| distance(n.position, from)).fold(0.0, f64::max)
}

/// The least distance of a node of `of` from the limbs of `from`; infinite where these are none.
#[must_use]
pub fn nearest(of: &Skeleton, from: &Skeleton) -> f64 {
    of.nodes.iter().map(|n| distance(n.position, from)).fold(f64::INFINITY, f64::min)
}

/// The distance of `p` from the limbs of `from`.
fn distance(p: DVec3, from: &Skeleton) -> f64 {
    from.segments()
        .map(|(a, b)| {
            let t = segment_parameter(p, a.position, b.position);
            (a.position + (b.position - a.position) * t).distance(p)
        })
        .fold(f64::INFINITY, f64::min)
}

/// The share of the ends of `of` that coincide with ends of `with`.
#[must_use]
pub fn shared_ends(of: &Skeleton, with: &Skeleton) -> f64 {
    let ends = |s: &Skeleton| -> Vec<DVec3> { s.paths.iter().map(|p| s.nodes[p.end as usize].position).collect() };
    let (own, other) = (ends(of), ends(with));
    own.iter().filter(|p| other.contains(p)).count() as f64 / own.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::*;

    #[test]
    fn crossings_are_counted_once() {
        let cross = skeleton(&[&[(0, 2), (2, 0)], &[(0, 0), (2, 2)]]);
        assert_eq!(crossings(&cross, &cross), 1);
        let (one, other) = (skeleton(&[&[(0, 2), (2, 0)]]), skeleton(&[&[(0, 0), (2, 2)]]));
        assert_eq!(crossings(&one, &other), 1);
        assert_eq!(floating(&one, &other), 1);
        assert_eq!(floating(&one, &one), 0);
        assert!((apart(&one, &other) - 2.0_f64.sqrt()).abs() < 1e-12);
        let comb = skeleton(&[&[(0, 3), (0, 2), (0, 1), (0, 0)], &[(1, 2), (0, 1), (0, 0)]]);
        assert_eq!(crossings(&comb, &comb), 0);
        let dots = skeleton(&[&[(0, 0)], &[(5, 5)]]);
        assert_eq!((crossings(&comb, &dots), crossings(&dots, &comb)), (0, 0));
    }
}
