//! Names and files are looked up: from a document to steps and objects that stand on their own.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::methods::Names;
use super::tree::Entry;
use super::{Claimed, LightsSpec, Mistake, ObjectSpec, Scene, SceneError, Source};
use crate::files::{
    Folder, decode_grey, decode_linear, decode_mesh, decode_panorama, decode_plate, decode_sketch, leaf_names,
    resize_grey, resize_plate,
};
use crate::geom::{Shape, ShapeSpec};
use crate::grow::{Expected, MarkKind, MethodSpec, Space, SpaceSpec, Step};
use crate::math::{Colour, DVec2, DVec3, Degrees, Ref, unknown};
use crate::model::{
    CameraSpec, GlowSpec, GroundSpec, Instance, LeavesSpec, Light, LightSpec, Material, Mesh, PaintSpec, Painting,
    Skin, Sky, SkySpec, ThornsSpec, ViewFrame, ViewSpec, ball_mesh, leaf_mesh,
};
use crate::raster::{Grey, Plate};

/// More places of a tile than this are refused.
const MOST_TILES: u64 = 100_000;

/// A scene whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// What it is called.
    pub title: String,
    /// The seed of all its random numbers.
    pub seed: u64,
    /// Size of its picture, in pixels.
    pub size: [u32; 2],
    /// Marks that its schematic shows.
    pub show: Vec<MarkKind>,
    /// Is it flat, with y up?
    pub is_flat: bool,
    /// In a flat scene: the picture as a place to draw on.
    pub view: Option<View>,
    /// Growth steps, by name.
    pub steps: Vec<Step>,
    /// What is seen.
    pub objects: Vec<ObjectPlan>,
    /// Materials, by name.
    pub materials: Vec<(String, Material)>,
    /// The view.
    pub camera: CameraSpec,
    /// Lights in world space.
    pub lights: Vec<Light>,
    /// The ground.
    pub ground: Option<GroundSpec>,
    /// What is behind everything.
    pub sky: Sky,
    /// What it claims.
    pub claims: BTreeMap<String, Claimed>,
    source: Source,
    tree: Entry,
}

/// A view whose files are read.
#[derive(Clone, Debug)]
pub struct View {
    /// The rectangle.
    pub frame: ViewFrame,
    /// The photograph, if any.
    pub plate: Option<Arc<Plate>>,
    /// Where something is nearer than the strokes: white.
    pub matte: Option<Arc<Grey>>,
}

/// An object whose names are resolved.
#[derive(Clone, Debug)]
pub struct ObjectPlan {
    /// Its name.
    pub name: String,
    /// Its steps, as indices of [`Resolved::steps`]; none where it is a mesh.
    pub steps: Vec<usize>,
    /// A mesh in place of steps, in scene space.
    pub mesh: Option<Mesh>,
    /// How skeletons become solid.
    pub skin: Skin,
    /// Index of its material in [`Resolved::materials`].
    pub material: usize,
    /// Materials of its levels, where they differ; the last stays.
    pub level_materials: Vec<usize>,
    /// What stands on its limbs.
    pub thorns: Option<ThornsSpec>,
    /// What colours its trees, in how many steps.
    pub paint: Option<(Arc<Painting>, u32)>,
    /// What grows along its ends: its name, what it is, one of it, and its material.
    pub leaves: Vec<(String, LeavesSpec, Mesh, usize)>,
    /// How far it is moved, in scene space.
    pub at: DVec3,
    /// Where else it stands; their `at` is how far it is moved.
    pub copies: Vec<Instance>,
    /// How it shines.
    pub glow: Option<GlowSpec>,
    /// How much of it has grown, from 0 to 1.
    pub until: f64,
    /// Does it cast shadows?
    pub shadow: bool,
    /// Lights along it.
    pub lights: Option<LightsSpec>,
}

impl Resolved {
    /// Bytes that growing it takes at its peak, step after step.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        self.steps.iter().map(Step::bytes_needed).max().unwrap_or(0)
    }

    /// An error at `place`, a dotted path of keys.
    #[must_use]
    pub fn error(&self, place: &str, message: impl Into<String>) -> SceneError {
        let mistake = Mistake { span: self.tree.find_span(place), place: place.to_owned(), message: message.into() };
        SceneError::new(&self.source, vec![mistake])
    }

    /// The scene as it was resolved, with overrides and what `like` took over, as JSON: what shapes the result.
    #[must_use]
    pub fn document(&self) -> serde_json::Value {
        self.tree.to_json()
    }
}

