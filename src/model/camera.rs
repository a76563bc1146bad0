//! The view: given, or fitted to what there is to see.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Film, Lens};
use crate::math::{DVec3, Degrees, Point};

/// Room left around what is fitted, as a share of the picture.
const MARGIN: f64 = 0.06;
/// How often a camera at a height is fitted anew: each time its height is wrong by about a tenth of what it was.
const TURNS: u32 = 6;
/// The sine of the greatest angle by which such a camera looks up or down.
const STEEPEST: f64 = 0.9;
/// Width of the film that focal lengths are told for, in millimetres: that of small cameras since 1925, and of full-frame sensors.
const FILM_WIDTH: f64 = 36.0;

/// A camera as a scene writes it: given by `at` and `look_at`, or else turned to an angle and fitted.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CameraSpec {
    /// Where it stands.
    pub at: Option<Point>,
    /// What it looks at.
    pub look_at: Option<Point>,
    /// Without `at`: how far it goes around to the right of the front.
    pub turn: Degrees,
    /// Without `at`: how far above the level it looks from.
    pub rise: Degrees,
    /// Without `at`: its height in scene units, as that of a person's eye, in place of `rise`.
    #[schemars(range(min = -1e6, max = 1e6))]
    pub eye: Option<f64>,
    /// Horizontal angle of view; 0 for a parallel view.
    pub angle: Degrees,
    /// Focal length in millimetres for a film 36 mm wide, in place of `angle`: 24 is wide, 50 as one sees, 200 brings near.
    #[schemars(range(min = 1.0, max = 5000.0))]
    pub length: Option<f64>,
    /// Width of the lens' opening in scene units: what is nearer or farther than `focus` blurs, but in the exact look. A lens of
    /// 50 mm at f/2 has 25 mm; 0 shows everything sharp.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub aperture: f64,
    /// Distance along the view of what is sharp, in scene units; by default that of what it looks at.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e9))]
    pub focus: Option<f64>,
    /// Longer or shorter exposure in stops: each doubles the light, or halves it.
    #[schemars(range(min = -20.0, max = 20.0))]
    pub exposure: f64,
    /// How light becomes a picture.
    pub film: Film,
    /// Without `at`: share of extra room around what is fitted.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub room: f64,
}

impl Default for CameraSpec {
    fn default() -> Self {
        Self {
            at: None,
            look_at: None,
            turn: Degrees(0.0),
            rise: Degrees(4.0),
            eye: None,
            angle: Degrees(30.0),
            length: None,
            aperture: 0.0,
            focus: None,
            exposure: 0.0,
            film: Film::Soft,
            room: 0.0,
        }
    }
}

impl CameraSpec {
    /// Do `at`, `look_at` and `angle` fit together?
    ///
    /// # Errors
    /// [`CameraError`].
    pub fn check(&self) -> Result<(), CameraError> {
        match (self.at, self.look_at) {
            (None, None) if self.eye.is_some() && self.angle() <= 0.0 => Err(CameraError::FlatEye),
            (None, None) => Ok(()),
            (Some(_), None) => Err(CameraError::LooksNowhere),
            (None, Some(_)) => Err(CameraError::StandsNowhere),
            (Some(at), Some(look_at)) if at.0.truncate() == look_at.0.truncate() => Err(CameraError::Upright),
            _ if self.angle() <= 0.0 => Err(CameraError::NoAngle),
            _ => Ok(()),
        }?;
        if self.aperture > 0.0 && self.angle() <= 0.0 { Err(CameraError::FlatLens) } else { Ok(()) }
    }

    /// Horizontal angle of view, in radians.
    fn angle(&self) -> f64 {
        self.length.map_or(self.angle.radians(), |length| 2.0 * libm::atan(FILM_WIDTH * 0.5 / length))
    }

    /// From the front, parallel: the view of flat scenes.
    #[must_use]
    pub fn front() -> Self {
        Self { rise: Degrees(0.0), angle: Degrees(0.0), ..Self::default() }
    }
}

/// Why there is no view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CameraError {
    /// A place without a direction.
    #[error("a camera with `at` needs `look_at` too")]
    LooksNowhere,
    /// A direction without a place.
    #[error("a camera with `look_at` needs `at` too")]
    StandsNowhere,
    /// The top of the picture would be anywhere.
    #[error("a camera must not look straight up or down, or at its own place")]
    Upright,
    /// A parallel view is from nowhere.
    #[error("a camera with `eye` needs an `angle` above 0")]
    FlatEye,
    /// A parallel view has no lens.
    #[error("a camera with `aperture` needs an `angle` above 0")]
    FlatLens,
    /// A parallel view is fitted, not placed.
    #[error("a camera with `at` needs an `angle` above 0")]
    NoAngle,
}

