//! Materials, lights, ground and sky.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{GrassSpec, Pattern, ReliefSpec, SkyPicture, Tips};
use crate::math::{Colour, DVec3, Degrees, Point};

/// What an object is made of, in the terms of POV-Ray's finish.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Its colour.
    pub colour: Colour,
    /// Share of light that it shows without any lamp.
    #[serde(default = "ambient")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub ambient: f64,
    /// Share of the lamps' light that it scatters.
    #[serde(default = "diffuse")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub diffuse: f64,
    /// Share of the lamps' light that goes through and is scattered beyond, as by a leaf: for what is thin.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub through: f64,
    /// How much paler the lower side of leaves is: the share of white in its colour.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub paler: f64,
    /// Light of its own, as a multiple of its colour.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub emission: f64,
    /// Strength of the highlight after Blinn.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub specular: f64,
    /// Size of that highlight: 0.001 is a point, 1 is all over.
    #[serde(default = "roughness")]
    #[schemars(range(min = 0.0005, max = 1.0))]
    pub roughness: f64,
    /// Strength of the highlight after Phong.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub phong: f64,
    /// Sharpness of that highlight: 1 is all over, 250 is polished.
    #[serde(default = "phong_size")]
    #[schemars(range(min = 1.0, max = 2000.0))]
    pub phong_size: f64,
    /// What is drawn over the colour.
    #[serde(default)]
    pub pattern: Option<Pattern>,
    /// The ends of limbs in another colour.
    #[serde(default)]
    pub tips: Option<Tips>,
}

fn ambient() -> f64 {
    0.2
}

fn diffuse() -> f64 {
    0.8
}

fn roughness() -> f64 {
    0.05
}

fn phong_size() -> f64 {
    40.0
}

impl Material {
    /// A matt material of this colour.
    #[must_use]
    pub fn matt(colour: Colour) -> Self {
        Self {
            colour,
            ambient: ambient(),
            diffuse: diffuse(),
            through: 0.0,
            paler: 0.0,
            emission: 0.0,
            specular: 0.0,
            roughness: roughness(),
            phong: 0.0,
            phong_size: phong_size(),
            pattern: None,
            tips: None,
        }
    }

    /// Its colour with the mean of its pattern.
    #[must_use]
    pub fn mean_colour(&self) -> Colour {
        self.pattern.map_or(self.colour, |pattern| self.blend(pattern.figure().mean()))
    }

    /// Its colour with this share of its pattern's over it.
    #[must_use]
    pub fn blend(&self, share: f64) -> Colour {
        self.pattern.map_or(self.colour, |pattern| self.colour.mixed(pattern.figure().colour(), share))
    }

    /// The colour of a leaf's lower side, whose upper side is of this one.
    #[must_use]
    pub fn below(&self, colour: Colour) -> Colour {
        colour.mixed(Colour([1.0; 3]), self.paler)
    }

    /// Does it show a light that falls on it at an angle of this cosine to its normal, negative from behind?
    #[must_use]
    pub fn shows(&self, facing: f64) -> bool {
        facing > 0.0 || (facing < 0.0 && self.through > 0.0)
    }

    /// Drawing ink: its own colour under every light.
    #[must_use]
    pub fn ink(colour: Colour) -> Self {
        Self { ambient: 0.0, diffuse: 0.0, emission: 1.0, ..Self::matt(colour) }
    }
}

/// A light as a scene writes it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LightSpec {
    /// Parallel light from far away.
    Sun {
        /// A point in the direction where it comes from.
        from: Point,
        /// Its colour times its strength.
        colour: Colour,
        /// Angle across which the sun is seen, for soft shadows; 0 gives sharp ones.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 30.0))]
        size: f64,
        /// Does it cast shadows?
        #[serde(default = "yes")]
        shadow: bool,
    },
    /// Light from a point.
    Point {
        /// Where it is.
        at: Point,
        /// Its colour times its strength.
        colour: Colour,
        /// Does it cast shadows?
        #[serde(default = "yes")]
        shadow: bool,
        /// Distance over which it falls off: at distance d there is `2 / (1 + (d / fade)^2)` of it. Without it, it does
        /// not.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        fade: Option<f64>,
    },
}

fn yes() -> bool {
    true
}

/// A light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Parallel light.
    Sun {
        /// Direction to the light, of length 1.
        towards: DVec3,
        /// Its colour times its strength.
        colour: Colour,
        /// Angle across which it is seen, in radians.
        size: f64,
        /// Does it cast shadows?
        shadow: bool,
    },
    /// Light from a point.
    Point {
        /// Where it is.
        at: DVec3,
        /// Its colour times its strength.
        colour: Colour,
        /// Does it cast shadows?
        shadow: bool,
        /// Distance over which it falls off, if it does.
        fade: Option<f64>,
    },
}

