//! What is to be made: steps, the objects that they become, and how these are seen. Plain values, with or without TOML.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;

use super::AssembleError;
use crate::grow::{GrowError, Key, Problem, Step, waits_for_itself};
use crate::math::{Colour, DVec3, Degrees};
use crate::model::{
    Air, BackgroundSpec, CameraSpec, GlowSpec, GroundSpec, Instance, Light, Look, Material, Mesh, Sky, ViewFrame,
};
use crate::raster::{Grey, Plate};
use crate::skin::{LeavesSpec, Painting, Skin, ThornsSpec};

/// A scene on its own: names are indices, files are read.
///
/// ```
/// use lichtenberg::assemble::{ObjectRecipe, Recipe, grow, model};
/// use lichtenberg::geom::{Neighbours, Shape, Solid};
/// use lichtenberg::grow::{Endpoints, Generators, LatticeSpace, Paths, Placement, Space, Step};
/// use lichtenberg::math::{DVec3, Memory, Progress};
/// use lichtenberg::skeleton::Width;
///
/// let room = Shape::new(Solid::Box { min: DVec3::ZERO, max: DVec3::new(2.0, 1.0, 3.0) });
/// let neighbours = Neighbours::new(18).ok_or("18 neighbours")?;
/// let space = LatticeSpace::new(room, 0.1, neighbours)?;
/// let step = Step {
///     source: Generators::At(vec![DVec3::X]),
///     endpoints: vec![Endpoints::new("tips", Placement::At(vec![DVec3::new(0.0, 0.0, 3.0), DVec3::new(2.0, 0.0, 3.0)]))],
///     width: Width::Constant(0.05),
///     ..Step::new("twig", Some(Space::Lattice(space)), Paths::method())
/// };
/// let recipe = Recipe { steps: vec![step], objects: vec![ObjectRecipe::new("twig", vec![0])], ..Recipe::default() };
/// let memory = Memory::new(1 << 30);
/// let grown = grow(&recipe, &[], &memory, &Progress::default())?;
/// let model = model(&recipe, &grown, recipe.size, &memory, &Progress::default())?;
/// assert_eq!(grown[0].skeleton.paths.len(), 2);
/// assert_eq!(model.objects.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Recipe {
    /// What it is called.
    pub title: String,
    /// The seed of all its random numbers.
    pub seed: u64,
    /// Size of its picture, in pixels.
    pub size: [u32; 2],
    /// Is it flat, with y up?
    pub is_flat: bool,
    /// In a flat scene: the picture as a place to draw on.
    pub view: Option<Backdrop>,
    /// Growth steps.
    pub steps: Vec<Step>,
    /// What is seen.
    pub objects: Vec<ObjectRecipe>,
    /// Materials with their names.
    pub materials: Vec<(String, Material)>,
    /// The view.
    pub camera: CameraSpec,
    /// Lights in world space.
    pub lights: Vec<Light>,
    /// The ground.
    pub ground: Option<GroundSpec>,
    /// Plants far behind.
    pub background: Option<BackgroundSpec>,
    /// What is behind everything.
    pub sky: Sky,
    /// Haze, if any.
    pub air: Option<Air>,
    /// How it is lit where nothing else is asked for.
    pub look: Look,
}

impl Default for Recipe {
    /// Nothing, in space, with the material `bark`, a sun and a weak light from the other side, under a pale sky.
    fn default() -> Self {
        Self {
            title: "Untitled".to_owned(),
            seed: 1,
            size: [640, 480],
            is_flat: false,
            view: None,
            steps: Vec::new(),
            objects: Vec::new(),
            materials: vec![("bark".to_owned(), Self::bark())],
            camera: CameraSpec::default(),
            lights: Self::two_suns(),
            ground: None,
            background: None,
            sky: Self::pale_sky(),
            air: None,
            look: Look::Studio,
        }
    }
}

impl Recipe {
    /// Refuses indices of what is not there, and steps that wait for themselves.
    pub(super) fn check(&self) -> Result<(), AssembleError> {
        let wrong = |step: &Step, problem| GrowError::Step { step: step.name.clone(), key: Key::From, problem };
        for step in &self.steps {
            if let Some(index) = step.after().find(|&index| index >= self.steps.len()) {
                return Err(wrong(step, Problem::NoStep(index)).into());
            }
        }
        if let Some(stuck) = waits_for_itself(&self.steps) {
            return Err(wrong(&self.steps[stuck], Problem::WaitsForItself).into());
        }
        for object in &self.objects {
            let leaves = object.leaves.iter().map(|leaves| leaves.material);
            let mut materials = object.level_materials.iter().copied().chain(leaves).chain([object.material]);
            if object.steps.iter().any(|&step| step >= self.steps.len())
                || materials.any(|material| material >= self.materials.len())
            {
                return Err(AssembleError::Index(object.name.clone()));
            }
        }
        Ok(())
    }

