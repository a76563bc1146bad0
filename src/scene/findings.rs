//! What is measured of claims.

use serde::Serialize;

use super::claim::{Claimed, Quantity};
use super::loaded::Loaded;
use crate::geom::{Shape, Surface};
use crate::grow::{Grown, Regions, Step};
use crate::math::{DVec3, Ref};
use crate::skeleton::{Skeleton, apart, crossings, dimension, floating, measure_from, nearest, shared_ends};

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
    /// How far within its bounds it is, as a share of the nearest one (of 1 where that is 0); below 0 where it does not hold.
    pub margin: f64,
}

/// Measures every claim on the steps that were grown.
#[must_use]
pub fn check_claims(scene: &Loaded, grown: &[Grown]) -> Vec<Finding> {
    let solids = |i: usize| grown[i].regions.as_ref().map(Regions::solid);
    let step = |name: &Ref<Step>| grown.iter().find(|g| g.name == name.name);
    let findings = scene.claims.iter().filter_map(|(name, Claimed { claim, shape })| {
        let with = claim.with.as_ref().and_then(step).map(|g| &g.skeleton);
        let shape = shape.as_ref().map(|shape| shape.with_grown(&solids));
        let measure = |step: &Grown, with| claim.measure.of(step, with, shape.as_ref());
        let measured = measure(step(&claim.of)?, with);
        let mut against = Vec::new();
        let mut holds = true;
        let mut margin = f64::INFINITY;
        let mut within = |room: f64, of: f64| {
            let share = room / if of == 0.0 { 1.0 } else { of.abs() };
            margin = if share.is_nan() { f64::NEG_INFINITY } else { margin.min(share) };
        };
        if let Some(least) = claim.at_least {
            against.push(format!("at least {least}"));
            holds &= measured >= least;
            within(measured - least, least);
        }
        if let Some(most) = claim.at_most {
            against.push(format!("at most {most}"));
            holds &= measured <= most;
            within(most - measured, most);
        }
        if let Some(other) = &claim.as_of {
            let same = measure(step(other)?, None);
            against.push(format!("{same:.4} of `{}` to {}", other.name, claim.within));
            holds &= (measured - same).abs() <= claim.within;
            within(claim.within - (measured - same).abs(), claim.within);
        }
        if let Some(other) = &claim.more_than {
            let than = measure(step(other)?, None);
            against.push(format!("more than {} times {than:.4} of `{}`", claim.times, other.name));
            holds &= measured > than * claim.times;
            within(measured - than * claim.times, than * claim.times);
        }
        Some(Finding {
            claim: name.clone(),
            says: claim.says.clone(),
            measured,
            against: against.join(", "),
            holds: holds && !against.is_empty(),
            margin,
        })
    });
    findings.collect()
}
