//! Light in voxels: which rays to the sky and to the sun are free.

use super::spec::{LightSenseSpec, SunSpec};
use crate::grow::rounds::sky;
use crate::math::{DVec3, solar_direction};

/// Rays to the sky stay this far above the horizon, in radians from the vertical.
const OPEN: f64 = 1.45;

/// How growth senses light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSense {
    /// Directions of the sky, and what they count together.
    pub sky: (Vec<DVec3>, f64),
    /// Where the sun is, and what it counts.
    pub sun: (Vec<DVec3>, f64),
}

impl SunSpec {
    /// Where the sun is at each of its hours, as far as it is above the horizon: x is east and y north, unless north is
    /// elsewhere.
    #[must_use]
    pub fn directions(&self) -> Vec<DVec3> {
        let [from, to] = self.hours;
        let steps = libm::ceil(to - from).max(0.0) as u32;
        let hour = |i: u32| if steps == 0 { from } else { from + (to - from) * f64::from(i) / f64::from(steps) };
        let at = |i: u32| solar_direction(self.latitude, self.day, hour(i), self.north);
        (0..=steps).map(at).filter(|way| way.z > 0.0).collect()
    }
}

impl LightSense {
    /// The rays of `spec`.
    #[must_use]
    pub fn new(spec: &LightSenseSpec) -> Self {
        let rays = if spec.sky > 0.0 { sky(spec.rays, OPEN) } else { Vec::new() };
        let sun = spec.sun.as_ref().map_or((Vec::new(), 0.0), |sun| (sun.directions(), sun.counts));
        Self { sky: (rays, spec.sky), sun }
    }

    /// What a limb gets that grows along `way`, of the rays that are free.
    pub(super) fn score(&self, way: DVec3, is_free: impl Fn(DVec3) -> bool) -> f64 {
        let mut score = 0.0;
        for (rays, counts) in [&self.sky, &self.sun] {
            let mut seen = 0.0;
            for &ray in rays {
                if is_free(ray) {
                    seen += (1.0 + way.dot(ray)) * 0.5;
                }
            }
            score += counts * seen / rays.len().max(1) as f64;
        }
        score
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Degrees;

    fn sun(latitude: f64, day: f64, hour: f64) -> Vec<DVec3> {
        let hours = [hour, hour];
        SunSpec { counts: 1.0, latitude: Degrees(latitude), day, hours, north: Degrees(0.0) }.directions()
    }

    /// Against almanacs: London (51.5 north) at noon in June 61.9 degrees, in December 15.1; at the equinox 90 less the latitude,
    /// and due west at six in the evening; from the south the sun is in the north.
    #[test]
    fn the_sun_stands_where_almanacs_have_it() {
        let height = |way: DVec3| libm::asin(way.z) * 180.0 / std::f64::consts::PI;
        for (latitude, day, expected) in
            [(51.5, 172.0, 61.9), (51.5, 355.0, 15.1), (51.5, 80.5, 38.5), (-33.9, 355.0, 79.5)]
        {
            let noon = sun(latitude, day, 12.0)[0];
            assert!((height(noon) - expected).abs() < 0.6, "{latitude} {day}: {}", height(noon));
            assert!(noon.x.abs() < 1e-9 && (noon.y < 0.0) == (latitude > 0.0));
        }
        let evening = sun(40.0, 172.0, 18.0)[0];
        assert!(evening.x < -0.8 && evening.y > 0.0, "in summer it sets north of west: {evening}");
        assert!(sun(51.5, 355.0, 6.0).is_empty() && sun(51.5, 172.0, 6.0)[0].x > 0.0);
        let turned =
            SunSpec { counts: 1.0, latitude: Degrees(51.5), day: 172.0, hours: [6.0, 18.0], north: Degrees(90.0) };
        let all = turned.directions();
        assert_eq!(all.len(), 13);
        // North is at -x, so south at x.
        assert!(all[6].x > 0.4 && all[6].y.abs() < 1e-9, "{}", all[6]);
    }
}
