//! Triangular lattices: in the plane every node has six neighbours at equal distance, so that paths favour no axis as they do on
//! square ones.

use rustc_hash::FxHashSet;
use schemars::JsonSchema;
use serde::Deserialize;

use super::{Region, ScatterError, scatter_estimate};
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
/// More nodes are refused.
const MOST: f64 = 1e8;

/// The nodes of the triangular lattice with this spacing, through the origin, that lie in `region` in the plane, row by row;
/// those at `fixed` come first, each in place of the lattice's nearest.
///
/// # Errors
/// [`ScatterError`].
pub(super) fn triangular(region: &dyn Region, spacing: f64, fixed: &[DVec3]) -> Result<Vec<DVec3>, ScatterError> {
    let [low, high] = region.bounds();
    let estimate = scatter_estimate([low, high], spacing, true);
    if estimate.is_nan() || estimate > MOST {
        return Err(ScatterError::TooMany(estimate));
    }
    let row_of = |y: f64| y / (spacing * ROW);
    let shift = |row: i64| if row.rem_euclid(2) == 0 { 0.0 } else { 0.5 };
    let column_of = |x: f64, row: i64| x / spacing - shift(row);
    let place =
        |column: i64, row: i64| DVec3::new((column as f64 + shift(row)) * spacing, row as f64 * spacing * ROW, 0.0);
    let mut nodes = Vec::new();
    let mut taken: FxHashSet<[i64; 2]> = FxHashSet::default();
    for &p in fixed {
        let row = libm::round(row_of(p.y)) as i64;
        if taken.insert([libm::round(column_of(p.x, row)) as i64, row]) {
            nodes.push(p);
        }
    }
    for row in libm::floor(row_of(low.y)) as i64..=libm::ceil(row_of(high.y)) as i64 {
        for column in libm::floor(column_of(low.x, row)) as i64..=libm::ceil(column_of(high.x, row)) as i64 {
            let p = place(column, row);
            if region.margin(p) <= 0.0 && !taken.contains(&[column, row]) {
                nodes.push(p);
            }
        }
    }
    Ok(nodes)
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
        let plan = ScatterPlan { spacing: 0.5, is_plane: true, joining: &Joining::Triangular, fixed: &[], owner: None };
        let graph = Scatter::new(&plan, &Square, &Stream::new(1, "triangles")).unwrap();
        // One node for each half of a rhombus: an area of sqrt(3) / 2 spacing^2.
        assert!((graph.len() as f64 / (100.0 / (0.25 * ROW)) - 1.0).abs() < 0.06, "{}", graph.len());
        for node in (0..graph.len() as u32).map(Node) {
            let p = graph.position(node);
            if Square.margin(p) < -0.6 {
                let ends = graph.ends(graph.edges(node));
                assert_eq!(ends.len(), 6, "{p}");
                assert!(ends.iter().all(|&end| (graph.position(end).distance(p) - 0.5).abs() < 1e-12));
            }
        }
    }

    /// A repeated step grows from node 0.
    #[test]
    fn what_is_fixed_comes_first() {
        let fixed = [DVec3::new(3.1, 4.2, 0.0), DVec3::new(3.12, 4.21, 0.0), DVec3::new(7.0, 7.0, 0.0)];
        let nodes = triangular(&Square, 0.5, &fixed).unwrap();
        assert_eq!(nodes[..2], [fixed[0], fixed[2]], "of two about one node the first");
        assert_eq!(nodes.len(), triangular(&Square, 0.5, &[]).unwrap().len());
    }
}
