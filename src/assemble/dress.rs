//! Objects get their skin, and what grows on it.

use super::{AssembleError, LeavesRecipe, ObjectRecipe, Recipe};
use crate::geom::{Bounds, Surface};
use crate::grow::{Grown, Regions, Space};
use crate::math::{Colour, DVec3, Memory, Progress, Stream};
use crate::model::{Body, BodyError, Instance, Material, Object, Pose, to_world};
use crate::skeleton::Skeleton;
use crate::skin::{IsosurfaceSpec, Skin, by_level, cones, foot, isosurface, painted, spheres, surface_mesh, tubes};

/// The objects that `recipe` becomes; `skeletons` are those of its steps, as much as has grown of them. `materials` gets
/// those that it makes.
pub(super) fn dress(
    scene: &Recipe,
    recipe: &ObjectRecipe,
    grown: &[Grown],
    skeletons: &[&Skeleton],
    materials: &mut Vec<(String, Material)>,
    memory: &Memory,
    progress: &Progress,
) -> Result<Vec<Object>, AssembleError> {
    let wrong = |error: BodyError| AssembleError::body(&recipe.name, error);
    let (name, is_flat, at, material) = (&recipe.name, scene.is_flat, recipe.at, recipe.material);
    let whole = match (&recipe.mesh, recipe.skin) {
        (Some(mesh), _) => Object::of_mesh(name, mesh, at, material),
        (None, Skin::Surface) => return solids(scene, recipe, grown),
        (None, Skin::Isosurface(spec)) => enclosed(scene, recipe, &spec, grown, skeletons, memory, progress)?,
        (None, Skin::Cones) => cones(name, skeletons, is_flat, at, material),
        (None, Skin::Spheres) => spheres(name, skeletons, is_flat, at, material),
        (None, Skin::Mesh) => foot(skeletons)
            .ok_or(BodyError::Empty)
            .and_then(|root| Object::of_mesh(name, &tubes(skeletons, root), to_world(root + at, is_flat), material)),
    };
    let mut whole = whole.map_err(wrong)?;
    if let (Body::Limbs(limbs), Some(_)) = (&mut whole.body, materials[material].1.tips) {
        limbs.measure_ends();
    }
    let (first, digits) = (whole.instances[0].at, whole.digits);
    let mut parts = coloured(scene, recipe, whole, materials);
    add_thorns(scene, recipe, &mut parts).map_err(wrong)?;
    for leaves in &recipe.leaves {
        let stream = Stream::new(scene.seed, &format!("leaves/{}/{}", recipe.name, leaves.name));
        let root = foot(skeletons).unwrap_or(DVec3::ZERO);
        let poses = leaves.spec.place(skeletons, root, digits, &stream).map_err(wrong)?;
        for (name, poses, material) in in_groups(recipe, leaves, &poses, materials) {
            let part = if recipe.skin.is_mesh() {
                leaves.mesh.at_poses(&poses).and_then(|mesh| Object::of_mesh(&name, &mesh, first, material))
            } else {
                Object::of_poses(&name, &leaves.mesh, poses, first, digits, material)
            };
            parts.push(part.map_err(wrong)?);
        }
    }
    Ok(placed(scene, recipe, parts))
}

/// Leaves by their tints, where there are any: the name, poses and material of each group.
fn in_groups(
    recipe: &ObjectRecipe,
    leaves: &LeavesRecipe,
    poses: &[(Pose, u8)],
    materials: &mut Vec<(String, Material)>,
) -> Vec<(String, Vec<Pose>, usize)> {
    let name = format!("{}_{}", recipe.name, leaves.name);
    let kinds = match &leaves.spec.tints {
        None => vec![(name, leaves.material)],
        Some(tints) => {
            let tinted = tints.groups().into_iter().map(|colour| tinted(materials, leaves.material, colour));
            (1..).zip(tinted).map(|(i, material)| (format!("{name}_{i}"), material)).collect()
        }
    };
    let groups = (0..).zip(kinds).map(|(group, (name, material))| {
        let own = poses.iter().filter(|(_, of)| *of == group).map(|(pose, _)| *pose);
        (name, own.collect(), material)
    });
    groups.filter(|(_, poses, _): &(_, Vec<Pose>, _)| !poses.is_empty()).collect()
}

