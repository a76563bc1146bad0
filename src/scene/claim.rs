//! Claims: what a figure shows, as numbers.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Resolved;
use super::resolve::Resolver;
use crate::geom::{Shape, ShapeSpec, Surface};
use crate::grow::{Grown, Regions, Step};
use crate::math::{DVec3, Ref};
use crate::skeleton::{Skeleton, apart, crossings, dimension, floating, measure_from, nearest, shared_ends};

/// A claim about a step: one quantity, and what it is held against.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// The claim in words.
    pub says: String,
    /// What is measured.
    pub measure: Quantity,
    /// The step that it is measured of.
    pub of: Ref<Step>,
    /// It is at least this.
    #[serde(default)]
    pub at_least: Option<f64>,
    /// It is at most this.
    #[serde(default)]
    pub at_most: Option<f64>,
    /// It is more than the same quantity of this step.
    #[serde(default)]
    pub more_than: Option<Ref<Step>>,
    /// It is as much as the same quantity of this step, to `within`.
    #[serde(default)]
    pub as_of: Option<Ref<Step>>,
    /// The greatest difference from that of `as_of`.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub within: f64,
    /// It is more than the other by at least this factor.
    #[serde(default = "one")]
    #[schemars(range(min = 1.0, max = 1e6))]
    pub times: f64,
    /// For `shared`, `floating`, `crossings`, `apart`, `nearest` and `dimension`: the other step.
    #[serde(default)]
    pub with: Option<Ref<Step>>,
    /// For `nearest`, `farthest` and `inside`: the shape.
    #[serde(default)]
    pub shape: Option<ShapeSpec>,
}

/// A claim whose shape is resolved.
#[derive(Clone, Debug)]
pub struct Claimed {
    /// The claim.
    pub claim: Claim,
    /// Its shape.
    pub shape: Option<Shape>,
}

fn one() -> f64 {
    1.0
}

/// What a claim measures: fields of [`crate::skeleton::Measurement`], and how two steps lie to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Number of paths.
    Endpoints,
    /// Total length of all limbs.
    Length,
    /// Mean length of a path over the straight distance between its ends.
    Tortuosity,
    /// Mean distance of the limbs from the upright line through the root.
    Offset,
    /// Mean height of the limbs, as a share of the greatest.
    Height,
    /// Mean height of the forks, as a share of the greatest height.
    ForkHeight,
    /// Greatest distance from the upright line through the root, over the greatest height.
    Spread,
    /// Length up to the first fork, as a share of the greatest height.
    Trunk,
    /// Number of nodes of the skeleton.
    Nodes,
    /// How far the lowest end lies below the root.
    Depth,
    /// Share of the paths that end lower than they start.
    Falling,
    /// The greatest radius.
    Radius,
    /// The greatest radius over the mean one at the ends.
    Taper,
    /// Box-counting dimension, with the step `with` where there is one.
    Dimension,
    /// Share of the step's endpoints that are endpoints of the step `with` too.
    Shared,
    /// Number of limbs that do not start on the step `with`.
    Floating,
    /// How often limbs cross those of the step `with`; without it, each other.
    Crossings,
    /// The greatest distance from the limbs of the step `with`.
    Apart,
    /// The least distance of a node from `shape`, negative inside of it, or from the limbs of the step `with`.
    Nearest,
    /// The greatest distance of a node from `shape`.
    Farthest,
    /// The share of the nodes that lie in `shape`.
    Inside,
    /// How many directions limbs take in the plane.
    Directions,
    /// How different ways to the ends are in length.
    LengthVariation,
    /// How much room there is between ends.
    Gaps,
    /// How long the paths of a level are, over those of the level before.
    LevelRatio,
    /// How far to the right (along x) ends are, as a share of how far they spread.
    Lean,
    /// The order of Strahler.
    Strahler,
    /// Limbs of an order over those of the next (Horton).
    Bifurcation,
    /// Mean length of the limbs of the first order.
    Twig,
    /// Nodes of the graph.
    GraphNodes,
    /// Edges of the graph for each of its nodes.
    EdgesPerNode,
    /// Endpoints that no path reached.
    Dropped,
    /// Number of trees: nodes where growth began.
    Trees,
    /// The share of all nodes that the largest tree has.
    LargestShare,
    /// How far it is from looking the same after a sixth of a turn about its middle, as a share of its greatest extent.
    SixfoldError,
    /// Of regions: their number.
    Surfaces,
    /// Of regions: 1 where all their surfaces are closed, consistently oriented 2-manifolds, else 0.
    Closed,
    /// Of regions: the least share that one has of the ball around it.
    Compactness,
    /// Of regions: the mean of the surface of one over that of a ball with its volume.
    Roughness,
}

