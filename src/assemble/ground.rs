//! The ground, and what grows on it.

use rand::RngExt;

use super::{AssembleError, Recipe};
use crate::math::{Colour, DVec3, Memory, Stream};
use crate::model::{BodyError, Camera, Digits, GrassSpec, Ground, GroundSpec, Instance, Material, Model, Object};
use crate::skin::turf;

/// The ground has faded into the horizon at this many times the camera's distance or the scene's size.
const REACH: f64 = 2.5;
/// Pieces of turf that differ, each of one colour.
const KINDS: u32 = 5;
/// Pieces of turf stand this far apart, in lengths of a blade, and reach somewhat into each other.
const APART: f64 = 3.0;
const SIDE: f64 = 4.5;
/// Grass grows from this share of its reach on the thinner, the farther away.
const THINS: f64 = 0.5;
/// It grows beyond the picture's edge by this share of the picture.
const BEYOND: f64 = 0.15;
/// What blades scatter and let through of the light.
const LIGHT: [f64; 2] = [0.6, 0.4];

/// Lays the ground of `recipe` in `model`, whose camera is set.
pub(super) fn lay(recipe: &Recipe, model: &mut Model, memory: &Memory) -> Result<(), AssembleError> {
    let Some(spec) = &recipe.ground else { return Ok(()) };
    let camera = model.camera;
    let extent = model.bounds().size().max_element().max((camera.at - camera.look_at).length());
    model.ground = Some(Ground {
        material: Material { pattern: spec.pattern, ..Material::matt(spec.colour) },
        height: spec.height,
        reach: spec.reach.unwrap_or(extent * REACH),
        radius: spec.radius,
    });
    let Some(grass) = &spec.grass else { return Ok(()) };
    grow_grass(recipe.seed, spec, grass, model, memory)
}

/// Adds pieces of turf wherever the camera sees the ground.
fn grow_grass(
    seed: u64,
    ground: &GroundSpec,
    grass: &GrassSpec,
    model: &mut Model,
    memory: &Memory,
) -> Result<(), AssembleError> {
    let wrong = |error: BodyError| AssembleError::body("grass", error);
    let stream = Stream::new(seed, "grass");
    let places = places(ground, grass, &model.camera, &stream, memory)?;
    for (kind, places) in (0..KINDS).zip(places) {
        if places.is_empty() {
            continue;
        }
        let mut mesh = turf(SIDE, &stream.nth(u64::from(kind)));
        mesh.points.iter_mut().for_each(|p| *p *= grass.height);
        let share = f64::from(kind) / f64::from(KINDS - 1);
        let [Colour(dark), Colour(light)] = grass.colours;
        let colour = Colour([0, 1, 2].map(|c| dark[c] + (light[c] - dark[c]) * share));
        let [diffuse, through] = LIGHT;
        let material = Material { diffuse, through, ..Material::matt(colour) };
        model.materials.push((format!("grass {}", kind + 1), material));
        let name = format!("grass_{}", kind + 1);
        let object = Object::of_mesh(&name, &mesh, DVec3::ZERO, model.materials.len() - 1).map_err(wrong)?;
        model.objects.push(Object { instances: places, ..object });
    }
    Ok(())
}

/// Where pieces of turf stand, by kind.
fn places(
    ground: &GroundSpec,
    grass: &GrassSpec,
    camera: &Camera,
    stream: &Stream,
    memory: &Memory,
) -> Result<Vec<Vec<Instance>>, AssembleError> {
    let (step, reach) = (grass.height * APART, grass.height * grass.reach);
    let digits = Digits::for_size(reach);
    let cells = libm::ceil(reach / step) as i64;
    memory.ask((2 * cells + 1).pow(2) as u64 * size_of::<Instance>() as u64)?;
    let middle = [camera.at.x, camera.at.y].map(|x| libm::round(x / step) as i64);
    let mut places = vec![Vec::new(); KINDS as usize];
    for j in middle[1] - cells..=middle[1] + cells {
        for i in middle[0] - cells..=middle[0] + cells {
            // The numbers of a cell are its own, wherever the camera is.
            let mut random = stream.nth(i as u64).nth(j as u64);
            let [x, y, turn, size, kind, fate]: [f64; 6] = std::array::from_fn(|_| random.random());
            let at = DVec3::new((i as f64 + x) * step, (j as f64 + y) * step, ground.height);
            let far = at.truncate().distance(camera.at.truncate()) / reach;
            let is_on = ground.radius.is_none_or(|radius| at.truncate().length() + step <= radius);
            if !is_on || fate > (1.0 - far) / (1.0 - THINS) || !is_seen(camera, at, step) {
                continue;
            }
            let kind = ((kind * f64::from(KINDS)) as usize).min(KINDS as usize - 1);
            let place =
                Instance { at: digits.round_point(at), turn: libm::floor(turn * 360.0), scale: 0.7 + 0.5 * size };
            places[kind].push(Instance { scale: Digits(3).round(place.scale), ..place });
        }
    }
    Ok(places)
}

