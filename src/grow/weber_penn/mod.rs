//! Growth by the parameters of Weber and Penn (1995): every stem a curve, whose length, number and angles its level decides.

mod growth;
mod resolve;
mod spec;
mod stem;

pub(super) use resolve::{RULES, resolve};
pub use spec::{CrownShape, StemSpec, WeberPennSpec};
