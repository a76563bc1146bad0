//! Rotational symmetry: copies of a grown part about an axis, such as the arms of a snow crystal.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Path, Skeleton};
use crate::math::{DMat3, DVec3, Point, rotation};

/// Rotational symmetry about an upright axis (in the plane, about a point).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SymmetrySpec {
    /// The order of the symmetry: 6 for snow.
    #[schemars(range(min = 1, max = 360))]
    pub fold: u32,
    /// Add a mirror image of each copy, in the upright plane through the axis and x before rotation.
    #[serde(default)]
    pub mirror: bool,
    /// A point of the axis; by default the origin.
    #[serde(default)]
    pub about: Option<Point>,
}

impl SymmetrySpec {
    /// The number of copies.
    #[must_use]
    pub fn parts(&self) -> u32 {
        self.fold * if self.mirror { 2 } else { 1 }
    }
}

impl Skeleton {
    /// The union of all copies by `symmetry`, the original first.
    #[must_use]
    pub fn symmetric(&self, symmetry: &SymmetrySpec) -> Self {
        let about = symmetry.about.map_or(DVec3::ZERO, |p| p.0);
        let mut whole = Self { classes: self.classes.clone(), ..Self::default() };
        let mirrors = [DMat3::IDENTITY, DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0))];
        for part in 0..symmetry.parts() {
            let (step, mirror) = (part % symmetry.fold, mirrors[(part / symmetry.fold) as usize]);
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(symmetry.fold);
            let turn = if step == 0 { mirror } else { rotation(DVec3::Z, angle) * mirror };
            let first = whole.nodes.len() as u32;
            for node in &self.nodes {
                let mut node = *node;
                if part > 0 {
                    node.position = about + turn * (node.position - about);
                }
                node.parent = node.parent.map(|parent| parent + first);
                whole.nodes.push(node);
            }
            let moved = |path: &Path| Path { end: path.end + first, root: path.root + first, ..*path };
            whole.paths.extend(self.paths.iter().map(moved));
        }
        whole
    }

    /// The deviation from `fold`-fold symmetry about the upright axis through the mean of the nodes: the greatest distance of a
    /// rotated node from the nearest node.
    #[must_use]
    pub fn asymmetry(&self, fold: u32) -> f64 {
        let root = self.nodes.iter().map(|n| n.position).sum::<DVec3>() / self.nodes.len().max(1) as f64;
        let turn = rotation(DVec3::Z, std::f64::consts::TAU / f64::from(fold));
        let turned = |p: DVec3| root + turn * (p - root);
        let mut sorted: Vec<DVec3> = self.nodes.iter().map(|n| n.position).collect();
        sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
        let nearest = |p: DVec3| {
            let start = sorted.partition_point(|q| q.x < p.x);
            let mut best = f64::INFINITY;
            for q in &sorted[start..] {
                if q.x - p.x >= best {
                    break;
                }
                best = best.min((*q - p).length());
            }
            for q in sorted[..start].iter().rev() {
                if p.x - q.x >= best {
                    break;
                }
                best = best.min((*q - p).length());
            }
            best
        };
        self.nodes.iter().map(|n| nearest(turned(n.position))).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn parts_stand_around_the_axis() {
        let mut arm = Skeleton::new(vec!["main".to_owned()]);
        let way = [2.0, 1.0, 0.0].map(|x| (x as u64, DVec3::new(x, 0.3 * x, 0.0), x));
        arm.add_path(&mut HashMap::new(), 0, way.into_iter());
        let symmetry = SymmetrySpec { fold: 6, mirror: true, about: None };
        let whole = arm.symmetric(&symmetry);
        assert_eq!((whole.nodes.len(), whole.paths.len()), (36, 12));
        assert!(whole.asymmetry(6) < 1e-12 && whole.asymmetry(5) > 0.1);
        assert!(arm.asymmetry(6) > 1.0);
        let parents = whole.nodes.iter().enumerate().filter_map(|(i, n)| n.parent.map(|p| (i, p as usize)));
        assert!(parents.clone().all(|(i, p)| p < i) && parents.count() == 24);
    }
}
