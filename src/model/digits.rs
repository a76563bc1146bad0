//! How exact written numbers are.

use crate::math::DVec3;

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
