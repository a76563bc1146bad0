//! How a step is repeated, as a scene writes it: subgraphs around every end, their size and direction, how long ends
//! live, and what influences them (Xu and Mould 2012, sections 3.2 to 3.4).

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::ShapeSpec;
use crate::math::{Degrees, PerRound, Point};

/// Rounds of subgraphs: in each, every end that still lives gets a space of its own, with its own nodes and endpoints.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RepeatSpec {
    /// How many rounds at most.
    #[schemars(range(min = 1, max = 64))]
    pub times: u32,
    /// Size of the space around an end over that of the space as it is written (its spacing too).
    #[serde(default = "same")]
    pub size: PerRound,
    /// What counts the rounds for all numbers that differ by round.
    #[serde(default)]
    pub by: Index,
    /// Where the z of the space around an end points.
    #[serde(default)]
    pub orient: Orient,
    /// Turns of that direction, by name, in the order of their names.
    #[serde(default)]
    pub turn: BTreeMap<String, TurnSpec>,
    /// How many more rounds an end may sprout; by default as many as are left.
    #[serde(default)]
    pub lifespan: Option<LifespanSpec>,
    /// What favours some ends over others, by name.
    #[serde(default)]
    pub influence: BTreeMap<String, InfluenceSpec>,
}

fn same() -> PerRound {
    PerRound::All(1.0)
}

/// What counts the rounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Index {
    /// The rounds themselves.
    #[default]
    Round,
    /// How much of its lifespan an end has lost: short-lived ends sprout like those of later rounds.
    Lifespan,
}

/// The direction of a subgraph, v_g in the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Orient {
    /// The way from the previous subgraph's root to this one.
    #[default]
    Outward,
    /// Any, at random.
    Random,
    /// Straight up.
    Up,
    /// Straight down.
    Down,
    /// Along this vector.
    Along(Point),
}

/// A turn of a subgraph's direction: exactly one of `toward`, `along` and `from`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnSpec {
    /// Up or down (2012, Fig. 16, and Table 2).
    #[serde(default)]
    pub toward: Option<Upright>,
    /// Along this vector: to the light, with the wind.
    #[serde(default)]
    pub along: Option<Point>,
    /// Away from this shape: a wall.
    #[serde(default)]
    pub from: Option<ShapeSpec>,
    /// By how much, each round; never beyond its target.
    pub by: PerRound,
    /// With `from`: only where the end is no farther from the shape than this.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub within: Option<f64>,
}

/// Up or down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Upright {
    /// Up.
    Up,
    /// Down.
    Down,
}

/// How many more rounds an end may sprout (2012, section 3.3.3).
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LifespanSpec {
    /// Of the ends that the step starts from.
    #[schemars(range(min = 1, max = 64))]
    pub first: u32,
    /// How much shorter the lifespan of an end is than that of the end it sprouted from.
    #[serde(default)]
    pub loss: Loss,
}

/// How much shorter lifespans become.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Loss {
    /// By this many rounds.
    Constant(#[schemars(range(min = 1, max = 64))] u32),
    /// This share of the ends sprouts no more; the others lose a random part of what they have, rounded up, at least 1.
    /// The paper has 0.3.
    Random(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// By these numbers of rounds with these chances: `[[0.5, 1], [0.3, 2], [0.2, 9]]`, chances first; they add up to 1.
    Chances(#[schemars(length(min = 1))] Vec<[f64; 2]>),
}

impl Default for Loss {
    fn default() -> Self {
        Self::Constant(1)
    }
}

/// What favours some ends over others (2012, section 3.4): all ends of a round are ranked, and as many losses of
/// lifespan, counts of endpoints and sizes as there are ends are drawn and sorted; the best rank gets the least loss, the
/// greatest count and size, and so on.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InfluenceSpec {
    /// What ends are ranked by.
    pub rank: RankSpec,
    /// Counts are drawn from this least to this greatest number, in place of those of the endpoints.
    #[serde(default)]
    #[schemars(inner(range(min = 0, max = 1000)))]
    pub count: Option<[u32; 2]>,
    /// Losses of lifespan are drawn from this least to this greatest number of rounds.
    #[serde(default)]
    #[schemars(inner(range(min = 0, max = 64)))]
    pub loss: Option<[u32; 2]>,
    /// Sizes are drawn from this least to this greatest number, and multiply the size.
    #[serde(default)]
    #[schemars(inner(range(min = 0.01, max = 100.0)))]
    pub size: Option<[f64; 2]>,
}

/// What ends are ranked by.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RankSpec {
    /// The angle between the way of the end and this vector: the smaller the better. It points to the light, or with the
    /// wind.
    Angle(Point),
    /// The distance from this shape: the nearer the better. Water, say.
    Near(ShapeSpec),
    /// The distance from this shape: the farther the better. A wall, say.
    Far(ShapeSpec),
    /// How much of the sky it sees past everything that grew before: the more the better.
    Shade(ShadeSpec),
}

/// Light by shade: rays to the sky through all that the rounds before have grown, of every step.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShadeSpec {
    /// Limbs take away light up to this distance from them, in scene units: they stand for their leaves.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub clump: f64,
    /// Rays from each end.
    #[serde(default = "rays")]
    #[schemars(range(min = 1, max = 1024))]
    pub rays: u32,
    /// An end from which a larger share of the rays is blocked dies.
    #[serde(default = "all")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub dies: f64,
    /// Rays stay within this angle of the vertical.
    #[serde(default = "open")]
    #[schemars(range(min = 1.0, max = 90.0))]
    pub open: Degrees,
}

fn rays() -> u32 {
    32
}

fn all() -> f64 {
    1.0
}

fn open() -> Degrees {
    Degrees(75.0)
}
