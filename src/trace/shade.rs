//! Shading: POV-Ray's local illumination, and the studio look.

use super::sampling::{DIMENSIONS, cone, cosine_hemisphere};
use super::world::{SurfaceHit, World};
use crate::bvh::Ray;
use crate::math::{Colour, DVec3, power};
use crate::model::{Light, Material};

/// POV-Ray's shadow tolerance: nothing nearer casts a shadow (`reference/povray.md`), in scene units.
const SHADOW: f64 = 1e-3;

/// Rays start at least this far off a surface, over how far that is from the origin: some ten times what single precision loses.
const FAR: f64 = 1e-6;

impl World<'_> {
    /// The radiance of `surface` towards the origin of `ray` by POV-Ray's local illumination (`reference/povray.md`): one shadow ray
    /// for each light.
    pub(super) fn exact(&self, ray: &Ray, surface: &SurfaceHit) -> [f64; 3] {
        let (material, pigment) = self.material(surface);
        let own = material.ambient + material.emission;
        let mut colour = pigment.map(|c| c * own);
        for light in &self.model.lights {
            let (towards, far, shadow) = towards(light, surface.point);
            if !surface.faces(towards, surface.turned, material, shadow) {
                continue;
            }
            let to_light = Ray { origin: surface.point, direction: towards, near: SHADOW, far };
            if shadow && (surface.is_inside || self.is_blocked(&to_light)) {
                continue;
            }
            let Colour(strength) = light.colour();
            let strength = strength.map(|x| x * light.falloff(far));
            add(&mut colour, &lit(material, pigment, shadow.then_some(ray), surface.turned, towards), &strength);
        }
        colour
    }

    /// The radiance of `surface` towards the origin of `ray` in the studio look: the sky instead of constant ambient light, and suns
    /// of finite size. `u` selects one direction to the sky and one to each sun.
    pub(super) fn studio(&self, ray: &Ray, surface: &SurfaceHit, u: &[f64; DIMENSIONS]) -> [f64; 3] {
        let (material, pigment) = self.material(surface);
        let mut colour = pigment.map(|c| c * material.emission);
        if surface.is_inside {
            return colour;
        }
        if let Some((onwards, share)) = self.scattered(material, surface, u[2], u[3])
            && !self.is_blocked(&onwards)
        {
            let Colour(light) = self.dome.light(onwards.direction);
            add(&mut colour, &pigment.map(|c| c * share), &light);
        }
        add(&mut colour, &self.sunlit(ray, surface, material, pigment, [u[4], u[5]]), &[1.0; 3]);
        colour
    }

    /// What `surface` shows of the lights of the studio, with suns of finite size; `u` selects a point of each sun.
    pub(super) fn sunlit(
        &self,
        ray: &Ray,
        surface: &SurfaceHit,
        material: &Material,
        pigment: [f64; 3],
        u: [f64; 2],
    ) -> [f64; 3] {
        let mut colour = [0.0; 3];
        for light in &self.model.lights {
            let Colour(strength) = light.studio();
            if strength == [0.0; 3] {
                continue;
            }
            let (mut towards, far, shadow) = towards(light, surface.point);
            if let Light::Sun { size, .. } = light
                && *size > 0.0
            {
                towards = cone(towards, size * 0.5, u[0], u[1]);
            }
            let facing = surface.normal.dot(towards);
            if !surface.faces(towards, surface.normal, material, shadow) {
                continue;
            }
            let origin = self.beside(surface, facing);
            if !shadow || !self.is_blocked(&Ray { far, ..Ray::new(origin, towards) }) {
                let strength = strength.map(|x| x * light.falloff(far));
                add(&mut colour, &lit(material, pigment, shadow.then_some(ray), surface.normal, towards), &strength);
            }
        }
        colour
    }

    /// A direction in which `material` scatters light, or from which it gets it, and the share of that light: on the side of
    /// the normal, or beyond a leaf.
    pub(super) fn scattered(&self, material: &Material, surface: &SurfaceHit, u: f64, v: f64) -> Option<(Ray, f64)> {
        let share = material.diffuse + material.through;
        if share <= 0.0 {
            return None;
        }
        let front = material.diffuse / share;
        let (side, u) = if u < front { (1.0, u / front) } else { (-1.0, (u - front) / (1.0 - front)) };
        let direction = cosine_hemisphere(surface.normal * side, u, v);
        Some((Ray::new(self.beside(surface, side), direction), share))
    }

    /// Where rays start from `surface`, on the side of its normal where `facing` is positive.
    fn beside(&self, surface: &SurfaceHit, facing: f64) -> DVec3 {
        // Far away single precision loses more.
        let off = self.off.max(surface.point.abs().max_element() * FAR);
        surface.point + surface.normal * off.copysign(facing)
    }

    /// The material of a surface, and its colour there.
    pub(super) fn material(&self, surface: &SurfaceHit) -> (&Material, [f64; 3]) {
        let material = match (surface.object, &self.model.ground) {
            (Some(object), _) => &self.model.materials[self.model.objects[object as usize].material].1,
            (None, Some(ground)) => &ground.material,
            (None, None) => unreachable!("a surface is an object's or the ground's"),
        };
        let colour = material.blend(surface.pattern);
        let Colour(shown) = match material.tips {
            Some(tips) if surface.tip > 0 => tips.over(material.mean_colour(), surface.tip),
            _ if surface.is_below && material.paler > 0.0 => material.below(colour),
            _ => colour,
        };
        (material, shown)
    }
}

impl SurfaceHit {
    /// Does it show light from this direction, being bumpy as `normal` has it? Light with shadows does not come through the limb.
    fn faces(&self, towards: DVec3, normal: DVec3, material: &Material, shadow: bool) -> bool {
        let facing = normal.dot(towards);
        material.shows(facing) && (!shadow || facing * self.face.dot(towards) >= 0.0)
    }
}

/// Direction to a light, its distance, and whether it casts shadows.
fn towards(light: &Light, point: DVec3) -> (DVec3, f64, bool) {
    match *light {
        Light::Sun { towards, shadow, .. } => (towards, f64::INFINITY, shadow),
        Light::Point { at, shadow, .. } => {
            let to_light = at - point;
            let distance = to_light.length();
            (to_light / distance.max(f64::MIN_POSITIVE), distance, shadow)
        }
    }
}

/// Adds `share * light`, channel by channel.
pub(super) fn add(sum: &mut [f64; 3], share: &[f64; 3], light: &[f64; 3]) {
    for i in 0..3 {
        sum[i] += share[i] * light[i];
    }
}

/// The share of a light that is shown: Lambertian diffuse on the side of the normal, what goes through on the other, and with `ray`
/// the highlights of Blinn (`specular`) and Phong. Shadowless lights have no highlights.
fn lit(material: &Material, pigment: [f64; 3], ray: Option<&Ray>, normal: DVec3, towards: DVec3) -> [f64; 3] {
    let facing = normal.dot(towards);
    let diffuse = facing.abs() * if facing > 0.0 { material.diffuse } else { material.through };
    let Some(ray) = ray.filter(|_| facing > 0.0) else { return pigment.map(|c| c * diffuse) };
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
