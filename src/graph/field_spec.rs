//! Weights and cost fields as a scene writes them.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::ShapeSpec;
use crate::math::Point;

/// A cost field: a structured value added to the random part of the weights, or multiplying it. An edge weighs
/// `length * (R^alpha * product of factors + sum)`; a field's value is `scale * (measure / per)^power`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FieldSpec {
    /// What it measures.
    pub of: MeasureSpec,
    /// Factor of the result.
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub scale: f64,
    /// Exponent of the measure.
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub power: f64,
    /// What the measure is divided by: for distances, the distance that counts as 1.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub per: f64,
    /// Take `1 / (1 + measure)` instead: costly near, cheap far.
    #[serde(default)]
    pub inverse: bool,
    /// Add to the random part, or multiply it (by 1/16 at the least).
    #[serde(default)]
    pub by: FieldUse,
}

fn one() -> f64 {
    1.0
}

/// How a field enters the weight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FieldUse {
    /// It is added to `R^alpha`.
    #[default]
    Add,
    /// `R^alpha` is multiplied by it.
    Multiply,
}

/// What a cost field measures.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MeasureSpec {
    /// Distance from a line: in the plane `|x|`, in space `sqrt(x^2 + y^2)` for the upright one.
    Axis {
        /// Direction of the line; upright by default.
        #[serde(default)]
        along: Option<Point>,
        /// A point of the line.
        #[serde(default)]
        through: Option<Point>,
    },
    /// Distance from a point.
    Point(Point),
    /// Height within the space's shape, 0 to 1.
    Height {
        /// The end where edges are cheap.
        cheap: HeightEnd,
    },
    /// Distance from a shape; 0 inside.
    Shape(ShapeSpec),
    /// Brightness of a greyscale picture (PNG or JPEG, white is costly), stretched over the space's shape; in space it
    /// stands upright and is extruded along y.
    Map {
        /// The picture, relative to the scene file.
        file: String,
    },
    /// Distance from the strokes of an SVG sketch, its page stretched over the space's shape; in space it stands
    /// upright and is extruded along y.
    Sketch {
        /// The sketch, relative to the scene file.
        file: String,
    },
}

/// An end of the height of a space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeightEnd {
    /// The top.
    High,
    /// The bottom.
    Low,
}
