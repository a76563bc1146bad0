//! Growth by a voxel space automaton (Greene 1989).

mod automaton;
mod light;
mod neighbourhood;
mod resolve;
mod spec;

pub use automaton::{Automaton, Cling};
pub use light::LightSense;
pub(super) use resolve::{RULES, resolve};
pub use spec::{AgeBranchesSpec, ClingSpec, KeepFromSpec, LightSenseSpec, SunSpec, VoxelsSpec};
