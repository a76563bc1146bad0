//! Objects: balls and the limbs between them.

use crate::geom::Bounds;
use crate::math::DVec3;

/// A sphere with what was known of its place in the skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle, from the object's foot.
    pub centre: DVec3,
    /// Its radius, above 0.
    pub radius: f64,
    /// Least path cost from the generator.
    pub cost: f64,
    /// The limb that it belongs to.
    pub branch: u32,
    /// The round of growth that made it.
    pub level: u16,
}

/// What a scene declares as one thing: balls, and round cones between pairs of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name in the scene.
    pub name: String,
    /// Where its foot stands in the world.
    pub foot: DVec3,
    /// Index of its material.
    pub material: usize,
    /// Spheres, from the foot.
    pub balls: Vec<Ball>,
    /// Pairs of balls joined by the frustum tangent to both ([`crate::geom::frustum`]).
    pub segments: Vec<[u32; 2]>,
    /// Digits behind the point of all its numbers.
    pub digits: Digits,
}

impl Object {
    /// A box around it in the world.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.balls.iter().map(|b| Bounds::of_ball(self.foot + b.centre, b.radius)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// How far it reaches above its foot.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.balls.iter().map(|b| b.centre.z + b.radius).fold(0.0, f64::max)
    }
}

/// How many decimal digits behind the point numbers keep: six figures of an object's size, as POV-Ray shows no more
/// (`reference/povray.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits(pub u32);

impl Digits {
    /// The digits for something of this size.
    #[must_use]
    pub fn for_size(size: f64) -> Self {
        let figures = 6 - libm::floor(libm::log10(size.max(1e-30))) as i32;
        Self(figures.clamp(3, 12) as u32)
    }

    /// 10 to the number of digits.
    #[must_use]
    pub fn scale(self) -> f64 {
        (0..self.0).fold(1.0, |scale, _| scale * 10.0)
    }

    /// `x` with this many digits.
    #[must_use]
    pub fn round(self, x: f64) -> f64 {
        libm::round(x * self.scale()) / self.scale()
    }

    /// Every coordinate of `p` with this many digits.
    #[must_use]
    pub fn round_point(self, p: DVec3) -> DVec3 {
        DVec3::new(self.round(p.x), self.round(p.y), self.round(p.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_size() {
        assert_eq!(Digits::for_size(13.2), Digits(5));
        assert_eq!(Digits::for_size(0.02), Digits(8));
        assert_eq!(Digits(5).round(1.234_567_89), 1.234_57);
    }
}
