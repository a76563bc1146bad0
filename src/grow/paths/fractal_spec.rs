//! Fractal placement as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::power;

/// Paths are planned again from all that has grown to `count` times `branching` new endpoints at a distance that is divided by
/// `attenuation`, until that is below `least` or all iterations are done. The first iteration has the counts that the endpoints
/// give.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FractalSpec {
    /// Distance d of the first endpoints from the generators, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub distance: f64,
    /// The attenuation factor alpha: what the distance is divided by from one iteration to the next.
    #[serde(default = "two")]
    #[schemars(range(min = 1.0, max = 100.0))]
    pub attenuation: f64,
    /// The branching factor beta: what the counts are multiplied by.
    #[serde(default = "two")]
    #[schemars(range(min = 0.1, max = 100.0))]
    pub branching: f64,
    /// Where endpoints are, seen from what has grown.
    #[serde(default)]
    pub place: Vicinity,
    /// Iterations at most.
    #[serde(default)]
    #[schemars(range(min = 1, max = 100))]
    pub iterations: Option<u32>,
    /// The epsilon below which no distance is used, in scene units: by default two steps of the lattice.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub least: Option<f64>,
}

fn two() -> f64 {
    2.0
}

/// Where endpoints are, seen from what has grown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Vicinity {
    /// No farther than the distance (the paper's text).
    #[default]
    Within,
    /// At the distance, to half a step of the lattice (its pseudocode).
    At,
}

impl FractalSpec {
    /// The distance of each iteration, in scene units, on a lattice with this spacing.
    pub(super) fn distances(&self, spacing: f64) -> Vec<f64> {
        let least = self.least.unwrap_or(2.0 * spacing);
        let most = self.iterations.unwrap_or(100);
        (0..most)
            .map(|i| self.distance / power(self.attenuation, f64::from(i)))
            .take_while(|&distance| distance >= least)
            .collect()
    }

    /// The endpoints of an iteration that starts with `count`.
    pub(super) fn count(&self, count: f64, iteration: usize) -> f64 {
        libm::round(count * power(self.branching, iteration as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_and_counts_are_the_pseudocodes() {
        let spec = FractalSpec {
            distance: 100.0,
            attenuation: 2.0,
            branching: 3.0,
            place: Vicinity::Within,
            iterations: None,
            least: None,
        };
        assert_eq!(spec.distances(1.0), [100.0, 50.0, 25.0, 12.5, 6.25, 3.125]);
        assert_eq!(FractalSpec { iterations: Some(3), ..spec }.distances(1.0), [100.0, 50.0, 25.0]);
        assert_eq!((spec.count(5.0, 0), spec.count(5.0, 2)), (5.0, 45.0));
    }
}
