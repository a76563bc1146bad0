//! How a scene is lit.

use schemars::JsonSchema;
use serde::Deserialize;

/// How a scene is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Look {
    /// As POV-Ray: local illumination, and POV-Ray's samples.
    Exact,
    /// Light from the whole sky, soft shadows of the sun, ambient occlusion.
    #[default]
    Studio,
    /// The studio's lights, which go on from surface to surface and through leaves.
    Natural,
}

impl Look {
    /// Its name in scenes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Studio => "studio",
            Self::Natural => "natural",
        }
    }
}
