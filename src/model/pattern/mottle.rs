//! Patches of another colour, of several sizes.

use super::expr::{Expr, Wave, waves};
use super::figure::Kind;

/// The larger patches, and smaller ones of about a third and a tenth of their size. No two waves have a common period.
const LARGE: [Wave; 3] = [
    Wave { along: [3.1, 2.3, 1.7], phase: 0.7, bend: 1.4, by: [-1.3, 1.9, 2.1] },
    Wave { along: [-1.9, 2.9, 2.7], phase: 2.9, bend: 1.3, by: [2.3, 1.1, -1.7] },
    Wave { along: [1.3, -2.1, 3.3], phase: 4.6, bend: 1.2, by: [1.6, 2.2, 0.9] },
];
const SMALL: [Wave; 2] = [
    Wave { along: [8.3, 5.9, -6.7], phase: 1.1, bend: 1.7, by: [-4.1, 6.3, 5.1] },
    Wave { along: [-5.3, 7.1, 7.9], phase: 3.7, bend: 1.6, by: [6.7, -3.9, 4.7] },
];
const SMALLEST: [Wave; 2] = [
    Wave { along: [23.0, -17.3, 19.1], phase: 0.4, bend: 2.1, by: [13.7, 19.9, -11.3] },
    Wave { along: [17.9, 21.7, -25.1], phase: 5.1, bend: 1.9, by: [-15.1, 10.7, 17.3] },
];
/// How much the sum of each counts.
const WEIGHTS: [f64; 3] = [0.16, 0.13, 0.08];

pub(super) const MOTTLE: Kind =
    Kind { name: "mottle", least: 0.0, height: 0.0, mean: 0.5, follows_limbs: false, share };

fn share() -> Expr {
    patches()
}

/// The larger patches are about so many units wide.
pub const PATCH: f64 = 1.5;

/// As [`patches`], without the smallest: what a mesh is fine enough for.
#[must_use]
pub fn swells() -> Expr {
    (waves(&LARGE) * 0.2 + waves(&SMALL) * 0.1 + 0.5).share()
}

/// Patches of several sizes, the larger ones [`PATCH`] units wide: from 0 to 1, half of it on the mean.
#[must_use]
pub fn patches() -> Expr {
    let [large, small, smallest] = WEIGHTS;
    (waves(&LARGE) * large + waves(&SMALL) * small + waves(&SMALLEST) * smallest + 0.5).share()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    /// Each colour has its share, and where one is changes from patch to patch.
    #[test]
    fn both_colours_are_there_alike() {
        let share = patches();
        let row = |y: f64| (0..200).map(move |x| (f64::from(x) * 0.37, y));
        let all: Vec<f64> =
            (0..200).flat_map(|y| row(f64::from(y) * 0.41)).map(|(x, z)| share.at(DVec3::new(x, 0.0, z))).collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let deviation = libm::sqrt(all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / all.len() as f64);
        assert!((mean - 0.5).abs() < 0.03 && (0.15..0.35).contains(&deviation), "{mean} {deviation}");
        assert!(all.iter().all(|x| (0.0..=1.0).contains(x)));
    }
}
