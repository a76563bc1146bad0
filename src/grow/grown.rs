//! What a step yields.

use super::regions::Regions;
use crate::geom::Mark;
use crate::math::DVec3;
use crate::skeleton::Skeleton;

/// More nodes of a skeleton than this are not made.
pub const MOST_NODES: u64 = 40_000_000;
/// Bytes that a node of a skeleton takes, with what is made of it.
pub(super) const NODE_BYTES: u64 = 256;

/// What a step yields.
#[derive(Clone, Debug, Default)]
pub struct Grown {
    /// The step's name.
    pub name: String,
    /// The union of its paths, with radii.
    pub skeleton: Skeleton,
    /// Where the plant starts that it belongs to, if it is a part of one.
    pub foot: Option<DVec3>,
    /// The level of its first round, counted through all steps before.
    pub first_level: u16,
    /// Nodes of the graph, or voxels that something is in.
    pub nodes: u64,
    /// Edges of the graph, each counted once.
    pub edges: u64,
    /// Nodes whose cost was settled.
    pub settled: u64,
    /// Endpoints that no path reached and that were dropped.
    pub dropped: usize,
    /// What construction drawings show, where asked for.
    pub marks: Vec<Mark>,
    /// What it grew in place of limbs.
    pub regions: Option<Regions>,
}

impl Grown {
    /// Bytes in memory, about.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let marks = self.marks.iter().map(|mark| size_of_val(&mark.line[..])).sum::<usize>();
        self.skeleton.bytes() + marks + self.regions.as_ref().map_or(0, Regions::bytes)
    }
}

/// Which part of a step others grow from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    All,
    /// The ends of its paths, but for those that grew on.
    Ends,
    /// The ends of all its paths, of every round.
    EveryEnd,
}

/// The places of a part of a skeleton.
pub(super) fn places(skeleton: &Skeleton, part: Part) -> Vec<DVec3> {
    match part {
        Part::All => skeleton.nodes.iter().map(|n| n.position).collect(),
        Part::Ends | Part::EveryEnd => {
            skeleton.ends(part == Part::EveryEnd).map(|(end, _)| skeleton.nodes[end as usize].position).collect()
        }
    }
}

/// What tells a place from any other.
pub(super) fn bits(p: DVec3) -> [u64; 3] {
    p.to_array().map(f64::to_bits)
}
