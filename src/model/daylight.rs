//! Sun and sky of a place, a day and an hour.

use std::f64::consts::{PI, TAU};

use hw_skymodel::rgb::{SkyParams, SkyState};

use super::clouds::Clouds;
use super::{DaylightSpec, Dome, Light, Sky, SkyPicture};
use crate::math::{Colour, DVec3, GOLDEN_ANGLE, from_height, power, solar_direction};

/// Why there is no day.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DaylightError {
    /// The sun is below the horizon, by so many degrees.
    #[error("at this hour the sun is {0:.1} degrees below the horizon: take one by day")]
    Night(f64),
    /// The model has no such sky.
    #[error("the sky has no light for this: turbidity is from 1 to 10")]
    NoSky,
}

/// Illuminance of the sun above the air, in klx (IES, *Recommended Practice for the Calculation of Daylight
/// Availability*, 1984), over the 0.683 klx of a unit of the sky's model.
const ABOVE_AIR: f64 = 127.5 / 0.683;
/// Wavelengths that stand for red, green and blue, in micrometres, and what ozone takes out of each (Preetham et al. 1999,
/// appendix A.1: 0.0035 m of it).
const WAVES: [(f64, f64); 3] = [(0.65, 0.0217), (0.55, 0.0298), (0.45, 0.0011)];
/// The sun's apparent diameter, in radians.
const SIZE: f64 = 0.0093;
/// A white surface that faces the sun shows this, in sun and sky together, before the look's own strengths.
const WHITE: f64 = 1.2;
/// What materials scatter by default of the light that they are given.
const SCATTERED: f64 = 0.8;
/// What the ground below the model's sky reflects.
const ALBEDO: f32 = 0.2;
/// Below this elevation, in radians, the sky passes into one colour all around: the last degrees of the model are a white line,
/// which a ground that fades before the horizon would show whole.
const HAZE: f64 = 0.07;
/// Rows of the sky's picture, and with clouds.
const ROWS: u32 = 192;
const CLOUDY_ROWS: u32 = 768;
/// What clouds scatter of the light that falls on them.
const WHITENESS: f64 = 0.8;
/// Clouds come out of the haze of the horizon over so many times its height.
const DISTANT: f64 = 3.0;
/// Illuminance under an overcast sky, in klx: this, and so much more by the sine of the sun's elevation (IES 1984).
const OVERCAST: [f64; 2] = [0.3, 21.0];

/// Sun and sky of a day and an hour.
#[derive(Clone, Debug)]
pub struct Daylight {
    towards: DVec3,
    /// Of the sky's model: nine numbers a channel, and its radiance.
    channels: [([f64; 9], f64); 3],
    /// What of the sun's light reaches a surface that faces it.
    sun: [f64; 3],
    /// What of the sky's light reaches a level surface.
    level: [f64; 3],
    /// Clouds, if there are any, and what they are seen by: the sun where nothing is before it, and the clear sky's light on a level
    /// surface.
    clouds: Option<(Clouds, [[f64; 3]; 2])>,
    /// Brightness of what is shown, by that of the model.
    scale: f64,
}

impl Daylight {
    /// The light of `spec`.
    ///
    /// # Errors
    /// [`DaylightError::Night`] while the sun is down.
    pub fn new(spec: &DaylightSpec) -> Result<Self, DaylightError> {
        let towards = solar_direction(spec.latitude, spec.day, spec.hour, spec.north);
        let elevation = libm::asin(towards.z.clamp(-1.0, 1.0));
        if elevation < 0.0 {
            return Err(DaylightError::Night(-elevation * 180.0 / PI));
        }
        let (elevation, turbidity) = (elevation as f32, spec.turbidity as f32);
        let state = SkyState::new(&SkyParams { elevation, turbidity, albedo: [ALBEDO; 3] });
        let (numbers, radiances) = state.map_err(|_| DaylightError::NoSky)?.raw();
        let own = |c: usize| (std::array::from_fn(|i| steady(numbers[9 * c + i])), steady(radiances[c]));
        let sun = sunlight(towards.z, spec.turbidity);
        let mut daylight =
            Self { towards, channels: [0, 1, 2].map(own), sun, level: [0.0; 3], clouds: None, scale: 1.0 };
        daylight.level = daylight.level();
        if spec.clouds > 0.0 {
            let clouds = Clouds::new(spec.clouds, spec.day, spec.hour, towards);
            daylight.clouds = Some((clouds, [sun, daylight.level]));
            daylight.sun = sun.map(|x| x * clouds.sun());
            daylight.level = daylight.level();
        }
        daylight.scale = spec.exposure * WHITE * PI / (luminance(daylight.sun) + luminance(daylight.level));
        Ok(daylight)
    }

