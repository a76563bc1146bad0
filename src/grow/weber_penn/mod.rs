//! Growth by the parameters of Weber and Penn (1995): every stem a curve, whose length, number and angles its level decides.

mod growth;
mod spec;
mod stem;

pub use spec::{CrownShape, StemSpec, WeberPennSpec};
pub(super) use spec::{RULES, resolve};
