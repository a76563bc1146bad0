//! Round cones: two spheres and the frustum tangent to both; with equal ends, a sphere.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x8};

use super::queries::Block;
use super::tree::Beam;
use super::{Primitive, Ray};
use crate::math::DVec3;

/// Two spheres and the frustum tangent to both; where one sphere contains the other, only that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundCone {
    /// Centre of one sphere.
    pub a: DVec3,
    /// Its radius.
    pub ra: f64,
    /// Centre of the other sphere.
    pub b: DVec3,
    /// Its radius.
    pub rb: f64,
}

/// An intersection of a ray with a round cone's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Distance along the ray.
    pub t: f64,
    /// Outward unit normal.
    pub normal: DVec3,
    /// The parameter between the ends: 0 on the sphere about `a`, 1 on that about `b`.
    pub share: f64,
    is_entrance: bool,
}

impl RoundCone {
    /// The first entrance of the ray beyond `ray.near`, in double precision: the nearest entrance into a sphere or the frustum.
    #[must_use]
    pub fn enter(&self, ray: &Ray) -> Option<Entry> {
        nearest(self.surfaces(ray).into_iter().flatten().filter(|e| e.t > ray.near && e.is_entrance))
    }

    /// The nearest intersection beyond `ray.near`, from inside or outside, internal surfaces included: what a camera inside it
    /// sees, as POV-Ray shows unions.
    #[must_use]
    pub fn inner(&self, ray: &Ray) -> Option<Entry> {
        nearest(self.surfaces(ray).into_iter().flatten().filter(|e| e.t > ray.near))
    }

