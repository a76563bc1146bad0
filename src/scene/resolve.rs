//! Names and files are looked up: from a document to steps and objects that stand on their own.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::tree::Entry;
use super::{Claim, Mistake, ObjectSpec, Scene, SceneError, Source};
use crate::files::{Folder, decode_grey, decode_obj, decode_panorama, decode_sketch};
use crate::geom::{Bounds, Shape, ShapeSpec, Strokes};
use crate::graph::{CostField, FieldSpec, FieldUse, HeightEnd, Measure, MeasureSpec};
use crate::grow::{
    EndpointSpec, Endpoints, FromSpec, LatticeSpec, MarkKind, NodesSpec, Placement, Source as Generators, Space,
    SpaceSpec, Step, StepSpec,
};
use crate::math::{Colour, DVec2, DVec3, Degrees, Point, Ref, unknown};
use crate::model::{CameraSpec, GroundSpec, Instance, Light, LightSpec, Material, Mesh, Skin, Sky, SkySpec};

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
    pub claims: BTreeMap<String, Claim>,
    source: Source,
    tree: Entry,
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
    /// How far it is moved, in scene space.
    pub at: DVec3,
    /// Where else it stands; their `at` is how far it is moved.
    pub copies: Vec<Instance>,
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

struct Resolver<'a> {
    scene: &'a Scene,
    folder: &'a Folder,
    tree: &'a Entry,
    mistakes: &'a mut Vec<Mistake>,
}

/// Resolves `scene`; adds what is wrong with it.
pub(super) fn resolve(scene: Scene, source: &Source, tree: &Entry, mistakes: &mut Vec<Mistake>) -> Option<Resolved> {
    let mut r = Resolver { scene: &scene, folder: &source.folder, tree, mistakes };
    for (name, spec) in &scene.shape {
        let shape = spec.resolve(&scene.shape);
        r.note(&format!("shape.{name}"), shape);
    }
    let is_flat = r.is_flat();
    let spaces: BTreeMap<&String, Option<Space>> =
        scene.space.iter().map(|(name, spec)| (name, r.space(name, spec))).collect();
    let steps: Vec<Option<Step>> = scene.grow.iter().map(|(name, spec)| r.step(name, spec, &spaces)).collect();
    let materials = r.materials(is_flat);
    let objects: Vec<Option<ObjectPlan>> =
        scene.object.iter().map(|(name, spec)| r.object(name, spec, &materials)).collect();
    let lights = r.lights(is_flat);
    for (name, claim) in &scene.claim {
        for (key, step) in
            [("of", Some(&claim.of)), ("more_than", claim.more_than.as_ref()), ("with", claim.with.as_ref())]
        {
            if let Some(step) = step {
                r.find(&format!("claim.{name}.{key}"), "step", step, scene.grow.keys());
            }
        }
        if claim.at_least.is_none() && claim.at_most.is_none() && claim.more_than.is_none() {
            r.wrong(&format!("claim.{name}"), "a claim needs `at_least`, `at_most` or `more_than`".to_owned());
        }
    }
    for (empty, key) in [(steps.is_empty(), "grow"), (objects.is_empty(), "object"), (spaces.is_empty(), "space")] {
        if empty {
            r.wrong(key, format!("a scene needs at least one `[{key}.NAME]`"));
        }
    }
    let [plain, flat] =
        [CameraSpec::default(), CameraSpec { rise: Degrees(0.0), angle: Degrees(0.0), ..CameraSpec::default() }];
    let white = Colour([1.0; 3]);
    let pale = Sky::Gradient { horizon: Colour([0.78, 0.84, 0.88]), zenith: Colour([0.25, 0.43, 0.68]) };
    let sky =
        scene.sky.as_ref().map_or_else(|| Some(if is_flat { Sky::plain(white) } else { pale }), |spec| r.sky(spec));
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
        size: scene.size,
        show: scene.show,
        ground: scene.ground,
        claims: scene.claim,
    })
}

