//! Clouds over a sky of daylight: one layer, whose share of the sky is given.

use crate::math::{DVec2, DVec3, name_of, power};

/// Heights above the horizon, as sines, are taken as this much more: the layer follows the earth, and its far end does not crowd.
const BENT: f64 = 0.09;
/// Clouds to a unit of the layer, whose height is 1.
const CLOUDS: f64 = 0.85;
/// Octaves of the noise, the share of each in the one before, and how far noise warps its own coordinates.
const OCTAVES: u32 = 6;
const FALLING: f64 = 0.56;
const WARP: f64 = 0.35;
/// The noise has this standard deviation, about.
const DEVIATION: f64 = 0.35;
/// How soon a cloud is thick from its edge on.
const THICK: f64 = 5.0;
/// How far towards the sun it is asked what stands before it, and how much of the light that takes.
const STEP: f64 = 0.12;
const SHADE: f64 = 1.1;
/// What the layer moves in an hour, and from day to day.
const WIND: DVec2 = DVec2::new(0.9, 0.35);
const DAYS: DVec2 = DVec2::new(13.7, 5.3);

/// A layer of clouds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clouds {
    /// Share of the sky that they cover.
    share: f64,
    /// Where the noise is above this there is a cloud.
    threshold: f64,
    /// Where the layer is.
    at: DVec2,
    /// The way to the sun along it.
    sunwards: DVec2,
}

/// What is seen of clouds in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    /// The share of the sky that they hide.
    pub cover: f64,
    /// The share of the sun's light that they show, below 1 where they are in their own shade.
    pub lit: f64,
}

impl Clouds {
    /// Clouds that cover this share of the sky, at a day and an hour, with the sun in this direction.
    pub fn new(share: f64, day: f64, hour: f64, sun: DVec3) -> Self {
        let threshold = -DEVIATION * quantile(share);
        Self { share, threshold, at: DAYS * day + WIND * hour, sunwards: sun.truncate() }
    }

    /// The share of the sun's light that comes through, as measured over years (Kasten and Czeplak 1980, without the light that the
    /// clouds scatter).
    pub fn sun(&self) -> f64 {
        1.0 - power(self.share, 3.4)
    }

    /// How far they are one sheet, which has no sunny sides.
    pub fn closed(&self) -> f64 {
        ((self.share - 0.6) / 0.4).clamp(0.0, 1.0)
    }

    /// What is seen of them in a direction above the horizon, of length 1.
    pub fn seen(&self, direction: DVec3) -> Seen {
        let at = self.at + direction.truncate() / (direction.z.max(0.0) + BENT) * CLOUDS;
        let depth = self.depth(at);
        if depth <= 0.0 {
            return Seen { cover: 0.0, lit: 1.0 };
        }
        let before = self.depth(at + self.sunwards * STEP) + 0.5 * self.depth(at + self.sunwards * (2.5 * STEP));
        Seen { cover: 1.0 - libm::exp(-THICK * depth), lit: libm::exp(-SHADE * (before + 0.4 * depth)) }
    }

    /// How thick the layer is at a place, in deviations of its noise; nothing between clouds.
    fn depth(&self, at: DVec2) -> f64 {
        let bend = DVec2::new(noise(at + DVec2::new(5.2, 1.3), 71), noise(at - DVec2::new(1.7, 9.2), 72));
        let (mut sum, mut size, mut p) = (0.0, 1.0, at + bend * WARP);
        for octave in 0..OCTAVES {
            sum += size * noise(p, octave);
            size *= FALLING;
            p *= 2.03;
        }
        ((sum - self.threshold) / DEVIATION).max(0.0)
    }
}

/// So many deviations from the mean a normal variable is below with this probability (a logistic curve comes near enough).
fn quantile(share: f64) -> f64 {
    let share = share.clamp(1e-3, 1.0 - 1e-3);
    libm::log(share / (1.0 - share)) / 1.702
}

/// Directions of gradients, besides their opposites.
const WAYS: [[f64; 2]; 4] = [
    [0.980_785_280_403_230_4, 0.195_090_322_016_128_27],
    [0.555_570_233_019_602_2, 0.831_469_612_302_545_2],
    [-0.195_090_322_016_128_27, 0.980_785_280_403_230_4],
    [-0.831_469_612_302_545_2, 0.555_570_233_019_602_2],
];

/// Gradient noise (Perlin 2002) in the plane, about from -1 to 1.
fn noise(p: DVec2, octave: u32) -> f64 {
    let low = DVec2::new(libm::floor(p.x), libm::floor(p.y));
    let within = p - low;
    let corner = |dx: f64, dy: f64| {
        let [x, y] = [low.x + dx, low.y + dy].map(|c| c as i64 as u64);
        let name = name_of(x ^ (u64::from(octave) << 48), y);
        let [a, b] = WAYS[(name >> 40) as usize % 4];
        let sign = if name >> 50 & 1 == 0 { 1.0 } else { -1.0 };
        DVec2::new(a, b).dot(within - DVec2::new(dx, dy)) * sign
    };
    let [u, v] = [within.x, within.y].map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let row = |dy: f64| corner(0.0, dy) * (1.0 - u) + corner(1.0, dy) * u;
    (row(0.0) * (1.0 - v) + row(1.0) * v) * std::f64::consts::SQRT_2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{GOLDEN_ANGLE, from_height};

    /// Over many days they cover the share that was asked for; none and all are none and all.
    #[test]
    fn they_cover_their_share() {
        for share in [0.0, 0.2, 0.5, 0.8, 1.0] {
            let covered: f64 = (0..4000)
                .map(|i| {
                    let clouds = Clouds::new(share, f64::from(i % 360), 12.0, DVec3::Z);
                    let seen = clouds.seen(from_height(0.3 + 0.7 * f64::from(i) / 4000.0, GOLDEN_ANGLE * f64::from(i)));
                    f64::from(u8::from(seen.cover > 0.0))
                })
                .sum();
            assert!((covered / 4000.0 - share).abs() < 0.06, "{share}: {}", covered / 4000.0);
        }
    }

    #[test]
    fn their_sunny_side_is_bright() {
        let sun = DVec3::new(0.8, 0.0, 0.6);
        let clouds = Clouds::new(0.4, 10.0, 12.0, sun);
        let mut along = [0.0; 2];
        for i in 0..20_000 {
            let way = from_height(0.4 + 0.5 * f64::from(i) / 20_000.0, GOLDEN_ANGLE * f64::from(i));
            let next = (way + DVec3::new(0.02, 0.0, 0.0)).normalize();
            let (here, there) = (clouds.seen(way), clouds.seen(next));
            // Where a cloud ends towards the sun, and where away from it.
            if here.cover > 0.0 && there.cover == 0.0 {
                along[0] += here.lit;
            } else if here.cover == 0.0 && there.cover > 0.0 {
                along[1] -= there.lit;
            }
        }
        assert!(along[0] + along[1] > 0.0, "{along:?}");
    }
}
