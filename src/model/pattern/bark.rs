//! Bark: fissures that run along the limb.

use super::expr::{Expr, Wave, waves};
use super::figure::Kind;

/// Fissures are where this sum is near 0: nets drawn out along the limb.
const NET: [Wave; 4] = [
    Wave { along: [3.1, 0.16, 1.2], phase: 0.4, bend: 1.1, by: [0.6, 0.31, -0.7] },
    Wave { along: [-1.4, 0.13, 2.9], phase: 1.9, bend: 1.0, by: [-0.8, 0.27, 0.5] },
    Wave { along: [1.9, -0.19, -2.6], phase: 4.1, bend: 1.2, by: [0.4, -0.36, 0.8] },
    Wave { along: [5.3, 0.43, 4.7], phase: 2.7, bend: 0.9, by: [-1.3, 0.71, 1.1] },
];
/// How narrow fissures are.
const FISSURE: f64 = 0.9;

pub(super) const BARK: Kind = Kind { name: "bark", least: 1.5, height: -0.15, mean: 0.3, follows_limbs: true, share };

fn share() -> Expr {
    Expr::from(0.0).max(Expr::from(1.0) - waves(&NET).abs() * FISSURE)
}
