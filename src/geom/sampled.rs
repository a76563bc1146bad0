//! A shape whose distances are dear, sampled where they are asked for.

use std::sync::{PoisonError, RwLock};

use rustc_hash::FxHashMap;

use super::Shape;
use crate::math::{DVec3, mix};

/// Parts of the samples, so that threads seldom wait for each other.
const PARTS: usize = 64;

/// A shape on a grid: distances are interpolated between samples, each taken once, when it is first asked for. They are off by less
/// than a step of the grid.
#[derive(Debug)]
pub struct Sampled {
    shape: Shape,
    spacing: f64,
    samples: Vec<RwLock<FxHashMap<[i64; 3], f64>>>,
}

impl PartialEq for Sampled {
    /// What has been asked for makes no difference.
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape && self.spacing == other.spacing
    }
}

impl Sampled {
    /// `shape` on a grid with this spacing, in scene units.
    #[must_use]
    pub fn new(shape: Shape, spacing: f64) -> Self {
        Self { shape, spacing, samples: (0..PARTS).map(|_| RwLock::default()).collect() }
    }

    /// The shape.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Spacing of the grid, in scene units.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    fn sample(&self, at: [i64; 3]) -> f64 {
        let part = at.iter().fold(0, |hash, &c| mix(hash ^ c as u64));
        let samples = &self.samples[part as usize % PARTS];
        // A number is whole or not there: who panicked left nothing half done.
        if let Some(&d) = samples.read().unwrap_or_else(PoisonError::into_inner).get(&at) {
            return d;
        }
        let d = self.shape.distance(DVec3::from_array(at.map(|c| c as f64)) * self.spacing);
        samples.write().unwrap_or_else(PoisonError::into_inner).insert(at, d);
        d
    }

    /// Signed distance from the surface, interpolated.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        let at = p / self.spacing;
        let low = at.map(libm::floor);
        let share = at - low;
        let [x, y, z] = low.to_array().map(|c| c as i64);
        let blend = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let line = |y: i64, z: i64| blend(self.sample([x, y, z]), self.sample([x + 1, y, z]), share.x);
        let face = |z: i64| blend(line(y, z), line(y + 1, z), share.y);
        blend(face(z), face(z + 1), share.z)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::Solid;
    use super::*;

    proptest! {
        #[test]
        fn samples_are_near(p in prop::array::uniform3(-2.0..2.0), spacing in 0.02..0.3_f64) {
            let half = DVec3::new(1.0, 0.7, 0.4);
            let shape = Shape::new(Solid::Box { min: -half, max: half });
            let p = DVec3::from_array(p);
            let sampled = Sampled::new(shape.clone(), spacing);
            prop_assert!((sampled.distance(p) - shape.distance(p)).abs() < spacing);
            prop_assert_eq!(sampled.distance(p), sampled.distance(p));
        }
    }
}
