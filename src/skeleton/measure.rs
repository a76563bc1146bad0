//! What figures claim of a skeleton, as numbers.

use std::collections::BTreeMap;

use rand::RngExt;
use serde::Serialize;

use super::{Orders, Path, Skeleton, dimension};
use crate::math::{DVec3, Stream};

/// Numbers that describe a skeleton's form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measurement {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of paths, one an endpoint.
    pub endpoints: usize,
    /// Total length of all segments, in scene units.
    pub length: f64,
    /// Mean over the paths of their length over the straight distance between their ends: 1 is straight.
    pub tortuosity: f64,
    /// Mean distance of the segments from the upright line through the root, weighted by length, in scene units.
    pub offset: f64,
    /// Mean height of the segments above the root as a share of the greatest, weighted by length.
    pub height: f64,
    /// Mean height of the forks above the root as a share of the greatest height.
    pub fork_height: f64,
    /// Greatest distance from the upright line through the root over the greatest height.
    pub spread: f64,
    /// Length of the limb that starts at the root up to its first fork, as a share of the greatest height.
    pub trunk: f64,
    /// How far the lowest end of a path lies below the root, in scene units.
    pub depth: f64,
    /// Share of the paths that end lower than the root of their graph.
    pub falling: f64,
    /// The greatest radius, in scene units.
    pub radius: f64,
    /// The greatest radius over the mean radius of the ends of paths.
    pub taper: f64,
    /// Box-counting dimension.
    pub dimension: f64,
    /// How many directions hold at least a hundredth of the length each, by tens of degrees, seen along z.
    pub directions: usize,
    /// Standard deviation over mean of the lengths of ways from a root to an end from which nothing grew on.
    pub length_variation: f64,
    /// How much room there is between ends: the mean distance of the middle between two of them from the nearest end, over
    /// the mean distance of two. Where ends fill a volume it is small, where they stand in clusters large.
    pub gaps: f64,
    /// How far apart ends and the roots of their graphs are, each level over the one before (geometric mean).
    pub level_ratio: f64,
    /// Mean place of the ends along x, as a share of the greatest distance from the upright line through the root.
    pub lean: f64,
    /// The highest order of Strahler.
    pub strahler: usize,
    /// Number of streams of an order over that of the next (Horton; geometric mean).
    pub bifurcation: f64,
    /// Mean length of a stream of the first order: a twig, in scene units.
    pub twig: f64,
}

/// Measures `skeleton`, from its first root; the last axis that it extends along is up.
#[must_use]
pub fn measure(skeleton: &Skeleton) -> Measurement {
    measure_from(skeleton, None)
}

