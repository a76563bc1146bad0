//! Regions as a scene writes them.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::grow::rules::{MOST_DENSE, Needs, Rules};
use crate::math::Point;

/// What goes with regions.
pub(in crate::grow) const RULES: Rules = Rules {
    subject: "regions have",
    needs: Needs::Lattice,
    repeats: false,
    has_endpoints: false,
    has_limbs: false,
    most_nodes: MOST_DENSE,
    ..Rules::PATHS
};

/// Regions, one for each generator: all that is nearest to it.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RegionsSpec {
    /// Only the regions that these points lie in; by default all.
    pub keep: Vec<Point>,
    /// Width of the gap between regions, in scene units: surfaces are drawn in by half of it.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub gap: f64,
    /// Plan the border again this many times, each on a lattice twice as fine around it (section 3.1).
    #[schemars(range(min = 0, max = 3))]
    pub refine: u32,
    /// How often borders are smoothed: 0 shows the steps of the lattice, 2 leaves edges, 10 pebbles.
    #[schemars(range(min = 0, max = 100))]
    pub smooth: u32,
}
