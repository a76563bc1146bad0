//! Rays and what they hit.

use crate::math::DVec3;

/// The part of a ray between two distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Its direction, of length 1.
    pub direction: DVec3,
    /// Hits count beyond this distance.
    pub near: f64,
    /// Hits count below this distance.
    pub far: f64,
}

/// The nearest thing that a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f64,
    /// Index of the primitive as it was given.
    pub id: u32,
}

impl Ray {
    /// The whole ray from `origin` along the unit vector `direction`.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, near: 0.0, far: f64::INFINITY }
    }

    /// The point at distance `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
