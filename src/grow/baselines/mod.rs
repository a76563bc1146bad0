//! What the papers compare their method with: dielectric breakdown and diffusion-limited aggregation.

mod dbm;
mod dla;
mod laplace;
mod multigrid;
mod spec;

pub(super) use spec::{DBM, DLA};
pub use spec::{DbmSpec, DlaSpec, SIDE, Solver, Walk};
