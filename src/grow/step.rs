//! One growth step: what grows from what, and the method that grows it.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use super::endpoints::{Endpoints, Placement, RandomPlaces};
use super::error::{GrowError, Key, Problem};
use super::grown::{Grown, Part};
use super::paths::Refine;
use super::rounds::Repeat;
use super::space::Space;
use super::spaces::LatticeSpace;
use crate::geom::{MarkKind, Shape};
use crate::math::{DVec3, Memory, Progress};
use crate::plan::PlanError;
use crate::skeleton::{Form, Skeleton, SymmetrySpec, Width};

/// A step whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its name in the scene.
    pub name: String,
    /// The space to grow in; methods without a graph have none.
    pub space: Option<Space>,
    /// The name of that space: steps in voxels of the same name grow together.
    pub space_name: String,
    /// Where paths start.
    pub source: Generators,
    /// Where they go.
    pub endpoints: Vec<Endpoints>,
    /// Names of the endpoints' classes.
    pub classes: Vec<String>,
    /// How limbs come about.
    pub method: Arc<dyn Method>,
    /// How it is repeated, around every end.
    pub repeat: Option<Repeat>,
    /// Radii.
    pub width: Width,
    /// Natural limbs.
    pub form: Option<Form>,
    /// Of how many pieces a strand is, where every path is one.
    pub strands: Option<u32>,
    /// How often what grew stands around an axis.
    pub symmetry: Option<SymmetrySpec>,
    /// What it costs to go along the step that this one grows from, over what it costs elsewhere.
    pub along: f64,
    /// How paths are planned again.
    pub refine: Option<Refine>,
    /// Lattice steps to average over.
    pub smooth: f64,
    /// What to do about unreached endpoints.
    pub unreached: Unreached,
}

/// The generators of a step.
#[derive(Clone, Debug)]
pub enum Generators {
    /// The nodes nearest to these points.
    At(Vec<DVec3>),
    /// All nodes in a shape.
    Inside(Shape),
    /// Nodes at random.
    Spread(RandomPlaces),
    /// What the steps with these indices have grown.
    Steps(Vec<usize>, Part),
}

/// What to do about endpoints that no path reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Unreached {
    /// Refuse the scene.
    #[default]
    Error,
    /// Leave them out, with a warning that counts them.
    Drop,
}

/// What a step may read while it grows.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The scene's seed.
    pub seed: u64,
    /// What the steps before it have grown, by index.
    pub grown: &'a [Option<&'a Skeleton>],
    /// What construction drawings are to show.
    pub show: &'a [MarkKind],
    /// What may be taken.
    pub memory: &'a Memory,
    /// Progress and cancelling.
    pub progress: &'a Progress,
}

/// What a method makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Yield {
    /// Paths, which share their way to the root.
    Paths,
    /// Limbs that know their root and their number.
    Limbs,
    /// Solids.
    Solids,
}

/// A way to grow.
pub trait Method: Any + fmt::Debug + Send + Sync {
    /// Its name, as scenes have it in `by.NAME`.
    fn name(&self) -> &'static str;

    /// Grows `step`, which is not repeated.
    ///
    /// # Errors
    /// [`GrowError`].
    fn grow(&self, step: &Step, context: &Context<'_>) -> Result<Grown, GrowError>;

    /// Looks, without growing, whether `step` has places for what it starts from and leads to, as far as no other step decides
    /// that; so much is known before growth.
    ///
    /// # Errors
    /// [`GrowError`].
    fn check_places(&self, _step: &Step, _context: &Context<'_>) -> Result<(), GrowError> {
        Ok(())
    }

    /// Bytes that growing `step` takes at its peak.
    fn bytes_needed(&self, step: &Step) -> u64;

    /// The same where it is known what has grown before.
    fn bytes_needed_from(&self, step: &Step, _grown: &[Option<&Skeleton>]) -> u64 {
        self.bytes_needed(step)
    }

    /// What it makes.
    fn yields(&self) -> Yield {
        Yield::Paths
    }

    /// The shapes that it holds.
    fn shapes(&self) -> Vec<&Shape> {
        Vec::new()
    }

    /// The same method with its shapes changed, where it has any.
    fn with_shapes(&self, _change: &dyn Fn(&Shape) -> Shape) -> Option<Arc<dyn Method>> {
        None
    }

    /// Do the steps of one space grow together?
    fn is_shared(&self) -> bool {
        false
    }

    /// Grows `steps`, which are all by this method in one space, among what `before` grew there.
    ///
    /// # Errors
    /// [`GrowError`].
    fn grow_together(
        &self,
        steps: &[&Step],
        _before: &[(&Step, &Skeleton)],
        context: &Context<'_>,
    ) -> Result<Vec<Grown>, GrowError> {
        steps.iter().map(|step| step.grow(context)).collect()
    }
}

impl Step {
    /// A step from the origin without endpoints, with a width of 0: fill in what it needs.
    #[must_use]
    pub fn new(name: &str, space: Option<Space>, method: Arc<dyn Method>) -> Self {
        Self {
            name: name.to_owned(),
            space_name: name.to_owned(),
            space,
            source: Generators::At(vec![DVec3::ZERO]),
            endpoints: Vec::new(),
            classes: vec!["main".to_owned()],
            method,
            repeat: None,
            width: Width::Constant(0.0),
            form: None,
            strands: None,
            symmetry: None,
            along: 0.0,
            refine: None,
            smooth: 0.0,
            unreached: Unreached::Error,
        }
    }

