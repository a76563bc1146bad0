//! From a document to a recipe: every name and file is looked up.

use std::collections::BTreeMap;

use super::claim::{Claim, Claimed, Quantity};
use super::document::Scene;
use super::loaded::Loaded;
use super::mistake::Mistake;
use super::resolver::Resolver;
use super::source::Source;
use super::tree::Entry;
use crate::assemble::{ObjectRecipe, Recipe};
use crate::geom::ShapeSpec;
use crate::grow::{
    Key, MOST_NODES, Space, SpaceSpec, Step, StepSpec, check_plants, expected_of, resolve_space, resolve_step,
    waits_for_itself,
};
use crate::math::Colour;
use crate::model::{CameraSpec, Light, Look, Material, Sky, SkySpec};

/// Resolves `scene`; adds what is wrong with it.
pub(super) fn resolve(mut scene: Scene, source: &Source, tree: &Entry, mistakes: &mut Vec<Mistake>) -> Option<Loaded> {
    let spec = scene.view.clone();
    let (view, size) = {
        let expected = BTreeMap::new();
        let mut r = Resolver { scene: &scene, folder: &source.folder, pixel: None, expected, tree, mistakes };
        r.view(spec.as_ref(), scene.size)?
    };
    if let Some(view) = &view {
        for (name, bounds) in [("view", view.frame.bounds()), ("sky", view.frame.sky())] {
            scene.shape.entry(name.to_owned()).or_insert(ShapeSpec::of_box(bounds));
        }
    }
    let pixel = view.as_ref().map(|view| view.frame.pixel);
    let expected = expected_of(&scene.grow);
    let mut r = Resolver { scene: &scene, folder: &source.folder, pixel, expected, tree, mistakes };
    let steps = r.steps();
    let seen = r.seen(view.is_some())?;
    let claims = r.claims();
    for (is_empty, key) in [(scene.grow.is_empty(), "grow"), (scene.object.is_empty(), "object")] {
        if is_empty {
            r.wrong(key, format!("a scene needs at least one `[{key}.NAME]`"));
        }
    }
    let Seen { is_flat, materials, objects, camera, lights, sky } = seen;
    let recipe = Recipe {
        title: scene.title,
        seed: scene.seed,
        size,
        is_flat,
        view,
        steps: steps?,
        objects: objects?,
        materials,
        camera,
        lights,
        ground: scene.ground,
        background: scene.background,
        air: scene.air,
        look: scene.look.unwrap_or_else(|| look_of(scene.sky.as_ref())),
        sky: sky?,
    };
    Some(Loaded::new(recipe, scene.show, claims?, source, tree))
}

/// The look of a scene that names none: a day has its light, what else is behind a scene is a studio's.
fn look_of(sky: Option<&SkySpec>) -> Look {
    if sky.is_some_and(|sky| sky.daylight.is_some()) { Look::Natural } else { Look::Studio }
}

/// How the scene is seen.
struct Seen {
    is_flat: bool,
    materials: Vec<(String, Material)>,
    objects: Option<Vec<ObjectRecipe>>,
    camera: CameraSpec,
    lights: Vec<Light>,
    sky: Option<Sky>,
}

