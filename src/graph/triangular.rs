//! Triangular lattices: in the plane every node has six neighbours at equal distance, so that paths favour no axis as they do on
//! square ones.

use rustc_hash::FxHashSet;
use schemars::JsonSchema;
use serde::Deserialize;

use super::Region;
use crate::math::DVec3;

/// A triangular lattice in the plane: six neighbours at equal distance.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TriangularSpec {
    /// Distance between neighbours, in scene units; in the space of a repeated step times its size.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub spacing: f64,
}

/// Rows are so many spacings apart.
const ROW: f64 = 0.866_025_403_784_438_6;
/// Neighbours are within so many spacings.
pub(super) const REACH: f64 = 1.01;
/// Rounding, in spacings.
const SLACK: f64 = 1e-6;

/// A triangular lattice through the origin.
struct Grid {
    spacing: f64,
}

impl Grid {
    fn shift(row: i64) -> f64 {
        if row.rem_euclid(2) == 0 { 0.0 } else { 0.5 }
    }

    fn row(&self, y: f64) -> f64 {
        y / (self.spacing * ROW)
    }

    fn column(&self, x: f64, row: i64) -> f64 {
        x / self.spacing - Self::shift(row)
    }

    fn place(&self, [column, row]: [i64; 2]) -> DVec3 {
        let (x, y) = ((column as f64 + Self::shift(row)) * self.spacing, row as f64 * self.spacing * ROW);
        DVec3::new(x, y, 0.0)
    }

    /// The node that stands for `p`: the nearest one that is open, if any around it is; that at `p` itself in any case.
    fn nearest(&self, p: DVec3, is_open: &dyn Fn(DVec3) -> bool) -> [i64; 2] {
        let middle = libm::round(self.row(p.y)) as i64;
        let mut around: Vec<[i64; 2]> = Vec::new();
        for row in middle - 1..=middle + 1 {
            let column = libm::round(self.column(p.x, row)) as i64;
            around.extend([column - 1, column, column + 1].map(|column| [column, row]));
        }
        around.sort_by(|&a, &b| self.place(a).distance(p).total_cmp(&self.place(b).distance(p)).then(a.cmp(&b)));
        let is_it = |at: &&[i64; 2]| is_open(self.place(**at)) || self.place(**at).distance(p) < self.spacing * SLACK;
        around.iter().find(is_it).copied().unwrap_or(around[0])
    }
}

/// The nodes of the triangular lattice with this spacing, through the origin, that lie in `region` in the plane, row by row;
/// those that stand for `fixed` places come first.
pub(super) fn triangular(region: &dyn Region, spacing: f64, fixed: &[DVec3]) -> Vec<DVec3> {
    let [low, high] = region.bounds();
    let grid = Grid { spacing };
    let is_open = |p: DVec3| region.margin(p) <= spacing * SLACK;
    let mut nodes = Vec::new();
    let mut taken: FxHashSet<[i64; 2]> = FxHashSet::default();
    for &p in fixed {
        let at = grid.nearest(p, &is_open);
        if taken.insert(at) {
            nodes.push(grid.place(at));
        }
    }
    for row in libm::floor(grid.row(low.y)) as i64..=libm::ceil(grid.row(high.y)) as i64 {
        for column in libm::floor(grid.column(low.x, row)) as i64..=libm::ceil(grid.column(high.x, row)) as i64 {
            let p = grid.place([column, row]);
            if is_open(p) && !taken.contains(&[column, row]) {
                nodes.push(p);
            }
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Joining, Node, Scatter, ScatterPlan};
    use crate::math::Stream;

    struct Square;

    impl Region for Square {
        fn margin(&self, p: DVec3) -> f64 {
            (p - DVec3::new(5.0, 5.0, 0.0)).abs().max_element() - 5.0
        }

        fn bounds(&self) -> [DVec3; 2] {
            [DVec3::ZERO, DVec3::new(10.0, 10.0, 0.0)]
        }
    }

    #[test]
    fn inner_nodes_have_six_neighbours_at_the_spacing() {
        let plan = ScatterPlan {
            spacing: 0.5,
            keep: 1.0,
            is_plane: true,
            joining: &Joining::Triangular,
            fixed: &[],
            owner: None,
        };
        let graph = Scatter::new(&plan, &Square, &Stream::new(1, "triangles")).unwrap();
        // 24 rows fit, 0.433 apart, of 21 and of 20 nodes by turns.
        assert_eq!(graph.len(), 12 * 21 + 12 * 20);
        for node in (0..graph.len() as u32).map(Node) {
            let p = graph.position(node);
            if Square.margin(p) < -0.6 {
                let ends = graph.ends(graph.edges(node));
                assert_eq!(ends.len(), 6, "{p}");
                assert!(ends.iter().all(|&end| (graph.position(end).distance(p) - 0.5).abs() < 1e-12));
            }
        }
    }

    /// A repeated step grows from node 0, and a place on the border has its neighbours.
    #[test]
    fn what_is_fixed_comes_first() {
        let fixed = [DVec3::new(3.1, 4.2, 0.0), DVec3::new(3.12, 4.21, 0.0), DVec3::new(10.3, 7.0, 0.0)];
        let nodes = triangular(&Square, 0.5, &fixed);
        assert!(nodes[0].distance(fixed[0]) < 0.3 && nodes[1].distance(fixed[2]) < 0.8, "{} {}", nodes[0], nodes[1]);
        assert!(Square.margin(nodes[1]) <= 1e-9);
        assert_eq!(nodes.len(), triangular(&Square, 0.5, &[]).len());
        assert_eq!(triangular(&Square, 0.5, &[DVec3::ZERO])[0], DVec3::ZERO);
    }
}