impl Quantity {
    fn of(self, grown: &Grown, with: Option<&Skeleton>, shape: Option<&Shape>) -> f64 {
        let skeleton = &grown.skeleton;
        let m = measure_from(skeleton, grown.foot);
        let distances =
            |shape: &Shape| -> Vec<f64> { skeleton.nodes.iter().map(|n| shape.distance(n.position)).collect() };
        let least = |d: Vec<f64>| d.into_iter().fold(f64::INFINITY, f64::min);
        match self {
            Self::Directions => m.directions as f64,
            Self::LengthVariation => m.length_variation,
            Self::Gaps => m.gaps,
            Self::LevelRatio => m.level_ratio,
            Self::Lean => m.lean,
            Self::Strahler => m.strahler as f64,
            Self::Bifurcation => m.bifurcation,
            Self::Twig => m.twig,
            Self::GraphNodes => grown.nodes as f64,
            Self::EdgesPerNode => grown.edges as f64 / grown.nodes.max(1) as f64,
            Self::Dropped => grown.dropped as f64,
            Self::Trees => trees(skeleton).len() as f64,
            Self::LargestShare => {
                trees(skeleton).into_iter().max().unwrap_or(0) as f64 / skeleton.nodes.len().max(1) as f64
            }
            Self::SixfoldError => {
                let root = skeleton.nodes.first().map_or(DVec3::ZERO, |n| n.position);
                let extent = skeleton.nodes.iter().map(|n| (n.position - root).length()).fold(1e-12, f64::max);
                skeleton.asymmetry(6) / extent
            }
            Self::Surfaces => surfaces(grown).len() as f64,
            Self::Closed => {
                let is_closed = |surface: &Surface| surface.is_closed_manifold() && surface.volume() > 0.0;
                f64::from(u8::from(!surfaces(grown).is_empty() && surfaces(grown).iter().all(is_closed)))
            }
            Self::Compactness => surfaces(grown).iter().map(compactness).fold(1.0, f64::min),
            Self::Roughness => {
                let all = surfaces(grown);
                all.iter().map(roughness).sum::<f64>() / all.len().max(1) as f64
            }
            Self::Endpoints => m.endpoints as f64,
            Self::Length => m.length,
            Self::Tortuosity => m.tortuosity,
            Self::Offset => m.offset,
            Self::Height => m.height,
            Self::ForkHeight => m.fork_height,
            Self::Spread => m.spread,
            Self::Trunk => m.trunk,
            Self::Nodes => m.nodes as f64,
            Self::Depth => m.depth,
            Self::Falling => m.falling,
            Self::Radius => m.radius,
            Self::Taper => m.taper,
            // Without the other step these hold nothing: no claim is met.
            Self::Shared => with.map_or(0.0, |with| shared_ends(skeleton, with)),
            Self::Floating => with.map_or(f64::INFINITY, |with| floating(skeleton, with) as f64),
            Self::Apart => with.map_or(f64::INFINITY, |with| apart(skeleton, with)),
            Self::Dimension => with.map_or(m.dimension, |with| dimension(&[skeleton, with])),
            Self::Crossings => crossings(skeleton, with.unwrap_or(skeleton)) as f64,
            Self::Nearest => match (shape, with) {
                (Some(shape), _) => least(distances(shape)),
                (None, with) => with.map_or(f64::NAN, |with| nearest(skeleton, with)),
            },
            Self::Farthest => {
                shape.map_or(f64::NAN, |shape| -least(distances(shape).into_iter().map(|d| -d).collect()))
            }
            Self::Inside => shape.map_or(f64::NAN, |shape| {
                let count = distances(shape).into_iter().filter(|&d| d <= 0.0).count();
                count as f64 / skeleton.nodes.len().max(1) as f64
            }),
        }
    }
}

/// The number of nodes of each tree.
fn trees(skeleton: &Skeleton) -> Vec<usize> {
    let mut tree: Vec<usize> = Vec::with_capacity(skeleton.nodes.len());
    let mut counts = Vec::new();
    for node in &skeleton.nodes {
        let own = node.parent.map_or_else(
            || {
                counts.push(0);
                counts.len() - 1
            },
            |parent| tree[parent as usize],
        );
        counts[own] += 1;
        tree.push(own);
    }
    counts
}

