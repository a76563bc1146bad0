//! A scene as renderers see it.

use super::{Air, Camera, Ground, Light, Look, Material, Object, Sky, Stroke};
use crate::geom::{Bounds, Mark};
use crate::math::{Colour, DVec3};

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
    /// Haze, if any.
    pub air: Option<Air>,
    /// How it is lit where nothing else is asked for.
    pub look: Look,
    /// Construction drawings, in world space.
    pub marks: Vec<Mark>,
    /// What shines in a flat scene with a view, in scene space.
    pub strokes: Vec<Stroke>,
}

impl Model {
    /// A box around all objects but scenery.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let own = self.objects.iter().filter(|object| !object.is_scenery);
        own.map(Object::bounds).fold(Bounds::EMPTY, Bounds::union)
    }

    /// Does anything stand about what it is of?
    #[must_use]
    pub fn has_scenery(&self) -> bool {
        self.objects.iter().any(|object| object.is_scenery)
    }

    /// A box around all objects.
    #[must_use]
    pub fn bounds_of_all(&self) -> Bounds {
        self.objects.iter().map(Object::bounds).fold(Bounds::EMPTY, Bounds::union)
    }

    /// A colour as it is seen from `from` through the air, this far away along a unit `way`.
    #[must_use]
    pub fn hazed(&self, from: DVec3, way: DVec3, far: f64, colour: Colour) -> Colour {
        let Some(air) = &self.air else { return colour };
        let left = air.through(from, way, far);
        self.sky.at_horizon().mixed(colour, left)
    }

    /// Bytes of its objects and its sky in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let bytes = |object: &Object| object.body.bytes() + size_of_val(&object.instances[..]);
        let sky = match &self.sky {
            Sky::Picture { picture, .. } => picture.bytes(),
            Sky::Gradient { .. } => 0,
        };
        sky + self.objects.iter().map(bytes).sum::<usize>()
    }

    /// How many spheres, cones and triangles there are, once for each object.
    #[must_use]
    pub fn primitives(&self) -> usize {
        self.objects.iter().map(|object| object.body.primitives()).sum()
    }
}

/// World space from a scene's own: in the plane, y is up; the world has z up.
#[must_use]
pub fn to_world(p: DVec3, is_flat: bool) -> DVec3 {
    if is_flat { DVec3::new(p.x, 0.0, p.y) } else { p }
}
