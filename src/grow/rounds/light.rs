//! Light from the sky past all that has grown.

use crate::bvh::{Cones, Ray, RoundCone};
use crate::math::{DVec3, GOLDEN_ANGLE, from_height};
use crate::skeleton::Skeleton;

/// What throws shade: everything that grew before this round.
pub struct Canopy {
    cones: Cones,
}

impl Canopy {
    /// Limbs as thick as `clump`.
    #[must_use]
    pub fn new(skeletons: &[&Skeleton], clump: f64) -> Self {
        let limbs: Vec<[DVec3; 2]> =
            skeletons.iter().flat_map(|s| s.segments()).map(|(a, b)| [a.position, b.position]).collect();
        let limb = |i: usize| {
            let [a, b] = limbs[i];
            RoundCone { a, ra: clump, b, rb: clump }
        };
        Self { cones: Cones::new(limbs.len(), limb) }
    }

    /// The share of `sky` that is hidden from `p`; what is nearer than `near` does not hide it.
    #[must_use]
    pub fn hidden(&self, p: DVec3, sky: &[DVec3], near: f64) -> f64 {
        f64::from(self.blocked(p, sky, near)) / sky.len().max(1) as f64
    }

    /// How many of the rays to `sky` from `p` are blocked.
    pub(super) fn blocked(&self, p: DVec3, sky: &[DVec3], near: f64) -> u32 {
        let is_blocked =
            |&&direction: &&DVec3| self.cones.is_blocked(&Ray { origin: p, direction, near, far: f64::INFINITY });
        sky.iter().filter(is_blocked).count() as u32
    }
}

/// `count` directions spread evenly over the sky within `open` radians of the vertical (a spiral by the golden angle).
#[must_use]
pub fn sky(count: u32, open: f64) -> Vec<DVec3> {
    let depth = 1.0 - libm::cos(open);
    (0..count)
        .map(|i| {
            let z = 1.0 - depth * (f64::from(i) + 0.5) / f64::from(count);
            from_height(z, GOLDEN_ANGLE * f64::from(i))
        })
        .collect()
}
