//! Unit vectors from polar and cylindrical coordinates, with the same bits on every platform.

use glam::DVec3;

/// The golden angle `pi (3 - sqrt 5)`, in radians: the azimuth from one point of a spherical Fibonacci lattice to the next.
pub const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// The unit vector at `polar` radians from +z and at `azimuth` radians from +x towards +y.
#[must_use]
pub fn from_polar(polar: f64, azimuth: f64) -> DVec3 {
    from_sin_cos(libm::sin(polar), libm::cos(polar), azimuth)
}

/// The unit vector with this `z`, -1 to 1, at `azimuth` radians from +x towards +y.
///
/// With z uniform in (-1, 1) and the azimuth uniform in (0, 2 pi) it is uniform on the sphere (Archimedes' hat-box
/// theorem).
#[must_use]
pub fn from_height(z: f64, azimuth: f64) -> DVec3 {
    from_sin_cos(libm::sqrt((1.0 - z * z).max(0.0)), z, azimuth)
}

/// The vector `(sin cos azimuth, sin sin azimuth, cos)`: the unit vector whose polar angle has this sine and cosine.
#[must_use]
pub fn from_sin_cos(sin: f64, cos: f64, azimuth: f64) -> DVec3 {
    DVec3::new(sin * libm::cos(azimuth), sin * libm::sin(azimuth), cos)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::Stream;
    use super::*;

    #[test]
    fn heights_are_uniform_on_the_sphere() {
        assert_eq!(GOLDEN_ANGLE, std::f64::consts::PI * (3.0 - libm::sqrt(5.0)));
        let mut random = Stream::new(1, "sphere");
        let n = 100_000;
        let (mut mean, mut squares) = (DVec3::ZERO, DVec3::ZERO);
        for _ in 0..n {
            let d = from_height(random.random_range(-1.0..1.0), random.random::<f64>() * std::f64::consts::TAU);
            assert!((d.length() - 1.0).abs() < 1e-12);
            mean += d / f64::from(n);
            squares += d * d / f64::from(n);
        }
        assert!(mean.length() < 0.01 && (squares - 1.0 / 3.0).abs().max_element() < 0.01, "{mean} {squares}");
        assert!((from_polar(0.3, 0.7) - from_height(libm::cos(0.3), 0.7)).length() < 1e-12);
    }
}
