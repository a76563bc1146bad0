//! The way through the house: steps are grown, skeletons dressed, the model put together.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rayon::prelude::*;

use super::dress::dress;
use super::{LightsSpec, Resolved, SceneError};
use crate::grow::{Canopy, GrowError, Grown, Mark, MarkKind, Regions, Rounds, Space, Step};
use crate::math::{Cancelled, Colour, DVec3, Progress};
use crate::model::{Camera, Ground, Light, Material, Model, Object, Projection, Skin, Stroke, shining, to_world};
use crate::skeleton::{Plant, PlantPart, Skeleton};

/// The ground has faded into the horizon at this many times the camera's distance or the scene's size.
const GROUND_REACH: f64 = 2.5;

/// Why a scene gave no result.
#[derive(Debug, thiserror::Error)]
pub enum Stage {
    /// The scene makes it impossible.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// It would take more memory than allowed.
    #[error(
        "the scene needs about {} MB of memory, more than the {} MB allowed: use a wider spacing or fewer nodes, or raise --max-memory",
        needed.div_ceil(1_000_000), limit / 1_000_000
    )]
    Memory {
        /// Bytes that it needs.
        needed: u64,
        /// Bytes that it may take.
        limit: u64,
    },
    /// Stopped by its [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Grows every step of `scene` within `max_memory` bytes; `show` lists what construction drawings need.
///
/// # Errors
/// [`Stage`].
pub fn grow(scene: &Resolved, show: &[MarkKind], max_memory: u64, progress: &Progress) -> Result<Vec<Grown>, Stage> {
    let needed = scene.bytes_needed();
    if needed > max_memory {
        return Err(Stage::Memory { needed, limit: max_memory });
    }
    let told = |error: GrowError| match error {
        GrowError::Scene { place, message } => Stage::Scene(scene.error(&place, message)),
        GrowError::Cancelled(cancelled) => Stage::Cancelled(cancelled),
    };
    let mut grown: Vec<Option<Grown>> = scene.steps.iter().map(|_| None).collect();
    let mut growing: BTreeMap<usize, Rounds<'_>> = BTreeMap::new();
    // A round holds all steps that wait for nothing that has not grown, and one repetition of each that is under way; it
    // reads only what the rounds before made.
    while grown.iter().any(Option::is_none) {
        let is_ready = |i: &usize| {
            grown[*i].is_none()
                && !growing.contains_key(i)
                && scene.steps[*i].after().all(|before| grown[before].is_some())
        };
        let ready: Vec<usize> = (0..grown.len()).filter(is_ready).collect();
        let earlier: Vec<Option<&Skeleton>> = grown.iter().map(|g| g.as_ref().map(|g| &g.skeleton)).collect();
        let (repeated, round): (Vec<usize>, Vec<usize>) =
            ready.into_iter().partition(|&i| scene.steps[i].repeat.is_some());
        for i in repeated {
            let step = &scene.steps[i];
            if let (Some(repeat), Some(Space::Scatter(space))) = (&step.repeat, &step.space) {
                growing.insert(i, Rounds::new(step, repeat, space, scene.seed, &earlier).map_err(told)?);
            }
        }
        let canopies: Vec<Vec<Canopy>> = {
            let world: Vec<&Skeleton> =
                earlier.iter().copied().flatten().chain(growing.values().map(Rounds::skeleton)).collect();
            growing.values().map(|rounds| rounds.clumps().map(|clump| Canopy::new(&world, clump)).collect()).collect()
        };
        let solids = |i: usize| grown[i].as_ref()?.regions.as_ref().map(Regions::solid);
        // Those in the same voxels grow together, the others alone.
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for i in round {
            let is_joined = |group: &&mut Vec<usize>| scene.steps[group[0]].shares_voxels(&scene.steps[i]);
            match groups.iter_mut().find(is_joined) {
                Some(group) => group.push(i),
                None => groups.push(vec![i]),
            }
        }
        let grow = |group: &Vec<usize>| -> Result<Vec<Grown>, GrowError> {
            let steps: Vec<Cow<'_, Step>> = group
                .iter()
                .map(|&i| {
                    let step = &scene.steps[i];
                    if step.solids().is_empty() { Cow::Borrowed(step) } else { Cow::Owned(step.with_solids(&solids)) }
                })
                .collect();
            let Some(Space::Voxels(space)) = &steps[0].space else {
                return steps.iter().map(|step| step.grow(scene.seed, &earlier, show, progress)).collect();
            };
            let steps: Vec<&Step> = steps.iter().map(AsRef::as_ref).collect();
            let before = (0..grown.len()).filter(|&i| scene.steps[i].shares_voxels(steps[0]));
            let before: Vec<(&Step, &Skeleton)> = before.filter_map(|i| Some((&scene.steps[i], earlier[i]?))).collect();
            Step::grow_together(&steps, space, &before, scene.seed, &earlier, progress)
        };
        // Side by side where memory allows; the result is the same.
        let needed: Vec<u64> = groups.iter().flatten().map(|&i| scene.steps[i].bytes_needed_from(&earlier)).collect();
        if let Some(&needed) = needed.iter().find(|&&needed| needed > max_memory) {
            return Err(Stage::Memory { needed, limit: max_memory });
        }
        let together: u64 = needed.iter().sum();
        let finished: Result<Vec<Vec<Grown>>, GrowError> = if together <= max_memory {
            groups.par_iter().map(grow).collect()
        } else {
            groups.iter().map(grow).collect()
        };
        let finished = finished.map_err(told)?;
        for (rounds, canopies) in growing.values_mut().zip(&canopies) {
            rounds.advance(canopies, show, max_memory, progress).map_err(told)?;
        }
        groups.into_iter().flatten().zip(finished.into_iter().flatten()).for_each(|(i, step)| grown[i] = Some(step));
        let done: Vec<usize> = growing.iter().filter(|(_, rounds)| rounds.is_done()).map(|(&i, _)| i).collect();
        for i in done {
            if let Some(rounds) = growing.remove(&i) {
                let earlier: Vec<Option<&Skeleton>> = grown.iter().map(|g| g.as_ref().map(|g| &g.skeleton)).collect();
                grown[i] = Some(rounds.finish(&earlier).map_err(told)?);
            }
        }
    }
    let mut grown: Vec<Grown> = grown.into_iter().flatten().collect();
    shape_plants(&scene.steps, &mut grown);
    Ok(grown)
}

