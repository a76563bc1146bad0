//! How much is expected to grow by segments, before it does.

use super::values::{Branches, Segments};
use crate::grow::grown::{MOST_NODES, NODE_BYTES};

/// How much is expected to grow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// Nodes, with those where limbs start.
    pub nodes: f64,
    /// Ends.
    pub ends: f64,
}

impl Expected {
    /// From so many starts, with so many branches of a node on the average: `(1 + branches)^depth` ends for each, and what lies
    /// between. Where limbs sprout, the first time there are so many in place of what grows on.
    #[must_use]
    pub fn new(starts: f64, depth: u32, sprout: Option<f64>, branches: f64) -> Self {
        let mut all = Self { nodes: starts, ends: starts };
        for place in 0..depth {
            all.ends = f64::min(all.ends * sprout.filter(|_| place == 0).unwrap_or(1.0 + branches), f64::MAX);
            all.nodes = f64::min(all.nodes + all.ends, f64::MAX);
        }
        all
    }
}

/// More is expected to grow than there may be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{nodes:.2e} nodes are to be expected ({starts:.0} starts with {each} ends each), more than {MOST_NODES}: lower `depth`, `most` or `chance`"
)]
pub struct TooMany {
    /// Nodes that are to be expected.
    pub nodes: f64,
    /// Limbs that start.
    pub starts: f64,
    /// Ends of each, as a product.
    pub each: String,
}

impl Segments {
    /// How much grows from so many starts, on the average.
    #[must_use]
    pub fn expected(&self, starts: f64) -> Expected {
        let mean = |branches: Branches| f64::from(branches.most) * branches.chance;
        Expected::new(starts, self.depth, self.sprout.map(mean), self.branches.map_or(0.0, mean))
    }

    /// Bytes that this takes.
    pub(super) fn bytes_for(&self, starts: f64) -> u64 {
        self.expected(starts).nodes.min(MOST_NODES as f64) as u64 * NODE_BYTES
    }

    /// How much grows from so many starts, if there may be as much.
    ///
    /// # Errors
    /// [`TooMany`].
    pub fn check(&self, starts: f64) -> Result<Expected, TooMany> {
        let expected = self.expected(starts);
        if expected.nodes <= MOST_NODES as f64 {
            return Ok(expected);
        }
        let mean = |b: &Branches| format!("{} * {}", b.most, b.chance);
        let depth = self.depth - u32::from(self.sprout.is_some());
        let sprouts = self.sprout.as_ref().map(mean);
        let branching = self.branches.as_ref().map(|b| format!("(1 + {})^{depth}", mean(b)));
        let each: Vec<String> = sprouts.into_iter().chain(branching).collect();
        let each = if each.is_empty() { "1".to_owned() } else { each.join(" * ") };
        Err(TooMany { nodes: expected.nodes, starts, each })
    }
}
