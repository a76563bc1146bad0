//! One growth step: a space is planned, and the paths to its endpoints become a skeleton.

use std::collections::HashMap;

use super::construction::{Mark, MarkKind, construction};
use super::{Endpoints, Space, Unreached};
use crate::geom::Shape;
use crate::graph::{Graph, Lattice, LatticeError, Node};
use crate::math::{Cancelled, DVec3, Progress};
use crate::plan::{Goal, Plan, PlanError, plan};
use crate::skeleton::{Skeleton, Width, bend, smooth};

/// A step whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its name in the scene.
    pub name: String,
    /// The space to plan in.
    pub space: Space,
    /// The name of that space, for errors.
    pub space_name: String,
    /// Where paths start.
    pub source: Source,
    /// Where they go.
    pub endpoints: Vec<Endpoints>,
    /// Names of the endpoints' classes.
    pub classes: Vec<String>,
    /// Radii.
    pub width: Width,
    /// Lattice steps to average over.
    pub smooth: f64,
    /// What to do about unreached endpoints.
    pub unreached: Unreached,
}

/// The generators of a step.
#[derive(Clone, Debug)]
pub enum Source {
    /// The nodes nearest to these points.
    At(Vec<DVec3>),
    /// All nodes in a shape.
    Inside(Shape),
}

/// What a step yields.
#[derive(Clone, Debug)]
pub struct Grown {
    /// The step's name.
    pub name: String,
    /// The union of its paths, with radii.
    pub skeleton: Skeleton,
    /// Nodes of the graph.
    pub nodes: u64,
    /// Edges of the graph, each counted once.
    pub edges: u64,
    /// Nodes whose cost was settled.
    pub settled: u64,
    /// Endpoints that no path reached and that were dropped.
    pub dropped: usize,
    /// What construction drawings show, where asked for.
    pub marks: Vec<Mark>,
}

/// Why a step did not grow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GrowError {
    /// Something in the scene makes it impossible.
    #[error("{message}")]
    Scene {
        /// Where in the scene: a dotted path of keys.
        place: String,
        /// What is wrong and what would be right.
        message: String,
    },
    /// Stopped by its [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Bytes that a node of a skeleton takes, with what is made of it.
const NODE_BYTES: u64 = 256;

impl Step {
    /// Bytes that growing it takes at its peak.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        let paths: u64 = self.endpoints.iter().map(|set| set.placement.count() as u64).sum();
        let across: u64 = self.space.window.size.iter().map(|&s| u64::from(s)).sum();
        // Paths share most of their nodes; they can never have more than the lattice has.
        let skeleton = paths.saturating_mul(across).min(self.space.window.nodes()) * NODE_BYTES;
        self.space.bytes_needed().saturating_add(skeleton)
    }

    /// Grows the step in the scene with this seed; `show` lists what construction drawings need.
    ///
    /// # Errors
    /// [`GrowError::Scene`] where endpoints cannot be placed or reached, the lattice is empty, or weights are out of
    /// range; [`GrowError::Cancelled`].
    pub fn grow(&self, seed: u64, show: &[MarkKind], progress: &Progress) -> Result<Grown, GrowError> {
        match self.space.neighbours.count() {
            4 => self.grow_in::<4>(seed, show, progress),
            8 => self.grow_in::<8>(seed, show, progress),
            6 => self.grow_in::<6>(seed, show, progress),
            18 => self.grow_in::<18>(seed, show, progress),
            _ => self.grow_in::<26>(seed, show, progress),
        }
    }

    fn grow_in<const N: usize>(&self, seed: u64, show: &[MarkKind], progress: &Progress) -> Result<Grown, GrowError> {
        let in_space =
            |key: &str, message: String| GrowError::Scene { place: format!("space.{}{key}", self.space_name), message };
        let lattice: Lattice<N> = self.space.lattice(seed).map_err(|error| {
            let key = if matches!(error, LatticeError::Weights(_)) { ".weights" } else { ".nodes" };
            in_space(key, error.to_string())
        })?;
        let generators = self.generators(&lattice)?;
        let mut wanted = Vec::new();
        for set in &self.endpoints {
            let nodes = set.placement.place(&lattice, seed).map_err(|message| GrowError::Scene {
                place: format!("grow.{}.to.{}", self.name, set.name),
                message,
            })?;
            wanted.extend(nodes.into_iter().map(|node| (node, set)));
        }
        let nodes: Vec<Node> = wanted.iter().map(|&(node, _)| node).collect();
        let goal = if show.contains(&MarkKind::Contours) { Goal::Everything } else { Goal::Nodes(&nodes) };
        let plan = plan(&lattice, &generators, goal, progress).map_err(|error| match error {
            PlanError::Cancelled(cancelled) => GrowError::Cancelled(cancelled),
            PlanError::TooWide { .. } => in_space(".weights", error.to_string()),
        })?;

        let (skeleton, dropped) = self.skeleton(&plan, &wanted)?;
        Ok(Grown {
            name: self.name.clone(),
            nodes: lattice.open_nodes(),
            edges: lattice.count_edges(),
            settled: plan.settled() as u64,
            marks: construction(self, &plan, &nodes, show).map_err(|message| in_space(".nodes", message))?,
            skeleton,
            dropped,
        })
    }

    fn generators<const N: usize>(&self, lattice: &Lattice<N>) -> Result<Vec<Node>, GrowError> {
        let place = || format!("grow.{}.from", self.name);
        match &self.source {
            Source::At(points) => points
                .iter()
                .map(|&p| {
                    lattice.nearest(p).ok_or_else(|| GrowError::Scene {
                        place: place(),
                        message: format!("the generator at {p} is outside the space or where nodes are forbidden"),
                    })
                })
                .collect(),
            Source::Inside(shape) => {
                let nodes: Vec<_> = lattice.nodes().filter(|&n| shape.contains(lattice.position(n))).collect();
                if nodes.is_empty() {
                    return Err(GrowError::Scene {
                        place: place(),
                        message: "no node of the space lies in this shape".to_owned(),
                    });
                }
                Ok(nodes)
            }
        }
    }

    fn skeleton<const N: usize>(
        &self,
        plan: &Plan<'_, Lattice<N>>,
        wanted: &[(Node, &Endpoints)],
    ) -> Result<(Skeleton, usize), GrowError> {
        let lattice = plan.graph();
        let range = lattice.weight_range();
        let mut skeleton = Skeleton::new(self.classes.clone());
        let mut known = HashMap::new();
        let mut dropped = 0;
        for &(end, set) in wanted {
            let Some(cost) = plan.cost(end) else {
                if self.unreached == Unreached::Error {
                    return Err(GrowError::Scene {
                        place: format!("grow.{}.to.{}", self.name, set.name),
                        message: format!(
                            "no path reaches the endpoint at {}: open a way, or set `unreached = \"drop\"`",
                            lattice.position(end)
                        ),
                    });
                }
                dropped += 1;
                continue;
            };
            let mut left = cost;
            let path = plan.path(end).map(|node| {
                let here = (node, lattice.position(node), range.real(left));
                left -= plan.predecessor(node).map_or(0, |(_, weight)| u64::from(weight));
                here
            });
            skeleton.add_path(&mut known, set.class, path);
        }
        self.width
            .apply(&mut skeleton)
            .map_err(|message| GrowError::Scene { place: format!("grow.{}.width", self.name), message })?;
        if self.smooth > 0.0 {
            smooth(&mut skeleton, self.smooth);
            skeleton = bend(&skeleton);
        }
        skeleton.number_branches();
        Ok((skeleton, dropped))
    }
}
