//! Baselines as a scene writes them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::grow::rules::{MOST_DENSE, Needs, Rules};

/// What goes with the dielectric breakdown model, which solves for all nodes again and again: more would take days.
pub(in crate::grow) const DBM: Rules = Rules {
    subject: "an aggregate has",
    needs: Needs::Lattice,
    repeats: false,
    class: Some(SIDE),
    most_nodes: 4 << 20,
    ..Rules::PATHS
};

/// What goes with diffusion-limited aggregation.
pub(in crate::grow) const DLA: Rules = Rules { has_endpoints: false, most_nodes: MOST_DENSE, ..DBM };

/// The name of the class of paths that end in the open.
pub const SIDE: &str = "minor";

/// The dielectric breakdown model: a neighbour of what has grown joins it with a chance in proportion to its
/// potential to the power `eta`. Growth ends where it touches an endpoint.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DbmSpec {
    /// How direct it is: 0 is a compact Eden cluster, 1 a bushy Lichtenberg figure, 4 hardly branches.
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = 20.0))]
    pub eta: f64,
    /// Nodes that grow at most.
    #[serde(default = "many")]
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// How potentials are found.
    #[serde(default)]
    pub solver: Solver,
}

/// How potentials are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Laplace's equation on the lattice (Kim and Lin 2004, section 4): about every node that grows, and everywhere after every
    /// sixteenth, by conjugate gradients with multigrid. Endpoints have potential 1, borders insulate.
    #[default]
    Grid,
    /// Point charges in free space, without a grid (Kim, Sewall, Sud and Lin 2007): fast, but endpoints attract nothing.
    Charges,
}

fn one() -> f64 {
    1.0
}

fn many() -> u32 {
    20_000
}

/// Diffusion-limited aggregation around the generators, until there are so many particles; those that would stay beyond the
/// space's border are lost.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DlaSpec {
    /// Particles that stay; fewer where the space is full.
    #[schemars(range(min = 1, max = 10_000_000))]
    pub particles: u32,
    /// Do they walk along the lattice? Otherwise anywhere, as discs (balls) as wide as its spacing.
    #[serde(default = "yes")]
    pub lattice: bool,
    /// How they walk.
    #[serde(default)]
    pub walk: Walk,
}

fn yes() -> bool {
    true
}

/// How particles walk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Walk {
    /// Steps as long as the way is free, from just outside of what has grown.
    #[default]
    Fast,
    /// As the books have it: from the border of the space, a step of the lattice at a time.
    Textbook,
}
