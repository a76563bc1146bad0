//! Box-counting (Minkowski) dimension.

use std::collections::HashSet;

use super::Skeleton;
use crate::math::{DVec3, slope};

/// log2 of the boxes along the side, 8 to 128: smaller boxes would resolve single limbs, which are lines.
const SCALES: std::ops::RangeInclusive<u32> = 3..=7;

/// The box-counting dimension of the union of `skeletons`: 1 for a line, 2 for a filled plane, about 1.34 for photographed
/// lightning; 0 for an empty one.
#[must_use]
pub fn dimension(skeletons: &[&Skeleton]) -> f64 {
    let nodes = || skeletons.iter().flat_map(|s| &s.nodes).map(|n| n.position);
    let low = nodes().fold(DVec3::INFINITY, DVec3::min);
    let high = nodes().fold(DVec3::NEG_INFINITY, DVec3::max);
    let size = (high - low).max_element();
    if size.is_nan() || size <= 0.0 {
        return 0.0;
    }
    let points: Vec<(f64, f64)> = SCALES
        .map(|scale| {
            let boxes = f64::from(1_u32 << scale);
            let edge = size / boxes;
            let mut met: HashSet<[i64; 3]> = HashSet::new();
            for (from, to) in skeletons.iter().flat_map(|s| s.segments()) {
                let segment = to.position - from.position;
                let steps = libm::ceil(segment.length() / edge * 8.0).max(1.0) as u32;
                for step in 0..=steps {
                    let p = from.position + segment * (f64::from(step) / f64::from(steps)) - low;
                    met.insert((p / edge).to_array().map(|c| libm::floor(c) as i64));
                }
            }
            (libm::log(boxes), libm::log((met.len().max(1)) as f64))
        })
        .collect();
    slope(&points)
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::*;

    #[test]
    fn lines_have_one_and_combs_more() {
        let line: Vec<_> = (0..200).rev().map(|i| (i, i)).collect();
        assert!((dimension(&[&skeleton(&[&line])]) - 1.0).abs() < 0.06);
        // Every column of a square: nearly filled.
        let comb: Vec<Vec<(i32, i32)>> =
            (0..128).map(|x| (0..128).rev().map(|y| (x, y)).chain((0..x).rev().map(|x| (x, 0))).collect()).collect();
        let comb: Vec<&[(i32, i32)]> = comb.iter().map(|path| &path[..]).collect();
        assert!((dimension(&[&skeleton(&comb)]) - 2.0).abs() < 0.1);
    }
}