    /// The sun.
    #[must_use]
    pub fn sun(&self) -> Light {
        let colour = Colour(self.sun).times(self.scale / PI);
        Light::Sun { towards: self.towards, colour, size: SIZE, shadow: true }
    }

    /// A light without shadow from the other side, which stands for the sky where no look has one.
    #[must_use]
    pub fn fill(&self) -> Light {
        let towards = DVec3::new(-self.towards.x, -self.towards.y, 0.7).normalize();
        let colour = Colour(self.level).times(self.scale / PI);
        Light::Sun { towards, colour, size: 0.0, shadow: false }
    }

    /// The sky, without the sun. In the studio look it is to the sun what it is in nature.
    #[must_use]
    pub fn sky(&self) -> Sky {
        // A ground fades into the mean of all directions at the horizon: so does the sky, from the other side.
        let mut haze = [0.0; 3];
        for x in 0..ROWS {
            let light = self.seen(TAU * f64::from(x) / f64::from(ROWS), HAZE);
            (0..3).for_each(|c| haze[c] += light[c] / f64::from(ROWS));
        }
        let rows = if self.clouds.is_some() { CLOUDY_ROWS } else { ROWS };
        let of = self.clone();
        let picture = SkyPicture::painted(rows, move |turn, rise| {
            let clear = (rise / HAZE).clamp(0.0, 1.0);
            if clear == 0.0 {
                return haze.map(|c| c as f32);
            }
            let light = of.seen(turn, rise.max(HAZE));
            [0, 1, 2].map(|c| (haze[c] + (light[c] - haze[c]) * clear) as f32)
        });
        // A white surface scatters four fifths, so that what shines by itself is to be as much darker.
        let strength = Light::SUN * SCATTERED;
        let light = Light::SUN / (strength * Dome::STRENGTH);
        Sky::Picture { picture, turn: 0.0, strength, light }
    }

    /// What is shown in a direction, by its angle from +x about the vertical and its elevation, in radians.
    fn seen(&self, turn: f64, rise: f64) -> [f64; 3] {
        self.radiance(from_height(libm::sin(rise), turn)).map(|c| c * self.scale)
    }

    /// Radiance from a direction of length 1 above the horizon.
    fn radiance(&self, direction: DVec3) -> [f64; 3] {
        let clear = self.clear(direction);
        let Some((clouds, [sun, level])) = self.clouds else { return clear };
        let seen = clouds.seen(direction);
        let cover = seen.cover * ((direction.z - HAZE) / (DISTANT * HAZE)).clamp(0.0, 1.0);
        let closed = clouds.closed();
        // One sheet is three times as bright overhead as at the horizon (Moon and Spencer 1942).
        let [least, more] = OVERCAST;
        let zenith = (least + more * self.towards.z) / 0.683 * 9.0 / (7.0 * PI);
        let sheet = zenith * (1.0 + 2.0 * direction.z.max(0.0)) / 3.0 * (0.8 + 0.4 * seen.lit);
        [0, 1, 2].map(|c| {
            let cloud = WHITENESS / PI * (sun[c] * seen.lit + level[c]);
            let cloud = cloud + (sheet - cloud) * closed;
            clear[c] + (cloud - clear[c]) * cover.max(closed * closed)
        })
    }

