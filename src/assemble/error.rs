//! Why a recipe gave no model.

use crate::grow::GrowError;
use crate::math::{Cancelled, OutOfMemory};
use crate::model::{BodyError, CameraError};
use crate::skin::IsosurfaceError;

/// Why a recipe gave no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AssembleError {
    /// A step did not grow.
    #[error(transparent)]
    Grow(GrowError),
    /// An object cannot be shown.
    #[error("object `{object}`: {problem}")]
    Object {
        /// The object's name.
        object: String,
        /// The part of it.
        key: ObjectKey,
        /// What is wrong and what would be right.
        problem: ObjectProblem,
    },
    /// An object names a step or a material by an index that none has.
    #[error("object `{0}`: there is no step or no material with an index that it gives")]
    Index(String),
    /// There is no view.
    #[error(transparent)]
    Camera(CameraError),
    /// It would take more memory than allowed.
    #[error("the scene needs {0}: use a wider spacing or fewer nodes, or raise --max-memory")]
    Memory(#[from] OutOfMemory),
    /// Stopped by its [`crate::math::Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A part of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectKey {
    /// All of it.
    Whole,
    /// A key of its isosurface.
    Isosurface(&'static str),
}

/// What makes an object impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ObjectProblem {
    /// It has no body.
    #[error(transparent)]
    Body(BodyError),
    /// It has no isosurface.
    #[error(transparent)]
    Isosurface(IsosurfaceError),
}

impl From<GrowError> for AssembleError {
    fn from(error: GrowError) -> Self {
        match error {
            GrowError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            GrowError::Memory(error) => Self::Memory(error),
            GrowError::Step { .. } => Self::Grow(error),
        }
    }
}

impl AssembleError {
    /// An error about the body of an object.
    pub(super) fn body(object: &str, error: BodyError) -> Self {
        Self::Object { object: object.to_owned(), key: ObjectKey::Whole, problem: ObjectProblem::Body(error) }
    }

    /// An error about the isosurface of an object.
    pub(super) fn isosurface(object: &str, error: IsosurfaceError) -> Self {
        match error {
            IsosurfaceError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            _ => Self::Object {
                object: object.to_owned(),
                key: ObjectKey::Isosurface(error.key()),
                problem: ObjectProblem::Isosurface(error),
            },
        }
    }
}
