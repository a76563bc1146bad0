//! Ends of limbs in another colour: what has grown last, as the pale tips of corals.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Limbs;
use crate::math::Colour;

/// The colour of the ends of limbs, which passes into that of the material. Where it is seen, no pattern is.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tips {
    /// The colour at the very end.
    pub colour: Colour,
    /// Distance from the end over which it goes, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub length: f64,
}

impl Tips {
    /// It goes in so many steps, so that renderers need no more textures.
    pub const STEPS: u8 = 12;

    /// The colour of so many steps of it over `own`.
    #[must_use]
    pub fn over(&self, own: Colour, steps: u8) -> Colour {
        own.mixed(self.colour, f64::from(steps) / f64::from(Self::STEPS))
    }

    /// The steps of it that a ball of `limbs` shows: all at the ends of limbs, none farther from the farthest end beyond than `length`.
    #[must_use]
    pub fn steps(&self, limbs: &Limbs, ball: u32) -> u8 {
        let beyond = limbs.beyond.get(ball as usize).map_or(f64::INFINITY, |&beyond| f64::from(beyond));
        libm::round((1.0 - beyond / self.length).max(0.0) * f64::from(Self::STEPS)) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use crate::model::Ball;

    #[test]
    fn ends_have_their_colour() {
        let ball = |x: f64, z: f64| Ball { centre: DVec3::new(x, 0.0, z), radius: 0.1, cost: 0.0, branch: 0, level: 0 };
        // A stem of 4 with a side limb of 1 at its middle.
        let balls = vec![ball(0.0, 0.0), ball(0.0, 2.0), ball(0.0, 3.0), ball(0.0, 4.0), ball(1.0, 2.0)];
        let mut limbs = Limbs { balls, segments: vec![[0, 1], [1, 2], [2, 3], [1, 4]], ..Limbs::default() };
        let tips = Tips { colour: Colour([1.0; 3]), length: 2.0 };
        limbs.measure_ends();
        assert_eq!([0, 1, 2, 3, 4].map(|ball| tips.steps(&limbs, ball)), [0, 0, 6, 12, 12]);
        assert_eq!(tips.over(Colour([0.0; 3]), 6), Colour([0.5; 3]));
    }
}
