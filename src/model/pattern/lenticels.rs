//! Lenticels: short dark bands across the limb, as birches and cherries have them.

use super::expr::{Expr, Wave, waves};
use super::figure::Kind;

/// Fast along the limb, slow around it: bands, which the slow parts break off.
const BANDS: [Wave; 3] = [
    Wave { along: [0.4, 6.3, 0.3], phase: 0.7, bend: 0.8, by: [1.1, 0.2, 0.9] },
    Wave { along: [-0.3, 9.1, 0.5], phase: 2.1, bend: 0.9, by: [-0.8, 0.3, 1.3] },
    Wave { along: [2.2, 0.9, -1.7], phase: 4.4, bend: 1.1, by: [0.7, 0.5, -0.6] },
];
/// How sharp a band ends, and where it begins.
const SHARP: f64 = 2.5;
const LEAST: f64 = 1.5;

pub(super) const LENTICELS: Kind =
    Kind { name: "lenticels", least: 0.5, height: 0.0, mean: 0.09, follows_limbs: true, share };

fn share() -> Expr {
    Expr::from(1.0).min(Expr::from(0.0).max((waves(&BANDS) - LEAST) * SHARP))
}
