//! Weber and Penn's parameters as a scene writes them.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::Degrees;

/// Trees by parameters of each level of stems (Weber and Penn 1995, sections 4.1 to 4.8), without pruning and wind; widths are
/// the step's own. A baseline to hold planned trees against.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeberPennSpec {
    /// How long limbs are by where they leave the trunk (Shape).
    #[serde(default)]
    pub shape: CrownShape,
    /// Height of the tree, in scene units (Scale).
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub scale: f64,
    /// By how much it differs from tree to tree, up and down (ScaleV).
    #[serde(default)]
    #[schemars(range(min = 0, max = 1e6))]
    pub scale_v: f64,
    /// The share of the trunk, from below, that bears no limbs (BaseSize).
    #[serde(default = "base_size")]
    #[schemars(range(min = 0, max = 0.95))]
    pub base_size: f64,
    /// How strongly stems from the third level on bend upwards; below 0 downwards (AttractionUp).
    #[serde(default)]
    #[schemars(range(min = -20, max = 20))]
    pub attraction_up: f64,
    /// The trunk, its limbs, their branches, and on.
    #[schemars(length(min = 1, max = 5))]
    pub levels: Vec<StemSpec>,
}

fn base_size() -> f64 {
    0.3
}

/// Stems of a level. Numbers that end in `_v` say by how much the one before differs from stem to stem, up and down.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StemSpec {
    /// How many leave each stem of the level before (nBranches); without meaning for the trunk.
    #[serde(default)]
    #[schemars(range(min = 0, max = 10_000))]
    pub branches: f64,
    /// Length: of the trunk over the tree's scale, of others over the greatest that the stem before allows (nLength).
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 10))]
    pub length: f64,
    /// (nLengthV)
    #[serde(default)]
    #[schemars(range(min = 0, max = 10))]
    pub length_v: f64,
    /// How many segments it has (nCurveRes).
    #[serde(default = "segments")]
    #[schemars(range(min = 1, max = 200))]
    pub segments: u32,
    /// How far it bends from its start to its end, or to its middle where it bends back (nCurve).
    #[serde(default)]
    pub curve: Degrees,
    /// How far it bends from its middle to its end; 0 for the same bend all along (nCurveBack).
    #[serde(default)]
    pub curve_back: Degrees,
    /// How far it strays, over all its segments (nCurveV).
    #[serde(default)]
    pub curve_v: Degrees,
    /// New stems that split off at the end of the first segment; of the trunk alone (0BaseSplits).
    #[serde(default)]
    #[schemars(range(max = 10))]
    pub base_splits: u32,
    /// New stems that split off at the end of each other segment, on average (nSegSplits).
    #[serde(default)]
    #[schemars(range(min = 0, max = 3))]
    pub splits: f64,
    /// How far they part (nSplitAngle).
    #[serde(default)]
    pub split_angle: Degrees,
    /// (nSplitAngleV)
    #[serde(default)]
    pub split_angle_v: Degrees,
    /// The angle to the stem before (nDownAngle).
    #[serde(default = "down_angle")]
    pub down_angle: Degrees,
    /// Below 0 it becomes larger towards the foot of that stem, by so much in all (nDownAngleV).
    #[serde(default)]
    pub down_angle_v: Degrees,
    /// How far around that stem from the one before; below 0 from side to side (nRotate).
    #[serde(default = "rotate")]
    pub rotate: Degrees,
    /// (nRotateV)
    #[serde(default)]
    pub rotate_v: Degrees,
}

fn segments() -> u32 {
    8
}

fn down_angle() -> Degrees {
    Degrees(60.0)
}

fn rotate() -> Degrees {
    Degrees(140.0)
}

/// How long limbs are by where they leave the trunk (Weber and Penn 1995, section 4.3, ShapeRatio).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CrownShape {
    /// Longest below.
    Conical,
    /// Longest in the middle.
    #[default]
    Spherical,
    /// Rounded above, longest below.
    Hemispherical,
    /// All the same.
    Cylindrical,
    /// Somewhat longer below.
    TaperedCylindrical,
    /// Longest at a third of the height.
    Flame,
    /// Longest above.
    InverseConical,
    /// Between a cylinder and a flame.
    TendFlame,
}

impl CrownShape {
    /// The share of the greatest length where so much of the bearing trunk is left above, from 0 at the tip to 1.
    #[must_use]
    pub fn ratio(self, above: f64) -> f64 {
        use std::f64::consts::{FRAC_PI_2, PI};
        let flame = if above <= 0.7 { above / 0.7 } else { (1.0 - above) / 0.3 };
        match self {
            Self::Conical => 0.2 + 0.8 * above,
            Self::Spherical => 0.2 + 0.8 * libm::sin(PI * above),
            Self::Hemispherical => 0.2 + 0.8 * libm::sin(FRAC_PI_2 * above),
            Self::Cylindrical => 1.0,
            Self::TaperedCylindrical => 0.5 + 0.5 * above,
            Self::Flame => flame,
            Self::InverseConical => 1.0 - 0.8 * above,
            Self::TendFlame => 0.5 + 0.5 * flame,
        }
    }
}
