//! Spaces: the kinds of graphs that steps grow in. A new kind is a file in `spaces/`, and a row in each list here.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::spaces::{ClustersSpec, LatticeSpace, LatticeSpec, ScatterSpace, ScatterSpec, VoxelNodesSpec, VoxelSpace};
use crate::geom::{Shape, ShapeSpec};
use crate::graph::{FieldSpec, TriangularSpec};
use crate::math::{Ref, Weights};

/// A randomly weighted graph in a shape, where paths are planned.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpaceSpec {
    /// Take everything that is not given here from the space of this name. The random weights are this space's own.
    #[serde(default)]
    pub like: Option<Ref<Space>>,
    /// Where nodes are.
    pub shape: ShapeSpec,
    /// A shape that no path enters.
    #[serde(default)]
    pub forbid: Option<ShapeSpec>,
    /// How nodes are laid out and joined.
    pub nodes: NodesSpec,
    /// The random part of the weights.
    #[serde(default)]
    pub weights: Weights,
    /// Cost fields, by name.
    #[serde(default)]
    pub field: BTreeMap<String, FieldSpec>,
    /// Volumes around a few points in addition to the shape, each joined to it and never to each other (scattered nodes
    /// only).
    #[serde(default)]
    pub clusters: Option<ClustersSpec>,
    /// The name of the random stream: spaces with the same one have the same random weights. By default the space's
    /// own name.
    #[serde(default)]
    pub stream: Option<String>,
}

/// How the nodes of a graph are laid out.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum NodesSpec {
    /// A regular lattice.
    Lattice(LatticeSpec),
    /// Irregular: Poisson-disc nodes, no two nearer than the spacing and with no room for another (Xu and Mould 2012,
    /// section 3.1).
    Scatter(ScatterSpec),
    /// A triangular lattice in the plane, whose paths favour no axis.
    Triangular(TriangularSpec),
    /// None: voxels, for growth by voxels (Greene 1989). What is forbidden in the space takes up voxels, and light.
    Voxels(VoxelNodesSpec),
}

impl NodesSpec {
    /// Do the nodes lie in a plane?
    #[must_use]
    pub fn is_plane(&self) -> bool {
        match self {
            Self::Lattice(lattice) => lattice.neighbours.dimensions() == 2,
            Self::Scatter(scatter) => scatter.plane,
            Self::Triangular(_) => true,
            Self::Voxels(_) => false,
        }
    }
}

/// Where a step grows.
#[derive(Clone, Debug)]
pub enum Space {
    /// On a regular lattice.
    Lattice(LatticeSpace),
    /// Among scattered nodes.
    Scatter(ScatterSpace),
    /// In voxels.
    Voxels(VoxelSpace),
}

impl Space {
    /// Where nodes are.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        match self {
            Self::Lattice(space) => &space.shape,
            Self::Scatter(space) => &space.shape,
            Self::Voxels(space) => &space.shape,
        }
    }

    /// Where nodes are, and where none are.
    pub fn shapes(&self) -> impl Iterator<Item = &Shape> {
        let forbid = match self {
            Self::Lattice(space) => &space.forbid,
            Self::Scatter(space) => &space.forbid,
            Self::Voxels(space) => &space.forbid,
        };
        std::iter::once(self.shape()).chain(forbid)
    }

    /// Every shape in it, to change.
    pub(super) fn shapes_mut(&mut self) -> Vec<&mut Shape> {
        match self {
            Self::Lattice(space) => space.shapes_mut(),
            Self::Scatter(space) => space.shapes_mut(),
            Self::Voxels(space) => space.shapes_mut(),
        }
    }

    /// How far apart its nodes are, in scene units.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        match self {
            Self::Lattice(space) => space.window.spacing,
            Self::Scatter(space) => space.spacing,
            Self::Voxels(space) => space.side,
        }
    }

    /// Index of the coordinate that points up: y in the plane, z in space.
    #[must_use]
    pub fn up(&self) -> usize {
        match self {
            Self::Lattice(space) => space.up(),
            Self::Scatter(space) => space.up(),
            Self::Voxels(_) => 2,
        }
    }

    /// The lattice, if it is one.
    #[must_use]
    pub fn lattice(&self) -> Option<&LatticeSpace> {
        if let Self::Lattice(space) = self { Some(space) } else { None }
    }
}