    /// Radiance of the clear sky (Hosek and Wilkie 2012, equations 8 and 9).
    fn clear(&self, direction: DVec3) -> [f64; 3] {
        let cos_theta = direction.z.max(0.0);
        let cos_gamma = direction.dot(self.towards).clamp(-1.0, 1.0);
        let gamma = libm::acos(cos_gamma);
        let square = cos_gamma * cos_gamma;
        self.channels.map(|([a, b, c, d, e, f, g, i, h], radiance)| {
            let glow = 1.0 + h * h - 2.0 * h * cos_gamma;
            let about = c + d * libm::exp(e * gamma) + f * square + g * (1.0 + square) / (glow * libm::sqrt(glow));
            let rise = 1.0 + a * libm::exp(b / (cos_theta + 0.01));
            (radiance * rise * (about + i * libm::sqrt(cos_theta))).max(0.0)
        })
    }

    /// What of the sky's light reaches a level surface.
    fn level(&self) -> [f64; 3] {
        const DIRECTIONS: u32 = 1024;
        let mut sum = [0.0; 3];
        for i in 0..DIRECTIONS {
            // Directions by the cosine of their height, so that each counts alike.
            let height = libm::sqrt((f64::from(i) + 0.5) / f64::from(DIRECTIONS));
            let direction = from_height(height, GOLDEN_ANGLE * f64::from(i));
            let light = self.radiance(direction);
            (0..3).for_each(|c| sum[c] += light[c]);
        }
        sum.map(|x| x * PI / f64::from(DIRECTIONS))
    }
}

