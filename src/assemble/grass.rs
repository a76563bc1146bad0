//! Grass where the camera sees the ground.

use super::AssembleError;
use super::relief::Heights;
use super::scattered::{is_seen, spots};
use crate::math::{Colour, DVec3, Memory, Stream};
use crate::model::{BodyError, Camera, Digits, GrassSpec, GroundSpec, Instance, Material, Model, Object};
use crate::skin::turf;

/// Pieces of turf that differ, each of one colour.
const KINDS: u32 = 5;
/// Pieces of turf stand this far apart, in lengths of a blade, and reach somewhat into each other.
const APART: f64 = 3.0;
const SIDE: f64 = 4.5;
/// Grass grows from this share of its reach on the thinner, the farther away.
const THINS: f64 = 0.5;
/// What blades scatter and let through of the light.
const LIGHT: [f64; 2] = [0.6, 0.4];

/// Adds pieces of turf wherever the camera sees the ground.
pub(super) fn grow_grass(
    seed: u64,
    ground: &GroundSpec,
    heights: &Heights,
    model: &mut Model,
    memory: &Memory,
) -> Result<(), AssembleError> {
    let Some(grass) = &ground.grass else { return Ok(()) };
    let wrong = |error: BodyError| AssembleError::body("grass", error);
    let stream = Stream::new(seed, "grass");
    let places = places(ground.radius, heights, grass, &model.camera, &stream, memory)?;
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
        model.objects.push(Object { instances: places, is_scenery: true, ..object });
    }
    Ok(())
}

/// Where pieces of turf stand, by kind.
fn places(
    radius: Option<f64>,
    heights: &Heights,
    grass: &GrassSpec,
    camera: &Camera,
    stream: &Stream,
    memory: &Memory,
) -> Result<Vec<Vec<Instance>>, AssembleError> {
    let (step, reach) = (grass.height * APART, grass.height * grass.reach);
    let digits = Digits::for_size(reach);
    let mut places = vec![Vec::new(); KINDS as usize];
    for spot in spots(camera, step, reach, stream, memory)? {
        let far = spot.at.distance(camera.at.truncate()) / reach;
        let is_on = radius.is_none_or(|radius| spot.at.length() + step <= radius);
        if !is_on || spot.fate > (1.0 - far) / (1.0 - THINS) {
            continue;
        }
        let at = spot.at.extend(heights.at(spot.at.x, spot.at.y));
        if is_seen(camera, at, step) {
            let kind = ((spot.kind * f64::from(KINDS)) as usize).min(KINDS as usize - 1);
            let scale = Digits(3).round(0.7 + 0.5 * spot.size);
            places[kind].push(Instance { at: digits.round_point(at), turn: libm::floor(spot.turn * 360.0), scale });
        }
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::model::Projection;

    fn camera(y: f64) -> Camera {
        let projection = Projection::Perspective { angle: 0.8 };
        Camera {
            at: DVec3::new(0.0, y, 1.6),
            look_at: DVec3::new(0.0, 0.0, 1.6),
            projection,
            aspect: 1.3,
            ..Camera::FRONT
        }
    }

    fn all(camera: &Camera) -> Vec<Instance> {
        let ground: GroundSpec = toml::from_str("colour = \"#445522\"").unwrap();
        let heights = Heights::new(&ground, &[]);
        let stream = Stream::new(1, "grass");
        let places = places(None, &heights, &GRASS, camera, &stream, &Memory::default()).unwrap();
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