/// [`measure`] from `foot`, where the plant starts that `skeleton` belongs to.
#[must_use]
pub fn measure_from(skeleton: &Skeleton, foot: Option<DVec3>) -> Measurement {
    let Some(root) = foot.or(skeleton.nodes.first().map(|n| n.position)) else {
        return Measurement::default();
    };
    let is_flat = skeleton.nodes.iter().all(|n| n.position.z == root.z);
    let height = |p: DVec3| if is_flat { p.y - root.y } else { p.z - root.z };
    let offset = |p: DVec3| {
        let d = p - root;
        if is_flat { d.x.abs() } else { libm::sqrt(d.x * d.x + d.y * d.y) }
    };
    let mut along = vec![0.0; skeleton.nodes.len()];
    let mut start: Vec<u32> = (0..skeleton.nodes.len() as u32).collect();
    let (mut length, mut offsets, mut heights) = (0.0, 0.0, 0.0);
    for (i, node) in skeleton.nodes.iter().enumerate() {
        let Some(p) = node.parent.map(|p| p as usize) else { continue };
        let from = skeleton.nodes[p].position;
        let step = (node.position - from).length();
        let middle = (node.position + from) * 0.5;
        along[i] = along[p] + step;
        start[i] = start[p];
        length += step;
        offsets += step * offset(middle);
        heights += step * height(middle);
    }
    let most =
        |f: &dyn Fn(DVec3) -> f64| skeleton.nodes.iter().map(|n| f(n.position)).fold(f64::MIN_POSITIVE, f64::max);
    // Of what grows downwards too.
    let top = most(&|p| height(p).abs());
    let ratios: Vec<f64> = skeleton
        .paths
        .iter()
        .filter_map(|path| {
            let end = path.end as usize;
            let from = skeleton.nodes[start[end] as usize].position;
            let straight = (skeleton.nodes[end].position - from).length();
            (straight > 0.0).then(|| along[end] / straight)
        })
        .collect();
    let children = skeleton.child_counts();
    let forks: Vec<usize> = (0..children.len()).filter(|&i| children[i] > 1).collect();
    let ends = || skeleton.paths.iter().map(|path| path.end as usize);
    let tips: f64 = ends().map(|i| skeleton.nodes[i].radius).sum();
    let radius = skeleton.nodes.iter().map(|n| n.radius).fold(0.0, f64::max);
    let falls = |path: &&Path| {
        let [end, root] = [path.end, path.root].map(|i| height(skeleton.nodes[i as usize].position));
        end < root
    };
    let mean = |sum: f64, count: usize| if count == 0 { 0.0 } else { sum / count as f64 };
    let share = |sum: f64| if length > 0.0 { sum / length } else { 0.0 };
    let orders = Orders::new(skeleton);
    let places: Vec<DVec3> = ends().map(|i| skeleton.nodes[i].position).collect();
    let widest = places.iter().map(|&p| offset(p)).fold(f64::MIN_POSITIVE, f64::max);
    let ways: Vec<f64> = skeleton.ends(false).map(|(end, _)| along[end as usize]).collect();
    Measurement {
        directions: directions(skeleton, length),
        length_variation: variation(&ways),
        gaps: gaps(&places),
        level_ratio: level_ratio(skeleton),
        lean: mean(places.iter().map(|p| p.x - root.x).sum(), places.len()) / widest,
        strahler: orders.highest(),
        bifurcation: orders.bifurcation(),
        twig: orders.lengths.first().copied().unwrap_or(0.0),
        nodes: skeleton.nodes.len(),
        endpoints: skeleton.paths.len(),
        length,
        tortuosity: mean(ratios.iter().sum(), ratios.len()),
        offset: share(offsets),
        height: share(heights) / top,
        fork_height: mean(forks.iter().map(|&i| height(skeleton.nodes[i].position)).sum(), forks.len()) / top,
        spread: most(&offset) / top,
        depth: -ends().map(|i| height(skeleton.nodes[i].position)).fold(0.0, f64::min),
        falling: mean(skeleton.paths.iter().filter(falls).count() as f64, skeleton.paths.len()),
        radius,
        taper: if tips > 0.0 { radius / mean(tips, skeleton.paths.len()) } else { 0.0 },
        dimension: dimension(&[skeleton]),
        trunk: forks.first().map_or(length, |&i| along[i]) / top,
    }
}

/// Standard deviation over mean; 0 of nothing.
fn variation(numbers: &[f64]) -> f64 {
    let count = numbers.len().max(1) as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let square = numbers.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
    if mean > 0.0 { libm::sqrt(square) / mean } else { 0.0 }
}

fn directions(skeleton: &Skeleton, length: f64) -> usize {
    let mut bins = [0.0; 36];
    for (from, to) in skeleton.segments() {
        let way = to.position - from.position;
        let turn = libm::atan2(way.y, way.x) / std::f64::consts::TAU + 1.0;
        bins[libm::floor(turn * 36.0 + 0.5) as usize % 36] += way.length();
    }
    bins.iter().filter(|&&sum| sum > length * 0.01).count()
}

/// Pairs of ends that [`gaps`] looks at.
const PAIRS: usize = 500;

fn gaps(places: &[DVec3]) -> f64 {
    let mut random = Stream::new(0, "gaps");
    let (mut room, mut apart) = (0.0, 0.0);
    for _ in 0..if places.len() > 1 { PAIRS } else { 0 } {
        let [a, b]: [DVec3; 2] = std::array::from_fn(|_| places[random.random_range(0..places.len())]);
        let middle = (a + b) * 0.5;
        let nearest = places.iter().map(|p| p.distance_squared(middle)).fold(f64::INFINITY, f64::min);
        room += libm::sqrt(nearest);
        apart += a.distance(b);
    }
    if apart > 0.0 { room / apart } else { 0.0 }
}

fn level_ratio(skeleton: &Skeleton) -> f64 {
    let mut reach: BTreeMap<u16, (f64, f64)> = BTreeMap::new();
    for path in &skeleton.paths {
        let [end, root] = [path.end, path.root].map(|i| &skeleton.nodes[i as usize]);
        let sum = reach.entry(end.level).or_default();
        *sum = (sum.0 + end.position.distance(root.position), sum.1 + 1.0);
    }
    let means: Vec<f64> = reach.values().map(|(sum, count)| sum / count).collect();
    match means[..] {
        [first, .., last] if first > 0.0 && last > 0.0 => {
            libm::exp(libm::log(last / first) / (means.len() as f64 - 1.0))
        }
        _ => 1.0,
    }
}
