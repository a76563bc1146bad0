//! Shapes, strokes and round cones.
//!
//! Later stages need never handle a shape with a negative size or a name that leads nowhere.

mod round_cone;
mod shape;
mod strokes;

pub use round_cone::{Frustum, frustum};
pub use shape::{Bounds, Shape, ShapeSpec, Solid};
pub use strokes::Strokes;
