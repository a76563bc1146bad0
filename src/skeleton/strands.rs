//! Strands: every path as a curve of its own, for hair and moss (Xu and Mould 2007, Fig. 15).

use super::{Path, Skeleton, SkeletonNode};

impl Skeleton {
    /// Every path as a strand of `pieces` (1 or more) straight segments from its root to its end, at equal intervals of its
    /// nodes; costs are interpolated.
    #[must_use]
    pub fn strands(&self, pieces: u32) -> Self {
        let mut strands = Self { classes: self.classes.clone(), ..Self::default() };
        strands.nodes.reserve(self.paths.len() * (pieces as usize + 1));
        strands.paths.reserve(self.paths.len());
        let mut nodes: Vec<&SkeletonNode> = Vec::new();
        for path in &self.paths {
            let parent = |node: &SkeletonNode| node.parent.map(|p| p as usize);
            nodes.clear();
            nodes.extend(
                std::iter::successors(Some(path.end as usize), |&at| parent(&self.nodes[at])).map(|at| &self.nodes[at]),
            );
            // A path of one node is invisible.
            if nodes.len() < 2 {
                continue;
            }
            nodes.reverse();
            let root = strands.nodes.len() as u32;
            let last = nodes.len() - 1;
            for i in 0..=pieces {
                let place = f64::from(i) / f64::from(pieces) * last as f64;
                let low = (place as usize).min(last - 1);
                let share = place - low as f64;
                let (a, b) = (nodes[low], nodes[low + 1]);
                let parent = (i > 0).then(|| strands.nodes.len() as u32 - 1);
                let cost = a.cost + (b.cost - a.cost) * share;
                let position = a.position + (b.position - a.position) * share;
                strands.nodes.push(SkeletonNode { position, parent, cost, age: cost, class: path.class, ..*nodes[0] });
            }
            strands.paths.push(Path { end: strands.nodes.len() as u32 - 1, root, ..*path });
        }
        strands
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::math::DVec3;

    #[test]
    fn every_path_is_one() {
        let mut tree = Skeleton::new(vec!["main".to_owned()]);
        let mut known = HashMap::new();
        let node = |i: u32, x: f64, y: f64| (i, DVec3::new(x, y, 0.0), f64::from(i));
        tree.add_path(&mut known, 0, [node(4, 4.0, 0.0), node(2, 2.0, 0.0), node(0, 0.0, 0.0)].into_iter());
        tree.add_path(&mut known, 0, [node(3, 2.0, 2.0), node(2, 2.0, 0.0)].into_iter());
        let strands = tree.strands(1);
        assert_eq!((strands.nodes.len(), strands.paths.len()), (4, 2));
        assert_eq!(strands.nodes[2].position, DVec3::ZERO);
        assert_eq!((strands.nodes[3].position, strands.nodes[3].parent), (DVec3::new(2.0, 2.0, 0.0), Some(2)));
        assert_eq!(tree.strands(4).nodes[1].position, DVec3::X);
    }
}