/// A camera in world space; the top of the picture is up (z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands.
    pub at: DVec3,
    /// What it looks at.
    pub look_at: DVec3,
    /// How the world falls into the picture.
    pub projection: Projection,
    /// Width of the picture over its height.
    pub aspect: f64,
    /// Its lens.
    pub lens: Lens,
    /// All light that comes to it is multiplied by this.
    pub gain: f64,
    /// Its film.
    pub film: Film,
}

/// How the world falls into a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Central projection.
    Perspective {
        /// Horizontal angle of view, in radians.
        angle: f64,
    },
    /// Parallel projection.
    Parallel {
        /// Width of what is seen, in scene units.
        width: f64,
    },
}

/// A point in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Fraction of the width from the left.
    pub x: f64,
    /// Fraction of the height from the top.
    pub y: f64,
    /// Width of one scene unit there, as a fraction of the picture's width.
    pub scale: f64,
    /// Distance along the view.
    pub depth: f64,
}

impl Camera {
    /// A parallel view from the front, one unit wide.
    pub const FRONT: Self = Self {
        at: DVec3::NEG_Y,
        look_at: DVec3::ZERO,
        projection: Projection::Parallel { width: 1.0 },
        aspect: 1.0,
        lens: Lens::PINHOLE,
        gain: 1.0,
        film: Film::Soft,
    };

    /// The camera that `spec` describes, fitted to `balls` (centre, radius) where it has no place of its own.
    /// `aspect` is the picture's width over its height.
    ///
    /// # Errors
    /// [`CameraError`] where `at`, `look_at` and `angle` do not fit together.
    pub fn new(
        spec: &CameraSpec,
        aspect: f64,
        balls: impl Iterator<Item = (DVec3, f64)> + Clone,
    ) -> Result<Self, CameraError> {
        spec.check()?;
        let placed = Self::placed(spec, aspect, balls);
        let focus = spec.focus.unwrap_or((placed.look_at - placed.at).length());
        let lens = Lens { aperture: spec.aperture, focus };
        Ok(Self { lens, gain: libm::exp2(spec.exposure), film: spec.film, ..placed })
    }

    /// As [`Camera::new`], with a pinhole.
    fn placed(spec: &CameraSpec, aspect: f64, balls: impl Iterator<Item = (DVec3, f64)> + Clone) -> Self {
        if let (Some(at), Some(look_at)) = (spec.at, spec.look_at) {
            let projection = Projection::Perspective { angle: spec.angle() };
            return Self { at: at.0, look_at: look_at.0, projection, aspect, ..Self::FRONT };
        }
        let Some(eye) = spec.eye else { return Self::fitted(spec, aspect, balls) };
        // Where it stands and how far it looks up depend on each other.
        let mut rise = 0.0;
        let mut camera = Self::fitted(&CameraSpec { rise: Degrees(rise), ..*spec }, aspect, balls.clone());
        for _ in 0..TURNS {
            let sine = (eye - camera.look_at.z) / (camera.at - camera.look_at).length();
            rise = libm::asin(sine.clamp(-STEEPEST, STEEPEST)) * 180.0 / std::f64::consts::PI;
            camera = Self::fitted(&CameraSpec { rise: Degrees(rise), ..*spec }, aspect, balls.clone());
        }
        camera
    }

