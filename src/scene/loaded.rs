//! A scene that was read: its recipe, and where everything in it stands in its text.

use std::collections::BTreeMap;

use super::claim::Claimed;
use super::mistake::{Mistake, SceneError};
use super::source::Source;
use super::tree::{Entry, Override};
use crate::assemble::{self, AssembleError, ObjectKey, Recipe};
use crate::geom::MarkKind;
use crate::grow::{GrowError, Grown, Key, Step};
use crate::math::{Cancelled, Memory, Progress};
use crate::model::Model;

/// A scene that was read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What is to be made.
    pub recipe: Recipe,
    /// Marks that its schematic shows.
    pub show: Vec<MarkKind>,
    /// What it claims.
    pub claims: BTreeMap<String, Claimed>,
    source: Source,
    overrides: Vec<Override>,
    tree: Entry,
}

/// Why a scene gave no result.
#[derive(Debug, thiserror::Error)]
pub enum Stage {
    /// The scene makes it impossible.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// It would take more memory than allowed; says how much.
    #[error("{0}")]
    Memory(AssembleError),
    /// Stopped by its [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Loaded {
    pub(super) fn new(
        recipe: Recipe,
        show: Vec<MarkKind>,
        claims: BTreeMap<String, Claimed>,
        source: &Source,
        tree: &Entry,
    ) -> Self {
        Self { recipe, show, claims, source: source.clone(), overrides: Vec::new(), tree: tree.clone() }
    }

    /// Remembers what was changed when it was read.
    pub(super) fn changed_by(self, overrides: &[Override]) -> Self {
        Self { overrides: overrides.to_vec(), ..self }
    }

    /// What it was read from, and what was changed then.
    pub(super) fn origin(&self) -> (&Source, &[Override]) {
        (&self.source, &self.overrides)
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

    /// `error` at its place in the scene.
    #[must_use]
    pub fn place(&self, error: AssembleError) -> Stage {
        let (place, message) = match &error {
            AssembleError::Cancelled(cancelled) => return Stage::Cancelled(*cancelled),
            AssembleError::Memory(_) | AssembleError::Grow(GrowError::Memory(_)) => return Stage::Memory(error),
            AssembleError::Grow(GrowError::Cancelled(cancelled)) => return Stage::Cancelled(*cancelled),
            AssembleError::Grow(GrowError::Step { step, key, problem }) => {
                (self.place_in_step(step, key), problem.to_string())
            }
            AssembleError::Object { object, key: ObjectKey::Whole, problem } => {
                (format!("object.{object}"), problem.to_string())
            }
            AssembleError::Object { object, key: ObjectKey::Isosurface(key), problem } => {
                (format!("object.{object}.skin.isosurface.{key}"), problem.to_string())
            }
            AssembleError::Index(object) => (format!("object.{object}"), error.to_string()),
            AssembleError::Camera(error) => ("camera".to_owned(), error.to_string()),
        };
        Stage::Scene(self.error(&place, message))
    }

    /// The dotted path of a part of a step.
    fn place_in_step(&self, name: &str, key: &Key) -> String {
        let step = self.recipe.steps.iter().find(|step| step.name == name);
        let space = step.map_or("", |step| &step.space_name);
        let method = step.map_or("", |step: &Step| step.method.name());
        let own = match key {
            Key::Nodes => return format!("space.{space}.nodes"),
            Key::Weights => return format!("space.{space}.weights"),
            Key::Space => "space".to_owned(),
            Key::From => "from".to_owned(),
            Key::FromAt => "from.at".to_owned(),
            Key::To => "to".to_owned(),
            Key::Set(set) => format!("to.{set}"),
            Key::Method => format!("by.{method}"),
            Key::MethodKey(key, None) => format!("by.{method}.{key}"),
            Key::MethodKey(key, Some(item)) => format!("by.{method}.{key}.{item}"),
            Key::Width => "width".to_owned(),
            Key::Symmetry => "symmetry".to_owned(),
            Key::Strands => "strands".to_owned(),
            Key::Refine => "refine".to_owned(),
            Key::Rounds => "repeat.times".to_owned(),
        };
        format!("grow.{name}.{own}")
    }
}

/// Looks for everything that keeps `scene` from growing within `memory`, as far as that is known before.
///
/// # Errors
/// [`Stage`]: what [`assemble::check`] finds, at its places in the scene.
pub fn check(scene: &Loaded, memory: &Memory, progress: &Progress) -> Result<(), Stage> {
    let mut mistakes = Vec::new();
    for error in assemble::check(&scene.recipe, memory, progress) {
        match scene.place(error) {
            Stage::Scene(error) => mistakes.extend(error.mistakes),
            other => return Err(other),
        }
    }
    if mistakes.is_empty() { Ok(()) } else { Err(SceneError::new(&scene.source, mistakes).into()) }
}

/// Grows every step of `scene` within `memory`; `show` lists what construction drawings need.
///
/// # Errors
/// [`Stage`]: what [`assemble::grow`] says, at its place in the scene.
pub fn grow(scene: &Loaded, show: &[MarkKind], memory: &Memory, progress: &Progress) -> Result<Vec<Grown>, Stage> {
    assemble::grow(&scene.recipe, show, memory, progress).map_err(|error| scene.place(error))
}

/// Grows the steps `wanted` and all that have to do with them; the others grow nothing.
///
/// # Errors
/// [`Stage`], as of [`grow`].
pub(super) fn grow_related(
    scene: &Loaded,
    wanted: &[usize],
    memory: &Memory,
    progress: &Progress,
) -> Result<Vec<Grown>, Stage> {
    assemble::grow_related(&scene.recipe, wanted, &[], memory, progress).map_err(|error| scene.place(error))
}

/// The model of `scene` from what its steps yielded, for a picture of `size` pixels, within `memory`.
///
/// # Errors
/// [`Stage`]: what [`assemble::model`] says, at its place in the scene.
pub fn model(
    scene: &Loaded,
    grown: &[Grown],
    size: [u32; 2],
    memory: &Memory,
    progress: &Progress,
) -> Result<Model, Stage> {
    assemble::model(&scene.recipe, grown, size, memory, progress).map_err(|error| scene.place(error))
}
