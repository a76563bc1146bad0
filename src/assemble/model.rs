//! The model of a recipe from what its steps yielded.

use super::dress::dress;
use super::ground::lay;
use super::lights::lights_along;
use super::memory::{bytes_of, bytes_to_dress};
use super::{AssembleError, Backdrop, ObjectRecipe, Recipe};
use crate::geom::Mark;
use crate::grow::Grown;
use crate::math::{DVec3, Memory, Progress};
use crate::model::{Camera, Model, Object, Projection, to_world};
use crate::skeleton::Skeleton;
use crate::skin::{Skin, stroke};

/// The model of `recipe` for a picture of `size` pixels within `memory`, `grown` being what its steps yielded.
///
/// # Errors
/// [`AssembleError`] where an object cannot be shown, the camera is wrong, or on cancelling.
pub fn model(
    recipe: &Recipe,
    grown: &[Grown],
    size: [u32; 2],
    memory: &Memory,
    progress: &Progress,
) -> Result<Model, AssembleError> {
    recipe.check()?;
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    // The camera is set when it is known what there is to see.
    let mut model = Model {
        title: recipe.title.clone(),
        is_flat: recipe.is_flat,
        objects: Vec::new(),
        materials: recipe.materials.clone(),
        camera: recipe.view.as_ref().map_or(Camera::FRONT, |view| front(view, aspect)),
        lights: recipe.lights.clone(),
        ground: None,
        sky: recipe.sky.clone(),
        air: recipe.air,
        look: recipe.look,
        marks: marks(recipe, grown),
        strokes: Vec::new(),
    };
    let memory = memory.beside(bytes_of(grown));
    for object in &recipe.objects {
        progress.check()?;
        let memory = memory.beside(model.bytes() as u64);
        add(recipe, object, grown, &mut model, &memory, progress)?;
    }
    if recipe.view.is_none() {
        let balls = model.objects.iter().flat_map(Object::balls_in_world);
        let drawn = model.marks.iter().flat_map(|m| m.line.iter().map(|&p| (p, 0.0)));
        model.camera = Camera::new(&recipe.camera, aspect, balls.chain(drawn)).map_err(AssembleError::Camera)?;
    }
    let memory = memory.beside(model.bytes() as u64);
    lay(recipe, &mut model, &memory)?;
    Ok(model)
}

/// Adds what `object` becomes.
fn add(
    recipe: &Recipe,
    object: &ObjectRecipe,
    grown: &[Grown],
    model: &mut Model,
    memory: &Memory,
    progress: &Progress,
) -> Result<(), AssembleError> {
    let whole: Vec<_> = object.steps.iter().map(|&step| &grown[step].skeleton).collect();
    let young: Vec<Skeleton>;
    let skeletons = if object.until < 1.0 {
        let oldest = whole.iter().flat_map(|s| &s.nodes).map(|n| n.age).fold(0.0, f64::max);
        young = whole.iter().map(|s| s.until(oldest * object.until)).collect();
        young.iter().collect()
    } else {
        whole
    };
    if let Some(glow) = object.glow {
        model.strokes.push(stroke(&object.name, &skeletons, object.at.truncate(), glow));
    }
    if let Some(spec) = &object.lights {
        model.lights.extend(lights_along(&skeletons, object.at, spec));
    }
    // What has not begun to grow, or shines alone, needs no skin.
    let is_solid = object.skin == Skin::Surface;
    let is_unborn = skeletons.iter().all(|s| s.nodes.is_empty()) && object.until < 1.0;
    if object.mesh.is_some() || is_solid || !is_unborn {
        memory.ask(bytes_to_dress(object, grown, &skeletons))?;
        let parts = dress(recipe, object, grown, &skeletons, &mut model.materials, memory, progress)?;
        model.objects.extend(parts);
    }
    Ok(())
}

/// The marks of all steps in world space. They are drawn with each object that shows their step, if it wants them; those of steps
/// that no object shows stay where they are.
fn marks(recipe: &Recipe, grown: &[Grown]) -> Vec<Mark> {
    let mut marks = Vec::new();
    for (i, step) in grown.iter().enumerate() {
        let showing: Vec<_> = recipe.objects.iter().filter(|object| object.steps.contains(&i)).collect();
        let nowhere = showing.is_empty().then_some(DVec3::ZERO);
        for offset in showing.iter().filter(|object| object.marks).map(|object| object.at).chain(nowhere) {
            marks.extend(step.marks.iter().map(|mark| Mark {
                line: mark.line.iter().map(|&p| to_world(p + offset, recipe.is_flat)).collect(),
                ..*mark
            }));
        }
    }
    marks
}

/// The camera that sees the rectangle of `view` from the front, filling the picture.
fn front(view: &Backdrop, aspect: f64) -> Camera {
    let middle = to_world(view.frame.bounds().centre(), true);
    let [width, height] = view.frame.extent;
    let at = middle - DVec3::Y * (width + height);
    Camera { at, look_at: middle, projection: Projection::Parallel { width }, aspect, ..Camera::FRONT }
}