    /// The camera that is turned as `spec` says, as near as all `balls` allow.
    fn fitted(spec: &CameraSpec, aspect: f64, balls: impl Iterator<Item = (DVec3, f64)> + Clone) -> Self {
        let angle = spec.angle();
        let (turn, rise) = (spec.turn.radians(), spec.rise.radians());
        let back = DVec3::new(libm::sin(turn) * libm::cos(rise), -libm::cos(turn) * libm::cos(rise), libm::sin(rise));
        let right = DVec3::new(libm::cos(turn), libm::sin(turn), 0.0);
        let up = back.cross(right);
        let grow = 1.0 + MARGIN + spec.room;

        // The middle of what is seen along each axis of the view.
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for (centre, radius) in balls.clone() {
            let p = DVec3::new(centre.dot(right), centre.dot(up), centre.dot(back));
            low = low.min(p - radius);
            high = high.max(p + radius);
        }
        if !low.is_finite() {
            (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
        }
        let middle = (low + high) * 0.5;
        let look_at = right * middle.x + up * middle.y + back * middle.z;
        let size = high - low;
        if angle <= 0.0 {
            let width = (size.x.max(size.y * aspect) * grow).max(1e-6);
            return Self {
                at: look_at + back * (size.length() + width),
                look_at,
                projection: Projection::Parallel { width },
                aspect,
                ..Self::FRONT
            };
        }
        // A ball of radius r at (x, depth D - z) is seen whole when x + r / cos(h) <= (D - z) tan(h), for each half
        // angle h.
        let tan = libm::tan(angle * 0.5) / grow;
        let distance = balls.fold(size.length() * 1e-3, |distance, (centre, radius)| {
            let p = centre - look_at;
            [(p.dot(right), tan), (p.dot(up), tan / aspect)]
                .into_iter()
                .map(|(x, tan)| p.dot(back) + (x.abs() + radius * libm::sqrt(1.0 + tan * tan)) / tan)
                .fold(distance, f64::max)
        });
        let projection = Projection::Perspective { angle };
        Self { at: look_at + back * distance, look_at, projection, aspect, ..Self::FRONT }
    }

    /// Unit vectors to the right, up and forwards of the picture.
    #[must_use]
    pub fn frame(&self) -> [DVec3; 3] {
        let forwards = (self.look_at - self.at).normalize();
        let right = forwards.cross(DVec3::Z).normalize();
        [right, right.cross(forwards), forwards]
    }

    /// Where `p` falls in the picture; `None` behind the camera.
    #[must_use]
    pub fn project(&self, p: DVec3) -> Option<Projected> {
        let [right, up, forwards] = self.frame();
        let d = p - self.at;
        let depth = d.dot(forwards);
        let scale = match self.projection {
            Projection::Parallel { width } => 1.0 / width,
            Projection::Perspective { .. } if depth <= 0.0 => return None,
            Projection::Perspective { angle } => 0.5 / (depth * libm::tan(angle * 0.5)),
        };
        Some(Projected { x: 0.5 + d.dot(right) * scale, y: 0.5 - d.dot(up) * scale * self.aspect, scale, depth })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stands_at_the_height_of_an_eye() {
        let balls =
            [(DVec3::new(0.0, 0.0, 1.0), 0.5), (DVec3::new(3.0, -1.0, 12.0), 0.4), (DVec3::new(-5.0, 1.0, 7.0), 0.2)];
        for (eye, angle) in [(1.6, 30.0), (1.6, 60.0), (15.0, 40.0)] {
            let spec = CameraSpec { eye: Some(eye), angle: Degrees(angle), ..CameraSpec::default() };
            let camera = Camera::new(&spec, 1.2, balls.into_iter()).unwrap();
            assert!((camera.at.z - eye).abs() < 1e-2, "{eye} {angle}: {}", camera.at.z);
        }
        let flat = CameraSpec { eye: Some(1.0), angle: Degrees(0.0), ..CameraSpec::default() };
        assert_eq!(flat.check(), Err(CameraError::FlatEye));
        let flat = CameraSpec { aperture: 0.1, ..CameraSpec::front() };
        assert_eq!(flat.check(), Err(CameraError::FlatLens));
    }

    #[test]
    fn a_lens_has_an_angle_and_what_is_sharp() {
        let ball = [(DVec3::new(0.0, 0.0, 1.0), 1.0)];
        let camera = |spec: &CameraSpec| Camera::new(spec, 1.0, ball.into_iter()).unwrap();
        // 36 mm at 18 mm: a right angle.
        let wide = camera(&CameraSpec { length: Some(18.0), aperture: 0.1, ..CameraSpec::default() });
        let Projection::Perspective { angle } = wide.projection else { panic!("a parallel view") };
        assert!((angle - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(wide.lens, Lens { aperture: 0.1, focus: (wide.at - wide.look_at).length() });
        assert_eq!(camera(&CameraSpec { focus: Some(3.0), ..CameraSpec::default() }).lens.focus, 3.0);
    }

    #[test]
    fn fits_what_there_is_to_see() {
        let balls =
            [(DVec3::new(0.0, 0.0, 1.0), 0.5), (DVec3::new(3.0, -1.0, 8.0), 0.1), (DVec3::new(-2.0, 1.0, 4.0), 0.2)];
        for angle in [0.0, 30.0, 80.0] {
            for aspect in [0.5, 1.0, 2.0] {
                let spec = CameraSpec { angle: Degrees(angle), turn: Degrees(25.0), ..CameraSpec::default() };
                let camera = Camera::new(&spec, aspect, balls.into_iter()).unwrap();
                let mut extreme = 0.0_f64;
                for (centre, radius) in balls {
                    let p = camera.project(centre).unwrap();
                    for d in [p.x - 0.5 + radius * p.scale, 0.5 - p.x + radius * p.scale] {
                        extreme = extreme.max(d);
                    }
                    for d in [p.y - 0.5, 0.5 - p.y] {
                        extreme = extreme.max(d + radius * p.scale * aspect);
                    }
                }
                assert!((0.4..=0.501).contains(&extreme), "{angle} {aspect}: {extreme}");
            }
        }
    }
}
