//! Low-discrepancy sampling: a deterministic sequence that is well distributed over a pixel and over neighbouring pixels.

use crate::math::{DVec3, mix, name_of};

/// Dimensions of a sample: two for the pixel, two for the sky, two for the sun.
pub(super) const DIMENSIONS: usize = 6;

/// Side of the square that one Hilbert curve fills, in pixels.
const SQUARE: u32 = 256;

/// Increments of the additive recurrence R6 (Roberts 2018), times 2^32: powers of 1 / phi_6, the root of x^7 = x + 1.
const STEPS: [u32; DIMENSIONS] =
    [3_859_688_306, 3_468_523_226, 3_117_001_274, 2_801_104_767, 2_517_223_199, 2_262_111_973];

/// The coordinates, 0 to 1, of `count` samples of a pixel: an additive recurrence along a Hilbert curve.
pub(super) fn numbers(x: u32, y: u32, count: u32) -> impl Iterator<Item = [f64; DIMENSIONS]> {
    let square = mix(u64::from(x / SQUARE) << 32 | u64::from(y / SQUARE)) as u32;
    let first = hilbert(x % SQUARE, y % SQUARE).wrapping_mul(count).wrapping_add(square);
    (0..count).map(move |n| STEPS.map(|step| share(first.wrapping_add(n).wrapping_mul(step))))
}

/// Increments of the additive recurrence R2 (Roberts 2018): powers of the inverse of the root of x^3 = x + 1.
const LENS_STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];

/// The point of the lens, as two numbers from 0 to 1, of the `n`th sample of a pixel.
pub(super) fn on_lens(x: u32, y: u32, n: u64) -> [f64; 2] {
    let pixel = name_of(u64::from(x), u64::from(y));
    let first = [pixel as u32, (pixel >> 32) as u32].map(share);
    [0, 1].map(|i| libm::fmod(first[i] + n as f64 * LENS_STEPS[i], 1.0))
}

/// Five numbers, 0 to 1, for the path of the `sample`th sample of a picture after so many bounces: at random, since few
/// dimensions can be well distributed.
pub(super) fn further(sample: u64, bounce: usize) -> [f64; 5] {
    let a = name_of(sample, bounce as u64);
    let (b, c) = (mix(a), mix(!a));
    [a as u32, (a >> 32) as u32, b as u32, (b >> 32) as u32, c as u32].map(share)
}

fn share(bits: u32) -> f64 {
    f64::from(bits) / 4_294_967_296.0
}

/// The index of a pixel on the Hilbert curve through its square.
fn hilbert(mut x: u32, mut y: u32) -> u32 {
    let mut index = 0;
    let mut side = SQUARE / 2;
    while side > 0 {
        let (right, lower) = (u32::from(x & side > 0), u32::from(y & side > 0));
        index += side * side * ((3 * right) ^ lower);
        if lower == 0 {
            if right == 1 {
                (x, y) = (SQUARE - 1 - x, SQUARE - 1 - y);
            }
            std::mem::swap(&mut x, &mut y);
        }
        side /= 2;
    }
    index
}

/// Two unit vectors orthogonal to the unit vector `n` and to each other (Duff et al. 2017).
fn orthonormal_pair(n: DVec3) -> [DVec3; 2] {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y)]
}

/// A uniformly distributed point of the unit disc from two uniform numbers.
pub(super) fn disc(u: f64, v: f64) -> (f64, f64) {
    let (r, turn) = (libm::sqrt(u), v * std::f64::consts::TAU);
    (r * libm::cos(turn), r * libm::sin(turn))
}

/// A cosine-weighted direction of the hemisphere about `normal` (Malley's method).
pub(super) fn cosine_hemisphere(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let [right, up] = orthonormal_pair(normal);
    let (x, y) = disc(u, v);
    let z = libm::sqrt((1.0 - x * x - y * y).max(0.0));
    (right * x + up * y + normal * z).normalize()
}

/// A direction of the cone with the half-angle `half` (radians) about `axis`, uniform on its cross-section.
pub(super) fn cone(axis: DVec3, half: f64, u: f64, v: f64) -> DVec3 {
    let [right, up] = orthonormal_pair(axis);
    let (x, y) = disc(u, v);
    let radius = libm::tan(half);
    (axis + (right * x + up * y) * radius).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_pixel_by_neighbours() {
        let mut places = vec![None; (SQUARE * SQUARE) as usize];
        for y in 0..SQUARE {
            for x in 0..SQUARE {
                let place = &mut places[hilbert(x, y) as usize];
                assert!(place.is_none());
                *place = Some((x, y));
            }
        }
        for pair in places.windows(2) {
            let [Some(a), Some(b)] = pair else { panic!("a pixel is left out") };
            assert_eq!(a.0.abs_diff(b.0) + a.1.abs_diff(b.1), 1);
        }
    }

    #[test]
    fn steps_are_powers_of_the_root() {
        let root = 1.112_775_684_278_705_5_f64;
        assert!((root * root * root * root * root * root * root - root - 1.0).abs() < 1e-9);
        let mut power = 1.0;
        for step in STEPS {
            power /= root;
            assert!((f64::from(step) / 4_294_967_296.0 - power).abs() < 1e-6, "{}", power * 4_294_967_296.0);
        }
    }

    #[test]
    fn directions_are_even() {
        let n = 4096;
        let normal = DVec3::new(0.6, 0.0, 0.8);
        let mean = numbers(3, 5, n).map(|u| cosine_hemisphere(normal, u[2], u[3]).dot(normal)).sum::<f64>();
        // The mean cosine of a cosine-weighted hemisphere.
        assert!((mean / f64::from(n) - 2.0 / 3.0).abs() < 1e-2);
    }
}