/// Gives plants, which several steps grew together, their widths and their form.
fn shape_plants(steps: &[Step], grown: &mut [Grown]) {
    // The step where each step's plant starts.
    let base = |mut i: usize| loop {
        match steps[i].width.starts_plant() {
            Some(false) => i = *steps[i].sources().first()?,
            Some(true) => return Some(i),
            None => return None,
        }
    };
    let mut plants: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    // In the order of growth: what a step grows from comes before it.
    let mut depth = vec![0; steps.len()];
    for _ in 0..steps.len() {
        for i in 0..steps.len() {
            depth[i] = steps[i].sources().iter().map(|&from| depth[from] + 1).max().unwrap_or(0);
        }
    }
    let mut order: Vec<usize> = (0..steps.len()).collect();
    order.sort_by_key(|&i| (depth[i], i));
    for i in order {
        if let Some(base) = base(i) {
            plants.entry(base).or_default().push(i);
        }
    }
    let feet: Vec<(usize, Option<DVec3>)> = plants
        .iter()
        .flat_map(|(&base, members)| {
            let foot = grown[base].skeleton.nodes.first().map(|node| node.position);
            members.iter().map(move |&i| (i, foot))
        })
        .collect();
    let shaped: Vec<(Vec<usize>, Vec<Skeleton>)> = plants
        .into_par_iter()
        .map(|(base, members)| {
            let parts: Vec<PlantPart<'_>> = members
                .iter()
                .map(|&i| PlantPart {
                    skeleton: &grown[i].skeleton,
                    width: &steps[i].width,
                    first_level: grown[i].first_level,
                })
                .collect();
            let mut plant = Plant::new(&parts);
            plant.thicken(&steps[base].width);
            if let Some(form) = &steps[base].form {
                plant.shape(form, &steps[base].width);
            }
            (members, plant.split())
        })
        .collect();
    for (members, skeletons) in shaped {
        for (i, mut skeleton) in members.into_iter().zip(skeletons) {
            skeleton.classes.clone_from(&steps[i].classes);
            skeleton.number_branches();
            grown[i].skeleton = skeleton;
        }
    }
    feet.into_iter().for_each(|(i, foot)| grown[i].foot = foot);
}

