//! Smoothing of positions along limbs.

use super::Skeleton;

/// Smooths positions along each limb with a standard deviation of `steps` lattice steps.
///
/// Roots and tips are fixed. A fork has one position, that of its main limb, so branching points stay together. The kernel is
/// `[1 2 1] / 4`, with a variance of half a step.
pub fn smooth(skeleton: &mut Skeleton, steps: f64) {
    let passes = libm::round(2.0 * steps * steps) as u32;
    let main = skeleton.main_children();
    let mut next: Vec<_> = skeleton.nodes.iter().map(|n| n.position).collect();
    for _ in 0..passes {
        for (i, node) in skeleton.nodes.iter().enumerate() {
            let (Some(before), Some(after)) = (node.parent, main[i]) else { continue };
            let [before, after] = [before, after].map(|n| skeleton.nodes[n as usize].position);
            next[i] = (before + node.position * 2.0 + after) * 0.25;
        }
        for (node, &position) in skeleton.nodes.iter_mut().zip(&next) {
            node.position = position;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::super::measure;
    use super::*;

    #[test]
    fn a_staircase_becomes_a_line() {
        let stairs: Vec<_> = (0..41).rev().map(|i| ((i + 1) / 2, i / 2)).collect();
        let mut s = skeleton(&[&stairs]);
        let before = measure(&s).tortuosity;
        let ends = (s.nodes[0].position, s.nodes[40].position);
        smooth(&mut s, 2.0);
        let after = measure(&s).tortuosity;
        assert!(before > 1.4 && after < 1.01, "{before} {after}");
        assert_eq!((s.nodes[0].position, s.nodes[40].position), ends);
    }
}