/// The surfaces of a step by regions.
fn surfaces(grown: &Grown) -> &[Surface] {
    grown.regions.as_ref().map_or(&[], |regions| &regions.surfaces)
}

fn compactness(surface: &Surface) -> f64 {
    let centre = surface.points.iter().copied().sum::<DVec3>() / surface.points.len().max(1) as f64;
    let reach = surface.points.iter().map(|p| (*p - centre).length()).fold(1e-12, f64::max);
    surface.volume() / (4.0 / 3.0 * std::f64::consts::PI * reach * reach * reach)
}

fn roughness(surface: &Surface) -> f64 {
    let radius = libm::cbrt(surface.volume() * 0.75 / std::f64::consts::PI);
    surface.area() / (4.0 * std::f64::consts::PI * radius * radius)
}

/// What was found of a claim.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The claim's name.
    pub claim: String,
    /// The claim in words.
    pub says: String,
    /// The quantity that was measured.
    pub measured: f64,
    /// What it was held against, in words.
    pub against: String,
    /// Does the claim hold?
    pub holds: bool,
}

impl Resolver<'_> {
    /// The claims, with their shapes.
    pub(super) fn claims(&mut self) -> Option<BTreeMap<String, Claimed>> {
        let mut claims = BTreeMap::new();
        for (name, claim) in &self.scene.claim {
            let place = format!("claim.{name}");
            for (key, step) in [
                ("of", Some(&claim.of)),
                ("more_than", claim.more_than.as_ref()),
                ("as_of", claim.as_of.as_ref()),
                ("with", claim.with.as_ref()),
            ] {
                if let Some(step) = step {
                    self.find(&format!("{place}.{key}"), "step", step, self.scene.grow.keys());
                }
            }
            let others = [claim.more_than.as_ref(), claim.as_of.as_ref()];
            if claim.at_least.is_none() && claim.at_most.is_none() && others.iter().all(Option::is_none) {
                self.wrong(&place, "a claim needs `at_least`, `at_most`, `more_than` or `as_of`".to_owned());
            }
            let is_short = match claim.measure {
                Quantity::Farthest | Quantity::Inside => claim.shape.is_none(),
                Quantity::Nearest => claim.shape.is_none() && claim.with.is_none(),
                _ => false,
            };
            if is_short {
                self.wrong(&place, "this is measured from a `shape`".to_owned());
            }
            let shape = match &claim.shape {
                Some(shape) => Some(self.shape(&format!("{place}.shape"), shape)?),
                None => None,
            };
            claims.insert(name.clone(), Claimed { claim: claim.clone(), shape });
        }
        Some(claims)
    }
}

/// Measures every claim on the steps that were grown.
#[must_use]
pub fn check_claims(scene: &Resolved, grown: &[Grown]) -> Vec<Finding> {
    let solids = |i: usize| grown[i].regions.as_ref().map(Regions::solid);
    let step = |name: &Ref<Step>| grown.iter().find(|g| g.name == name.name);
    let findings = scene.claims.iter().filter_map(|(name, Claimed { claim, shape })| {
        let with = claim.with.as_ref().and_then(step).map(|g| &g.skeleton);
        let shape = shape.as_ref().map(|shape| shape.with_grown(&solids));
        let measure = |step: &Grown, with| claim.measure.of(step, with, shape.as_ref());
        let measured = measure(step(&claim.of)?, with);
        let mut against = Vec::new();
        let mut holds = true;
        if let Some(least) = claim.at_least {
            against.push(format!("at least {least}"));
            holds &= measured >= least;
        }
        if let Some(most) = claim.at_most {
            against.push(format!("at most {most}"));
            holds &= measured <= most;
        }
        if let Some(other) = &claim.as_of {
            let same = measure(step(other)?, None);
            against.push(format!("{same:.4} of `{}` to {}", other.name, claim.within));
            holds &= (measured - same).abs() <= claim.within;
        }
        if let Some(other) = &claim.more_than {
            let than = measure(step(other)?, None);
            against.push(format!("more than {} times {than:.4} of `{}`", claim.times, other.name));
            holds &= measured > than * claim.times;
        }
        Some(Finding {
            claim: name.clone(),
            says: claim.says.clone(),
            measured,
            against: against.join(", "),
            holds: holds && !against.is_empty(),
        })
    });
    findings.collect()
}
