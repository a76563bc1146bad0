//! Triangular lattices: in the plane every node has six neighbours at equal distance, so that paths favour no axis as they do on
//! square ones.

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

/// The nodes of the triangular lattice with this spacing, through the origin, that lie in `region` in the plane; row by row.
///
/// # Errors
/// [`ScatterError`].
pub(super) fn triangular(region: &dyn Region, spacing: f64) -> Result<Vec<DVec3>, ScatterError> {
    let [low, high] = region.bounds();
    let estimate = scatter_estimate([low, high], spacing, true);
    if estimate.is_nan() || estimate > MOST {
        return Err(ScatterError::TooMany(estimate));
    }
    let rows = |y: f64| libm::floor(y / (spacing * ROW)) as i64;
    let mut nodes = Vec::new();
    for row in rows(low.y)..=rows(high.y) + 1 {
        let shift = if row.rem_euclid(2) == 0 { 0.0 } else { 0.5 };
        let columns = |x: f64| libm::floor(x / spacing - shift) as i64;
        for column in columns(low.x)..=columns(high.x) + 1 {
            let p = DVec3::new((column as f64 + shift) * spacing, row as f64 * spacing * ROW, 0.0);
            if region.margin(p) <= 0.0 {
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
}
