//! Growth by least-cost paths: to endpoints, by fractal placement, refined; and endpoints by grammar.

mod fractal;
mod fractal_spec;
mod grammar;
mod plain;
mod refine;
mod refine_spec;

pub(super) use fractal::FRACTAL;
pub use fractal_spec::{FractalSpec, Vicinity};
pub use grammar::{GrammarError, GrammarSpec};
pub use plain::Paths;
pub(super) use refine::refined;
pub use refine_spec::{Refine, RefineError, RefineSpec};
