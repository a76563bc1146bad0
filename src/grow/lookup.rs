//! Where what is written is looked up, and where what is wrong with it is told.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::segments::Expected;
use super::spec::StepSpec;
use super::step::Step;
use crate::geom::{Bounds, Shape, ShapeSpec};
use crate::math::{DVec3, Ref};
use crate::raster::Grey;

/// The strokes and the points of a sketch, in scene units: (across, up, 0).
pub type Sketched = (Vec<Vec<DVec3>>, Vec<DVec3>);

/// Names and files of a scene. Keys are dotted paths below the step or the space that is being resolved.
pub trait Lookup {
    /// Notes what is wrong with the value at `key`.
    fn wrong(&mut self, key: &str, message: String);

    /// A shape; what is wrong with it is noted.
    fn shape(&mut self, key: &str, spec: &ShapeSpec) -> Option<Shape>;

    /// A picture in shades of grey; what is wrong with it is noted.
    fn grey(&mut self, key: &str, file: &str) -> Option<Arc<Grey>>;

    /// The drawing `file`, its page stretched over `frame`, whose axis `up` is upright; what is wrong with it is noted.
    fn sketch(&mut self, key: &str, file: &str, frame: Bounds, up: usize) -> Option<Sketched>;

    /// The index of the step of this name; where there is none that is noted.
    fn step(&mut self, key: &str, name: &Ref<Step>) -> Option<usize>;

    /// All steps as they are written.
    fn steps(&self) -> &BTreeMap<String, StepSpec>;

    /// How much each step is expected to grow, by name.
    fn expected(&self, step: &str) -> Expected;

    /// Is the scene flat?
    fn is_flat(&self) -> bool;

    /// Size of a pixel in scene units, where there is a view.
    fn pixel(&self) -> Option<f64>;
}

/// The value, or its error noted at `key`.
pub(super) fn note<T>(lookup: &mut dyn Lookup, key: &str, result: Result<T, impl ToString>) -> Option<T> {
    result.map_err(|error| lookup.wrong(key, error.to_string())).ok()
}

/// The shape, where one is given: `None` where that is wrong.
pub(super) fn given_shape(lookup: &mut dyn Lookup, key: &str, spec: Option<&ShapeSpec>) -> Option<Option<Shape>> {
    spec.map_or(Some(None), |spec| lookup.shape(key, spec).map(Some))
}
