//! Measurements of a skeleton's form.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use rand::RngExt;
use serde::Serialize;

use super::{Orders, Path, Skeleton, dimension, width_exponent};
use crate::math::{DVec3, Stream};

/// Measurements of a skeleton's form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measurement {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of paths, one an endpoint.
    pub endpoints: usize,
    /// Total length of all segments, in scene units.
    pub length: f64,
    /// Mean over the paths of arc length over chord length: 1 is straight.
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
    /// Exponent of the radius over the length of the longest path to a tip ([`width_exponent`]).
    pub width_exponent: f64,
    /// Box-counting dimension.
    pub dimension: f64,
    /// How many directions hold at least a hundredth of the length each, by tens of degrees, seen along z.
    pub directions: usize,
    /// Coefficient of variation of the path lengths from a root to an end from which nothing grew.
    pub length_variation: f64,
    /// Mean distance of the midpoint of two ends from the nearest end, over the mean distance of two ends, and over what both are
    /// for as many ends at random in a ball (in the plane, in a disc): 1 there, more where ends form clusters or leave room.
    pub gaps: f64,
    /// Mean distance between ends and the roots of their graphs, each level over the one before (geometric mean).
    pub level_ratio: f64,
    /// Mean x of the ends, as a share of the greatest distance from the upright line through the root.
    pub lean: f64,
    /// The Strahler number.
    pub strahler: usize,
    /// Horton's bifurcation ratio (geometric mean).
    pub bifurcation: f64,
    /// Mean length of a stream of order 1, a twig, in scene units.
    pub twig: f64,
}

/// Measures `skeleton`, from its first root; the last axis that it extends along is up.
#[must_use]
pub fn measure(skeleton: &Skeleton) -> Measurement {
    measure_from(skeleton, None)
}

/// [`measure`] from `foot`, the root of the plant of which `skeleton` is a part.
#[must_use]
pub fn measure_from(skeleton: &Skeleton, foot: Option<DVec3>) -> Measurement {
    let Some(root) = foot.or(skeleton.nodes.first().map(|n| n.position)) else {
        return Measurement::default();
    };
    let axis = VerticalAxis { root, is_flat: skeleton.nodes.iter().all(|n| n.position.z == root.z) };
    let (height, offset) = (|p: DVec3| axis.height(p), |p: DVec3| axis.offset(p));
    let Lengths { along, start, length, offsets, heights } = Lengths::new(skeleton, &axis);
    let most =
        |f: &dyn Fn(DVec3) -> f64| skeleton.nodes.iter().map(|n| f(n.position)).fold(f64::MIN_POSITIVE, f64::max);
    // Absolute, for what grows downwards.
    let top = most(&|p| height(p).abs());
    let ratios = tortuosities(skeleton, &along, &start);
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
    let positions: Vec<DVec3> = ends().map(|i| skeleton.nodes[i].position).collect();
    let widest = positions.iter().map(|&p| offset(p)).fold(f64::MIN_POSITIVE, f64::max);
    let lengths: Vec<f64> = skeleton.ends(false).map(|(end, _)| along[end as usize]).collect();
    Measurement {
        directions: directions(skeleton, length),
        length_variation: variation(&lengths),
        gaps: gaps(&positions),
        level_ratio: level_ratio(skeleton),
        lean: mean(positions.iter().map(|p| p.x - root.x).sum(), positions.len()) / widest,
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
        width_exponent: width_exponent(skeleton),
        dimension: dimension(&[skeleton]),
        trunk: forks.first().map_or(length, |&i| along[i]) / top,
    }
}

/// The upright line through the root.
struct VerticalAxis {
    root: DVec3,
    /// Is the skeleton in the plane, with y up?
    is_flat: bool,
}

impl VerticalAxis {
    /// Height above the root.
    fn height(&self, p: DVec3) -> f64 {
        if self.is_flat { p.y - self.root.y } else { p.z - self.root.z }
    }

    /// Distance from the line.
    fn offset(&self, p: DVec3) -> f64 {
        let d = p - self.root;
        if self.is_flat { d.x.abs() } else { libm::sqrt(d.x * d.x + d.y * d.y) }
    }
}

/// Sums over the segments.
struct Lengths {
    /// Arc length from the root of its tree to each node.
    along: Vec<f64>,
    /// The root of each node's tree.
    start: Vec<u32>,
    /// The total length.
    length: f64,
    /// Integral of the offset over the length.
    offsets: f64,
    /// Integral of the height over the length.
    heights: f64,
}

