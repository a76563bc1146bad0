//! What sources and endpoints need of a graph, whatever its kind.

use super::endpoints::RandomPlaces;
use super::error::{GrowError, Problem};
use super::near::Near;
use super::step::{Context, Step};
use crate::geom::{Mark, Shape};
use crate::graph::Node;
use crate::math::{DVec3, Progress};
use crate::plan::PlanError;

/// A graph in its space: places become nodes.
pub(super) trait Site {
    /// Where a node is.
    fn position(&self, node: Node) -> DVec3;

    /// How many nodes and edges it has.
    fn size(&self) -> [u64; 2];

    /// The nearest node to each point that was given by hand; `None` outside the space.
    fn within(&self, points: &[DVec3]) -> Vec<Option<Node>>;

    /// The nearest node to each place of another step; `None` where the graph does not reach.
    fn carried(&self, points: &[DVec3]) -> Vec<Option<Node>>;

    /// All nodes in a shape, in order.
    fn inside(&self, shape: &Shape) -> Vec<Node>;

    /// Keeps `node` from being chosen at random.
    fn take(&mut self, node: Node);

    /// `count` nodes at random, taken then. A larger count starts with the smaller one.
    ///
    /// # Errors
    /// [`Problem::NoRoom`].
    fn choose(&mut self, random: &RandomPlaces, seed: u64) -> Result<Vec<Node>, Problem>;

    /// Nodes in the vicinity of a step, taken then.
    ///
    /// # Errors
    /// [`Problem::NothingNear`], [`Problem::NoRoom`].
    fn choose_near(&mut self, near: &Near, context: &Context<'_>) -> Result<Vec<Node>, Problem>;
}

/// A site that paths are planned in.
pub(super) trait PathSite: Site {
    /// What paths cost on average, in units of planned costs, over a length.
    ///
    /// # Errors
    /// [`GrowError::Cancelled`].
    fn cost_over_length(&self, first: Node, progress: &Progress) -> Result<[f64; 2], GrowError>;

    /// Plans from `generators`, each with the cost that it starts at, to `ends`; to every node where these are `None`.
    ///
    /// # Errors
    /// [`PlanError`].
    fn plan<'s>(
        &'s self,
        generators: &[(Node, u64)],
        ends: Option<&[Node]>,
        progress: &Progress,
    ) -> Result<Box<dyn PathTree + 's>, PlanError>;

    /// Marks of what was planned, as construction drawings show it.
    ///
    /// # Errors
    /// [`Problem::TooManyMarks`], [`Problem::NoContours`], [`Problem::NoSectors`].
    fn marks(
        &self,
        step: &Step,
        tree: &dyn PathTree,
        ends: &[Node],
        context: &Context<'_>,
    ) -> Result<Vec<Mark>, Problem>;
}

/// Least-cost paths, found.
pub(super) trait PathTree {
    /// How many nodes have their final cost.
    fn settled(&self) -> u64;

    /// Is there a path to `node`?
    fn is_reached(&self, node: Node) -> bool;

    /// The nodes from `node` back to its generator with their costs, in scene units times weight.
    fn path(&self, node: Node) -> Vec<(Node, f64)>;

    /// Lines of equal cost on the plane, or on the upright plane through a point; `None` where the graph has no rows.
    fn contours(&self, _through: DVec3) -> Option<Vec<Vec<DVec3>>> {
        None
    }
}
