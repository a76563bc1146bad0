//! Marks of construction drawings.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::DVec3;

/// A kind of mark in a construction drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MarkKind {
    /// A dot a node of the graph.
    Nodes,
    /// A line an edge.
    Edges,
    /// A line an edge, the wider and darker the less it costs.
    Costs,
    /// Dashed: where the sectors of a Yao graph in the plane meet, around the first generator.
    Sectors,
    /// A ring an endpoint, a disc a generator.
    Endpoints,
    /// Outlines of the space, of what it forbids, and of where endpoints are placed.
    Shapes,
    /// Lines of equal path cost; in space, on the upright plane through the first generator.
    Contours,
}

impl MarkKind {
    /// Is it of the graph alone, whatever is planned in it?
    #[must_use]
    pub fn is_of_graph(self) -> bool {
        match self {
            Self::Nodes | Self::Edges | Self::Costs => true,
            Self::Sectors | Self::Endpoints | Self::Shapes | Self::Contours => false,
        }
    }
}

/// One mark: a polyline, or a dot where it has a single point.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// What it stands for.
    pub kind: MarkKind,
    /// Its points, in scene units.
    pub line: Vec<DVec3>,
    /// Of costs: the share of edges that cost less than this one, from 0 to 1; 0 for all else.
    pub cost: f64,
}
