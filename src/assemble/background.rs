//! Plants of the scene once more, far behind it.

use super::relief::Heights;
use super::scattered::{is_seen, spots};
use super::{AssembleError, Recipe};
use crate::math::{Colour, DVec3, Memory, Stream};
use crate::model::pattern::{PATCH, patches};
use crate::model::{BackgroundSpec, Body, Digits, GroundSpec, Instance, Material, Mesh, Model, Object};
use crate::skin::{distant_leaves, distant_limbs, distant_step, distant_triangles};

/// Their sizes over that of the plant itself.
const SIZES: [f64; 2] = [0.55, 1.15];
/// They stand in the ground by this share of their height, since their limbs have no ends.
const SUNK: f64 = 0.01;

/// Adds what `spec` says behind the objects of `model`, on ground of these heights.
pub(super) fn add_background(
    recipe: &Recipe,
    spec: &BackgroundSpec,
    ground: Option<(&GroundSpec, &Heights)>,
    model: &mut Model,
    memory: &Memory,
) -> Result<(), AssembleError> {
    let stream = Stream::new(recipe.seed, "background");
    let places = places(spec, ground, model, &stream, memory)?;
    let foot = ground.map_or(0.0, |(ground, _)| ground.height);
    let parts = plant(model, foot);
    for (name, mesh, material) in parts {
        if mesh.triangles.is_empty() || places.is_empty() {
            continue;
        }
        model.materials.push((name.to_owned(), material));
        let object = Object::of_mesh(name, &mesh, DVec3::ZERO, model.materials.len() - 1)
            .map_err(|error| AssembleError::body("background", error))?;
        let digits = Digits::for_size(spec.to);
        let places = places.iter().map(|&place| Instance { at: digits.round_point(place.at), ..place });
        model.objects.push(Object { instances: places.collect(), is_scenery: true, ..object });
    }
    Ok(())
}

/// Where they stand.
fn places(
    spec: &BackgroundSpec,
    ground: Option<(&GroundSpec, &Heights)>,
    model: &Model,
    stream: &Stream,
    memory: &Memory,
) -> Result<Vec<Instance>, AssembleError> {
    let camera = &model.camera;
    let share = patches();
    let unit = spec.groves / PATCH;
    let sunk = model.bounds().size().z.max(0.0) * SUNK;
    // Behind what they are copies of.
    let middle = model.bounds().centre().truncate();
    let nearest = spec.from.max(middle.distance(camera.at.truncate()));
    let mut places = Vec::new();
    for spot in spots(camera, spec.apart, spec.to, stream, memory)? {
        let (x, y) = (spot.at.x, spot.at.y);
        let far = spot.at.distance(camera.at.truncate());
        let is_grove = share.at(DVec3::new(x / unit, 1.0, y / unit)) > 1.0 - spec.share;
        let is_on = ground.and_then(|(ground, _)| ground.radius).is_none_or(|radius| spot.at.length() <= radius);
        if !is_on || !is_grove || !(nearest..=spec.to).contains(&far) {
            continue;
        }
        let at = DVec3::new(x, y, ground.map_or(0.0, |(_, heights)| heights.at(x, y)) - sunk);
        if is_seen(camera, at, spec.apart) {
            let scale = Digits(3).round(SIZES[0] + (SIZES[1] - SIZES[0]) * spot.size);
            places.push(Instance { at, turn: libm::floor(spot.turn * 360.0), scale });
        }
    }
    Ok(places)
}

/// The plants of `model` as they are seen from afar, about the middle of their foot: wood and leaves.
fn plant(model: &Model, foot: f64) -> [(&'static str, Mesh, Material); 2] {
    let bounds = model.bounds();
    let middle = bounds.centre().with_z(foot);
    let own = || model.objects.iter().filter(|object| !object.is_scenery);
    let material = |object: &Object| model.materials[object.material].1;
    let (mut wood, mut leaves) = (Mesh::default(), Mesh::default());
    let (mut of_wood, mut of_leaves) = (Mixture::default(), Mixture::default());
    let count: usize = own().map(|object| object.body.poses().len()).sum();
    for object in own() {
        let place = Instance { at: object.instances[0].at - middle, ..object.instances[0] };
        match &object.body {
            Body::Limbs(limbs) => {
                distant_limbs(limbs, &place, &mut wood);
                of_wood.add(material(object), limbs.balls.iter().map(|ball| ball.radius).sum());
            }
            Body::Mesh(mesh) => {
                distant_triangles(mesh, distant_step(mesh.triangles.len()), &place, &mut wood);
                of_wood.add(material(object), mesh.triangles.len() as f64);
            }
            Body::Posed(leaf, poses) => {
                distant_leaves(leaf, poses, distant_step(count), &place, &mut leaves);
                of_leaves.add(material(object), poses.len() as f64);
            }
        }
    }
    [("background wood", wood, of_wood.mean()), ("background leaves", leaves, of_leaves.mean())]
}

/// The material of things of several.
#[derive(Default)]
struct Mixture {
    sum: [f64; 3],
    weight: f64,
    /// What there is most of, and how much.
    most: Option<(Material, f64)>,
}

impl Mixture {
    fn add(&mut self, material: Material, weight: f64) {
        let Colour(colour) = material.mean_colour();
        (0..3).for_each(|c| self.sum[c] += colour[c] * weight);
        self.weight += weight;
        if self.most.is_none_or(|(_, most)| weight > most) {
            self.most = Some((material, weight));
        }
    }

    /// That of which there is most, in the mean colour.
    fn mean(&self) -> Material {
        let mean = Colour(self.sum.map(|x| x / self.weight.max(f64::MIN_POSITIVE)));
        self.most.map_or(Material::matt(mean), |(most, _)| Material { colour: mean, pattern: None, ..most })
    }
}