    /// The approximate normal at `p`: away from the axis.
    #[must_use]
    pub fn normal_at(&self, p: DVec3) -> DVec3 {
        let ba = self.b - self.a;
        let share = ((p - self.a).dot(ba) / ba.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (p - self.a - ba * share).normalize_or(DVec3::Z)
    }

    /// Is `p` inside?
    #[must_use]
    pub fn holds(&self, p: DVec3) -> bool {
        let (ba, rr) = (self.b - self.a, self.ra - self.rb);
        let d2 = ba.length_squared() - rr * rr;
        if (p - self.a).length() <= self.ra || (p - self.b).length() <= self.rb {
            return true;
        }
        if d2 <= 0.0 {
            return false;
        }
        // Inside the frustum: below its side, between its ends.
        let along = (p - self.a).dot(ba) / ba.length();
        let across = libm::sqrt(((p - self.a).length_squared() - along * along).max(0.0));
        let sin = rr / ba.length();
        let cos = libm::sqrt(1.0 - sin * sin);
        let (from, to) = (self.ra * sin, ba.length() + self.rb * sin);
        (from..=to).contains(&along) && across * cos + along * sin <= self.ra
    }

    /// Entrances and exits of both spheres and the frustum.
    fn surfaces(&self, ray: &Ray) -> [Option<Entry>; 6] {
        let (ba, d) = (self.b - self.a, ray.direction);
        let base = (self.a - ray.origin).dot(d);
        let oa = ray.at(base) - self.a;
        let rr = self.ra - self.rb;
        let (m0, m1, m2, m3, m5) = (ba.dot(ba), ba.dot(oa), ba.dot(d), d.dot(oa), oa.dot(oa));
        let d2 = m0 - rr * rr;
        let k2 = d2 - m2 * m2;
        let k1 = d2 * m3 - m1 * m2 + m2 * rr * self.ra;
        let k0 = d2 * m5 - m1 * m1 + m1 * rr * self.ra * 2.0 - m0 * self.ra * self.ra;
        let root = libm::sqrt(k1 * k1 - k0 * k2);
        let body = |sign: f64| {
            let t = (sign * root - k1) / k2;
            let y = m1 - self.ra * rr + t * m2;
            let normal = ((oa + d * t) * d2 - ba * y).normalize_or_zero();
            (y > 0.0 && y < d2).then_some(Entry {
                t: t + base,
                normal,
                share: y / d2,
                is_entrance: normal.dot(d) < 0.0,
            })
        };
        let sphere = |centre: DVec3, radius: f64, sign: f64, share: f64| {
            let o = ray.at(base) - centre;
            let b = o.dot(d);
            let t = -b + sign * libm::sqrt(b * b - o.length_squared() + radius * radius);
            let normal = (o + d * t) / radius;
            (!t.is_nan()).then_some(Entry { t: t + base, normal, share, is_entrance: sign < 0.0 })
        };
        [
            body(-1.0),
            body(1.0),
            sphere(self.a, self.ra, -1.0, 0.0),
            sphere(self.a, self.ra, 1.0, 0.0),
            sphere(self.b, self.rb, -1.0, 1.0),
            sphere(self.b, self.rb, 1.0, 1.0),
        ]
    }
}

fn nearest(entries: impl Iterator<Item = Entry>) -> Option<Entry> {
    entries.reduce(|a, b| if b.t < a.t { b } else { a })
}

#[inline(always)]
fn dot<S: Simd>(a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Primitive<8> for RoundCone {
    fn pack(&self) -> Option<[f32; 8]> {
        let p = [self.a.x, self.a.y, self.a.z, self.ra, self.b.x, self.b.y, self.b.z, self.rb].map(|x| x as f32);
        (p.iter().all(|x| x.is_finite()) && p[3] > 0.0 && p[7] > 0.0).then_some(p)
    }

    fn bounds(p: &[f32; 8]) -> [[f32; 3]; 2] {
        let axes = [0, 1, 2];
        [axes.map(|i| (p[i] - p[3]).min(p[i + 4] - p[7])), axes.map(|i| (p[i] + p[3]).max(p[i + 4] + p[7]))]
    }

    /// Quilez, "rounded cone - intersection"; each root is taken alone, so that spheres within one another need no
    /// case of their own.
    #[inline(always)]
    fn enter<S: Simd>(beam: &Beam<S>, block: &Block<8>) -> f32x8<S> {
        let simd = beam.simd;
        let zero = f32x8::splat(simd, 0.0);
        let d = beam.direction;
        let (a, ra) = (block.point(simd, 0), block.lane(simd, 3));
        let (b, rb) = (block.point(simd, 4), block.lane(simd, 7));
        let ba = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        // The ray's origin is moved to its point nearest to `a`: large distances would cancel catastrophically.
        let ao = [a[0] - beam.origin[0], a[1] - beam.origin[1], a[2] - beam.origin[2]];
        let base = dot(ao, d);
        let oa = [d[0] * base - ao[0], d[1] * base - ao[1], d[2] * base - ao[2]];
        let rr = ra - rb;
        let m0 = dot(ba, ba);
        let m1 = dot(ba, oa);
        let m2 = dot(ba, d);
        let m3 = dot(d, oa);
        let m5 = dot(oa, oa);
        let d2 = m0 - rr * rr;
        let k2 = d2 - m2 * m2;
        let k1 = d2 * m3 - m1 * m2 + m2 * rr * ra;
        let k0 = d2 * m5 - m1 * m1 + m1 * rr * ra * 2.0 - m0 * ra * ra;
        let h = k1 * k1 - k0 * k2;
        let near = f32x8::splat(simd, beam.near) - base;

        // A ray misses most blocks that it visits: square roots are taken only for hits.
        let infinity = f32x8::splat(simd, f32::INFINITY);
        let mut t = infinity;
        if (h.simd_ge(zero) & d2.simd_gt(zero)).any_true() {
            let body = (zero - h.sqrt() - k1) / k2;
            let y = m1 - ra * rr + body * m2;
            let on_body = y.simd_gt(zero) & y.simd_lt(d2) & body.simd_gt(near);
            t = on_body.select(body, infinity);
        }
        let h1 = m3 * m3 - m5 + ra * ra;
        let m6 = m3 - m2;
        let ob = [oa[0] - ba[0], oa[1] - ba[1], oa[2] - ba[2]];
        let h2 = m6 * m6 - dot(ob, ob) + rb * rb;
        if (h1.simd_ge(zero) | h2.simd_ge(zero)).any_true() {
            let t1 = zero - m3 - h1.sqrt();
            t = (t1.simd_gt(near) & t1.simd_lt(t)).select(t1, t);
            let t2 = zero - m6 - h2.sqrt();
            t = (t2.simd_gt(near) & t2.simd_lt(t)).select(t2, t);
        }
        t + base
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONE: RoundCone = RoundCone { a: DVec3::ZERO, ra: 2.0, b: DVec3::new(0.0, 0.0, 10.0), rb: 1.0 };

    /// The normals at the entrances of spheres and frustum are those of what is met there.
    #[test]
    fn each_part_is_entered() {
        let below = CONE.enter(&Ray::new(DVec3::new(0.0, 0.0, -9.0), DVec3::Z)).unwrap();
        assert_eq!((below.t, below.normal, below.share), (7.0, -DVec3::Z, 0.0));
        let above = CONE.enter(&Ray::new(DVec3::new(0.0, 0.0, 20.0), -DVec3::Z)).unwrap();
        assert_eq!((above.t, above.normal, above.share), (9.0, DVec3::Z, 1.0));
        let side = CONE.enter(&Ray::new(DVec3::new(9.0, 0.0, 5.0), -DVec3::X)).unwrap();
        // The slope of the tangent frustum: radii fall by 1 in 10.
        assert!((side.normal.z - 0.1).abs() < 1e-12 && side.normal.x > 0.0, "{}", side.normal);
        assert!(side.share > 0.4 && side.share < 0.6);
        assert_eq!(CONE.enter(&Ray::new(DVec3::new(9.0, 0.0, 5.0), DVec3::X)), None);
    }

    /// A ray from inside enters nothing, but sees the inside.
    #[test]
    fn inside_is_seen_from_within() {
        let middle = DVec3::new(0.0, 0.0, 5.0);
        let ray = Ray::new(middle, DVec3::X);
        assert!(CONE.holds(middle) && CONE.enter(&ray).is_none());
        let wall = CONE.inner(&ray).unwrap();
        assert!(CONE.holds(ray.at(wall.t - 1e-9)) && !CONE.holds(ray.at(wall.t + 1e-9)));
        assert!(!CONE.holds(DVec3::new(0.0, 0.0, 11.5)) && CONE.holds(DVec3::new(0.0, 0.0, -1.5)));
    }

    #[test]
    fn only_solids_are_packed() {
        let packed = CONE.pack().unwrap();
        assert_eq!(RoundCone::bounds(&packed), [[-2.0, -2.0, -2.0], [2.0, 2.0, 11.0]]);
        assert!(RoundCone { ra: 0.0, ..CONE }.pack().is_none());
        assert!(RoundCone { b: DVec3::NAN, ..CONE }.pack().is_none());
        // One end within the other is that sphere alone.
        let ball = RoundCone { a: DVec3::ZERO, ra: 3.0, b: DVec3::X, rb: 1.0 };
        assert!(ball.holds(-DVec3::X * 2.9) && !ball.holds(DVec3::X * 3.1));
    }
}
