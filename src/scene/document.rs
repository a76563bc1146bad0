//! A scene file as serde reads it, after validation.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::animation::TrackSpec;
use super::claim::Claim;
use super::mistake::Mistake;
use super::tree::Entry;
use crate::assemble::LightsSpec;
use crate::geom::{MarkKind, ShapeSpec};
use crate::grow::{SpaceSpec, Step, StepSpec};
use crate::math::{DVec3, Degrees, Point, Ref};
use crate::model::{
    Air, BackgroundSpec, CameraSpec, GlowSpec, GroundSpec, LightSpec, Look, Material, SkySpec, ViewSpec,
};
use crate::skin::{LeavesSpec, PaintSpec, Skin, ThornsSpec};

/// A scene: named growth steps in named spaces, the objects that they become, and how these are seen.
///
/// Angles are in degrees, lengths in scene units. In space the world is right-handed with z up; a scene whose
/// lattices have 4 or 8 neighbours is flat, with y up.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Lichtenberg scene")]
pub struct Scene {
    /// Another file: the scene takes from it what it does not give itself. The path is relative to the file that names it;
    /// an included file may include another, and need not be a whole scene. Spaces, steps, objects, materials and claims of
    /// the same name are taken key by key, as by `like`, and so are `camera`, `ground` and `view`; a shape, a light and all
    /// else whole. Files that an included file names, such as meshes, are relative to the scene.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub include: Option<String>,
    /// Where it stands: `meadow`, `heath`, `desert`, `snow`, `night`, `sea-floor`, whose lengths are in metres, or `studio`. The scene
    /// takes sky, ground, camera, look and what else the stage has that it does not give itself, as by `include`; of a sky of the
    /// same kind, key by key.
    #[serde(default)]
    #[schemars(length(min = 1))]
    pub stage: Option<String>,
    /// How many scene units are a metre of its stage.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub metre: f64,
    /// What it is called.
    #[schemars(length(min = 1))]
    pub title: String,
    /// A few words about it.
    #[serde(default)]
    pub about: Option<String>,
    /// The rules that fix its structure across releases.
    #[serde(default = "first_edition")]
    #[schemars(range(min = 1, max = 1))]
    pub edition: u32,
    /// The seed of all its random numbers.
    #[serde(default = "first_seed")]
    #[schemars(range(min = 0, max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    /// Size of its picture in pixels: width, height; by default the photograph's, or 640 x 480.
    #[serde(default)]
    #[schemars(inner(range(min = 1, max = 32768)))]
    pub size: Option<[u32; 2]>,
    /// In a flat scene: the picture as a place to draw on, over a photograph or over black.
    #[serde(default)]
    pub view: Option<ViewSpec>,
    /// It is drawn as a schematic, with these marks of its construction: `render` traces it only where `--look` says how.
    #[serde(default)]
    pub show: Vec<MarkKind>,
    /// Shapes, by name.
    #[serde(default)]
    pub shape: BTreeMap<String, ShapeSpec>,
    /// Spaces to grow in, by name.
    #[serde(default)]
    pub space: BTreeMap<String, SpaceSpec>,
    /// Growth steps, by name.
    pub grow: BTreeMap<String, StepSpec>,
    /// What is seen, by name.
    pub object: BTreeMap<String, ObjectSpec>,
    /// Materials, by name. `bark` and, for flat scenes, `ink` (black; white with a `[view]`) are there already.
    #[serde(default)]
    pub material: BTreeMap<String, Material>,
    /// The view; by default from the front, fitted to the objects.
    #[serde(default)]
    pub camera: Option<CameraSpec>,
    /// Lights, by name; by default a sun and a weak light from the other side.
    #[serde(default)]
    pub light: BTreeMap<String, LightSpec>,
    /// The ground; by default none.
    #[serde(default)]
    pub ground: Option<GroundSpec>,
    /// Its plants once more, far behind; by default none.
    #[serde(default)]
    pub background: Option<BackgroundSpec>,
    /// What is behind everything; by default white for flat scenes, black with a `[view]`, a
    /// pale sky in space.
    #[serde(default)]
    pub sky: Option<SkySpec>,
    /// Haze; by default none.
    #[serde(default)]
    pub air: Option<Air>,
    /// How it is lit; by default `natural` under a sky of daylight, else `studio`.
    #[serde(default)]
    pub look: Option<Look>,
    /// What changes from frame to frame, by name.
    #[serde(default)]
    pub animation: BTreeMap<String, TrackSpec>,
    /// What the scene claims of its steps, as numbers that `check` and the tests read, by name.
    #[serde(default)]
    pub claim: BTreeMap<String, Claim>,
}

