//! Why there is no body.

/// More primitives than this in an object are refused: POV-Ray takes about a kilobyte for each.
const MOST_PRIMITIVES: usize = 20_000_000;

/// Why an object has no body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BodyError {
    /// Nothing would be seen.
    #[error("nothing is left to show: its steps have no paths, or its mesh no triangles")]
    Empty,
    /// Too much to write and render.
    #[error("{0} primitives are more than {MOST_PRIMITIVES}: use fewer endpoints, or cones in place of spheres")]
    TooMany(usize),
    /// Too small or too large for renderers.
    #[error("its size is out of the range that renderers show, 0.001 to 1e7 scene units: change the spacing")]
    Size,
}

impl BodyError {
    /// Refuses more primitives than an object may have.
    ///
    /// # Errors
    /// [`BodyError::TooMany`].
    pub fn check_count(count: usize) -> Result<(), Self> {
        if count > MOST_PRIMITIVES { Err(Self::TooMany(count)) } else { Ok(()) }
    }

    /// Refuses an extent that renderers do not show.
    ///
    /// # Errors
    /// [`BodyError::Size`].
    pub fn check_size(size: f64) -> Result<(), Self> {
        if (1e-3..=1e7).contains(&size) { Ok(()) } else { Err(Self::Size) }
    }
}
