//! Moss on the upper side of limbs.

use super::expr::{Expr, Wave, waves};
use super::figure::Kind;

/// Moss is where the upper side's share and this sum are above a threshold.
const PATCHES: [Wave; 3] = [
    Wave { along: [2.3, 1.9, 0.7], phase: 0.2, bend: 1.2, by: [-1.1, 0.8, 1.6] },
    Wave { along: [-1.1, 2.1, 2.2], phase: 2.3, bend: 1.1, by: [1.7, 0.9, -0.6] },
    Wave { along: [1.2, -2.4, 1.8], phase: 5.2, bend: 1.3, by: [0.8, 1.5, 1.2] },
];
// The weight of the patches, that of the upper side, and the threshold.
const PATCH: f64 = 0.3;
const UPPER: f64 = 0.9;
const LEAST: f64 = 0.45;

/// A cushion, which is there or not: thin limbs have it as thick ones do.
pub(super) const MOSS: Kind = Kind { name: "moss", least: 0.0, height: 0.2, mean: 0.0, follows_limbs: true, share };

fn share() -> Expr {
    let across = Expr::from(1e-6).max((Expr::X * Expr::X + Expr::Z * Expr::Z).sqrt());
    let share = waves(&PATCHES) * PATCH + Expr::X / across * UPPER - LEAST;
    share.share()
}