    /// Refuses a camera that sees nothing. Where there is a view, it takes the camera's place.
    pub(super) fn check_camera(&self) -> Result<(), AssembleError> {
        if self.view.is_some() { Ok(()) } else { self.camera.check().map_err(AssembleError::Camera) }
    }

    /// The material of limbs that have no other.
    #[must_use]
    pub fn bark() -> Material {
        Material::matt(Colour::from_srgb([150, 130, 110]))
    }

    /// A sun, and a weak light from the other side.
    #[must_use]
    pub fn two_suns() -> Vec<Light> {
        let sun = |towards: [f64; 3], colour: [f64; 3], size: f64, shadow| Light::Sun {
            towards: DVec3::from_array(towards).normalize(),
            colour: Colour(colour),
            size: Degrees(size).radians(),
            shadow,
        };
        vec![sun([-0.5, -0.8, 0.8], [1.0, 0.94, 0.84], 3.0, true), sun([0.9, -0.4, 0.4], [0.3, 0.34, 0.4], 0.0, false)]
    }

    /// The sky of scenes in space that have no other.
    #[must_use]
    pub fn pale_sky() -> Sky {
        Sky::Gradient { horizon: Colour([0.78, 0.84, 0.88]), zenith: Colour([0.25, 0.43, 0.68]) }
    }
}

/// The picture of a flat scene as a place to draw on, its files read.
#[derive(Clone, Debug)]
pub struct Backdrop {
    /// The rectangle.
    pub frame: ViewFrame,
    /// The photograph, if any.
    pub plate: Option<Arc<Plate>>,
    /// Where something is nearer than the strokes: white.
    pub matte: Option<Arc<Grey>>,
}

/// What becomes an object of the model, or several.
#[derive(Clone, Debug)]
pub struct ObjectRecipe {
    /// Its name.
    pub name: String,
    /// Its steps, as indices of [`Recipe::steps`]; none where it is a mesh.
    pub steps: Vec<usize>,
    /// A mesh in place of steps, in scene space.
    pub mesh: Option<Mesh>,
    /// How skeletons become solid.
    pub skin: Skin,
    /// Index of its material in [`Recipe::materials`].
    pub material: usize,
    /// Materials of its levels, where they differ; the last stays.
    pub level_materials: Vec<usize>,
    /// What stands on its limbs.
    pub thorns: Option<ThornsSpec>,
    /// What colours its trees, in how many steps.
    pub paint: Option<(Arc<Painting>, u32)>,
    /// What grows along its ends.
    pub leaves: Vec<LeavesRecipe>,
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
    /// Are the marks of its steps drawn with it?
    pub marks: bool,
    /// Lights along it.
    pub lights: Option<LightsSpec>,
}

impl ObjectRecipe {
    /// An object of the steps with these indices, as round cones of the first material.
    #[must_use]
    pub fn new(name: &str, steps: Vec<usize>) -> Self {
        Self {
            name: name.to_owned(),
            steps,
            mesh: None,
            skin: Skin::default(),
            material: 0,
            level_materials: Vec::new(),
            thorns: None,
            paint: None,
            leaves: Vec::new(),
            at: DVec3::ZERO,
            copies: Vec::new(),
            glow: None,
            until: 1.0,
            shadow: true,
            marks: true,
            lights: None,
        }
    }
}

/// What grows along the ends of limbs.
#[derive(Clone, Debug)]
pub struct LeavesRecipe {
    /// Its name.
    pub name: String,
    /// How it stands.
    pub spec: LeavesSpec,
    /// One of it.
    pub mesh: Mesh,
    /// Index of its material in [`Recipe::materials`].
    pub material: usize,
}

/// Lights along the limbs of an object: without shadow, evenly spaced along its paths of class `main`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightsSpec {
    /// How many.
    #[schemars(range(min = 1, max = 64))]
    pub count: u32,
    /// Their colour times their strength, all together.
    pub colour: Colour,
    /// Distance over which their light falls off: at it there is as much as they have, far from it `2 (fade / d)^2` of
    /// that.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub fade: f64,
}
