//! Points and colours as POV-Ray has them.

use super::decimal::vector;
use crate::math::{Colour, DVec3};
use crate::model::Digits;

/// Digits of numbers that are not lengths.
pub(super) const PLAIN: Digits = Digits(6);

/// POV-Ray's space from the world's: swapping y and z turns right-handed into left-handed without mirroring the shape.
pub(super) fn to_pov(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, p.y)
}

/// A colour.
pub(super) fn colour(Colour([r, g, b]): Colour) -> String {
    vector(DVec3::new(r, g, b), PLAIN)
}