pub(super) struct Resolver<'a> {
    pub scene: &'a Scene,
    pub folder: &'a Folder,
    tree: &'a Entry,
    mistakes: &'a mut Vec<Mistake>,
    /// What steps are expected to grow, as far as it has been asked for.
    pub expected: BTreeMap<String, Expected>,
}

/// Resolves `scene`; adds what is wrong with it.
pub(super) fn resolve(
    mut scene: Scene,
    source: &Source,
    tree: &Entry,
    mistakes: &mut Vec<Mistake>,
) -> Option<Resolved> {
    let spec = scene.view.clone();
    let (view, size) = {
        let mut r = Resolver { scene: &scene, folder: &source.folder, tree, mistakes, expected: BTreeMap::new() };
        r.view(spec.as_ref(), scene.size)?
    };
    if let Some(view) = &view {
        for (name, bounds) in [("view", view.frame.bounds()), ("sky", view.frame.sky())] {
            scene.shape.entry(name.to_owned()).or_insert(ShapeSpec::of_box(bounds));
        }
    }
    let pixel = view.as_ref().map(|view| view.frame.pixel);
    let mut r = Resolver { scene: &scene, folder: &source.folder, tree, mistakes, expected: BTreeMap::new() };
    for (name, spec) in &scene.shape {
        let shape = spec.resolve(&scene.shape, &Names { folder: r.folder, scene: &scene });
        r.note(&format!("shape.{name}"), shape);
    }
    let is_flat = r.same_kind();
    let spaces: BTreeMap<&String, Option<Space>> =
        scene.space.iter().map(|(name, spec)| (name, r.space(name, spec))).collect();
    let steps: Vec<Option<Step>> = scene.grow.iter().map(|(name, spec)| r.step(name, spec, &spaces, pixel)).collect();
    // Of what has no other mistake.
    if r.mistakes.is_empty() {
        r.check_expected();
    }
    r.circles(&steps);
    r.plants(&steps);
    if view.is_some() && !is_flat {
        r.wrong("view", "a view is for flat scenes: those in space have a camera".to_owned());
    }
    let materials = r.materials(is_flat);
    let objects: Vec<Option<ObjectPlan>> =
        scene.object.iter().map(|(name, spec)| r.object(name, spec, &materials, is_flat)).collect();
    let lights = r.lights(is_flat);
    let claims = r.claims();
    for (empty, key) in [(steps.is_empty(), "grow"), (objects.is_empty(), "object")] {
        if empty {
            r.wrong(key, format!("a scene needs at least one `[{key}.NAME]`"));
        }
    }
    let [plain, flat] =
        [CameraSpec::default(), CameraSpec { rise: Degrees(0.0), angle: Degrees(0.0), ..CameraSpec::default() }];
    let paper = Colour([if scene.view.is_some() { 0.0 } else { 1.0 }; 3]);
    let pale = Sky::Gradient { horizon: Colour([0.78, 0.84, 0.88]), zenith: Colour([0.25, 0.43, 0.68]) };
    let sky =
        scene.sky.as_ref().map_or_else(|| Some(if is_flat { Sky::plain(paper) } else { pale }), |spec| r.sky(spec));
    Some(Resolved {
        is_flat,
        steps: steps.into_iter().collect::<Option<_>>()?,
        objects: objects.into_iter().collect::<Option<_>>()?,
        materials,
        camera: scene.camera.unwrap_or(if is_flat { flat } else { plain }),
        lights,
        sky: sky?,
        source: source.clone(),
        tree: tree.clone(),
        title: scene.title,
        seed: scene.seed,
        size,
        view,
        show: scene.show,
        ground: scene.ground,
        claims: claims?,
    })
}

