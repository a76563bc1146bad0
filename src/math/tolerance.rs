//! The project's tolerances, in one place, each with its reason.

/// POV-Ray shows nothing of a radius at or below this (`reference/povray.md`).
pub const INVISIBLE_RADIUS: f64 = 1e-5;
