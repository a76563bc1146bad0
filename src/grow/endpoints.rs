//! Endpoints: where paths are to go.

use super::near::Near;
use crate::geom::Shape;
use crate::math::{DVec3, PerRound};

/// A set of endpoints whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct Endpoints {
    /// The set's name within its step.
    pub name: String,
    /// The class of its paths, as an index of the step's classes.
    pub class: u16,
    /// Where they are.
    pub placement: Placement,
}

impl Endpoints {
    /// A set of the first class.
    #[must_use]
    pub fn new(name: &str, placement: Placement) -> Self {
        Self { name: name.to_owned(), class: 0, placement }
    }
}

/// Where a set of endpoints is.
#[derive(Clone, Debug)]
pub enum Placement {
    /// At these points, each carried to the nearest node.
    At(Vec<DVec3>),
    /// At the last of each list of points, by way of the others.
    Through(Vec<Vec<DVec3>>),
    /// At random.
    Random(RandomPlaces),
    /// At random in the vicinity of what a step grew.
    Near(Near),
}

/// Places at random, uniform in a shape (2007, section 3).
#[derive(Clone, Debug)]
pub struct RandomPlaces {
    /// How many; of a repeated step in each round, around each end.
    pub count: PerRound,
    /// The shape; without it the space's own. In a repeated step it lies in the space around each end.
    pub inside: Option<Shape>,
    /// Greatest depth below the shape's surface.
    pub shell: Option<f64>,
    /// Least distance between any two.
    pub apart: f64,
    /// Name of the random stream.
    pub stream: String,
}

impl RandomPlaces {
    /// `count` places in `inside`, or anywhere in the space, with a random stream of this name.
    #[must_use]
    pub fn new(count: u32, inside: Option<Shape>, stream: &str) -> Self {
        Self { count: PerRound::All(f64::from(count)), inside, shell: None, apart: 0.0, stream: stream.to_owned() }
    }

    /// Does `p` lie in `inside`, no deeper than the shell?
    pub(super) fn holds(&self, inside: &Shape, p: DVec3) -> bool {
        inside.contains(p) && self.shell.is_none_or(|shell| inside.depth(p) <= shell)
    }
}

impl Placement {
    /// How many endpoints there will be.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::At(points) => points.len(),
            Self::Through(lists) => lists.len(),
            Self::Random(random) => random.count.at(0) as usize,
            Self::Near(near) => near.count as usize,
        }
    }

    /// How many least-cost paths lead to them.
    pub(super) fn paths(&self) -> usize {
        if let Self::Through(lists) = self { lists.iter().map(Vec::len).sum() } else { self.count() }
    }

    /// The shape that they lie in, if one is given.
    pub(super) fn shape(&self) -> Option<&Shape> {
        match self {
            Self::Random(random) => random.inside.as_ref(),
            Self::Near(near) => Some(&near.inside),
            Self::At(_) | Self::Through(_) => None,
        }
    }

    /// The same, to change.
    pub(super) fn shape_mut(&mut self) -> Option<&mut Shape> {
        match self {
            Self::Random(random) => random.inside.as_mut(),
            Self::Near(near) => Some(&mut near.inside),
            Self::At(_) | Self::Through(_) => None,
        }
    }
}
