//! One stem of a tree: where it starts, and what its level and the stem before make of it.

use rand::RngExt;

use super::spec::{CrownShape, StemSpec, WeberPennSpec};
use crate::math::{DMat3, DVec3, Stream, rotation};

/// A stem, or what is left of it from a segment on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stem {
    /// Its level: 0 is the trunk.
    pub level: usize,
    /// The node that it starts at.
    pub node: u32,
    /// Its next segment.
    pub segment: u32,
    /// Its z is where it grows, its x what it bends about.
    pub frame: DMat3,
    /// Its whole length.
    pub length: f64,
    /// Its length over the greatest that its level allows.
    pub vigour: f64,
    /// A split has turned it by so much in each segment that is left: it bends back.
    pub back: f64,
    /// Its share of the stems that leave it, which splits divide.
    pub share: f64,
    /// What tells it from all others, for random numbers.
    pub name: u64,
}

/// `v` up or down of 0, evenly.
pub(super) fn stray(v: f64, random: &mut Stream) -> f64 {
    v * (2.0 * random.random::<f64>() - 1.0)
}

impl StemSpec {
    /// The greatest length of a stem over what the stem before allows, with chance.
    pub(super) fn length_max(&self, random: &mut Stream) -> f64 {
        f64::max(self.length + stray(self.length_v, random), 0.0)
    }

    /// How far a stem bends about its x in a segment (section 4.1).
    pub(super) fn bend(&self, segment: u32, random: &mut Stream) -> f64 {
        let segments = f64::from(self.segments);
        let bend = if self.curve_back.0 == 0.0 {
            self.curve.radians() / segments
        } else if f64::from(segment) < segments / 2.0 {
            self.curve.radians() / (segments / 2.0)
        } else {
            self.curve_back.radians() / (segments / 2.0)
        };
        bend + stray(self.curve_v.radians(), random) / segments
    }
}

impl WeberPennSpec {
    /// How many stems leave a whole `stem` (section 4.3).
    pub(super) fn count(&self, stem: &Stem) -> f64 {
        let Some(next) = self.levels.get(stem.level + 1) else { return 0.0 };
        match stem.level {
            0 => next.branches,
            1 => next.branches * (0.2 + 0.8 * stem.vigour),
            _ => next.branches * (0.5 + 0.5 * stem.vigour),
        }
    }

    /// The share of a trunk's or stem's length that bears no stems.
    pub(super) fn bare(&self, level: usize) -> f64 {
        if level == 0 { self.base_size } else { 0.0 }
    }

    /// The length of a stem that leaves `stem` at `offset` along it, and that over the greatest (section 4.3).
    pub(super) fn child_length(&self, stem: &Stem, offset: f64, random: &mut Stream) -> (f64, f64) {
        let most = self.levels[stem.level + 1].length_max(random);
        if stem.level > 0 {
            let length = most * (stem.length - 0.6 * offset).max(0.0);
            return (length, 1.0 - offset / stem.length);
        }
        let ratio = self.shape.ratio(self.above(stem, offset));
        (stem.length * most * ratio, ratio)
    }

    /// The share of what bears stems that is above `offset`.
    fn above(&self, stem: &Stem, offset: f64) -> f64 {
        ((stem.length - offset) / (stem.length * (1.0 - self.bare(stem.level)))).clamp(0.0, 1.0)
    }

    /// The angle between `stem` and one that leaves it at `offset` (section 4.2).
    pub(super) fn down(&self, stem: &Stem, offset: f64, random: &mut Stream) -> f64 {
        let next = &self.levels[stem.level + 1];
        let v = next.down_angle_v.radians();
        if v >= 0.0 {
            return next.down_angle.radians() + stray(v, random);
        }
        let ratio = CrownShape::Conical.ratio(self.above(stem, offset));
        next.down_angle.radians() + v * (1.0 - 2.0 * ratio)
    }
}

impl Stem {
    /// Turns it about its own x.
    pub(super) fn bend(&mut self, angle: f64) {
        self.frame *= rotation(DVec3::X, angle);
    }

    /// Its angle to the upright.
    pub(super) fn declination(&self) -> f64 {
        libm::acos(self.frame.z_axis.z.clamp(-1.0, 1.0))
    }

    /// Bends it upwards for a segment (section 4.8).
    pub(super) fn lift(&mut self, attraction: f64, segments: u32) {
        // The cosine of the angle between its y and the upright.
        let orientation = self.frame.y_axis.z;
        self.bend(-attraction * self.declination() * orientation / f64::from(segments));
    }

    /// Turns it about the upright.
    pub(super) fn spread(&mut self, angle: f64) {
        self.frame = rotation(DVec3::Z, angle) * self.frame;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Section 4.3's table of ShapeRatio, at the foot, the middle and the tip of what bears limbs.
    #[test]
    fn crowns_have_the_papers_ratios() {
        let ratios = |shape: CrownShape| [1.0, 0.5, 0.0].map(|above| (shape.ratio(above) * 1000.0).round() / 1000.0);
        assert_eq!(ratios(CrownShape::Conical), [1.0, 0.6, 0.2]);
        assert_eq!(ratios(CrownShape::Spherical), [0.2, 1.0, 0.2]);
        assert_eq!(ratios(CrownShape::Hemispherical), [1.0, 0.766, 0.2]);
        assert_eq!(ratios(CrownShape::Cylindrical), [1.0, 1.0, 1.0]);
        assert_eq!(ratios(CrownShape::TaperedCylindrical), [1.0, 0.75, 0.5]);
        assert_eq!(ratios(CrownShape::Flame), [0.0, 0.714, 0.0]);
        assert_eq!(ratios(CrownShape::InverseConical), [0.2, 0.6, 1.0]);
        assert_eq!(ratios(CrownShape::TendFlame), [0.5, 0.857, 0.5]);
    }

    /// A stem that lies flat rises, whichever way its frame is rolled.
    #[test]
    fn attraction_lifts() {
        for roll in [0.0, 0.6, 1.5, 2.9, 4.0] {
            let frame = rotation(DVec3::Y, 1.2) * rotation(DVec3::Z, roll);
            let mut stem =
                Stem { level: 2, node: 0, segment: 0, frame, length: 1.0, vigour: 1.0, back: 0.0, share: 1.0, name: 0 };
            let before = stem.declination();
            stem.lift(0.5, 4);
            assert!(stem.declination() <= before, "{roll}");
        }
    }
}
