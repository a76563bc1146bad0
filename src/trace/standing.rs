//! Where things stand in the world.

use crate::bvh::Ray;
use crate::math::{DMat3, DVec3};
use crate::model::{Instance, Pose};

/// Where an object, or one posed mesh of it, is in the world.
pub(super) struct Standing {
    /// Where its origin is.
    at: DVec3,
    /// Its axes' inverse: what turns directions in the world into its own.
    inverse: DMat3,
}

impl Standing {
    pub fn whole(instance: &Instance) -> Self {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| instance.unturned(axis) / instance.scale);
        Self { at: instance.at, inverse: DMat3::from_cols(x, y, z) }
    }

    pub fn posed(instance: &Instance, pose: &Pose) -> Self {
        let axes = [pose.axes.x_axis, pose.axes.y_axis, pose.axes.z_axis];
        let [x, y, z] = axes.map(|axis| instance.turned(axis * instance.scale));
        Self { at: instance.to_world(pose.at), inverse: DMat3::from_cols(x, y, z).inverse() }
    }

    pub fn to_world(&self, p: DVec3) -> DVec3 {
        self.inverse.inverse() * p + self.at
    }

    pub fn to_own(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.at)
    }

    /// The ray in the object's own space, and how much longer distances along it are in the world.
    pub fn ray(&self, ray: &Ray) -> (Ray, f64) {
        let direction = self.inverse * ray.direction;
        let length = direction.length();
        let (origin, direction) = (self.to_own(ray.origin), direction / length);
        (Ray { origin, direction, near: ray.near * length, far: ray.far * length }, 1.0 / length)
    }

    /// A unit normal in the world from one of the object's own.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        (self.inverse.transpose() * normal).normalize_or(DVec3::Z)
    }
}