impl Resolver<'_> {
    pub fn wrong(&mut self, place: &str, message: String) {
        self.mistakes.push(Mistake { span: self.tree.find_span(place), place: place.to_owned(), message });
    }

    /// The value, or its error noted at `place`.
    pub fn note<T>(&mut self, place: &str, result: Result<T, impl ToString>) -> Option<T> {
        result.map_err(|error| self.wrong(place, error.to_string())).ok()
    }

    /// The index of `name` among `known`.
    pub fn find<'b, T>(
        &mut self,
        place: &str,
        kind: &str,
        name: &Ref<T>,
        known: impl Iterator<Item = &'b String> + Clone,
    ) -> Option<usize> {
        let found = known.clone().position(|k| *k == name.name);
        if found.is_none() {
            self.wrong(place, unknown(kind, &name.name, known));
        }
        found
    }

    pub fn shape(&mut self, place: &str, spec: &ShapeSpec) -> Option<Shape> {
        let names = Names { folder: self.folder, scene: self.scene };
        let shape = spec.resolve(&self.scene.shape, &names);
        self.note(place, shape)
    }

    /// Is the scene flat?
    pub fn is_flat(&self) -> bool {
        self.scene.space.values().next().is_some_and(|spec| spec.nodes.is_plane())
    }

    /// All spaces are flat, or none is: which.
    fn same_kind(&mut self) -> bool {
        let scene = self.scene;
        let flat = |spec: &SpaceSpec| spec.nodes.is_plane();
        let is_flat = self.is_flat();
        if let Some((name, _)) = scene.space.iter().find(|(_, spec)| flat(spec) != is_flat) {
            let message = "a scene's spaces are all flat (lattices with 4 or 8 neighbours, scattered nodes with `plane = true`) or all in space".to_owned();
            self.wrong(&format!("space.{name}.nodes"), message);
        }
        is_flat
    }

    /// The view, and the size of the picture.
    fn view(&mut self, spec: Option<&ViewSpec>, size: Option<[u32; 2]>) -> Option<(Option<View>, [u32; 2])> {
        let Some(spec) = spec else { return Some((None, size.unwrap_or([640, 480]))) };
        let read = |folder: &Folder, file: &str| folder.read(file);
        let mut plate = None;
        if let Some(file) = &spec.plate {
            let read = read(self.folder, file)
                .and_then(|bytes| decode_plate(&bytes).map_err(|error| format!("cannot read `{file}`: {error}")));
            plate = Some(Arc::new(self.note("view.plate", read)?));
        }
        let mut matte = None;
        if let Some(file) = &spec.matte {
            let read = read(self.folder, file)
                .and_then(|bytes| decode_grey(&bytes).map_err(|error| format!("cannot read `{file}`: {error}")));
            matte = Some(Arc::new(self.note("view.matte", read)?));
        }
        let own = plate.as_ref().map(|plate| plate.frame());
        let size = size.or(own).unwrap_or([640, 480]);
        if let Some(matte) = &matte
            && matte.size() != own.unwrap_or(size)
        {
            let ([w, h], [width, height]) = (matte.size(), own.unwrap_or(size));
            let message = format!("the matte has {w} by {h} pixels, what it belongs to {width} by {height}");
            self.wrong("view.matte", message);
            return None;
        }
        // A photograph takes the picture's size.
        if own.is_some_and(|own| own != size) {
            if let Some(plate) = &mut plate {
                let smaller = resize_plate(plate, size);
                *plate = Arc::new(self.note("size", smaller)?);
            }
            matte = matte.map(|matte| Arc::new(resize_grey(&matte, size)));
        }
        Some((Some(View { frame: ViewFrame::new(spec, size), plate, matte }), size))
    }

    fn materials(&self, is_flat: bool) -> Vec<(String, Material)> {
        let mut materials = self.scene.material.clone();
        if is_flat {
            // What shines is white on black.
            let ink = if self.scene.view.is_some() { 1.0 } else { 0.0 };
            materials.entry("ink".to_owned()).or_insert(Material::ink(Colour([ink; 3])));
        } else {
            materials.entry("bark".to_owned()).or_insert(Material::matt(Colour::from_srgb([150, 130, 110])));
        }
        materials.into_iter().collect()
    }

    fn object(
        &mut self,
        name: &str,
        spec: &ObjectSpec,
        materials: &[(String, Material)],
        is_flat: bool,
    ) -> Option<ObjectPlan> {
        let place = format!("object.{name}");
        let steps: Vec<_> = spec
            .grow
            .iter()
            .enumerate()
            .map(|(i, step)| self.find(&format!("{place}.grow.{i}"), "step", step, self.scene.grow.keys()))
            .collect();
        if spec.grow.is_empty() == spec.mesh.is_none() {
            self.wrong(&place, "an object has either steps (`grow`) or a `mesh`".to_owned());
        }
        if spec.glow.is_some() && self.scene.view.is_none() {
            self.wrong(&format!("{place}.glow"), "only scenes with `[view]` have glowing objects".to_owned());
        }
        let mesh = match &spec.mesh {
            Some(file) => {
                let read = self.folder.read(file);
                let mesh =
                    read.and_then(|b| decode_mesh(file, &b).map_err(|error| format!("cannot read `{file}`: {error}")));
                self.note(&format!("{place}.mesh"), mesh).map(Some)
            }
            None => Some(None),
        };
        let names = materials.iter().map(|(name, _)| name);
        let material = match &spec.material {
            Some(material) => self.find(&format!("{place}.material"), "material", material, names.clone())?,
            None => names.clone().position(|n| n == "ink").or_else(|| names.clone().position(|n| n == "bark"))?,
        };
        if is_flat && (spec.skin == Skin::Mesh || !spec.leaves.is_empty()) {
            let message = "leaves and the skin `mesh` are for scenes in space".to_owned();
            self.wrong(&place, message);
        }
        if matches!(spec.skin, Skin::Mesh | Skin::Isosurface(_)) && !spec.level_materials.is_empty() {
            let message = "this skin makes all levels one: it has one material".to_owned();
            self.wrong(&format!("{place}.level_materials"), message);
        }
        self.skin(&place, spec);
        let paint = match &spec.paint {
            Some(paint) => Some((self.painting(&format!("{place}.paint.file"), paint)?, paint.steps)),
            None => None,
        };
        let level_materials: Vec<_> = (0..)
            .zip(&spec.level_materials)
            .map(|(i, material): (usize, _)| {
                self.find(&format!("{place}.level_materials.{i}"), "material", material, names.clone())
            })
            .collect();
        let leaves: Vec<_> = spec
            .leaves
            .iter()
            .map(|(key, leaves)| {
                let place = format!("{place}.leaves.{key}");
                if spec.grow.is_empty() {
                    self.wrong(&place, "only what grew bears leaves".to_owned());
                }
                if leaves.facing.is_some_and(|p| p.0 == DVec3::ZERO) {
                    self.wrong(&format!("{place}.facing"), "leaves face a direction, not the zero vector".to_owned());
                }
                let material = self.find(&format!("{place}.material"), "material", &leaves.material, names.clone())?;
                let mesh = leaf(&leaves.shape, leaves.fold.radians(), self.folder);
                let mesh = self.note(&format!("{place}.shape"), mesh)?;
                Some((key.clone(), leaves.clone(), mesh, material))
            })
            .collect();
        Some(ObjectPlan {
            level_materials: level_materials.into_iter().collect::<Option<_>>()?,
            leaves: leaves.into_iter().collect::<Option<_>>()?,
            name: name.to_owned(),
            steps: steps.into_iter().collect::<Option<_>>()?,
            mesh: mesh?,
            skin: spec.skin,
            material,
            thorns: spec.thorns,
            paint,
            at: spec.at.map_or(DVec3::ZERO, |p| p.0),
            copies: spec
                .copies
                .iter()
                .map(|copy| Instance { at: copy.at.0, turn: copy.turn.0, scale: copy.scale })
                .chain(spec.tile.iter().flat_map(|tile| {
                    tile.places().map(|by| Instance::at(spec.at.map_or(DVec3::ZERO, |p| p.0) + by)).collect::<Vec<_>>()
                }))
                .collect(),
            glow: spec.glow,
            until: spec.until,
            shadow: spec.shadow,
            lights: spec.lights,
        })
    }

    /// A skin, and what is on it, fit what the object is made of.
    fn skin(&mut self, place: &str, spec: &ObjectSpec) {
        let is_solid = |step: &Ref<Step>| {
            self.scene.grow.get(&step.name).is_some_and(|step| matches!(step.by, MethodSpec::Regions(_)))
        };
        let solids = spec.grow.iter().filter(|step| is_solid(step)).count();
        let is_surface = spec.skin == Skin::Surface;
        if solids > 0 && !(is_surface && solids == spec.grow.len()) {
            let message =
                "regions have no limbs: their objects have `skin = \"surface\"`, and no other steps".to_owned();
            self.wrong(&format!("{place}.skin"), message);
        } else if is_surface && solids == 0 {
            let message =
                "the skin `surface` is that of regions: limbs have `cones`, `spheres`, `mesh` or `isosurface`";
            self.wrong(&format!("{place}.skin"), message.to_owned());
        }
        let is_cones = spec.skin == Skin::Cones && !spec.grow.is_empty();
        let keys = [
            ("thorns", spec.thorns.is_some(), is_cones, "limbs of cones"),
            ("paint", spec.paint.is_some(), is_cones, "limbs of cones"),
            ("leaves", !spec.leaves.is_empty(), !is_surface, "limbs"),
        ];
        for (key, _, _, what) in keys.into_iter().filter(|(_, is_given, fits, _)| *is_given && !fits) {
            self.wrong(&format!("{place}.{key}"), format!("`{key}` belongs to {what}"));
        }
        if spec.paint.is_some() && !spec.level_materials.is_empty() {
            let message = "colours come either from a picture (`paint`) or by level".to_owned();
            self.wrong(&format!("{place}.paint"), message);
        }
        if let Some(tile) = &spec.tile {
            let places = u64::from(tile.count[0]) * u64::from(tile.count[1]);
            let is_apart = (0..2).all(|axis| tile.count[axis] == 1 || tile.step[axis].abs() > 0.0);
            if places > MOST_TILES || !is_apart {
                let message = format!("a tile has {MOST_TILES} places at most, apart from each other");
                self.wrong(&format!("{place}.tile"), message);
            }
        }
    }

    fn painting(&mut self, place: &str, spec: &PaintSpec) -> Option<Arc<Painting>> {
        let file = &spec.file;
        let wrong = |error: String| format!("cannot read `{file}`: {error}");
        let picture = self.folder.read(file).and_then(|bytes| decode_linear(&bytes).map_err(|e| wrong(e.to_string())));
        let picture = self.note(place, picture)?;
        let pixels = picture.pixels(["R", "G", "B"])?;
        Some(Arc::new(Painting { size: [picture.width, picture.height], pixels }))
    }

    fn sky(&mut self, spec: &SkySpec) -> Option<Sky> {
        let gradient = spec.horizon.is_some() || spec.zenith.is_some();
        match (spec.colour, gradient, &spec.file) {
            (Some(colour), false, None) => Some(Sky::plain(colour)),
            (None, true, None) => {
                let (Some(horizon), Some(zenith)) = (spec.horizon, spec.zenith) else {
                    self.wrong("sky", "a gradient needs both `horizon` and `zenith`".to_owned());
                    return None;
                };
                Some(Sky::Gradient { horizon, zenith })
            }
            (None, false, Some(file)) => {
                let picture = self
                    .folder
                    .read(file)
                    .and_then(|b| decode_panorama(&b).map_err(|error| format!("cannot read `{file}`: {error}")));
                let picture = Arc::new(self.note("sky.file", picture)?);
                Some(Sky::Picture { picture, turn: spec.turn.0, strength: spec.strength.unwrap_or(1.0) })
            }
            _ => {
                let message = "a sky has exactly one of `colour`, `horizon` with `zenith`, and `file`";
                self.wrong("sky", message.to_owned());
                None
            }
        }
    }

    fn lights(&mut self, is_flat: bool) -> Vec<Light> {
        if self.scene.light.is_empty() && !is_flat {
            let sun = |towards: [f64; 3], colour: [f64; 3], size: f64, shadow| Light::Sun {
                towards: DVec3::from_array(towards).normalize(),
                colour: Colour(colour),
                size: Degrees(size).radians(),
                shadow,
            };
            return vec![
                sun([-0.5, -0.8, 0.8], [1.0, 0.94, 0.84], 3.0, true),
                sun([0.9, -0.4, 0.4], [0.3, 0.34, 0.4], 0.0, false),
            ];
        }
        let mut lights = Vec::new();
        for (name, spec) in &self.scene.light {
            lights.extend(match *spec {
                LightSpec::Sun { from, colour, size, shadow } => {
                    let towards = from.0.try_normalize().ok_or("a sun needs a direction, not the zero vector");
                    self.note(&format!("light.{name}.sun.from"), towards).map(|towards| Light::Sun {
                        towards,
                        colour,
                        size: Degrees(size).radians(),
                        shadow,
                    })
                }
                LightSpec::Point { at, colour, shadow, fade } => Some(Light::Point { at: at.0, colour, shadow, fade }),
            });
        }
        lights
    }
}

/// One leaf: a ball, a shape that comes with the program, or the outline in an SVG file beside the scene.
fn leaf(shape: &str, fold: f64, folder: &Folder) -> Result<Mesh, String> {
    if shape == "ball" {
        return Ok(ball_mesh());
    }
    let bytes = if shape.ends_with(".svg") {
        folder.read(shape)?
    } else {
        let own = Folder::Embedded("leaves".into()).read(&format!("{shape}.svg"));
        own.map_err(|_| unknown("leaf", shape, leaf_names().iter()))?
    };
    let wrong = |error: String| format!("cannot use `{shape}` as a leaf: {error}");
    let page = decode_sketch(&bytes).map_err(|e| wrong(e.to_string()))?;
    let outline = page.lines.iter().find(|(_, is_closed)| *is_closed).map(|(line, _)| line);
    let outline = outline.ok_or_else(|| wrong("it has no closed outline".to_owned()))?;
    let outline: Vec<DVec2> = outline.iter().map(|p| DVec2::new(p.x * page.aspect, p.y)).collect();
    leaf_mesh(&outline, fold).map_err(wrong)
}
