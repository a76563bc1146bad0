//! Why a step did not grow: the step, the part of it, and the reason.

use crate::graph::{LatticeError, ScatterError, WeightError};
use crate::math::{Cancelled, DVec3, OutOfMemory};
use crate::plan::PlanError;

/// Why a step did not grow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GrowError {
    /// Something about the step makes it impossible.
    #[error("step `{step}`: {problem}")]
    Step {
        /// The step's name.
        step: String,
        /// The part of it.
        key: Key,
        /// What is wrong and what would be right.
        problem: Problem,
    },
    /// It takes more memory than allowed.
    #[error(transparent)]
    Memory(#[from] OutOfMemory),
    /// Stopped by its [`crate::math::Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A part of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Key {
    /// Which space it grows in.
    Space,
    /// The nodes of that space.
    Nodes,
    /// The weights of that space.
    Weights,
    /// Its generators.
    From,
    /// Generators given by hand.
    FromAt,
    /// All its endpoints.
    To,
    /// A set of endpoints, by name.
    Set(String),
    /// Its method.
    Method,
    /// A key of its method, with the index of an item where it is a list.
    MethodKey(&'static str, Option<usize>),
    /// Radii.
    Width,
    /// Copies about an axis.
    Symmetry,
    /// Strands.
    Strands,
    /// Refinement.
    Refine,
    /// The number of its rounds.
    Rounds,
}

/// What makes growth impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A method without the space that it needs.
    #[error("this way of growing needs a space")]
    NoSpace,
    /// A method in a space of another kind.
    #[error("this way of growing needs {0}")]
    WrongSpace(&'static str),
    /// No lattice.
    #[error(transparent)]
    Lattice(LatticeError),
    /// No scattered nodes.
    #[error(transparent)]
    Scatter(ScatterError),
    /// Weights out of range.
    #[error(transparent)]
    Weights(WeightError),
    /// A search that cannot be done.
    #[error(transparent)]
    Plan(PlanError),
    /// A step that it needs has not grown.
    #[error("the step has not grown")]
    NotGrown,
    /// Nothing to start from.
    #[error("nothing of that step lies in the space")]
    NothingInSpace,
    /// Nothing to start from.
    #[error("no node of the space lies in this shape")]
    NoNodeInShape,
    /// A generator outside.
    #[error("the generator at {0} is outside the space or where nodes are forbidden")]
    GeneratorOutside(DVec3),
    /// An endpoint outside.
    #[error("the endpoint at {0} is outside the space or where nodes are forbidden")]
    EndpointOutside(DVec3),
    /// No end to go on from.
    #[error("there is no end to grow from: the step before has no paths")]
    NoEnds,
    /// A source that has no limbs.
    #[error("limbs without a graph start at points or at ends")]
    NoLimbs,
    /// A source that a repeated step cannot have.
    #[error("a repeated step starts from points or the ends of steps")]
    NoRoundSource,
    /// The step that endpoints are near has nothing.
    #[error("the step that they are to be near has no limbs")]
    NothingNear,
    /// Too little room.
    #[error(
        "only {placed} of {count} endpoints could be placed: make `inside` larger, `apart` ({apart}) or the spacing smaller, or ask for fewer"
    )]
    NoRoom {
        /// How many have a place.
        placed: usize,
        /// How many are asked for.
        count: u32,
        /// The distance between them that is asked for.
        apart: f64,
    },
    /// No path.
    #[error("no path reaches the endpoint at {0}: join the shape's pieces, open a way, or set `unreached = \"drop\"`")]
    Unreached(DVec3),
    /// Too much to draw.
    #[error("{count} {what} are too many to draw ({most} at most): use a wider spacing")]
    TooManyMarks {
        /// Nodes or edges.
        what: &'static str,
        /// How many.
        count: u64,
        /// How many can be drawn.
        most: u64,
    },
    /// Contours where there is no lattice.
    #[error("contours of cost are drawn on lattices only")]
    NoContours,
    /// Sectors where there is no Yao graph in the plane.
    #[error("sectors are drawn of Yao graphs in the plane only: `nodes.scatter` with `plane = true`, without `radius`")]
    NoSectors,
    /// A class without a number.
    #[error("{0}")]
    Width(String),
    /// A round of refinement that plans among too many nodes.
    #[error(
        "round {round} would plan among about {count} nodes, more than {most}: use fewer `times`, or a smaller `ratio` or `reach`"
    )]
    TooRefined {
        /// The round, from 1.
        round: u32,
        /// How many.
        count: u64,
        /// How many there may be.
        most: u64,
    },
    /// Too many nodes of a skeleton.
    #[error("{count} nodes are more than {most}: use fewer endpoints, pieces or parts")]
    TooManyNodes {
        /// How many there would be.
        count: u64,
        /// How many there may be.
        most: u64,
    },
    /// More grew than there may be.
    #[error("more than {0} nodes grow: lower `depth`, `most` or `chance`")]
    Overgrown(u64),
    /// More grew than there may be.
    #[error("more than {0} nodes grow: use fewer `points`, a longer `step`, or start nearer to them")]
    Colonised(u64),
    /// A shape too thin for points.
    #[error("only {placed} of {count} points fit into the shape: is it thinner than its box by far?")]
    NoPoints {
        /// How many have a place.
        placed: usize,
        /// How many are asked for.
        count: u32,
    },
    /// A repeated step elsewhere.
    #[error("a repeated step needs scattered nodes")]
    NotRepeated,
    /// A step before it that is not there.
    #[error("there is no step with the index {0}")]
    NoStep(usize),
    /// A circle of steps.
    #[error("this step waits for itself: it grows from, or near, a step that waits for it")]
    WaitsForItself,
    /// More is expected than there may be.
    #[error(transparent)]
    Expected(super::segments::TooMany),
    /// Rounds that explode.
    #[error(
        "round {round} would have {ends} ends, more than the {most:.0} that there is memory for: use fewer rounds, lower counts or shorter lifespans"
    )]
    TooManyEnds {
        /// The round, from 1.
        round: u32,
        /// How many ends it would have.
        ends: f64,
        /// How many there may be.
        most: f64,
    },
    /// A round without a place for its endpoints.
    #[error(
        "round {round} could place none of its {count} endpoints: make `inside` or `shell` larger, `apart` or the spacing smaller"
    )]
    EmptyRound {
        /// The round, from 1.
        round: u32,
        /// How many endpoints are asked for.
        count: f64,
    },
    /// Fractal placement that never begins.
    #[error("no iteration: the distance starts below `least`, {0}")]
    NoIteration(f64),
    /// Fractal placement that explodes.
    #[error(
        "with iteration {iteration} there would be {count} endpoints, more than the {nodes} nodes: lower `branching`, or allow fewer iterations"
    )]
    TooManyIterations {
        /// The iteration, from 1.
        iteration: usize,
        /// How many endpoints there would be by then.
        count: f64,
        /// How many nodes there are.
        nodes: f64,
    },
    /// Fractal placement without room.
    #[error("no node lies at that distance: raise `by.fractal.distance`, or enlarge the space")]
    NoNodeAtDistance,
    /// Too many regions.
    #[error("{count} generators are too many: {most} at most")]
    TooManyRegions {
        /// How many there are.
        count: usize,
        /// How many there may be.
        most: u16,
    },
    /// A place in no region.
    #[error("{0} lies in no region: it is outside of the space, or nothing reaches it")]
    NoRegion(DVec3),
    /// A refined lattice that is too large.
    #[error("a lattice of {0:?} nodes is too large: refine less, or use a wider spacing")]
    TooFine([u32; 3]),
    /// The dielectric breakdown model ended in the open.
    #[error("growth touches no endpoint within {0} nodes: allow more, or set `unreached = \"drop\"`")]
    NoTouch(u32),
    /// A limb outside of its box.
    #[error("the limb at {0} starts outside of `inside`")]
    StartsOutside(DVec3),
    /// A limb outside of its voxels.
    #[error("the limb at {0} starts outside of the space, or in what is forbidden")]
    StartsForbidden(DVec3),
    /// A limb with nothing to cling to.
    #[error("near {0} no place lies within `cling.within` of the surface")]
    NothingToClingTo(DVec3),
    /// A plant without an open direction.
    #[error(
        "nothing grows: every direction leads out of the space, into what is forbidden or kept from, off the surface, or nearer than `apart` to other growth"
    )]
    Stuck,
}
