//! Why a search gave no plan.

use super::buckets::MOST_BUCKETS;
use crate::math::Cancelled;

/// Why a search gave no plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The ratio of the weights is too large for buckets as narrow as the least of them.
    #[error(
        "the largest weight is {ratio} times the least; at most {MOST_BUCKETS} can be planned with: lower alpha, max or the cost fields"
    )]
    TooWide {
        /// Largest weight over least.
        ratio: u32,
    },
    /// Cancelled by its [`crate::math::Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