/// The model of a scene from what its steps yielded, for a picture of `size` pixels.
///
/// # Errors
/// [`Stage::Scene`] where an object cannot be shown or the camera is wrong.
pub fn model(scene: &Resolved, grown: &[Grown], size: [u32; 2]) -> Result<Model, Stage> {
    let mut objects = Vec::new();
    let mut strokes = Vec::new();
    let mut lights = scene.lights.clone();
    let mut materials = scene.materials.clone();
    for plan in &scene.objects {
        let whole: Vec<_> = plan.steps.iter().map(|&step| &grown[step].skeleton).collect();
        let young: Vec<Skeleton>;
        let skeletons = if plan.until < 1.0 {
            let oldest = whole.iter().flat_map(|s| &s.nodes).map(|n| n.age).fold(0.0, f64::max);
            young = whole.iter().map(|s| s.until(oldest * plan.until)).collect();
            young.iter().collect()
        } else {
            whole
        };
        if let Some(glow) = plan.glow {
            strokes.push(Stroke::new(&plan.name, &skeletons, plan.at.truncate(), glow));
        }
        if let Some(spec) = &plan.lights {
            lights.extend(lights_along(&skeletons, plan.at, spec));
        }
        // What has not begun to grow, or shines alone, needs no skin.
        let is_solid = plan.skin == Skin::Surface;
        if plan.mesh.is_none() && !is_solid && skeletons.iter().all(|s| s.nodes.is_empty()) && plan.until < 1.0 {
            continue;
        }
        objects.extend(dress(scene, plan, grown, &skeletons, &mut materials)?);
    }
    // Marks move with the object that shows their step; steps that no object shows stay where they are.
    let mut marks = Vec::new();
    for (i, step) in grown.iter().enumerate() {
        let offset = scene.objects.iter().find(|o| o.steps.contains(&i)).map_or(DVec3::ZERO, |o| o.at);
        marks.extend(step.marks.iter().map(|mark| Mark {
            kind: mark.kind,
            line: mark.line.iter().map(|&p| to_world(p + offset, scene.is_flat)).collect(),
        }));
    }
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    if let Some(view) = &scene.view {
        // Its rectangle, seen from the front, fills the picture.
        let middle = to_world(view.frame.bounds().centre(), true);
        let [width, height] = view.frame.extent;
        let camera = Camera {
            at: middle - DVec3::Y * (width + height),
            look_at: middle,
            projection: Projection::Parallel { width },
            aspect,
        };
        return Ok(assemble(scene, objects, materials, strokes, lights, marks, camera));
    }
    let balls = objects.iter().flat_map(Object::balls_in_world);
    let drawn = marks.iter().flat_map(|m| m.line.iter().map(|&p| (p, 0.0)));
    let camera =
        Camera::new(&scene.camera, aspect, balls.chain(drawn)).map_err(|message| scene.error("camera", message))?;
    Ok(assemble(scene, objects, materials, strokes, lights, marks, camera))
}

fn assemble(
    scene: &Resolved,
    objects: Vec<Object>,
    materials: Vec<(String, Material)>,
    strokes: Vec<Stroke>,
    lights: Vec<Light>,
    marks: Vec<Mark>,
    camera: Camera,
) -> Model {
    let mut model = Model {
        title: scene.title.clone(),
        is_flat: scene.is_flat,
        objects,
        materials,
        camera,
        lights,
        ground: None,
        sky: scene.sky.clone(),
        marks,
        strokes,
    };
    let extent = model.bounds().size().max_element().max((camera.at - camera.look_at).length());
    model.ground = scene.ground.map(|ground| Ground {
        material: Material::matt(ground.colour),
        height: ground.height,
        reach: extent * GROUND_REACH,
        radius: ground.radius,
    });
    model
}

/// Lights along the core of what grew: evenly spaced along its paths.
fn lights_along(skeletons: &[&Skeleton], at: DVec3, spec: &LightsSpec) -> Vec<Light> {
    let core = shining(skeletons).filter(|(.., is_core)| *is_core);
    let pieces: Vec<(DVec3, DVec3)> = core.map(|(from, to, _)| (from.position, to.position)).collect();
    let length: f64 = pieces.iter().map(|(a, b)| (*b - *a).length()).sum();
    let Colour(colour) = spec.colour;
    let one = Colour(colour.map(|c| c / f64::from(spec.count)));
    let mut lights = Vec::new();
    let mut gone = 0.0;
    for (a, b) in pieces {
        let step = (b - a).length();
        let next = |made: usize| length * (made as f64 + 0.5) / f64::from(spec.count);
        while lights.len() < spec.count as usize && gone + step > next(lights.len()) {
            let p = a + (b - a) * ((next(lights.len()) - gone) / step);
            lights.push(Light::Point { at: p + at, colour: one, shadow: false, fade: Some(spec.fade) });
        }
        gone += step;
    }
    lights
}
