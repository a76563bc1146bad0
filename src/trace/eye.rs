//! Camera rays.

use super::sampling::disc;
use super::world::{Within, World};
use crate::bvh::Ray;
use crate::math::DVec3;
use crate::model::{Camera, Projection};

/// The generator of camera rays.
pub(super) struct Eye {
    pub camera: Camera,
    /// Right, up and forwards.
    pub frame: [DVec3; 3],
    size: [f64; 2],
    /// Perspective: distance of the image plane of height 1. Parallel: width of the image plane.
    scale: f64,
    /// The solids that it is in.
    pub within: Vec<Within>,
}

impl Eye {
    pub fn new(world: &World<'_>, size: [u32; 2]) -> Self {
        let camera = world.model.camera;
        let within = match camera.projection {
            Projection::Perspective { .. } => world.within(camera.at),
            Projection::Parallel { .. } => Vec::new(),
        };
        let size = size.map(f64::from);
        let scale = match camera.projection {
            Projection::Perspective { angle } => 0.5 * size[0] / size[1] / libm::tan(angle * 0.5),
            Projection::Parallel { width } => width,
        };
        Self { camera, frame: camera.frame(), size, scale, within }
    }

    /// The ray through a point of the picture in pixel coordinates (`reference/povray.md`), and through the point of the lens that
    /// `u` selects (Cook et al. 1984).
    pub fn ray_through_lens(&self, x: f64, y: f64, u: [f64; 2]) -> Ray {
        let ray = self.ray(x, y);
        let lens = self.camera.lens;
        let [right, up, forwards] = self.frame;
        let sharp = ray.origin + ray.direction * (lens.focus / ray.direction.dot(forwards));
        let (across, upwards) = disc(u[0], u[1]);
        let origin = ray.origin + (right * across + up * upwards) * (lens.aperture * 0.5);
        Ray::new(origin, (sharp - origin).normalize())
    }

    /// The ray through a point of the picture in pixel coordinates (`reference/povray.md`).
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let [right, up, forwards] = self.frame;
        let [width, height] = self.size;
        let aspect = width / height;
        let (u, v) = (x / width - 0.5, 0.5 - y / height);
        match self.camera.projection {
            Projection::Perspective { .. } => {
                Ray::new(self.camera.at, (forwards * self.scale + right * (aspect * u) + up * v).normalize())
            }
            Projection::Parallel { .. } => {
                Ray::new(self.camera.at + (right * u + up * (v / aspect)) * self.scale, forwards)
            }
        }
    }
}