/// Does the camera see what stands within `radius` of a place on the ground?
fn is_seen(camera: &Camera, at: DVec3, radius: f64) -> bool {
    let is_near = at.distance(camera.at) < 4.0 * radius;
    is_near || camera.project(at).is_some_and(|p| (-BEYOND..=1.0 + BEYOND).contains(&p.x) && p.y < 1.0 + 4.0 * BEYOND)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Projection;

    fn camera(y: f64) -> Camera {
        let projection = Projection::Perspective { angle: 0.8 };
        Camera { at: DVec3::new(0.0, y, 1.6), look_at: DVec3::new(0.0, 0.0, 1.6), projection, aspect: 1.3 }
    }

    fn all(camera: &Camera) -> Vec<Instance> {
        let ground: GroundSpec = toml::from_str("colour = \"#445522\"").unwrap();
        let places = places(&ground, &GRASS, camera, &Stream::new(1, "grass"), &Memory::default()).unwrap();
        assert!(places.len() == KINDS as usize && places.iter().all(|kind| kind.len() > 100));
        places.into_iter().flatten().collect()
    }

    const GRASS: GrassSpec = GrassSpec { height: 0.2, colours: [Colour([0.1; 3]), Colour([0.2; 3])], reach: 200.0 };

    #[test]
    fn grass_covers_what_the_camera_sees() {
        let camera = camera(-20.0);
        let grass = all(&camera);
        let far = |place: &Instance| place.at.truncate().distance(camera.at.truncate());
        assert!(grass.iter().all(|place| far(place) <= 40.0 && place.at.z == 0.0));
        // Near by, a piece on each square of the ground that is seen.
        let mut random = Stream::new(2, "places");
        let tries = 200_000;
        let seen = (0..tries).filter(|_| {
            let [x, y]: [f64; 2] = std::array::from_fn(|_| random.random::<f64>() * 40.0 - 20.0);
            let p = camera.at.with_z(0.0) + DVec3::new(x, y, 0.0);
            p.distance(camera.at.with_z(0.0)) < 20.0 && is_seen(&camera, p, 0.6)
        });
        let expected = seen.count() as f64 / f64::from(tries) * 1600.0 / 0.36;
        let near = grass.iter().filter(|place| far(place) < 20.0).count() as f64;
        assert!((near / expected - 1.0).abs() < 0.05, "{near} {expected}");
        // Beyond it thins out.
        let ring = |from: f64, to: f64| {
            grass.iter().filter(|p| (from..to).contains(&far(p))).count() as f64 / (to * to - from * from)
        };
        assert!(ring(35.0, 40.0) < 0.3 * ring(10.0, 20.0));
    }

    #[test]
    fn grass_stays_where_it_is_when_the_camera_moves() {
        let [here, there] = [-20.0, -17.0].map(camera);
        let is_near = |p: DVec3, camera: &Camera| p.distance(camera.at) < 19.0 && is_seen(camera, p, 0.6);
        let of_both = |all: Vec<Instance>| -> Vec<Instance> {
            let mut both: Vec<_> = all.into_iter().filter(|p| is_near(p.at, &here) && is_near(p.at, &there)).collect();
            both.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(a.at.y.total_cmp(&b.at.y)));
            both
        };
        let (a, b) = (of_both(all(&here)), of_both(all(&there)));
        assert!(a.len() > 100 && a == b);
    }
}
