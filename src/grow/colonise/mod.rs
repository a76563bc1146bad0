//! Growth by space colonisation: limbs compete for attraction points (Runions, Lane and Prusinkiewicz 2007).

mod growth;
mod resolve;
mod spec;

pub(super) use resolve::{RULES, resolve};
pub use spec::{Colonise, ColoniseSpec};
