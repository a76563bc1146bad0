//! What stands far behind, as a scene writes it.

use schemars::JsonSchema;
use serde::Deserialize;

/// Plants of the scene once more, far behind it: groves, a forest's edge. They are a few thousand triangles each.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BackgroundSpec {
    /// The nearest ones' distance from the camera, in scene units; none stands nearer than the scene's middle.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub from: f64,
    /// The farthest ones' distance from the camera, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub to: f64,
    /// Mean distance between neighbours where they stand together, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e5))]
    pub apart: f64,
    /// Width of their groves and of the clearings between, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub groves: f64,
    /// The share of the land that groves take.
    #[serde(default = "half")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub share: f64,
}

fn half() -> f64 {
    0.5
}