impl Lengths {
    fn new(skeleton: &Skeleton, axis: &VerticalAxis) -> Self {
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
            offsets += step * axis.offset(middle);
            heights += step * axis.height(middle);
        }
        Self { along, start, length, offsets, heights }
    }
}

/// Arc length over chord length of each path that has a chord.
fn tortuosities(skeleton: &Skeleton, along: &[f64], start: &[u32]) -> Vec<f64> {
    let ratio = |path: &Path| {
        let end = path.end as usize;
        let from = skeleton.nodes[start[end] as usize].position;
        let chord = (skeleton.nodes[end].position - from).length();
        (chord > 0.0).then(|| along[end] / chord)
    };
    skeleton.paths.iter().filter_map(ratio).collect()
}

/// The coefficient of variation, standard deviation over mean; 0 of an empty list.
fn variation(numbers: &[f64]) -> f64 {
    let count = numbers.len().max(1) as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let square = numbers.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
    if mean > 0.0 { libm::sqrt(square) / mean } else { 0.0 }
}

/// [`Measurement::directions`].
fn directions(skeleton: &Skeleton, length: f64) -> usize {
    let mut bins = [0.0; 36];
    for (from, to) in skeleton.segments() {
        let segment = to.position - from.position;
        let turn = libm::atan2(segment.y, segment.x) / std::f64::consts::TAU + 1.0;
        bins[libm::floor(turn * 36.0 + 0.5) as usize % 36] += segment.length();
    }
    bins.iter().filter(|&&sum| sum > length * 0.01).count()
}

/// Pairs of ends sampled by [`gaps`].
const PAIRS: usize = 500;

/// [`Measurement::gaps`].
fn gaps(ends: &[DVec3]) -> f64 {
    let mut random = Stream::new(0, "gaps");
    let (mut room, mut apart) = (0.0, 0.0);
    for _ in 0..if ends.len() > 1 { PAIRS } else { 0 } {
        let [a, b]: [DVec3; 2] = std::array::from_fn(|_| ends[random.random_range(0..ends.len())]);
        let middle = (a + b) * 0.5;
        let nearest = ends.iter().map(|p| p.distance_squared(middle)).fold(f64::INFINITY, f64::min);
        room += libm::sqrt(nearest);
        apart += a.distance(b);
    }
    // At random in a ball of radius 1 the nearest of n is Gamma(4/3) / n^(1/3) away (Hertz 1909), two are 36/35 apart; in a disc
    // these are 1 / (2 sqrt(n)) times the root of pi, and 128 / (45 pi).
    let n = ends.len() as f64;
    let is_flat = ends.iter().all(|p| p.z == ends[0].z);
    let even = if is_flat {
        0.5 * libm::sqrt(PI / n) / (128.0 / (45.0 * PI))
    } else {
        0.892_979_511_569_249 / libm::cbrt(n) / (36.0 / 35.0)
    };
    if apart > 0.0 { room / apart / even } else { 0.0 }
}

/// [`Measurement::level_ratio`].
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Points at random in a ball or a disc around `centre`.
    fn scattered(count: usize, centre: DVec3, is_flat: bool, random: &mut Stream) -> Vec<DVec3> {
        let mut points = Vec::new();
        while points.len() < count {
            let p = DVec3::from_array(std::array::from_fn(|_| 2.0 * random.random::<f64>() - 1.0));
            let p = if is_flat { p.with_z(0.0) } else { p };
            if p.length() < 1.0 {
                points.push(p + centre);
            }
        }
        points
    }

    #[test]
    fn gaps_do_not_depend_on_how_many_ends_there_are() {
        let mut random = Stream::new(7, "ends");
        for is_flat in [false, true] {
            for count in [200, 2_000, 10_000] {
                let even = gaps(&scattered(count, DVec3::ZERO, is_flat, &mut random));
                assert!((even - 1.0).abs() < 0.1, "{count}: {even}");
                let mut two = scattered(count / 2, DVec3::X * 3.0, is_flat, &mut random);
                two.extend(scattered(count / 2, -DVec3::X * 3.0, is_flat, &mut random));
                assert!(gaps(&two) > 1.5, "{count}: {}", gaps(&two));
            }
        }
    }
}
