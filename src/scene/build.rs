//! The way through the house: steps are grown, skeletons dressed, the model put together.

use rayon::prelude::*;

use super::{Resolved, SceneError};
use crate::grow::{GrowError, Grown, Mark, MarkKind};
use crate::math::{Cancelled, DVec3, Progress};
use crate::model::{Camera, Ground, Instance, Material, Model, Object, to_world};

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
        "the scene needs about {} MB of memory, more than the {} MB allowed: use a wider spacing, or raise --max-memory",
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
    let grow = |step: &crate::grow::Step| step.grow(scene.seed, show, progress);
    // Side by side where memory allows; the result is the same.
    let together: u64 = scene.steps.iter().map(crate::grow::Step::bytes_needed).sum();
    let grown: Result<Vec<Grown>, GrowError> = if together <= max_memory {
        scene.steps.par_iter().map(grow).collect()
    } else {
        scene.steps.iter().map(grow).collect()
    };
    grown.map_err(|error| match error {
        GrowError::Scene { place, message } => Stage::Scene(scene.error(&place, message)),
        GrowError::Cancelled(cancelled) => Stage::Cancelled(cancelled),
    })
}

/// The model of a scene from what its steps yielded, for a picture of `size` pixels.
///
/// # Errors
/// [`Stage::Scene`] where an object cannot be shown or the camera is wrong.
pub fn model(scene: &Resolved, grown: &[Grown], size: [u32; 2]) -> Result<Model, Stage> {
    let mut objects = Vec::new();
    for plan in &scene.objects {
        let skeletons: Vec<_> = plan.steps.iter().map(|&step| &grown[step].skeleton).collect();
        let object = match &plan.mesh {
            Some(mesh) => Object::of_mesh(&plan.name, mesh, plan.at, plan.material),
            None => plan.skin.dress(&plan.name, &skeletons, scene.is_flat, plan.at, plan.material),
        };
        let mut object = object.map_err(|error| scene.error(&format!("object.{}", plan.name), error.to_string()))?;
        let (first, digits) = (object.instances[0].at, object.digits);
        object.instances.extend(plan.copies.iter().map(|copy| Instance {
            at: digits.round_point(first + to_world(copy.at - plan.at, scene.is_flat)),
            ..*copy
        }));
        objects.push(object);
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
    let balls = objects.iter().flat_map(Object::balls_in_world);
    let drawn = marks.iter().flat_map(|m| m.line.iter().map(|&p| (p, 0.0)));
    let camera =
        Camera::new(&scene.camera, aspect, balls.chain(drawn)).map_err(|message| scene.error("camera", message))?;
    let mut model = Model {
        title: scene.title.clone(),
        is_flat: scene.is_flat,
        objects,
        materials: scene.materials.clone(),
        camera,
        lights: scene.lights.clone(),
        ground: None,
        sky: scene.sky.clone(),
        marks,
    };
    let extent = model.bounds().size().max_element().max((camera.at - camera.look_at).length());
    model.ground = scene.ground.map(|ground| Ground {
        material: Material::matt(ground.colour),
        height: ground.height,
        reach: extent * GROUND_REACH,
        radius: ground.radius,
    });
    Ok(model)
}
