//! The point of a line segment nearest to another point.

use crate::math::DVec3;

/// The parameter of the point of the segment from `a` to `b` nearest to `p`: 0 at `a`, 1 at `b`; 0 where they coincide.
#[must_use]
pub fn segment_parameter(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (p, axis) = (p - a, b - a);
    let length = axis.length_squared();
    if length > 0.0 { (p.dot(axis) / length).clamp(0.0, 1.0) } else { 0.0 }
}

/// Distance of `p` from the segment from `a` to `b`.
#[must_use]
pub fn segment_distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    libm::sqrt(segment_distance_squared(p, a, b))
}

/// The square of [`segment_distance`].
#[must_use]
pub fn segment_distance_squared(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    (p - a - (b - a) * segment_parameter(p, a, b)).length_squared()
}
