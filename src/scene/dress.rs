//! Objects get their skin, and what grows on it.

use super::build::Stage;
use super::{ObjectPlan, Resolved};
use crate::geom::{Bounds, Surface};
use crate::grow::{GrowError, Grown, Regions, isosurface};
use crate::math::{DVec3, Progress, Stream};
use crate::model::{Instance, Material, Mesh, Object, Skin, SkinError, foot, to_world};
use crate::skeleton::Skeleton;

/// The objects that `plan` becomes; `skeletons` are those of its steps, as much as has grown of them. `materials` gets those
/// that it makes.
pub(super) fn dress(
    scene: &Resolved,
    plan: &ObjectPlan,
    grown: &[Grown],
    skeletons: &[&Skeleton],
    materials: &mut Vec<(String, Material)>,
) -> Result<Vec<Object>, Stage> {
    let place = format!("object.{}", plan.name);
    let wrong = |error: SkinError| Stage::Scene(scene.error(&place, error.to_string()));
    let whole = match (&plan.mesh, plan.skin) {
        (Some(mesh), _) => Object::of_mesh(&plan.name, mesh, plan.at, plan.material),
        (None, Skin::Surface) => return solids(scene, plan, grown),
        (None, Skin::Isosurface(spec)) => {
            let solids = |i: usize| grown[i].regions.as_ref().map(Regions::solid);
            let step = plan.steps.first().map(|&step| scene.steps[step].with_solids(&solids));
            let space = step.as_ref().and_then(|step| step.space.as_ref()?.lattice());
            let progress = Progress::default();
            let surface = isosurface(&spec, skeletons, space, scene.is_flat, scene.seed, &progress);
            let surface = surface.map_err(|error| match error {
                GrowError::Scene { place: key, message } => {
                    Stage::Scene(scene.error(&format!("{place}.skin.isosurface.{key}"), message))
                }
                GrowError::Cancelled(cancelled) => Stage::Cancelled(cancelled),
            })?;
            let root = foot(skeletons).ok_or(SkinError::Empty).map_err(wrong)?;
            let mesh = Mesh::of_surface(&surface, root, scene.is_flat);
            Object::of_mesh(&plan.name, &mesh, to_world(root + plan.at, scene.is_flat), plan.material)
        }
        (None, skin) => skin.dress(&plan.name, skeletons, scene.is_flat, plan.at, plan.material),
    };
    let whole = whole.map_err(wrong)?;
    let (first, digits) = (whole.instances[0].at, whole.digits);
    let mut parts = Vec::new();
    if let Some((picture, steps)) = &plan.paint {
        let base = materials[plan.material].clone();
        for (part, colour) in whole.painted(picture, *steps, scene.is_flat) {
            let name = format!("{} {}", base.0, colour.hex());
            let known = materials.iter().position(|(known, _)| *known == name);
            let index = known.unwrap_or_else(|| {
                materials.push((name, Material { colour, ..base.1 }));
                materials.len() - 1
            });
            parts.push(Object { material: index, ..part });
        }
    } else {
        for (level, mut part) in whole.by_level().into_iter().enumerate() {
            let material = plan.level_materials.get(level).or(plan.level_materials.last());
            part.material = material.copied().unwrap_or(plan.material);
            parts.push(part);
        }
    }
    if let Some(thorns) = &plan.thorns {
        for i in 0..parts.len() {
            let stream = Stream::new(scene.seed, &format!("thorns/{}/{i}", plan.name));
            let on = thorns.on(&parts[i], &stream).map_err(wrong)?;
            if !on.balls.is_empty() {
                parts[i].thorns = Some(*thorns);
                parts.push(on);
            }
        }
    }
    for (name, spec, mesh, material) in &plan.leaves {
        let stream = Stream::new(scene.seed, &format!("leaves/{}/{name}", plan.name));
        let grown_foot = foot(skeletons).unwrap_or(DVec3::ZERO);
        let poses = spec.place(skeletons, grown_foot, digits, &stream).map_err(wrong)?;
        let name = format!("{}_{name}", plan.name);
        if poses.is_empty() {
            continue;
        }
        parts.push(if plan.skin == Skin::Mesh {
            Object::of_mesh(&name, &mesh.at_poses(&poses).map_err(wrong)?, first, *material).map_err(wrong)?
        } else {
            Object::of_poses(&name, mesh, poses, first, digits, *material).map_err(wrong)?
        });
    }
    Ok(placed(scene, plan, parts))
}

/// The objects that regions are: one each, with the materials of the levels in turn; all with the same foot, the middle of the
/// lowest they reach.
fn solids(scene: &Resolved, plan: &ObjectPlan, grown: &[Grown]) -> Result<Vec<Object>, Stage> {
    let surfaces: Vec<&Surface> = plan
        .steps
        .iter()
        .filter_map(|&step| grown[step].regions.as_ref())
        .flat_map(|regions: &Regions| &regions.surfaces)
        .collect();
    let bounds =
        surfaces.iter().flat_map(|s| &s.points).fold(Bounds::EMPTY, |b, &p| b.union(Bounds { min: p, max: p }));
    let mut foot = bounds.centre();
    foot[if scene.is_flat { 1 } else { 2 }] = bounds.min[if scene.is_flat { 1 } else { 2 }];
    let mut parts = Vec::new();
    for (i, surface) in surfaces.iter().enumerate() {
        let name = if surfaces.len() == 1 { plan.name.clone() } else { format!("{}_{}", plan.name, i + 1) };
        let kinds = plan.level_materials.len();
        let material = if kinds == 0 { plan.material } else { plan.level_materials[i % kinds] };
        let mesh = Mesh::of_surface(surface, foot, scene.is_flat);
        let part = Object::of_mesh(&name, &mesh, to_world(foot + plan.at, scene.is_flat), material);
        parts.push(part.map_err(|error| scene.error(&format!("object.{}", plan.name), error.to_string()))?);
    }
    if parts.is_empty() {
        return Err(scene.error(&format!("object.{}", plan.name), SkinError::Empty.to_string()).into());
    }
    Ok(placed(scene, plan, parts))
}

/// The parts, each wherever the object stands.
fn placed(scene: &Resolved, plan: &ObjectPlan, mut parts: Vec<Object>) -> Vec<Object> {
    for part in &mut parts {
        let (first, digits) = (part.instances[0].at, part.digits);
        part.shadow = plan.shadow;
        part.instances.extend(plan.copies.iter().map(|copy| Instance {
            at: digits.round_point(first + to_world(copy.at - plan.at, scene.is_flat)),
            ..*copy
        }));
    }
    parts
}
