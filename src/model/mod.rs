//! The neutral description of a scene that exporters and renderers read.
//!
//! World space is right-handed with z up. Later stages need never handle a number that is not finite, a radius of 0,
//! or a number with more digits than are written: all are rounded once, here.

mod appearance;
mod camera;
mod dome;
mod leaves;
mod object;
mod paint;
mod pattern;
mod skin;
mod stroke;
mod surface;
mod thorns;
mod view;

pub use appearance::{FADE, Ground, GroundSpec, Light, LightSpec, Material, Sky, SkySpec};
pub use camera::{Camera, CameraSpec, Projected, Projection};
pub use dome::Dome;
pub use leaves::{LeafLight, LeavesSpec, ball_mesh, leaf_mesh};
pub use object::{Ball, Digits, Instance, Mesh, Object, Pose};
pub use paint::{PaintSpec, Painting};
pub use pattern::{BARK, Frame, MOSS, Pattern, Wave, limb_frames};
pub use skin::{Skin, SkinError, foot};
pub use stroke::{CORE, CloudLight, GlowSpec, Halo, NearGlow, Piece, Stroke, shining};
pub use thorns::ThornsSpec;
pub use view::{BEYOND, Frame as ViewFrame, ViewSpec};

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
    /// What shines in a flat scene with a view, in scene space.
    pub strokes: Vec<Stroke>,
}

impl Model {
    /// A box around all objects.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.objects.iter().map(Object::bounds).fold(Bounds::EMPTY, Bounds::union)
    }

    /// How many spheres, cones and triangles there are, once for each object.
    #[must_use]
    pub fn primitives(&self) -> usize {
        self.objects.iter().map(Object::primitives).sum()
    }
}

/// World space from a scene's own: in the plane, y is up; the world has z up.
#[must_use]
pub fn to_world(p: DVec3, is_flat: bool) -> DVec3 {
    if is_flat { DVec3::new(p.x, 0.0, p.y) } else { p }
}
