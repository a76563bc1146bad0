//! Repeated steps: subgraphs around every end, round after round, and what favours some ends over others.

mod growth;
mod influence;
mod light;
mod repeat;
mod resolve;
mod spec;

pub use growth::Rounds;
pub use influence::{Influence, Rank};
pub use light::{Canopy, sky};
pub use repeat::{Repeat, Target, Turn};
pub(super) use resolve::{indices, resolve};
pub use spec::{Index, InfluenceSpec, LifespanSpec, Loss, Orient, RankSpec, RepeatSpec, ShadeSpec, TurnSpec, Upright};
