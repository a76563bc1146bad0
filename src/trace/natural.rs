//! The natural look: the studio's lights, which go on from surface to surface and through leaves.

use super::sampling::{DIMENSIONS, further};
use super::shade::add;
use super::world::{SurfaceHit, World};
use crate::bvh::Ray;
use crate::math::Colour;

/// How often light is scattered on its way to the eye at most. In a crown of leaves that scatter and let through half of what they
/// get, what is left out is a sixty-fourth of what came in.
const BOUNCES: usize = 6;
/// A path whose end comes to the eye by this share is followed in any case.
const LITTLE: f64 = 0.4;
/// No path brings more than this: what is met by one path of very many shows as a speck.
const BRIGHTEST: f64 = 8.0;

impl World<'_> {
    /// The radiance of `surface` towards the origin of `ray` by path tracing (Kajiya 1986): at each surface one direction is
    /// followed, by the share that it scatters, and all lights are asked for. `u` are the numbers of the sample, the `sample`th.
    pub(super) fn natural(&self, ray: &Ray, surface: &SurfaceHit, u: &[f64; DIMENSIONS], sample: u64) -> [f64; 3] {
        let mut colour = [0.0; 3];
        // What of the light at the present surface comes to the eye.
        let mut share = [1.0; 3];
        let mut ray = *ray;
        let mut surface = *surface;
        let mut u = [u[2], u[3], u[4], u[5], 0.0];
        for bounce in 1..=BOUNCES {
            let (material, pigment) = self.material(&surface);
            add(&mut colour, &share, &pigment.map(|c| c * material.emission));
            if surface.is_inside {
                break;
            }
            let seen = self.sunlit(&ray, &surface, material, pigment, [u[2], u[3]]);
            add(&mut colour, &share, &seen.map(|x| x.min(BRIGHTEST)));
            let Some((onwards, scattered)) = self.scattered(material, &surface, u[0], u[1]) else { break };
            (0..3).for_each(|c| share[c] *= pigment[c] * scattered);
            // Of paths that bring little only a share goes on, and counts for all (Arvo and Kirk 1990).
            let going = (share[0].max(share[1]).max(share[2]) / LITTLE).min(1.0);
            if bounce > 1 && going < 1.0 {
                if u[4] >= going {
                    break;
                }
                share = share.map(|x| x / going);
            }
            let next = if bounce < BOUNCES { self.closest(&onwards, &[], false) } else { None };
            let is_open = next.is_none() && (bounce < BOUNCES || !self.is_blocked(&onwards));
            let Some(next) = next else {
                if is_open {
                    let Colour(light) = self.dome.light(onwards.direction);
                    add(&mut colour, &share, &light);
                }
                break;
            };
            (ray, surface, u) = (onwards, next, further(sample, bounce));
        }
        colour
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DMat3, DVec3, Progress, Stream};
    use crate::model::{
        Ball, Body, Camera, CameraSpec, Digits, Limbs, Material, Mesh, Model, Object, Pattern, Pose, Sky, pattern,
    };
    use crate::trace::{Look, RenderSettings, render};
    use rand::RngExt;

    /// The sky at which as much comes from below the horizon as from above it.
    const EVEN: f64 = 1.0 / 0.35 - 0.5;

    /// `object` in white, under a sky that is as bright on all sides.
    fn furnace(body: Body, material: Material) -> Model {
        let object = Object::new("it", body, DVec3::ZERO, Digits(6), 0);
        let camera = Camera::new(&CameraSpec::default(), 1.0, object.balls_in_world()).unwrap();
        Model {
            title: String::new(),
            is_flat: false,
            objects: vec![object],
            materials: vec![("white".to_owned(), material)],
            camera,
            lights: vec![],
            ground: None,
            sky: Sky::plain(Colour([EVEN; 3])),
            air: None,
            look: Look::Natural,
            marks: vec![],
            strokes: vec![],
        }
    }

    /// Least and greatest of what is shown where nothing but the object is, over the light that comes from everywhere.
    fn shown(model: &Model) -> [f64; 2] {
        let world = World::new(model);
        let Colour([light, ..]) = world.dome.light(DVec3::X);
        assert_eq!(world.dome.light(DVec3::Z), world.dome.light(DVec3::NEG_Z));
        let view = RenderSettings { transparent: true, ..RenderSettings::new([24, 24], Look::Natural, 256) };
        let picture = render(&world, &view, &Progress::default()).unwrap();
        let whole: Vec<f64> = picture.pixels.iter().filter(|p| p[3] == 1.0).map(|p| f64::from(p[0]) / light).collect();
        assert!(whole.len() > 8, "{}", whole.len());
        [whole.iter().copied().fold(f64::INFINITY, f64::min), whole.iter().copied().fold(0.0, f64::max)]
    }

    /// What scatters all light is not seen in a furnace whose walls all glow alike.
    #[test]
    fn a_white_furnace_shows_nothing_of_bark_and_leaf() {
        let white = Colour([1.0; 3]);
        let ball = Ball { centre: DVec3::Z, radius: 1.0, cost: 0.0, branch: 0, level: 0 };
        let limb = Limbs { balls: vec![ball], ..Limbs::default() };
        let pattern = Some(Pattern::Bark(pattern::Carved { colour: white, size: 0.1, depth: Some(0.0) }));
        let bark = Material { diffuse: 1.0, pattern, ..Material::matt(white) };
        let [least, most] = shown(&furnace(Body::Limbs(limb), bark));
        assert!(least > 0.999 && most < 1.001, "bark: {least} {most}");

        // A cloud of leaves, whose light goes from one to the next: what has not come out after all bounces is missing.
        let leaf = Mesh {
            points: vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let mut random = Stream::new(1, "furnace");
        let mut number = || random.random::<f64>() - 0.5;
        let poses = (0..12).map(|_| {
            let [at, way, side] = std::array::from_fn(|_| DVec3::new(number(), number(), number()));
            let way = way.normalize();
            let side = side.cross(way).normalize();
            Pose::new(at * 2.0, DMat3::from_cols(side, way, side.cross(way)))
        });
        let body = Body::Posed(leaf, poses.collect());
        let [least, most] = shown(&furnace(body, Material { diffuse: 0.5, through: 0.5, ..Material::matt(white) }));
        assert!(least > 0.85 && most < 1.02, "leaves: {least} {most}");
    }
}
