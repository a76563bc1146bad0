//! Why a shape as a scene writes it is no shape.

use super::{ClosedMeshError, OutlineError, ProfileError};
use crate::math::DVec3;

/// Why a shape as a scene writes it is no shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A name that is not defined, as [`unknown`](crate::math::unknown) says it.
    #[error("{0}")]
    Unknown(String),
    /// A file that cannot be read, or has nothing that a shape could be made of.
    #[error("cannot read `{file}`: {reason}")]
    File {
        /// Its name.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// There are no steps.
    #[error("there is no step `{0}` here")]
    NoStep(String),
    /// A step that yields no solids.
    #[error("step `{0}` grows limbs: only steps with `by.regions` are shapes")]
    Limbs(String),
    /// A shape refers to itself.
    #[error("shape `{0}` is made of itself")]
    Circular(String),
    /// A step's space refers to what the step grows.
    #[error("step `{0}` grows in what it grew itself")]
    CircularStep(String),
    /// A combination that names a shape twice.
    #[error("shape `{0}` is combined twice: once is enough")]
    Twice(String),
    /// A chain of shapes that is too long.
    #[error("more than {0} shapes are made of one another: give the last of them where it is used")]
    TooDeep(usize),
    /// Too many solids.
    #[error("it is made of more than {0} solids, each as often as it is named")]
    TooManySolids(u64),
    /// A combination of no shapes.
    #[error("combine at least one shape")]
    NoParts,
    /// Two ends coincide.
    #[error("{0} needs two different ends")]
    SameEnds(&'static str),
    /// A direction is the zero vector.
    #[error("{0} needs a direction, not the zero vector")]
    NoDirection(&'static str),
    /// A box with a maximum below its minimum.
    #[error("a box needs min below max, not {0} and {1}")]
    Box(DVec3, DVec3),
    /// An ellipsoid with a half-axis of 0 or less.
    #[error("an ellipsoid needs half-axes above 0, not {0}")]
    Ellipsoid(DVec3),
    /// A cone without a radius.
    #[error("a cone needs a radius above 0 at one end")]
    Cone,
    /// A shell without thickness.
    #[error("a shell needs an `outside` or an `inside` above 0")]
    Shell,
    /// A sketch without a profile.
    #[error("`{file}`: {error}")]
    Sketch {
        /// The sketch.
        file: String,
        /// What is wrong.
        error: ProfileError,
    },
    /// A mesh that encloses no solid.
    #[error("`{file}`: {error}")]
    Mesh {
        /// The mesh.
        file: String,
        /// What is wrong.
        error: ClosedMeshError,
    },
    /// A picture without an outline.
    #[error("`{file}`: {error}")]
    Picture {
        /// The picture.
        file: String,
        /// What is wrong.
        error: OutlineError,
    },
    /// A text without an outline.
    #[error("{text:?}: {error}")]
    Letters {
        /// The text.
        text: String,
        /// What is wrong.
        error: OutlineError,
    },
}

impl ShapeError {
    /// That `file` cannot be read.
    pub fn file(file: &str, reason: impl ToString) -> Self {
        Self::File { file: file.to_owned(), reason: reason.to_string() }
    }
}

impl From<ShapeError> for String {
    fn from(error: ShapeError) -> Self {
        error.to_string()
    }
}
