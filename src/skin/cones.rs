//! Round cones and spheres along limbs.

use crate::math::{DVec3, tolerance::INVISIBLE_RADIUS};
use crate::model::{Ball, Body, BodyError, Digits, Limbs, Object, to_world};
use crate::skeleton::{Skeleton, overlap, overlap_count};

/// Spheres stand no further apart than this share of the smaller radius: their union then dips by 3 % of it.
const SPHERE_GAP: f64 = 0.5;
/// Most spheres to a segment: a twig thinner than this allows is far below a pixel.
const MOST_SPHERES: u32 = 256;

/// A round cone along each segment of `skeletons`, with the first root as the foot, moved by `offset` (in scene space).
///
/// # Errors
/// [`BodyError`].
pub fn cones(
    name: &str,
    skeletons: &[&Skeleton],
    is_flat: bool,
    offset: DVec3,
    material: usize,
) -> Result<Object, BodyError> {
    let root = foot(skeletons).ok_or(BodyError::Empty)?;
    let (limbs, digits) = limbs(skeletons, root, is_flat, true)?;
    Ok(Object::new(name, Body::Limbs(limbs), to_world(root + offset, is_flat), digits, material))
}

/// As [`cones`], but a sphere at each node, with more between them until they overlap (Xu and Mould 2008, section 4).
///
/// # Errors
/// [`BodyError`].
pub fn spheres(
    name: &str,
    skeletons: &[&Skeleton],
    is_flat: bool,
    offset: DVec3,
    material: usize,
) -> Result<Object, BodyError> {
    let root = foot(skeletons).ok_or(BodyError::Empty)?;
    let dense: Vec<Skeleton> = skeletons.iter().map(|s| overlap(s, SPHERE_GAP, MOST_SPHERES)).collect();
    let (limbs, digits) = limbs(&dense.iter().collect::<Vec<_>>(), root, is_flat, false)?;
    Ok(Object::new(name, Body::Limbs(limbs), to_world(root + offset, is_flat), digits, material))
}

/// The foot of an object made of `skeletons`: their first root.
#[must_use]
pub fn foot(skeletons: &[&Skeleton]) -> Option<DVec3> {
    skeletons.iter().find_map(|s| s.nodes.first()).map(|node| node.position)
}

/// How many spheres [`spheres`] has for `skeleton`.
pub(super) fn count_overlapping(skeleton: &Skeleton) -> u64 {
    overlap_count(skeleton, SPHERE_GAP, MOST_SPHERES)
}

/// A ball for each node, measured from `root`, and with `joined` a segment to its parent.
fn limbs(skeletons: &[&Skeleton], root: DVec3, is_flat: bool, joined: bool) -> Result<(Limbs, Digits), BodyError> {
    let size = skeletons
        .iter()
        .flat_map(|s| &s.nodes)
        .map(|n| (n.position - root).abs().max_element() + n.radius)
        .fold(0.0, f64::max);
    BodyError::check_size(size)?;
    let digits = Digits::for_size(size);
    let nodes = skeletons.iter().map(|s| s.nodes.len()).sum::<usize>();
    BodyError::check_count(nodes * (1 + usize::from(joined)))?;
    let mut limbs = Limbs { balls: Vec::with_capacity(nodes), ..Limbs::default() };
    let mut branches = 0;
    for skeleton in skeletons {
        let first = limbs.balls.len() as u32;
        for (node, at) in skeleton.nodes.iter().zip(first..) {
            limbs.balls.push(Ball {
                centre: digits.round_point(to_world(node.position - root, is_flat)),
                radius: digits.round(node.radius).max(INVISIBLE_RADIUS * 2.0),
                cost: node.cost,
                branch: branches + node.branch,
                level: node.level,
            });
            if let (true, Some(parent)) = (joined, node.parent) {
                limbs.segments.push([first + parent, at]);
            }
        }
        branches += skeleton.nodes.iter().map(|n| n.branch + 1).max().unwrap_or(0);
    }
    Ok((limbs, digits))
}
