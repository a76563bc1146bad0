//! Round cones, the limb segments: two spheres and the frustum tangent to both.

use crate::math::DVec3;

/// A conical frustum without caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Centre of one end.
    pub a: DVec3,
    /// Radius there.
    pub ra: f64,
    /// Centre of the other end.
    pub b: DVec3,
    /// Radius there.
    pub rb: f64,
}

/// The frustum tangent to the spheres `(a, ra)` and `(b, rb)`, or `None` where one sphere contains the other.
///
/// With L the distance of the centres, u the direction from a to b and sin t = (ra - rb) / L, it extends from
/// `a + u ra sin t` with radius `ra cos t` to `b + u rb sin t` with radius `rb cos t`.
#[must_use]
pub fn frustum(a: DVec3, ra: f64, b: DVec3, rb: f64) -> Option<Frustum> {
    let l = (b - a).length();
    let sin = (ra - rb) / l;
    // Not a number where L is 0 and the radii are equal.
    if sin.is_nan() || sin.abs() >= 1.0 {
        return None;
    }
    let u = (b - a) / l;
    let cos = libm::sqrt(1.0 - sin * sin);
    Some(Frustum { a: a + u * (ra * sin), ra: ra * cos, b: b + u * (rb * sin), rb: rb * cos })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Each end circle lies on its sphere, and the cone's slope is the spheres' tangent there.
        #[test]
        fn is_tangent_to_both_spheres(x in -5.0..5.0, y in -5.0..5.0, z in -5.0..5.0, ra in 0.01..2.0, rb in 0.01..2.0) {
            let (a, b) = (DVec3::ZERO, DVec3::new(x, y, z));
            match frustum(a, ra, b, rb) {
                None => prop_assert!((b - a).length() <= (ra - rb).abs()),
                Some(f) => {
                    prop_assert!(((f.a - a).length_squared() + f.ra * f.ra - ra * ra).abs() < 1e-9);
                    prop_assert!(((f.b - b).length_squared() + f.rb * f.rb - rb * rb).abs() < 1e-9);
                    // A point of the rim, seen from the sphere's centre, is at a right angle to the slope.
                    let u = (b - a).normalize();
                    let out = u.any_orthonormal_vector();
                    let (rim_a, rim_b) = (f.a + out * f.ra, f.b + out * f.rb);
                    prop_assert!((rim_b - rim_a).dot(rim_a - a).abs() < 1e-8);
                }
            }
        }
    }
}
