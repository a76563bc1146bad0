//! The relief of the ground as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

use super::pattern::{Expr, PATCH, swells};
use crate::math::DVec3;

/// Rises of the ground, from drifts and tussocks to hills: one layer of its relief.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReliefSpec {
    /// How far the highest rise above the ground, in scene units.
    #[schemars(range(min = 0.0, max = 1e5))]
    pub height: f64,
    /// How wide they are, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub size: f64,
    /// Distance from the origin where they begin, in scene units: at twice this they have their height.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub from: f64,
}

/// A layer of the relief, ready to be asked.
#[derive(Clone, Debug)]
pub struct Relief {
    spec: ReliefSpec,
    share: Expr,
}

impl Relief {
    /// The layer that `spec` describes.
    #[must_use]
    pub fn new(spec: ReliefSpec) -> Self {
        Self { spec, share: swells() }
    }

    /// Its height above the ground at a place, from 0 to the one given.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let ReliefSpec { height, size, from } = self.spec;
        let begun = if from > 0.0 { (libm::sqrt(x * x + y * y) / from - 1.0).clamp(0.0, 1.0) } else { 1.0 };
        if begun == 0.0 {
            return 0.0;
        }
        let unit = size / PATCH;
        // No layer begins or ends with an edge.
        height * begun * begun * (3.0 - 2.0 * begun) * self.share.at(DVec3::new(x / unit, 0.0, y / unit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hills_rise_where_they_begin() {
        let relief = Relief::new(ReliefSpec { height: 30.0, size: 200.0, from: 100.0 });
        let ring = |r: f64| (0..360).map(move |i| (r * libm::cos(f64::from(i)), r * libm::sin(f64::from(i))));
        assert!(ring(99.0).all(|(x, y)| relief.at(x, y) == 0.0));
        let far: Vec<f64> = (2..40).flat_map(|i| ring(100.0 * f64::from(i))).map(|(x, y)| relief.at(x, y)).collect();
        let (least, most) = far.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &h| (a.min(h), b.max(h)));
        assert!((0.0..3.0).contains(&least) && (27.0..=30.0).contains(&most), "{least} {most}");
        // Nowhere a step: where one is is asked of ever smaller distances.
        let steepest = |d: f64| {
            let rises =
                (0..4000).map(|i| f64::from(i) * 0.37).map(|x| (relief.at(x + d, 7.0) - relief.at(x, 7.0)).abs());
            rises.fold(0.0, f64::max)
        };
        assert!(steepest(0.01) < 0.02 * steepest(1.0) && steepest(1e-4) < 2e-4 * steepest(1.0));
    }
}
