//! A cache of samples of a costly signed distance function.

use std::sync::{PoisonError, RwLock};

use rustc_hash::FxHashMap;

use crate::math::{DVec3, mix};

/// Shards of the cache, so that threads seldom wait for each other.
const SHARDS: usize = 64;

/// A signed distance function.
pub trait SignedDistance {
    /// Signed distance of `p` from the surface, negative inside.
    fn distance(&self, p: DVec3) -> f64;
}

/// A signed distance function on a grid: trilinear interpolation of samples, each evaluated on first use. The error is less
/// than a grid step.
#[derive(Debug)]
pub struct Sampled<S> {
    shape: S,
    spacing: f64,
    samples: Vec<RwLock<FxHashMap<[i64; 3], f64>>>,
}

impl<S: PartialEq> PartialEq for Sampled<S> {
    /// The cache's contents make no difference.
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape && self.spacing == other.spacing
    }
}

impl<S: SignedDistance> Sampled<S> {
    /// `shape` on a grid with this spacing, in scene units.
    #[must_use]
    pub fn new(shape: S, spacing: f64) -> Self {
        Self { shape, spacing, samples: (0..SHARDS).map(|_| RwLock::default()).collect() }
    }

    /// The exact shape.
    #[must_use]
    pub fn shape(&self) -> &S {
        &self.shape
    }

    /// Spacing of the grid, in scene units.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    fn sample(&self, at: [i64; 3]) -> f64 {
        let shard = at.iter().fold(0, |hash, &c| mix(hash ^ c as u64));
        let samples = &self.samples[shard as usize % SHARDS];
        // An entry is complete or absent, so a poisoned lock is harmless.
        if let Some(&d) = samples.read().unwrap_or_else(PoisonError::into_inner).get(&at) {
            return d;
        }
        let d = self.shape.distance(DVec3::from_array(at.map(|c| c as f64)) * self.spacing);
        samples.write().unwrap_or_else(PoisonError::into_inner).insert(at, d);
        d
    }

    /// Signed distance of `p`, interpolated.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        let at = p / self.spacing;
        let low = at.map(libm::floor);
        let share = at - low;
        let [x, y, z] = low.to_array().map(|c| c as i64);
        let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let line = |y: i64, z: i64| lerp(self.sample([x, y, z]), self.sample([x + 1, y, z]), share.x);
        let face = |z: i64| lerp(line(y, z), line(y + 1, z), share.y);
        lerp(face(z), face(z + 1), share.z)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A box about the origin, by its half-extents.
    #[derive(Clone)]
    struct Cuboid(DVec3);

    impl SignedDistance for Cuboid {
        fn distance(&self, p: DVec3) -> f64 {
            let q = p.abs() - self.0;
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
        }
    }

    proptest! {
        #[test]
        fn samples_are_near(p in prop::array::uniform3(-2.0..2.0), spacing in 0.02..0.3_f64) {
            let shape = Cuboid(DVec3::new(1.0, 0.7, 0.4));
            let p = DVec3::from_array(p);
            let sampled = Sampled::new(shape.clone(), spacing);
            prop_assert!((sampled.distance(p) - shape.distance(p)).abs() < spacing);
            prop_assert_eq!(sampled.distance(p), sampled.distance(p));
        }
    }
}