/// The sun's light on a surface that faces it, `height` the sine of its elevation (Preetham et al. 1999, appendix A.1, without
/// what gases and water vapour take).
fn sunlight(height: f64, turbidity: f64) -> [f64; 3] {
    let zenith = 90.0 - libm::asin(height.clamp(0.0, 1.0)) * 180.0 / PI;
    let mass = 1.0 / (height + 0.15 * power(93.885 - zenith, -1.253));
    let haze = 0.046_08 * turbidity - 0.045_86;
    WAVES.map(|(wave, ozone)| {
        let depth = 0.008_735 * power(wave, -4.08) + haze.max(0.0) * power(wave, -1.3) + ozone;
        ABOVE_AIR * libm::exp(-depth * mass)
    })
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// With fewer digits: platforms' cube roots differ in the last of an `f32`.
fn steady(x: f32) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let size = libm::exp2(libm::floor(libm::log2(f64::from(x.abs()))) - 14.0);
    libm::round(f64::from(x) / size) * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Degrees;
    use crate::model::{Camera, Ground, Look, Material, Model};

    /// At a place where the sun stands so high at noon.
    fn at_height(degrees: f64) -> DaylightSpec {
        DaylightSpec {
            latitude: Degrees(90.0 - degrees),
            day: 81.0,
            hour: 12.0,
            north: Degrees(0.0),
            turbidity: 2.0,
            clouds: 0.0,
            exposure: 1.0,
        }
    }

    /// The clear day of IES 1984, in klx - sun `127.5 exp(-0.21 / sin h)`, sky `0.8 + 15.5 sqrt(sin h)` - lies between one
    /// of pure air and one with some haze. (Of a sun lower than that the model's sky is up to a tenth brighter.)
    #[test]
    fn sun_and_sky_are_as_bright_as_on_a_clear_day() {
        for degrees in [35.0, 45.0, 60.0, 75.0] {
            let day = |turbidity: f64| {
                let daylight = Daylight::new(&DaylightSpec { turbidity, ..at_height(degrees) }).unwrap();
                assert!((daylight.towards.z - libm::sin(Degrees(degrees).radians())).abs() < 0.02);
                (luminance(daylight.sun) * 0.683, luminance(daylight.level) * 0.683)
            };
            let sine = libm::sin(Degrees(degrees).radians());
            let (sun, sky) = (127.5 * libm::exp(-0.21 / sine), 0.8 + 15.5 * libm::sqrt(sine));
            let ((clear_sun, clear_sky), (hazy_sun, hazy_sky)) = (day(1.0), day(3.0));
            assert!(hazy_sun < sun && sun < clear_sun, "{degrees}: {hazy_sun} {sun} {clear_sun}");
            assert!(clear_sky < sky && sky < hazy_sky, "{degrees}: {clear_sky} {sky} {hazy_sky}");
        }
    }

    #[test]
    fn a_low_sun_is_red_and_the_sky_blue() {
        let warmth = |degrees: f64| {
            let [r, _, b] = Daylight::new(&at_height(degrees)).unwrap().sun;
            r / b
        };
        assert!(warmth(5.0) > 2.0 * warmth(60.0) && warmth(60.0) > 1.0);
        let noon = Daylight::new(&at_height(45.0)).unwrap();
        let [r, g, b] = noon.radiance(from_height(0.9, 0.5 * PI));
        assert!(b > 1.5 * g && g > r, "{r} {g} {b}");
        // Brighter about the sun and beyond the zenith than a quarter away from it.
        let light = |y: f64, z: f64| luminance(noon.radiance(DVec3::new(0.0, y, z).normalize()));
        let (about, quarter, beyond) = (luminance(noon.radiance(noon.towards)), light(0.5, 0.5), light(0.95, 0.2));
        assert!(about > 2.0 * quarter && beyond > quarter, "{about} {quarter} {beyond}");
    }

    #[test]
    fn the_studio_has_sun_and_sky_as_in_nature() {
        let daylight = Daylight::new(&at_height(40.0)).unwrap();
        let ground = Ground { material: Material::matt(Colour([0.0; 3])), height: 0.0, reach: 1.0, radius: None };
        let model = Model {
            title: String::new(),
            is_flat: false,
            objects: vec![],
            materials: vec![],
            camera: Camera::FRONT,
            lights: vec![],
            ground: Some(ground),
            sky: daylight.sky(),
            air: None,
            look: Look::Natural,
            marks: vec![],
            strokes: vec![],
        };
        let lights = Dome::new(&model).lights(400);
        let level = |c: usize| lights.iter().map(|(d, colour)| d.z.max(0.0) * colour.0[c]).sum::<f64>();
        let Colour(sun) = daylight.sun().studio();
        let nature = daylight.level.into_iter().zip(daylight.sun);
        for (c, (sky_in_nature, sun_in_nature)) in nature.enumerate() {
            let (shown, expected) = (level(c) / sun[c], sky_in_nature / sun_in_nature);
            assert!((shown / expected - 1.0).abs() < 0.05, "{shown} {expected}");
        }
    }

    #[test]
    fn a_longer_exposure_is_brighter_and_night_is_refused() {
        let spec = at_height(30.0);
        let white = |spec: &DaylightSpec| {
            let daylight = Daylight::new(spec).unwrap();
            (luminance(daylight.sun().colour().0) + luminance(daylight.fill().colour().0)) / WHITE
        };
        assert!((white(&spec) - 1.0).abs() < 1e-9);
        assert!((white(&DaylightSpec { exposure: 2.5, ..spec }) - 2.5).abs() < 1e-9);
        let night = Daylight::new(&DaylightSpec { hour: 1.0, ..spec });
        assert!(matches!(night, Err(DaylightError::Night(below)) if below > 20.0));
    }

    #[test]
    fn fewer_digits() {
        assert_eq!([steady(1.0), steady(-0.75), steady(0.0)], [1.0, -0.75, 0.0]);
        assert_eq!(steady(0.1), steady(f32::from_bits(0.1_f32.to_bits() + 1)));
        assert!((steady(0.1) - 0.1).abs() < 1e-5);
    }
}