/// What is declared and seen as one thing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectSpec {
    /// Take everything that is not given here from the object of this name.
    #[serde(default)]
    pub like: Option<Ref<Self>>,
    /// The steps that it is made of.
    #[serde(default)]
    pub grow: Vec<Ref<Step>>,
    /// In place of steps: a mesh from a Wavefront OBJ file beside the scene, y up as usual there; smooth where it has
    /// normals.
    #[serde(default)]
    pub mesh: Option<String>,
    /// How skeletons become solid.
    #[serde(default)]
    pub skin: Skin,
    /// What it is made of.
    #[serde(default)]
    pub material: Option<Ref<Material>>,
    /// What its levels are made of, from the first on, where they differ; the last stays.
    #[serde(default)]
    pub level_materials: Vec<Ref<Material>>,
    /// Leaves, fruit and blossom along the ends of its limbs, by name.
    #[serde(default)]
    pub leaves: BTreeMap<String, LeavesSpec>,
    /// Thorns on the surface of its limbs (the skin `cones`).
    #[serde(default)]
    pub thorns: Option<ThornsSpec>,
    /// Colours from a picture, for each of its trees or strands (the skin `cones`).
    #[serde(default)]
    pub paint: Option<PaintSpec>,
    /// How far it is moved from where it grew.
    #[serde(default)]
    pub at: Option<Point>,
    /// In a scene with `[view]`: how it shines.
    #[serde(default)]
    pub glow: Option<GlowSpec>,
    /// How much of it has grown: 1 all of it, 0 nothing, by the cost of the way from where growth began.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub until: f64,
    /// Does it cast shadows? What shines from within, by lights along it, should not.
    #[serde(default = "yes")]
    pub shadow: bool,
    /// Where the construction is drawn: are the marks of its steps drawn with it?
    #[serde(default = "yes")]
    pub marks: bool,
    /// Lights along its core, in space.
    #[serde(default)]
    pub lights: Option<LightsSpec>,
    /// Where else it stands: instances, which take next to no memory.
    #[serde(default)]
    pub copies: Vec<CopySpec>,
    /// It is one patch of many alike, in rows and columns: instances too.
    #[serde(default)]
    pub tile: Option<TileSpec>,
}

/// Rows and columns of an object; the first is where it grew.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TileSpec {
    /// How many along x, and along y (in a flat scene upwards).
    #[schemars(inner(range(min = 1, max = 1000)))]
    pub count: [u32; 2],
    /// How far they are from each other along x and y, in scene units.
    pub step: [f64; 2],
}

impl TileSpec {
    /// How far each is moved, but for the first.
    pub(super) fn places(&self) -> impl Iterator<Item = DVec3> + '_ {
        let [columns, rows] = self.count;
        (0..rows)
            .flat_map(move |y| (0..columns).map(move |x| [x, y]))
            .skip(1)
            .map(|[x, y]| DVec3::new(f64::from(x) * self.step[0], f64::from(y) * self.step[1], 0.0))
    }
}

/// A further place where an object stands.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CopySpec {
    /// How far it is moved from where it grew.
    pub at: Point,
    /// Angle about the vertical through its foot, counterclockwise from above.
    #[serde(default)]
    pub turn: Degrees,
    /// Its size over the first one's.
    #[serde(default = "whole")]
    #[schemars(range(min = 1e-3, max = 1e3))]
    pub scale: f64,
}

fn whole() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

fn first_edition() -> u32 {
    1
}

fn one() -> f64 {
    1.0
}

fn first_seed() -> u64 {
    1
}

/// The document of a tree that was found valid.
pub(super) fn read(tree: &Entry, mistakes: &mut Vec<Mistake>) -> Option<Scene> {
    serde_path_to_error::deserialize(tree.to_json())
        .map_err(|error| {
            let place = error.path().to_string().replace(['[', ']'], "");
            let place = if place == "." { String::new() } else { place };
            mistakes.push(Mistake { span: tree.find_span(&place), message: error.into_inner().to_string(), place });
        })
        .ok()
}
