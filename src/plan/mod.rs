//! Least-cost paths: single-source shortest paths from generators to every node or to the wanted ones.
//!
//! Later stages need never handle a cycle: every node has one predecessor, chosen by cost and then by slot, so the
//! union of paths is a forest, and paths that meet never part. The result does not depend on the number of threads.

mod buckets;
mod cells;
mod error;
mod front;
mod mean;
mod routes;
mod search;
#[cfg(test)]
mod search_tests;
mod shared;
mod tree;

pub use error::PlanError;
pub use mean::mean_cost;
pub use routes::{Routes, routes};
pub use search::{Goal, bytes_needed, plan, plan_delayed, plan_from};
pub use tree::Plan;
