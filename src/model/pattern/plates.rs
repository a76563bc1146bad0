//! Plates: bark that breaks into scales, as that of old pines, planes and pears.

use super::expr::{Expr, Wave, waves};
use super::figure::Kind;

/// Cracks along the limb are where the first sum is near 0, those across it where the second is.
const ALONG: [Wave; 3] = [
    Wave { along: [2.6, 0.35, 0.9], phase: 0.3, bend: 1.2, by: [0.5, 1.1, -0.4] },
    Wave { along: [-1.1, 0.3, 2.5], phase: 2.2, bend: 1.1, by: [-0.6, 0.9, 0.7] },
    Wave { along: [1.7, -0.5, -2.2], phase: 4.4, bend: 1.0, by: [0.8, -1.3, 0.3] },
];
const ACROSS: [Wave; 2] = [
    Wave { along: [0.4, 1.5, 0.3], phase: 1.2, bend: 1.6, by: [1.7, 0.4, -1.4] },
    Wave { along: [-0.5, 1.9, 0.7], phase: 3.3, bend: 1.5, by: [-1.2, 0.5, 1.9] },
];
/// How narrow both are.
const CRACK: [f64; 2] = [2.0, 2.6];

pub(super) const PLATES: Kind =
    Kind { name: "plates", least: 1.2, height: -0.15, mean: 0.28, follows_limbs: true, share };

fn share() -> Expr {
    let crack = |sum: Expr, narrow: f64| Expr::from(1.0) - sum.abs() * narrow;
    Expr::from(0.0).max(crack(waves(&ALONG), CRACK[0]).max(crack(waves(&ACROSS), CRACK[1])))
}
