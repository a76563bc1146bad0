//! How paths are refined, as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

/// A lattice is refined down to this share of its spacing, at most.
const FINEST: u32 = 1 << 12;

/// Why paths are not refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RefineError {
    /// There are no pixels.
    #[error("refinement to pixels needs a `[view]`")]
    NoView,
    /// Both or none.
    #[error("refinement needs exactly one of `times` and `pixels`")]
    NotOne,
    /// Too much of it.
    #[error("a lattice {times} times refined by {ratio} is too fine: {FINEST} times at most")]
    TooFine {
        /// How often.
        times: u32,
        /// How much finer each time.
        ratio: u32,
    },
}

/// Path refinement: a sublattice around each node of the coarse paths, all of a path stitched into one graph, and
/// the path planned again within it, as often as asked for. Exactly one of `times` and `pixels`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RefineSpec {
    /// How often.
    #[serde(default)]
    #[schemars(range(min = 1, max = 12))]
    pub times: Option<u32>,
    /// Until a step of the lattice is at most this many pixels of the picture: a picture twice as large takes one round
    /// more, which leaves the coarse way as it is. Needs `[view]`.
    #[serde(default)]
    #[schemars(range(min = 0.25, max = 100.0))]
    pub pixels: Option<f64>,
    /// How much finer each round's lattice is.
    #[serde(default = "two")]
    #[schemars(range(min = 2, max = 8))]
    pub ratio: u32,
    /// How far a sublattice reaches from its node, in coarse steps: it has `2 * reach * ratio + 1` nodes a side.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 8))]
    pub reach: u32,
}

fn two() -> u32 {
    2
}

fn one() -> u32 {
    1
}

/// How paths are refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refine {
    /// How often.
    pub times: u32,
    /// How much finer each round's lattice is.
    pub ratio: u32,
    /// How far a sublattice reaches from its node, in coarse steps.
    pub reach: u32,
}

impl RefineSpec {
    /// The rounds for a lattice of `spacing`, `pixel` being the size of one, where there is a view.
    ///
    /// # Errors
    /// [`RefineError`].
    pub fn resolve(&self, spacing: f64, pixel: Option<f64>) -> Result<Refine, RefineError> {
        let times = match (self.times, self.pixels, pixel) {
            (Some(times), None, _) => times,
            (None, Some(pixels), Some(pixel)) => {
                let (mut times, mut step) = (0, spacing);
                while step > pixels * pixel * (1.0 + 1e-9) && times < 12 {
                    step /= f64::from(self.ratio);
                    times += 1;
                }
                times
            }
            (None, Some(_), None) => return Err(RefineError::NoView),
            _ => return Err(RefineError::NotOne),
        };
        if self.ratio.checked_pow(times).is_none_or(|finer| finer > FINEST) {
            return Err(RefineError::TooFine { times, ratio: self.ratio });
        }
        Ok(Refine { times, ratio: self.ratio, reach: self.reach })
    }
}
