//! Allometry: how the width of limbs goes with their length.

use super::Skeleton;
use crate::math::slope;

/// The exponent x of `radius = c * reach^x`, where the reach of a node is the length of the longest path from it to a tip: by
/// least squares of logarithms over the forks of `skeleton`, 0 where there are fewer than two. Limbs that bend alike under
/// their own weight have 1.5 (elastic similarity, McMahon and Kronauer 1976).
#[must_use]
pub fn width_exponent(skeleton: &Skeleton) -> f64 {
    let mut reach = vec![0.0_f64; skeleton.nodes.len()];
    for i in (0..reach.len()).rev() {
        if let Some(parent) = skeleton.nodes[i].parent {
            let step = skeleton.nodes[i].position.distance(skeleton.nodes[parent as usize].position);
            reach[parent as usize] = reach[parent as usize].max(reach[i] + step);
        }
    }
    let children = skeleton.child_counts();
    let points: Vec<(f64, f64)> = (0..reach.len())
        .filter(|&i| children[i] > 1 && reach[i] > 0.0 && skeleton.nodes[i].radius > 0.0)
        .map(|i| (libm::log(reach[i]), libm::log(skeleton.nodes[i].radius)))
        .collect();
    slope(&points)
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::*;

    #[test]
    fn widths_by_a_power_have_its_exponent() {
        // A stem with a side limb at every node.
        let paths: Vec<Vec<(i32, i32)>> =
            (0..20).map(|y| [(1, y)].into_iter().chain((0..=y).rev().map(|y| (0, y))).collect()).collect();
        let paths: Vec<&[(i32, i32)]> = paths.iter().map(|path| &path[..]).collect();
        let mut s = skeleton(&paths);
        let reach = |y: f64| 20.0 - y;
        s.nodes.iter_mut().for_each(|node| node.radius = 0.01 * libm::pow(reach(node.position.y), 1.5));
        assert!((width_exponent(&s) - 1.5).abs() < 1e-9, "{}", width_exponent(&s));
    }
}
