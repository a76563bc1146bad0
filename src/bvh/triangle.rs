//! Two-sided triangles.

use fearless_simd::{Select, Simd, SimdBase, f32x8};

use super::queries::Block;
use super::tree::Beam;
use super::{Primitive, Ray};
use crate::math::DVec3;

/// Three corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle(pub [DVec3; 3]);

impl Triangle {
    /// The distance of the ray's intersection with the triangle's plane, and the barycentric coordinates of the second and the
    /// third vertex there (Moeller and Trumbore 1997), in double precision; `None` if they are parallel.
    #[must_use]
    pub fn meet(&self, ray: &Ray) -> Option<(f64, [f64; 2])> {
        let [a, b, c] = self.0;
        let (e1, e2) = (b - a, c - a);
        let p = ray.direction.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            return None;
        }
        let o = ray.origin - a;
        let q = o.cross(e1);
        Some((e2.dot(q) / det, [o.dot(p) / det, ray.direction.dot(q) / det]))
    }

    /// The unit normal, right-handed by the order of the vertices; zero for a degenerate triangle.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        let [a, b, c] = self.0;
        (b - a).cross(c - a).normalize_or_zero()
    }
}

#[inline(always)]
fn dot<S: Simd>(a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<S: Simd>(a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn sub<S: Simd>(a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

impl Primitive<9> for Triangle {
    fn pack(&self) -> Option<[f32; 9]> {
        let mut p = [0.0; 9];
        for (to, x) in p.iter_mut().zip(self.0.iter().flat_map(DVec3::to_array)) {
            *to = x as f32;
        }
        (p.iter().all(|x: &f32| x.is_finite()) && self.normal() != DVec3::ZERO).then_some(p)
    }

    fn bounds(p: &[f32; 9]) -> [[f32; 3]; 2] {
        let axes = [0, 1, 2];
        [axes.map(|i| p[i].min(p[i + 3]).min(p[i + 6])), axes.map(|i| p[i].max(p[i + 3]).max(p[i + 6]))]
    }

    #[inline(always)]
    fn enter<S: Simd>(beam: &Beam<S>, block: &Block<9>) -> f32x8<S> {
        let simd = beam.simd;
        // Edge functions relative to the ray's origin (Woop et al. 2013 without the shear): triangles that share an edge compute
        // it identically, so that the test is watertight.
        let a = sub(block.point(simd, 0), beam.origin);
        let b = sub(block.point(simd, 3), beam.origin);
        let c = sub(block.point(simd, 6), beam.origin);
        let d = beam.direction;
        let zero = f32x8::splat(simd, 0.0);
        let u = dot(cross(c, b), d);
        let v = dot(cross(a, c), d);
        let w = dot(cross(b, a), d);
        let front = u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero);
        let back = u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero);
        let n = cross(sub(b, a), sub(c, a));
        let t = dot(n, a) / dot(n, d);
        let met = (front | back) & t.simd_gt(f32x8::splat(simd, beam.near));
        met.select(t, f32x8::splat(simd, f32::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNER: Triangle = Triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);

    /// The weights of the corners give the point that is met.
    #[test]
    fn a_ray_meets_it_by_weights() {
        let ray = Ray::new(DVec3::new(0.25, 0.5, 3.0), -DVec3::Z);
        assert_eq!(CORNER.meet(&ray), Some((3.0, [0.25, 0.5])));
        assert_eq!(CORNER.meet(&Ray::new(DVec3::Z, DVec3::X)), None);
        assert_eq!(CORNER.normal(), DVec3::Z);
    }

    #[test]
    fn what_has_no_area_is_not_packed() {
        assert!(CORNER.pack().is_some());
        assert!(Triangle([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]).pack().is_none());
        assert!(Triangle([DVec3::ZERO, DVec3::X, DVec3::Y * f64::INFINITY]).pack().is_none());
        assert_eq!(Triangle::bounds(&CORNER.pack().unwrap()), [[0.0; 3], [1.0, 1.0, 0.0]]);
    }
}
