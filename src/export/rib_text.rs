//! Numbers, colours and matrices as RIB has them.

use super::decimal::plain_number as number;
use crate::math::{Colour, DVec3};
use crate::model::Digits;

/// Digits of numbers that are not lengths.
pub(super) const PLAIN: Digits = Digits(6);
/// Digits of the numbers of matrices.
pub(super) const MATRIX: Digits = Digits(8);

pub(super) fn triple(p: DVec3, digits: Digits) -> String {
    p.to_array().map(|c| number(c, digits)).join(" ")
}

pub(super) fn colour(Colour(c): Colour) -> String {
    triple(DVec3::from_array(c), PLAIN)
}

/// The matrix from the world to a camera at `at` with these unit vectors to the right, up and forwards: row vectors, the
/// translation last.
pub(super) fn to_camera(at: DVec3, [r, u, f]: [DVec3; 3], digits: Digits) -> String {
    let row = |axis: usize| format!("{} 0", triple(DVec3::new(r[axis], u[axis], f[axis]), MATRIX));
    let last = triple(-DVec3::new(r.dot(at), u.dot(at), f.dot(at)), digits);
    format!("{} {} {} {last} 1", row(0), row(1), row(2))
}