impl Light {
    /// A sun in the studio look is this much stronger than in the exact one, where constant light adds to it.
    pub(super) const SUN: f64 = 1.6;

    /// Its colour in the studio look: lights without shadow are left out, since the sky takes their place, but for those
    /// that fall off.
    #[must_use]
    pub fn studio(&self) -> Colour {
        let (Colour(colour), stays) = match *self {
            Self::Sun { colour, shadow, .. } => (colour, shadow),
            Self::Point { colour, shadow, fade, .. } => (colour, shadow || fade.is_some()),
        };
        Colour(colour.map(|x| if stays { x * Self::SUN } else { 0.0 }))
    }

    /// Its colour in the exact look.
    #[must_use]
    pub fn colour(&self) -> Colour {
        let (Self::Sun { colour, .. } | Self::Point { colour, .. }) = *self;
        colour
    }

    /// The share of its light that is left at this distance, as POV-Ray has it with `fade_power 2`.
    #[must_use]
    pub fn falloff(&self, distance: f64) -> f64 {
        match *self {
            Self::Point { fade: Some(fade), .. } => 2.0 / (1.0 + (distance / fade) * (distance / fade)),
            Self::Sun { .. } | Self::Point { .. } => 1.0,
        }
    }
}

/// The ground, level but for its relief.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroundSpec {
    /// Its colour.
    pub colour: Colour,
    /// Its height, in scene units.
    #[serde(default)]
    #[schemars(range(min = -1e6, max = 1e6))]
    pub height: f64,
    /// What is drawn over its colour: where limbs have their way, it has its height.
    #[serde(default)]
    pub pattern: Option<Pattern>,
    /// Distance from the origin where it has faded into the horizon, in scene units; by default two and a half times the size of what
    /// is seen.
    #[serde(default)]
    #[schemars(range(min = 1e-3, max = 1e9))]
    pub reach: Option<f64>,
    /// Rises of it, layer over layer.
    #[serde(default)]
    #[schemars(length(max = 8))]
    pub relief: Vec<ReliefSpec>,
    /// How far it rises around limbs that come out of it, in their radii: earth, moss or snow at the foot of a trunk.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub mound: f64,
    /// Grass on it.
    #[serde(default)]
    pub grass: Option<GrassSpec>,
    /// A round ground of this radius about the origin; without it the ground goes on, and fades into the horizon.
    #[serde(default)]
    #[schemars(range(min = 1e-3, max = 1e6))]
    pub radius: Option<f64>,
}

/// A level ground in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Its material.
    pub material: Material,
    /// Its z.
    pub height: f64,
    /// Distance from the origin where it has faded into the horizon.
    pub reach: f64,
    /// Where it ends, if it does; it then does not fade.
    pub radius: Option<f64>,
}

impl Ground {
    /// The share of the ground at `p`: less than 1 where it fades into the horizon.
    #[must_use]
    pub fn share(&self, p: DVec3) -> f64 {
        match self.radius {
            Some(_) => 1.0,
            None => ((1.0 - (p / self.reach).length()).max(0.0) / FADE).min(1.0),
        }
    }
}

/// A ground fades from full to nothing over this share of its reach, from the outside.
pub const FADE: f64 = 0.45;

/// What is behind everything.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// From one colour at the horizon and below to another overhead, even in z.
    Gradient {
        /// At the horizon and below.
        horizon: Colour,
        /// Overhead.
        zenith: Colour,
    },
    /// A picture of all directions.
    Picture {
        /// The picture.
        picture: SkyPicture,
        /// Angle about the vertical, in degrees.
        turn: f64,
        /// Its light times this.
        strength: f64,
        /// How much more it lights in the studio look than it shows: 1 for pictures, which are as bright as one likes.
        light: f64,
    },
}

impl Sky {
    /// The same colour all over.
    #[must_use]
    pub fn plain(colour: Colour) -> Self {
        Self::Gradient { horizon: colour, zenith: colour }
    }

    /// The colour in a direction, of length 1.
    #[must_use]
    pub fn colour(&self, direction: DVec3) -> Colour {
        match self {
            Self::Gradient { horizon, zenith } => horizon.mixed(*zenith, direction.z.max(0.0)),
            Self::Picture { picture, turn, strength, .. } => {
                let turn = Degrees(*turn).radians();
                let (sin, cos) = (libm::sin(turn), libm::cos(turn));
                let d = DVec3::new(
                    direction.x * cos + direction.y * sin,
                    direction.y * cos - direction.x * sin,
                    direction.z,
                );
                Colour(picture.at(d)).times(*strength)
            }
        }
    }

    /// The colour that a ground fades into.
    #[must_use]
    pub fn at_horizon(&self) -> Colour {
        match self {
            Self::Gradient { horizon, .. } => *horizon,
            Self::Picture { picture, strength, .. } => Colour(picture.horizon()).times(*strength),
        }
    }
}