    /// The lattice that it grows in.
    ///
    /// # Errors
    /// A space of another kind, or none.
    pub fn lattice(&self) -> Result<&LatticeSpace, GrowError> {
        match &self.space {
            Some(Space::Lattice(space)) => Ok(space),
            Some(_) => Err(self.error(Key::Space, Problem::WrongSpace("a lattice"))),
            None => Err(self.error(Key::Space, Problem::NoSpace)),
        }
    }

    /// Bytes that growing it takes at its peak.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        self.method.bytes_needed(self)
    }

    /// The same where it is known what has grown before.
    #[must_use]
    pub fn bytes_needed_from(&self, grown: &[Option<&Skeleton>]) -> u64 {
        self.method.bytes_needed_from(self, grown)
    }

    /// How many least-cost paths it plans.
    #[must_use]
    pub fn count_paths(&self) -> u64 {
        self.endpoints.iter().map(|set| set.placement.paths() as u64).sum()
    }

    /// How many times it is there, by its symmetry.
    #[must_use]
    pub fn parts(&self) -> u32 {
        self.symmetry.map_or(1, |symmetry| symmetry.parts())
    }

    /// The steps that must have grown before, by index.
    pub fn after(&self) -> impl Iterator<Item = usize> + '_ {
        let near = |set: &Endpoints| if let Placement::Near(near) = &set.placement { Some(near.step) } else { None };
        self.sources().iter().copied().chain(self.endpoints.iter().filter_map(near)).chain(self.solids())
    }

    /// The steps that this one grows from.
    #[must_use]
    pub fn sources(&self) -> &[usize] {
        if let Generators::Steps(steps, _) = &self.source { steps } else { &[] }
    }

    /// Grows the step, which is not repeated.
    ///
    /// # Errors
    /// [`GrowError::Step`] where endpoints cannot be placed or reached, the lattice is empty, or weights are out of
    /// range; [`GrowError::Cancelled`].
    pub fn grow(&self, context: &Context<'_>) -> Result<Grown, GrowError> {
        self.method.grow(self, context)
    }

    /// Looks, without growing, whether it has the places that it needs, as far as no other step decides that.
    ///
    /// # Errors
    /// As [`Step::grow`].
    pub fn check_places(&self, context: &Context<'_>) -> Result<(), GrowError> {
        let is_elsewhere = self.repeat.is_some() || !self.solids().is_empty();
        if is_elsewhere { Ok(()) } else { self.method.check_places(self, context) }
    }

    /// Do both grow in the same space, together?
    #[must_use]
    pub fn shares_space(&self, other: &Self) -> bool {
        self.method.is_shared() && other.method.is_shared() && self.space_name == other.space_name
    }

    /// An error about a part of it.
    pub(super) fn error(&self, key: Key, problem: Problem) -> GrowError {
        GrowError::Step { step: self.name.clone(), key, problem }
    }

    /// What is told of a search that failed.
    pub(super) fn plan_error(&self, error: PlanError) -> GrowError {
        match error {
            PlanError::Cancelled(cancelled) => GrowError::Cancelled(cancelled),
            PlanError::TooWide { .. } => self.error(Key::Weights, Problem::Plan(error)),
        }
    }
}
