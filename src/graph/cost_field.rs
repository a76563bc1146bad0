//! Cost fields: structured values that modulate the weights in space (Xu and Mould 2008, section 3, Figs 1 and 5).

use std::fmt;
use std::sync::Arc;

use super::FieldValue;
use crate::geom::{Bounds, Shape, Strokes};
use crate::math::{DVec3, power};
use crate::raster::Grey;

/// A scalar field, and how it modulates the weights.
#[derive(Clone, Debug)]
pub struct CostField {
    /// The quantity measured.
    pub measure: Measure,
    /// Divisor of the measure before `power` applies: scene units for distances.
    pub per: f64,
    /// Exponent of the measure.
    pub power: f64,
    /// Factor of the result.
    pub scale: f64,
    /// Take 1 / (1 + measure) instead: costly near, cheap far.
    pub inverse: bool,
    /// Multiply the random part of the weight instead of adding to it.
    pub multiply: bool,
}

/// A function of a place, the same at every call.
#[derive(Clone)]
pub struct FieldFunction(pub Arc<dyn Fn(DVec3) -> f64 + Send + Sync>);

impl fmt::Debug for FieldFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("FieldFunction")
    }
}

/// The quantity that a field measures.
#[derive(Clone, Debug)]
pub enum Measure {
    /// Distance from the line through a point along a unit vector.
    Axis {
        /// A point of the line.
        through: DVec3,
        /// Its direction, a unit vector.
        along: DVec3,
    },
    /// Distance from a point.
    Point(DVec3),
    /// Relative height along axis `up`, from 0 at the cheap end to 1 at the costly one.
    Height {
        /// 1 in the plane, 2 in space.
        up: usize,
        /// Coordinate where it is 0.
        cheap: f64,
        /// Coordinate where it is 1.
        costly: f64,
    },
    /// Distance from a shape; 0 inside.
    Shape(Shape),
    /// Brightness of a picture, 0 black to 1 white, stretched over `frame` (x across, axis `up` upwards).
    Map {
        /// The painted map.
        picture: Arc<Grey>,
        /// What it covers.
        frame: Bounds,
        /// 1 in the plane, 2 in space, where the map is extruded along y.
        up: usize,
    },
    /// A function of one's own: finite, at least 0.
    Function(FieldFunction),
    /// Distance from the nearest stroke of a sketch; in space the sketch is extruded along y.
    Sketch {
        /// The strokes, in the plane of x and y.
        strokes: Arc<Strokes>,
        /// 1 in the plane, 2 in space.
        up: usize,
    },
}

impl CostField {
    /// `measure` itself, added to the weights.
    #[must_use]
    pub fn new(measure: Measure) -> Self {
        Self { measure, per: 1.0, power: 1.0, scale: 1.0, inverse: false, multiply: false }
    }

    /// The shape that it measures from, if it does.
    pub fn shape_mut(&mut self) -> Option<&mut Shape> {
        if let Measure::Shape(shape) = &mut self.measure { Some(shape) } else { None }
    }

    /// The axes along which it may vary.
    #[must_use]
    pub fn varies(&self) -> [bool; 3] {
        match &self.measure {
            Measure::Axis { along, .. } => along.to_array().map(|c| c.abs() < 1.0),
            Measure::Height { up, .. } => [0, 1, 2].map(|axis| axis == *up),
            Measure::Map { up, .. } | Measure::Sketch { up, .. } => [0, 1, 2].map(|axis| axis == 0 || axis == *up),
            Measure::Point(_) | Measure::Shape(_) | Measure::Function(_) => [true; 3],
        }
    }

    /// Its value at `p`: `scale * (measure / per)^power`.
    #[must_use]
    pub fn value(&self, p: DVec3) -> f64 {
        let flat = |up: usize| DVec3::new(p.x, p[up], 0.0);
        let measure = match &self.measure {
            Measure::Axis { through, along } => {
                let d = p - *through;
                (d - *along * d.dot(*along)).length()
            }
            Measure::Point(at) => (p - *at).length(),
            Measure::Height { up, cheap, costly } => ((p[*up] - cheap) / (costly - cheap)).clamp(0.0, 1.0),
            Measure::Shape(shape) => shape.distance(p).max(0.0),
            Measure::Function(FieldFunction(function)) => function(p),
            Measure::Map { picture, frame, up } => {
                let size = frame.size();
                picture.at((p.x - frame.min.x) / size.x, (frame.max[*up] - p[*up]) / size[*up])
            }
            Measure::Sketch { strokes, up } => strokes.distance(flat(*up)),
        } / self.per;
        let measure = if self.inverse { 1.0 / (1.0 + measure) } else { measure };
        self.scale * power(measure, self.power)
    }

    /// The combination of `fields` at `p`: the sum of the added ones, the product of the others.
    #[must_use]
    pub fn combine(fields: &[Self], p: DVec3) -> FieldValue {
        let none = FieldValue { sum: 0.0, factor: 1.0 };
        fields.iter().fold(none, |all, field| {
            let value = field.value(p);
            if field.multiply {
                FieldValue { factor: all.factor * value, ..all }
            } else {
                FieldValue { sum: all.sum + value, ..all }
            }
        })
    }
}
