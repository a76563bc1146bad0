//! What is measured of claims.

use std::cmp::Ordering;

use serde::Serialize;

use super::claim::{Claim, Claimed, Quantity};
use super::load::load_frame;
use super::loaded::{Loaded, Stage, grow_related};
use crate::geom::{Shape, Surface};
use crate::grow::{Grown, Regions, Step};
use crate::math::{DVec3, Memory, Progress, Ref};
use crate::skeleton::{Skeleton, apart, crossings, dimension, floating, measure_from, nearest, shared_ends};

impl Quantity {
    fn of(self, grown: &Grown, other: Option<&Grown>, shape: Option<&Shape>) -> f64 {
        let skeleton = &grown.skeleton;
        let with = other.map(|other| &other.skeleton);
        let m = measure_from(skeleton, grown.foot);
        let distances =
            |shape: &Shape| -> Vec<f64> { skeleton.nodes.iter().map(|n| shape.distance(n.position)).collect() };
        let least = |d: Vec<f64>| d.into_iter().fold(f64::INFINITY, f64::min);
        match self {
            Self::Directions => m.directions as f64,
            Self::LengthVariation => m.length_variation,
            Self::Gaps => m.gaps,
            Self::LevelRatio => m.level_ratio,
            Self::WidthExponent => m.width_exponent,
            Self::Lean => m.lean,
            Self::Strahler => m.strahler as f64,
            Self::Bifurcation => m.bifurcation,
            Self::Twig => m.twig,
            Self::GraphNodes => (grown.nodes + other.map_or(0, |other| other.nodes)) as f64,
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
            Self::Endpoints => (m.endpoints + with.map_or(0, |with| with.paths.len())) as f64,
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
    /// The quantity that was measured: its mean, where the claim is about several seeds.
    pub measured: f64,
    /// Standard deviation between these seeds; 0 where there is one.
    pub spread: f64,
    /// What it was held against, in words.
    pub against: String,
    /// Does the claim hold?
    pub holds: bool,
    /// How far within its bounds it is, as a share of the nearest one (of 1 where that is 0); below 0 where it does not hold.
    pub margin: f64,
}

/// Measures every claim on the steps that were grown; where claims are about several seeds, or about a frame, `scene` is grown for
/// these too.
///
/// # Errors
/// [`Stage`] of what is grown.
pub fn check_claims(
    scene: &Loaded,
    grown: &[Grown],
    memory: &Memory,
    progress: &Progress,
) -> Result<Vec<Finding>, Stage> {
    let mut readings: Vec<Vec<Reading>> = vec![Vec::new(); scene.claims.len()];
    let claims = || scene.claims.values().map(|claimed| &claimed.claim);
    let mut frames: Vec<Option<f64>> = claims().map(|claim| claim.frame).collect();
    frames.sort_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
    frames.dedup();
    let memory = &memory.beside(grown.iter().map(|step| step.bytes() as u64).sum());
    for frame in frames {
        let mut other = match frame {
            None => scene.clone(),
            Some(frame) => {
                let (source, overrides) = scene.origin();
                load_frame(source, overrides, Some(frame))?
            }
        };
        let most = claims().filter(|claim| claim.frame == frame).map(|claim| claim.seeds).max().unwrap_or(1);
        for i in 0..most {
            other.recipe.seed = scene.recipe.seed.wrapping_add(i.into());
            let is_asked = |claimed: &Claimed| claimed.claim.frame == frame && i < claimed.claim.seeds;
            let anew = if i == 0 && frame.is_none() {
                None
            } else {
                let asked = scene.claims.values().filter(|claimed| is_asked(claimed));
                let steps: Vec<usize> = asked.flat_map(|claimed| claimed.steps(&other.recipe.steps)).collect();
                Some(grow_related(&other, &steps, memory, progress)?)
            };
            let grown = anew.as_deref().unwrap_or(grown);
            for (readings, claimed) in readings.iter_mut().zip(scene.claims.values()) {
                if is_asked(claimed) {
                    readings.extend(reading(claimed, grown));
                }
            }
        }
    }
    let findings = scene.claims.iter().zip(&readings).filter(|(_, readings)| !readings.is_empty());
    Ok(findings.map(|((name, Claimed { claim, .. }), readings)| finding(name, claim, readings)).collect())
}

impl Claimed {
    /// The steps that it is about, by index.
    fn steps(&self, steps: &[Step]) -> Vec<usize> {
        // A shape may be what any of them grew.
        if self.shape.is_some() {
            return (0..steps.len()).collect();
        }
        let Claim { of, with, as_of, more_than, .. } = &self.claim;
        let named = [Some(of), with.as_ref(), as_of.as_ref(), more_than.as_ref()];
        let index = |name: &Ref<Step>| steps.iter().position(|step| step.name == name.name);
        named.into_iter().flatten().filter_map(index).collect()
    }
}

/// What was measured with one seed: of the claim's step, and of those that it is held against.
#[derive(Clone, Copy)]
struct Reading {
    measured: f64,
    same: f64,
    than: f64,
}

/// Measures a claim; nothing where a step was not grown.
fn reading(Claimed { claim, shape }: &Claimed, grown: &[Grown]) -> Option<Reading> {
    let solids = |i: usize| grown[i].regions.as_ref().map(Regions::solid);
    let step = |name: &Ref<Step>| grown.iter().find(|g| g.name == name.name);
    let shape = shape.as_ref().map(|shape| shape.with_grown(&solids));
    let with = claim.with.as_ref().and_then(step);
    let measure = |name: &Ref<Step>, with| step(name).map(|step| claim.measure.of(step, with, shape.as_ref()));
    // A bound that is not asked for is not read.
    let other = |name: &Option<Ref<Step>>| name.as_ref().map_or(Some(0.0), |name| measure(name, None));
    Some(Reading { measured: measure(&claim.of, with)?, same: other(&claim.as_of)?, than: other(&claim.more_than)? })
}

/// Holds the mean of what was measured against the bounds.
fn finding(name: &str, claim: &Claim, readings: &[Reading]) -> Finding {
    let n = readings.len() as f64;
    let mean = |part: fn(&Reading) -> f64| readings.iter().map(part).sum::<f64>() / n;
    let (measured, same, than) = (mean(|r| r.measured), mean(|r| r.same), mean(|r| r.than));
    let spread =
        libm::sqrt(readings.iter().map(|r| (r.measured - measured) * (r.measured - measured)).sum::<f64>() / n);
    let mut against = Vec::new();
    // How much room each bound leaves, and of what.
    let mut rooms = Vec::new();
    if let Some(least) = claim.at_least {
        against.push(format!("at least {least}"));
        rooms.push((measured - least, least));
    }
    if let Some(most) = claim.at_most {
        against.push(format!("at most {most}"));
        rooms.push((most - measured, most));
    }
    if let Some(other) = &claim.as_of {
        against.push(format!("{same:.4} of `{}` to {}", other.name, claim.within));
        rooms.push((claim.within - (measured - same).abs(), claim.within));
    }
    let mut holds = rooms.iter().all(|&(room, _)| room >= 0.0);
    if let Some(other) = &claim.more_than {
        against.push(format!("more than {} times {than:.4} of `{}`", claim.times, other.name));
        rooms.push((measured - than * claim.times, than * claim.times));
        holds &= measured > than * claim.times;
    }
    let share = |&(room, of): &(f64, f64)| room / if of == 0.0 { 1.0 } else { of.abs() };
    let margin = rooms
        .iter()
        .map(share)
        .fold(f64::INFINITY, |least, share| if share.is_nan() { f64::NEG_INFINITY } else { least.min(share) });
    if readings.len() > 1 {
        against.push(format!("mean of {n} seeds, deviation {spread:.4}"));
    }
    Finding {
        claim: name.to_owned(),
        says: claim.says.clone(),
        measured,
        spread,
        against: against.join(", "),
        holds: holds && !rooms.is_empty(),
        margin,
    }
}
