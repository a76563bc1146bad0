//! Where the sun stands.

use super::{DVec3, Degrees, rotation};

/// The tilt of the Earth's axis.
const TILT: Degrees = Degrees(23.44);

/// The direction to the sun at `hour` of solar time, of length 1: x is east and y north, unless north is turned from y
/// counterclockwise. Day 80 is the equinox in spring. Below the horizon z is negative.
#[must_use]
pub fn solar_direction(latitude: Degrees, day: f64, hour: f64, north: Degrees) -> DVec3 {
    // The solstice of December is ten days before the year begins.
    let declination = -TILT.radians() * libm::cos(std::f64::consts::TAU * (day + 10.0) / 365.0);
    let (sin_d, cos_d) = (libm::sin(declination), libm::cos(declination));
    let (sin_l, cos_l) = (libm::sin(latitude.radians()), libm::cos(latitude.radians()));
    let angle = Degrees((hour - 12.0) * 15.0).radians();
    let (sin_h, cos_h) = (libm::sin(angle), libm::cos(angle));
    let east = -cos_d * sin_h;
    let northward = sin_d * cos_l - cos_d * sin_l * cos_h;
    let up = sin_d * sin_l + cos_d * cos_l * cos_h;
    rotation(DVec3::Z, north.radians()) * DVec3::new(east, northward, up)
}
