//! What figures claim of a skeleton, as numbers.

use serde::Serialize;

use super::{Skeleton, dimension};
use crate::math::DVec3;

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
    /// Share of the paths that end lower than they start.
    pub falling: f64,
    /// The greatest radius, in scene units.
    pub radius: f64,
    /// The greatest radius over the mean radius of the ends of paths.
    pub taper: f64,
    /// Box-counting dimension.
    pub dimension: f64,
}

/// Measures `skeleton`; the last axis that it extends along is up.
#[must_use]
pub fn measure(skeleton: &Skeleton) -> Measurement {
    let Some(root) = skeleton.nodes.first().map(|n| n.position) else {
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
    let falls = |&i: &usize| height(skeleton.nodes[i].position) < height(skeleton.nodes[start[i] as usize].position);
    let mean = |sum: f64, count: usize| if count == 0 { 0.0 } else { sum / count as f64 };
    let share = |sum: f64| if length > 0.0 { sum / length } else { 0.0 };
    Measurement {
        nodes: skeleton.nodes.len(),
        endpoints: skeleton.paths.len(),
        length,
        tortuosity: mean(ratios.iter().sum(), ratios.len()),
        offset: share(offsets),
        height: share(heights) / top,
        fork_height: mean(forks.iter().map(|&i| height(skeleton.nodes[i].position)).sum(), forks.len()) / top,
        spread: most(&offset) / top,
        depth: -ends().map(|i| height(skeleton.nodes[i].position)).fold(0.0, f64::min),
        falling: mean(ends().filter(falls).count() as f64, skeleton.paths.len()),
        radius,
        taper: if tips > 0.0 { radius / mean(tips, skeleton.paths.len()) } else { 0.0 },
        dimension: dimension(&[skeleton]),
        trunk: forks.first().map_or(length, |&i| along[i]) / top,
    }
}
