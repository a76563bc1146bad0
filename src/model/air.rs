//! Haze.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::DVec3;

/// Haze that lies on the ground, in the colour of the sky at the horizon, as POV-Ray's ground fog.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Air {
    /// Distance along the ground at which some 37 % of a thing's own colour is left, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e9))]
    pub clear: f64,
    /// Height above 0 at which it is half as dense as on the ground, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e9))]
    pub height: f64,
}

impl Air {
    /// The share of light that comes through it from a distance `far`, which may be infinite, along a unit `way` to `from`.
    #[must_use]
    pub fn through(&self, from: DVec3, way: DVec3, far: f64) -> f64 {
        // So little of a rise that it is level.
        let passed = if way.z.abs() < 1e-9 {
            self.density(from.z) * far
        } else {
            (self.below(from.z + way.z * far) - self.below(from.z)) / way.z
        };
        libm::exp(-passed / self.clear)
    }

    /// Its density at a height, 1 on the ground and below.
    fn density(&self, z: f64) -> f64 {
        let share = z.max(0.0) / self.height;
        1.0 / (1.0 + share * share)
    }

    /// What of it lies below a height, per area, over its density on the ground.
    fn below(&self, z: f64) -> f64 {
        if z <= 0.0 { z } else { self.height * libm::atan(z / self.height) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_as_much_as_its_density_adds_up_to() {
        let air = Air { clear: 300.0, height: 20.0 };
        assert!((air.through(DVec3::ZERO, DVec3::X, 300.0) - libm::exp(-1.0)).abs() < 1e-12);
        assert!((air.density(20.0) - 0.5).abs() < 1e-12);
        for (z, way) in
            [(1.6, DVec3::new(1.0, 0.0, 0.2)), (30.0, DVec3::new(1.0, 0.0, -0.1)), (5.0, DVec3::new(0.0, 1.0, 0.0))]
        {
            let way = way.normalize();
            let steps = 100_000;
            let step = 200.0 / f64::from(steps);
            let sum: f64 = (0..steps).map(|i| air.density(z + way.z * step * (f64::from(i) + 0.5)) * step).sum();
            let through = air.through(DVec3::Z * z, way, 200.0);
            assert!((through - libm::exp(-sum / 300.0)).abs() < 1e-6, "{z}: {through}");
        }
        // All of what lies above, and of level ground without end.
        let up = air.through(DVec3::ZERO, DVec3::Z, f64::INFINITY);
        assert!((up - libm::exp(-10.0 * std::f64::consts::PI / 300.0)).abs() < 1e-12);
        assert_eq!(air.through(DVec3::ZERO, DVec3::X, f64::INFINITY), 0.0);
        assert_eq!(air.through(DVec3::Z, DVec3::new(0.8, 0.0, -0.6), f64::INFINITY), 0.0);
    }
}
