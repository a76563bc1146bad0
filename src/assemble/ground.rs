//! The ground, and what stands all over it.

use super::background::add_background;
use super::grass::grow_grass;
use super::relief::Heights;
use super::{AssembleError, Recipe};
use crate::math::{DVec3, Memory};
use crate::model::{Ground, GroundSpec, Material, Model, Object};
use crate::skin::{terrain, terrain_bytes};

/// The ground has faded into the horizon at this many times the camera's distance or the scene's size.
const REACH: f64 = 2.5;
/// A relief reaches no farther, in scene units: renderers show nothing beyond ten times this.
const FARTHEST: f64 = 1e6;

/// Lays the ground of `recipe` in `model`, whose camera is set, and what stands on it.
pub(super) fn lay(recipe: &Recipe, model: &mut Model, memory: &Memory) -> Result<(), AssembleError> {
    let heights = recipe.ground.as_ref().map(|spec| Heights::new(spec, &model.objects));
    let ground = recipe.ground.as_ref().zip(heights.as_ref());
    if let Some((spec, heights)) = ground {
        if recipe.camera.eye.is_some() && recipe.camera.at.is_none() {
            let at = model.camera.at;
            model.camera.at.z += heights.at(at.x, at.y) - spec.height;
        }
        lay_ground(spec, heights, model, memory)?;
        grow_grass(recipe.seed, spec, heights, model, memory)?;
    }
    if let Some(spec) = &recipe.background {
        add_background(recipe, spec, ground, model, memory)?;
    }
    Ok(())
}

/// Lays the level ground, and its relief upon that.
fn lay_ground(spec: &GroundSpec, heights: &Heights, model: &mut Model, memory: &Memory) -> Result<(), AssembleError> {
    let camera = model.camera;
    let extent = model.bounds().size().max_element().max((camera.at - camera.look_at).length());
    let material = Material { pattern: spec.pattern, ..Material::matt(spec.colour) };
    let reach = spec.reach.unwrap_or(extent * REACH);
    model.ground = Some(Ground { material, height: heights.below(), reach, radius: spec.radius });
    if heights.is_level() {
        return Ok(());
    }
    let radius = spec.radius.unwrap_or(reach).min(FARTHEST);
    memory.ask(terrain_bytes(radius, heights.least()))?;
    let mesh = terrain(radius, heights.least(), |x, y| heights.at(x, y));
    model.materials.push(("terrain".to_owned(), material));
    let object = Object::of_mesh("terrain", &mesh, DVec3::ZERO, model.materials.len() - 1)
        .map_err(|error| AssembleError::body("ground", error))?;
    // Level ground casts no shadow either, and low suns would show the triangles.
    model.objects.push(Object { shadow: false, is_scenery: true, ..object });
    Ok(())
}
