//! The neutral description of a scene that exporters and renderers read.
//!
//! World space is right-handed with z up. Later stages need never handle a number that is not finite, a radius of 0,
//! or a number with more digits than are written: all are rounded once, here.

mod appearance;
mod camera;
mod object;
mod skin;

pub use appearance::{Ground, GroundSpec, Light, LightSpec, Material, Sky};
pub use camera::{Camera, CameraSpec, Projected, Projection};
pub use object::{Ball, Digits, Object};
pub use skin::{Skin, SkinError};

use crate::geom::Bounds;
use crate::grow::Mark;
use crate::math::DVec3;

/// A scene as renderers see it.
#[derive(Clone, Debug)]
pub struct Model {
    /// The scene's title.
    pub title: String,
    /// Is everything in the plane y = 0, seen from the front?
    pub is_flat: bool,
    /// What was grown.
    pub objects: Vec<Object>,
    /// What objects are made of; [`Object::material`] is an index.
    pub materials: Vec<(String, Material)>,
    /// The view.
    pub camera: Camera,
    /// What lights it.
    pub lights: Vec<Light>,
    /// The ground, if any.
    pub ground: Option<Ground>,
    /// What is behind everything.
    pub sky: Sky,
    /// Construction drawings, in world space.
    pub marks: Vec<Mark>,
}

impl Model {
    /// A box around all objects.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.objects.iter().map(Object::bounds).fold(Bounds::EMPTY, Bounds::union)
    }

    /// How many spheres and cones there are.
    #[must_use]
    pub fn primitives(&self) -> usize {
        self.objects.iter().map(|o| o.balls.len() + o.segments.len()).sum()
    }
}

/// World space from a scene's own: in the plane, y is up; the world has z up.
#[must_use]
pub fn to_world(p: DVec3, is_flat: bool) -> DVec3 {
    if is_flat { DVec3::new(p.x, 0.0, p.y) } else { p }
}
