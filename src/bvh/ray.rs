//! Rays and hits.

use crate::math::DVec3;

/// The part of a ray between two distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Its origin.
    pub origin: DVec3,
    /// Its direction, a unit vector.
    pub direction: DVec3,
    /// Exclusive lower bound of the distance of hits.
    pub near: f64,
    /// Exclusive upper bound of the distance of hits.
    pub far: f64,
}

/// The nearest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f64,
    /// Index of the primitive.
    pub id: u32,
}

impl Ray {
    /// The unbounded ray from `origin` along the unit vector `direction`.
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