impl Resolver<'_> {
    fn wrong(&mut self, place: &str, message: String) {
        self.mistakes.push(Mistake { span: self.tree.find_span(place), place: place.to_owned(), message });
    }

    /// The value, or its error noted at `place`.
    fn note<T>(&mut self, place: &str, result: Result<T, impl ToString>) -> Option<T> {
        result.map_err(|error| self.wrong(place, error.to_string())).ok()
    }

    /// The index of `name` among `known`.
    fn find<'b, T>(
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

    fn shape(&mut self, place: &str, spec: &ShapeSpec) -> Option<Shape> {
        let shape = spec.resolve(&self.scene.shape);
        self.note(place, shape)
    }

    /// All spaces are flat, or none is.
    fn is_flat(&mut self) -> bool {
        let scene = self.scene;
        let flat = |spec: &SpaceSpec| {
            let NodesSpec::Lattice(lattice) = &spec.nodes;
            lattice.neighbours.dimensions() == 2
        };
        let is_flat = scene.space.values().next().is_some_and(flat);
        if let Some((name, _)) = scene.space.iter().find(|(_, spec)| flat(spec) != is_flat) {
            let message = "a scene's lattices are all flat (4 or 8 neighbours) or all in space (6, 18, 26)".to_owned();
            self.wrong(&format!("space.{name}.nodes.lattice.neighbours"), message);
        }
        is_flat
    }

    fn space(&mut self, name: &str, spec: &SpaceSpec) -> Option<Space> {
        let place = format!("space.{name}");
        let shape = self.shape(&format!("{place}.shape"), &spec.shape);
        let forbid = match &spec.forbid {
            Some(forbid) => Some(self.shape(&format!("{place}.forbid"), forbid)?),
            None => None,
        };
        let NodesSpec::Lattice(LatticeSpec { spacing, neighbours }) = spec.nodes;
        let shape = shape?;
        let window =
            self.note(&format!("{place}.nodes.lattice.spacing"), Space::window(&shape, spacing, neighbours))?;
        let up = if neighbours.dimensions() == 2 { 1 } else { 2 };
        let fields: Vec<_> = spec
            .field
            .iter()
            .map(|(key, field)| self.field(&format!("{place}.field.{key}"), field, shape.bounds(), up))
            .collect();
        Some(Space {
            shape,
            forbid,
            window,
            neighbours,
            weights: spec.weights,
            fields: fields.into_iter().collect::<Option<_>>()?,
            stream: spec.stream.clone().unwrap_or_else(|| name.to_owned()),
        })
    }

    fn field(&mut self, place: &str, spec: &FieldSpec, frame: Bounds, up: usize) -> Option<CostField> {
        let upright = if up == 1 { DVec3::Y } else { DVec3::Z };
        let of = |key: &str| format!("{place}.of.{key}");
        let measure = match &spec.of {
            MeasureSpec::Axis { along, through } => {
                let along = along.map_or(upright, |p| p.0);
                let unit = along.try_normalize().ok_or("an axis needs a direction, not the zero vector");
                Measure::Axis { through: through.map_or(DVec3::ZERO, |p| p.0), along: self.note(&of("axis"), unit)? }
            }
            MeasureSpec::Point(Point(p)) => Measure::Point(*p),
            MeasureSpec::Height { cheap } => {
                let (low, high) = (frame.min[up], frame.max[up]);
                if low == high {
                    self.wrong(&of("height"), "the space has no height".to_owned());
                    return None;
                }
                let (cheap, dear) = if *cheap == HeightEnd::Low { (low, high) } else { (high, low) };
                Measure::Height { up, cheap, dear }
            }
            MeasureSpec::Shape(shape) => Measure::Shape(self.shape(&of("shape"), shape)?),
            MeasureSpec::Map { file } => {
                let picture = self
                    .folder
                    .read(file)
                    .and_then(|bytes| decode_grey(&bytes).map_err(|error| format!("cannot read `{file}`: {error}")));
                Measure::Map { picture: Arc::new(self.note(&of("map.file"), picture)?), frame, up }
            }
            MeasureSpec::Sketch { file } => {
                let lines = self.sketch(&of("sketch.file"), file, frame, up)?.0;
                Measure::Sketch { strokes: Arc::new(Strokes::new(lines)), up }
            }
        };
        Some(CostField {
            measure,
            per: spec.per,
            power: spec.power,
            scale: spec.scale,
            inverse: spec.inverse,
            multiply: spec.by == FieldUse::Multiply,
        })
    }

    /// The strokes and the points of an SVG file, its page stretched over `frame`: (across, up, 0).
    fn sketch(&mut self, place: &str, file: &str, frame: Bounds, up: usize) -> Option<(Vec<Vec<DVec3>>, Vec<DVec3>)> {
        let page = self
            .folder
            .read(file)
            .and_then(|bytes| decode_sketch(&bytes).map_err(|error| format!("cannot read `{file}`: {error}")));
        let page = self.note(place, page)?;
        let size = frame.size();
        let stretch = |p: DVec2| DVec3::new(frame.min.x + p.x * size.x, frame.min[up] + p.y * size[up], 0.0);
        let lines = page.lines.iter().map(|(line, _)| line.iter().map(|&p| stretch(p)).collect()).collect();
        Some((lines, page.points().map(stretch).collect()))
    }

    fn step(&mut self, name: &str, spec: &StepSpec, spaces: &BTreeMap<&String, Option<Space>>) -> Option<Step> {
        let place = format!("grow.{name}");
        self.find(&format!("{place}.space"), "space", &spec.space, self.scene.space.keys());
        let space = spaces.get(&spec.space.name).cloned().flatten();
        let mut classes: Vec<String> = spec.to.values().map(|set| set.class.clone()).collect();
        classes.sort();
        classes.dedup();
        if spec.to.is_empty() {
            self.wrong(&format!("{place}.to"), "a step needs at least one set of endpoints, `to.NAME`".to_owned());
        }
        let source = match &spec.from {
            FromSpec::At(points) => Some(Generators::At(points.iter().map(|p| p.0).collect())),
            FromSpec::Inside(shape) => self.shape(&format!("{place}.from.inside"), shape).map(Generators::Inside),
        };
        let widths = spec.width.check(&classes);
        self.note(&format!("{place}.width"), widths);
        let sets: Vec<_> = spec
            .to
            .iter()
            .map(|(key, set)| {
                let placement =
                    self.placement(&format!("{place}.to.{key}"), &format!("{name}/{key}"), set, space.as_ref());
                let class = classes.binary_search(&set.class).unwrap_or(0) as u16;
                placement.map(|placement| Endpoints { name: key.clone(), class, placement })
            })
            .collect();
        Some(Step {
            name: name.to_owned(),
            space: space?,
            space_name: spec.space.name.clone(),
            source: source?,
            endpoints: sets.into_iter().collect::<Option<_>>()?,
            classes,
            width: spec.width.clone(),
            smooth: spec.smooth,
            unreached: spec.unreached,
        })
    }

    fn placement(&mut self, place: &str, own: &str, spec: &EndpointSpec, space: Option<&Space>) -> Option<Placement> {
        match (&spec.count, &spec.at, &spec.sketch) {
            (Some(count), None, None) => {
                let inside = match &spec.inside {
                    Some(inside) => self.shape(&format!("{place}.inside"), inside)?,
                    None => space?.shape.clone(),
                };
                Some(Placement::Random {
                    count: *count,
                    inside,
                    apart: spec.apart,
                    stream: spec.stream.clone().unwrap_or_else(|| own.to_owned()),
                })
            }
            (None, Some(points), None) => {
                if points.is_empty() {
                    self.wrong(&format!("{place}.at"), "list at least one endpoint".to_owned());
                }
                Some(Placement::At(points.iter().map(|p| p.0).collect()))
            }
            (None, None, Some(file)) => {
                let space = space?;
                let frame = space.shape.bounds();
                let (_, points) = self.sketch(&format!("{place}.sketch"), file, frame, space.up())?;
                let raise = |p: DVec3| if space.up() == 1 { p } else { DVec3::new(p.x, frame.centre().y, p.y) };
                Some(Placement::At(points.into_iter().map(raise).collect()))
            }
            _ => {
                let message =
                    "endpoints need exactly one of `count` (at random), `at` (a list) and `sketch` (an SVG file)";
                self.wrong(place, message.to_owned());
                None
            }
        }
    }

    fn materials(&self, is_flat: bool) -> Vec<(String, Material)> {
        let mut materials = self.scene.material.clone();
        if is_flat {
            materials.entry("ink".to_owned()).or_insert(Material::ink(Colour([0.0; 3])));
        } else {
            materials.entry("bark".to_owned()).or_insert(Material::matt(Colour::from_srgb([150, 130, 110])));
        }
        materials.into_iter().collect()
    }

    fn object(&mut self, name: &str, spec: &ObjectSpec, materials: &[(String, Material)]) -> Option<ObjectPlan> {
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
        let mesh = match &spec.mesh {
            Some(file) => {
                let read = self.folder.read(file);
                let mesh = read.and_then(|b| decode_obj(&b).map_err(|error| format!("cannot read `{file}`: {error}")));
                self.note(&format!("{place}.mesh"), mesh).map(Some)
            }
            None => Some(None),
        };
        let names = materials.iter().map(|(name, _)| name);
        let material = match &spec.material {
            Some(material) => self.find(&format!("{place}.material"), "material", material, names)?,
            None => names.clone().position(|n| n == "ink").or_else(|| names.clone().position(|n| n == "bark"))?,
        };
        Some(ObjectPlan {
            name: name.to_owned(),
            steps: steps.into_iter().collect::<Option<_>>()?,
            mesh: mesh?,
            skin: spec.skin,
            material,
            at: spec.at.map_or(DVec3::ZERO, |p| p.0),
            copies: spec
                .copies
                .iter()
                .map(|copy| Instance { at: copy.at.0, turn: copy.turn.0, scale: copy.scale })
                .collect(),
        })
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
                LightSpec::Point { at, colour, shadow } => Some(Light::Point { at: at.0, colour, shadow }),
            });
        }
        lights
    }
}
