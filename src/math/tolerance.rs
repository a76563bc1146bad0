//! The project's tolerances, in one place, each with its reason.

/// Two points nearer than this share of the scene's size are one: well under the six digits that are exported.
pub const SAME_POINT: f64 = 1e-9;

/// POV-Ray shows nothing of a radius at or below this (`reference/povray.md`).
pub const INVISIBLE_RADIUS: f64 = 1e-5;