impl Resolver<'_> {
    /// Shapes, spaces and steps.
    fn steps(&mut self) -> Option<Vec<Step>> {
        let scene = self.scene;
        for (name, spec) in &scene.shape {
            self.shape(&format!("shape.{name}"), spec);
        }
        self.same_kind();
        let mut spaces: BTreeMap<&String, Option<Space>> = BTreeMap::new();
        for (name, spec) in &scene.space {
            let space = resolve_space(name, spec, &mut self.below(&format!("space.{name}")));
            spaces.insert(name, space);
        }
        let mut steps: Vec<Option<Step>> = Vec::new();
        for (name, spec) in &scene.grow {
            steps.push(self.step(name, spec, &spaces));
        }
        // Of what has no other mistake.
        if self.mistakes.is_empty() {
            self.check_expected();
        }
        check_plants(&steps, &mut |step, key, message| {
            let key = if key == Key::Width { "width" } else { "from" };
            self.wrong(&format!("grow.{}.{key}", step.name), message.to_owned());
        });
        let steps: Vec<Step> = steps.into_iter().collect::<Option<_>>()?;
        if let Some(stuck) = waits_for_itself(&steps) {
            let message = "this step waits for itself: it grows from, or near, a step that waits for it".to_owned();
            self.wrong(&format!("grow.{}", steps[stuck].name), message);
        }
        Some(steps)
    }

    fn step(&mut self, name: &str, spec: &StepSpec, spaces: &BTreeMap<&String, Option<Space>>) -> Option<Step> {
        let place = format!("grow.{name}");
        let space = spec.space.as_ref().and_then(|space| {
            self.find(&format!("{place}.space"), "space", space, self.scene.space.keys());
            spaces.get(&space.name)?.as_ref()
        });
        resolve_step(name, spec, space, &mut self.below(&place))
    }

    fn seen(&mut self, has_view: bool) -> Option<Seen> {
        let scene = self.scene;
        let is_flat = self.is_flat();
        if has_view && !is_flat {
            self.wrong("view", "a view is for flat scenes: those in space have a camera".to_owned());
        }
        let materials = self.materials(is_flat);
        let mut objects = Vec::new();
        for (name, spec) in &scene.object {
            objects.push(self.object(name, spec, &materials, is_flat));
        }
        let paper = Colour([if has_view { 0.0 } else { 1.0 }; 3]);
        let default = if is_flat { Sky::plain(paper) } else { Recipe::pale_sky() };
        let daylight = self.daylight();
        Some(Seen {
            is_flat,
            objects: objects.into_iter().collect(),
            materials,
            camera: scene.camera.unwrap_or_else(if is_flat { CameraSpec::front } else { CameraSpec::default }),
            lights: self.lights(is_flat, daylight.as_ref()),
            sky: scene.sky.as_ref().map_or(Some(default), |spec| self.sky(spec, daylight.as_ref())),
        })
    }

    /// All spaces are flat, or none is.
    fn same_kind(&mut self) {
        let scene = self.scene;
        let flat = |spec: &SpaceSpec| spec.nodes.is_plane();
        let is_flat = self.is_flat();
        if let Some((name, _)) = scene.space.iter().find(|(_, spec)| flat(spec) != is_flat) {
            let message = "a scene's spaces are all flat (lattices with 4 or 8 neighbours, scattered nodes with `plane = true`) or all in space".to_owned();
            self.wrong(&format!("space.{name}.nodes"), message);
        }
    }

    /// Are all steps together, with their symmetries, within what there may be?
    fn check_expected(&mut self) {
        let all: f64 = self.expected.values().map(|expected| expected.nodes).sum();
        if all > MOST_NODES as f64 {
            let message = format!(
                "{all:.2e} nodes are to be expected of all steps by segments, more than {MOST_NODES}: lower `depth`, `most` or `chance`"
            );
            self.wrong("grow", message);
        }
    }

    /// The claims, with their shapes.
    fn claims(&mut self) -> Option<BTreeMap<String, Claimed>> {
        let mut claims = BTreeMap::new();
        for (name, claim) in &self.scene.claim {
            let place = format!("claim.{name}");
            self.check_claim(&place, claim);
            let shape = match &claim.shape {
                Some(shape) => Some(self.shape(&format!("{place}.shape"), shape)?),
                None => None,
            };
            claims.insert(name.clone(), Claimed { claim: claim.clone(), shape });
        }
        Some(claims)
    }

    fn check_claim(&mut self, place: &str, claim: &Claim) {
        for (key, step) in [
            ("of", Some(&claim.of)),
            ("more_than", claim.more_than.as_ref()),
            ("as_of", claim.as_of.as_ref()),
            ("with", claim.with.as_ref()),
        ] {
            if let Some(step) = step {
                self.find(&format!("{place}.{key}"), "step", step, self.scene.grow.keys());
            }
        }
        let others = [claim.more_than.as_ref(), claim.as_of.as_ref()];
        if claim.at_least.is_none() && claim.at_most.is_none() && others.iter().all(Option::is_none) {
            self.wrong(place, "a claim needs `at_least`, `at_most`, `more_than` or `as_of`".to_owned());
        }
        let is_short = match claim.measure {
            Quantity::Farthest | Quantity::Inside => claim.shape.is_none(),
            Quantity::Nearest => claim.shape.is_none() && claim.with.is_none(),
            _ => false,
        };
        if is_short {
            self.wrong(place, "this is measured from a `shape`".to_owned());
        }
    }
}
