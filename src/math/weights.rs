//! How random weights are distributed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The distribution of an edge's random part, `R^alpha` with R uniform in (1, max).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Weights {
    /// Upper end of the range of R. Xu and Mould 2007's `1 + r U` is `max = 1 + r`.
    #[schemars(range(min = 1.0, max = 1e6))]
    pub max: f64,
    /// How tortuous paths are: 0.3 is nearly straight, 1 slightly winding, 3 erratic (Fig. 2 of 2008).
    #[schemars(range(min = 0.0, max = 1e3))]
    pub alpha: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { max: 10.0, alpha: 1.0 }
    }
}
