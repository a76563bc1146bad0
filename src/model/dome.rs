//! The sky as a number of lights, for renderers that know no other soft light.

use super::{Model, Sky};
use crate::math::{Colour, DVec3, GOLDEN_ANGLE, from_height};

/// Light that comes back from what the sun and the sky shine upon, as a share of the ground's colour.
const BOUNCE: f64 = 0.35;

/// The light of the sky and of the ground below, from all directions.
#[derive(Clone, Debug)]
pub struct Dome {
    sky: Sky,
    /// Light from below.
    bounce: Colour,
}

impl Dome {
    /// Strength of the dome in the studio look: an open, level, white surface under a white sky shows this.
    pub const STRENGTH: f64 = 0.62;

    /// No part of a sky gives more light than this, before its strength: a sun in its picture would be met by few of many rays,
    /// which shows as specks. A scene has a sun of its own.
    pub const BRIGHTEST: f64 = 4.0;

    /// The dome of a model.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let Colour(below) = model.ground.map_or(model.sky.at_horizon(), |ground| ground.material.mean_colour());
        let Colour(sky) = model.sky.at_horizon();
        Self { sky: model.sky.clone(), bounce: Colour([0, 1, 2].map(|i| below[i] * BOUNCE * (0.5 + sky[i]))) }
    }

    /// The light from a direction of length 1.
    #[must_use]
    pub fn light(&self, direction: DVec3) -> Colour {
        let Colour(light) = if direction.z < 0.0 { self.bounce } else { self.sky.colour(direction) };
        let strength = if direction.z < 0.0 { Self::STRENGTH } else { self.strength() };
        Colour(light.map(|x| x.min(Self::BRIGHTEST) * strength))
    }

    /// What the sky's colour counts as light.
    #[must_use]
    pub fn strength(&self) -> f64 {
        let Sky::Picture { light, .. } = self.sky else { return Self::STRENGTH };
        light * Self::STRENGTH
    }

    /// `count` parallel lights, spread evenly (a spherical Fibonacci lattice, Hannay and Nye 2004): directions towards
    /// them and colours, so that each adds its colour times the cosine.
    #[must_use]
    pub fn lights(&self, count: u32) -> Vec<(DVec3, Colour)> {
        let n = f64::from(count);
        // Cosines over the whole sphere's directions sum to count / 4.
        let share = 4.0 / n;
        (0..count)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / n;
                let direction = from_height(z, GOLDEN_ANGLE * f64::from(i));
                let light = match &self.sky {
                    // A picture may change within a light's share of the sky.
                    Sky::Picture { picture, turn, strength, .. } if z >= 0.0 => {
                        let about = super::Instance { at: DVec3::ZERO, turn: *turn, scale: 1.0 }.unturned(direction);
                        let most = Self::BRIGHTEST / strength.max(1e-9);
                        Colour(picture.mean(about, 1.0 - 2.0 / n, most)).times(strength * self.strength())
                    }
                    _ => self.light(direction),
                };
                (direction, light.times(share))
            })
            .collect()
    }
}