/// The material `base` in another colour, by index.
fn tinted(materials: &mut Vec<(String, Material)>, base: usize, colour: Colour) -> usize {
    let name = format!("{} {}", materials[base].0, colour.hex());
    let known = materials.iter().position(|(known, _)| *known == name);
    known.unwrap_or_else(|| {
        materials.push((name, Material { colour, ..materials[base].1 }));
        materials.len() - 1
    })
}

/// One surface around all limbs.
fn enclosed(
    scene: &Recipe,
    recipe: &ObjectRecipe,
    spec: &IsosurfaceSpec,
    grown: &[Grown],
    skeletons: &[&Skeleton],
    memory: &Memory,
    progress: &Progress,
) -> Result<Result<Object, BodyError>, AssembleError> {
    let solids = |i: usize| grown[i].regions.as_ref().map(Regions::solid);
    let step = recipe.steps.first().map(|&step| scene.steps[step].with_solids(&solids));
    let space = step.as_ref().and_then(|step| step.space.as_ref()).and_then(Space::lattice);
    let surface = isosurface(spec, skeletons, space, scene.is_flat, scene.seed, memory, progress);
    let surface = surface.map_err(|error| AssembleError::isosurface(&recipe.name, error))?;
    Ok(foot(skeletons).ok_or(BodyError::Empty).and_then(|root| {
        let mesh = surface_mesh(&surface, root, scene.is_flat);
        Object::of_mesh(&recipe.name, &mesh, to_world(root + recipe.at, scene.is_flat), recipe.material)
    }))
}

/// `whole` as parts of one material each: by the picture that paints it, or by level.
fn coloured(
    scene: &Recipe,
    recipe: &ObjectRecipe,
    whole: Object,
    materials: &mut Vec<(String, Material)>,
) -> Vec<Object> {
    let Some((picture, steps)) = &recipe.paint else {
        let levels = by_level(whole).into_iter().enumerate();
        let of_level = |level: usize| recipe.level_materials.get(level).or(recipe.level_materials.last());
        return levels
            .map(|(level, part)| Object { material: of_level(level).copied().unwrap_or(recipe.material), ..part })
            .collect();
    };
    let parts = painted(&whole, picture, *steps, scene.is_flat).into_iter();
    parts.map(|(part, colour)| Object { material: tinted(materials, recipe.material, colour), ..part }).collect()
}

/// Adds the thorns of each part as a part of its own.
fn add_thorns(scene: &Recipe, recipe: &ObjectRecipe, parts: &mut Vec<Object>) -> Result<(), BodyError> {
    let Some(thorns) = &recipe.thorns else { return Ok(()) };
    for i in 0..parts.len() {
        let stream = Stream::new(scene.seed, &format!("thorns/{}/{i}", recipe.name));
        let Some(on) = thorns.on(&parts[i], &stream)? else { continue };
        if let Body::Limbs(limbs) = &mut parts[i].body {
            limbs.thorns = Some(thorns.displacement());
        }
        parts.push(on);
    }
    Ok(())
}

/// The objects that regions are: one each, with the materials of the levels in turn; all with the same foot, the middle of the
/// lowest they reach.
fn solids(scene: &Recipe, recipe: &ObjectRecipe, grown: &[Grown]) -> Result<Vec<Object>, AssembleError> {
    let surfaces: Vec<&Surface> = recipe
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
        let name = if surfaces.len() == 1 { recipe.name.clone() } else { format!("{}_{}", recipe.name, i + 1) };
        let kinds = recipe.level_materials.len();
        let material = if kinds == 0 { recipe.material } else { recipe.level_materials[i % kinds] };
        let mesh = surface_mesh(surface, foot, scene.is_flat);
        let part = Object::of_mesh(&name, &mesh, to_world(foot + recipe.at, scene.is_flat), material);
        parts.push(part.map_err(|error| AssembleError::body(&recipe.name, error))?);
    }
    if parts.is_empty() {
        return Err(AssembleError::body(&recipe.name, BodyError::Empty));
    }
    Ok(placed(scene, recipe, parts))
}

/// The parts, each wherever the object stands.
fn placed(scene: &Recipe, recipe: &ObjectRecipe, mut parts: Vec<Object>) -> Vec<Object> {
    for part in &mut parts {
        let (first, digits) = (part.instances[0].at, part.digits);
        part.shadow = recipe.shadow;
        part.instances.extend(recipe.copies.iter().map(|copy| Instance {
            at: digits.round_point(first + to_world(copy.at - recipe.at, scene.is_flat)),
            ..*copy
        }));
    }
    parts
}
