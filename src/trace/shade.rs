//! The light that a surface sends back: POV-Ray's local illumination, and the studio's.

use super::sampling::{DIMENSIONS, above, around};
use super::world::{Surface, World};
use crate::bvh::Ray;
use crate::math::{Colour, DVec3, power};
use crate::model::{Light, Material};

/// POV-Ray lets nothing nearer than this cast a shadow (`reference/povray.md`; its own unit is ours).
const SHADOW: f64 = 1e-3;

impl World<'_> {
    /// The light along `ray` from `surface`, as POV-Ray computes it (`reference/povray.md`): no more than one light's
    /// shadow ray each.
    pub(super) fn exact(&self, ray: &Ray, surface: &Surface) -> [f64; 3] {
        let (material, pigment) = self.material(surface);
        let own = material.ambient + material.emission;
        let mut colour = pigment.map(|c| c * own);
        for light in &self.model.lights {
            let (towards, far, shadow) = towards(light, surface.point);
            if towards.dot(surface.normal) <= 0.0 {
                continue;
            }
            let to_light = Ray { origin: surface.point, direction: towards, near: SHADOW, far };
            if shadow && (surface.is_inside || self.is_blocked(&to_light)) {
                continue;
            }
            let Colour(strength) = light.colour();
            let strength = strength.map(|x| x * light.falloff(far));
            add(&mut colour, &lit(material, pigment, shadow.then_some(ray), surface.normal, towards), &strength);
        }
        colour
    }

    /// The light along `ray` from `surface` in the studio look: the sky from all around instead of constant ambient
    /// light, and suns that have a size. `u` picks one direction each.
    pub(super) fn studio(&self, ray: &Ray, surface: &Surface, u: &[f64; DIMENSIONS]) -> [f64; 3] {
        let (material, pigment) = self.material(surface);
        let mut colour = pigment.map(|c| c * material.emission);
        let origin = surface.point + surface.normal * self.off;
        if material.diffuse > 0.0 && !surface.is_inside {
            let direction = above(surface.normal, u[2], u[3]);
            if !self.is_blocked(&Ray::new(origin, direction)) {
                let Colour(light) = self.dome.light(direction);
                add(&mut colour, &pigment.map(|c| c * material.diffuse), &light);
            }
        }
        for light in &self.model.lights {
            let Colour(strength) = light.studio();
            if strength == [0.0; 3] {
                continue;
            }
            let (mut towards, far, shadow) = towards(light, surface.point);
            if let Light::Sun { size, .. } = light
                && *size > 0.0
            {
                towards = around(towards, size * 0.5, u[4], u[5]);
            }
            if towards.dot(surface.normal) <= 0.0 || surface.is_inside {
                continue;
            }
            if !shadow || !self.is_blocked(&Ray { far, ..Ray::new(origin, towards) }) {
                let strength = strength.map(|x| x * light.falloff(far));
                add(&mut colour, &lit(material, pigment, shadow.then_some(ray), surface.normal, towards), &strength);
            }
        }
        colour
    }

    /// What a surface is made of, and its colour there.
    fn material(&self, surface: &Surface) -> (&Material, [f64; 3]) {
        let material = match (surface.object, &self.model.ground) {
            (Some(object), _) => &self.model.materials[self.model.objects[object as usize].material].1,
            (None, Some(ground)) => &ground.material,
            (None, None) => unreachable!("a surface is an object's or the ground's"),
        };
        (material, material.blend(surface.pattern).0)
    }
}

/// Direction to a light, its distance, and whether it casts shadows.
fn towards(light: &Light, point: DVec3) -> (DVec3, f64, bool) {
    match *light {
        Light::Sun { towards, shadow, .. } => (towards, f64::INFINITY, shadow),
        Light::Point { at, shadow, .. } => {
            let way = at - point;
            let distance = way.length();
            (way / distance.max(f64::MIN_POSITIVE), distance, shadow)
        }
    }
}

fn add(sum: &mut [f64; 3], share: &[f64; 3], light: &[f64; 3]) {
    for i in 0..3 {
        sum[i] += share[i] * light[i];
    }
}

/// The share of a light that comes back: diffuse, and highlights after Blinn (`specular`) and Phong, where `ray` asks
/// for them: lights without shadow make none.
fn lit(material: &Material, pigment: [f64; 3], ray: Option<&Ray>, normal: DVec3, towards: DVec3) -> [f64; 3] {
    let diffuse = material.diffuse * normal.dot(towards);
    let Some(ray) = ray else { return pigment.map(|c| c * diffuse) };
    let mut gloss = 0.0;
    if material.specular > 0.0 {
        let cos = (towards - ray.direction).normalize_or_zero().dot(normal);
        if cos > 0.0 {
            gloss += material.specular * power(cos, 1.0 / material.roughness);
        }
    }
    if material.phong > 0.0 {
        let mirrored = ray.direction - normal * (2.0 * ray.direction.dot(normal));
        let cos = mirrored.dot(towards);
        if cos > 0.0 {
            gloss += material.phong * power(cos, material.phong_size);
        }
    }
    pigment.map(|c| c * diffuse + gloss)
}
