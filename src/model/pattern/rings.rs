//! Rings: scars all around a stem, as leaves leave on palms.

use super::expr::{Expr, Wave, waves};
use super::figure::Kind;

/// No ring is level all around, nor as far from the next as others.
const UNEVEN: [Wave; 2] = [
    Wave { along: [0.5, 0.9, 0.4], phase: 0.9, bend: 0.7, by: [0.6, 0.3, -0.5] },
    Wave { along: [-0.6, 1.7, 0.7], phase: 2.6, bend: 0.6, by: [0.3, 0.8, 0.5] },
];
const BEND: f64 = 0.6;
/// How sharp a scar is, and where it begins.
const SHARP: f64 = 2.2;
const LEAST: f64 = 0.5;

pub(super) const RINGS: Kind =
    Kind { name: "rings", least: 0.5, height: -0.12, mean: 0.26, follows_limbs: true, share };

fn share() -> Expr {
    let turns = Expr::from(std::f64::consts::TAU) * Expr::Y + waves(&UNEVEN) * BEND;
    ((turns.sin() - LEAST) * SHARP).share()
}
