//! Leaves, fruit and blossom: one small mesh each, declared once and set along the ends of limbs.

use earcut::Earcut;
use rand::RngExt;
use schemars::JsonSchema;
use serde::Deserialize;

use super::skin::MOST_PRIMITIVES;
use super::{Digits, Mesh, Pose, SkinError};
use crate::grow::{Canopy, sky};
use crate::math::{DMat3, DVec2, DVec3, Degrees, Point, Ref, Stream, rotation, turned_toward};
use crate::model::Material;
use crate::skeleton::{Skeleton, SkeletonNode};

/// Rings and sectors of the ball that fruit are.
const BALL: [u32; 2] = [6, 10];

/// What grows along the ends of limbs.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeavesSpec {
    /// `oak`, `oval`, `maple`, `birch`, `willow`, `ivy`, `needle`, `frond`, `blossom`, `ball`; or an SVG file beside the scene,
    /// whose first closed outline is the leaf's, its stalk at the lowest point.
    #[schemars(length(min = 1))]
    pub shape: String,
    /// Length of a leaf, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub size: f64,
    /// How much sizes vary, as a share.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 0.9))]
    pub vary: f64,
    /// Leaves on each end of a limb.
    #[schemars(range(min = 1, max = 1000))]
    pub count: u32,
    /// The share of ends that bear any.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub share: f64,
    /// Length of the end over which they stand, in scene units; the first is at the tip.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub along: f64,
    /// Angle from the limb.
    #[serde(default = "spread")]
    #[schemars(range(min = 0.0, max = 180.0))]
    pub angle: Degrees,
    /// Angle around the limb from one to the next (phyllotaxis): 137.5 is the golden angle, 180 two rows, 90 crossed.
    #[serde(default = "golden")]
    #[schemars(range(min = 0.0, max = 360.0))]
    pub turn: Degrees,
    /// By how much they hang.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 180.0))]
    pub droop: Degrees,
    /// Leaves lie across this direction, their upper side that way: those of ivy away from the wall. By default the upper side
    /// faces up as far as the leaf's own way allows.
    #[serde(default)]
    pub facing: Option<Point>,
    /// How far the halves of a leaf are folded up along its middle.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 80.0))]
    pub fold: Degrees,
    /// Size by light.
    #[serde(default)]
    pub light: Option<LeafLight>,
    /// What they are made of.
    pub material: Ref<Material>,
}

/// Sizes by how much of the sky a leaf sees past the limbs of its object.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeafLight {
    /// Limbs take away light up to this distance from them, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub clump: f64,
    /// Size over the given one where all of the sky is hidden, and where none is.
    #[schemars(inner(range(min = 0.0, max = 10.0)))]
    pub sizes: [f64; 2],
}

fn whole() -> f64 {
    1.0
}

fn spread() -> Degrees {
    Degrees(50.0)
}

fn golden() -> Degrees {
    Degrees(137.507_764)
}

/// A leaf's mesh from its outline, whose lowest point is the stalk: of length 1 along y, z up, folded along its middle by
/// `fold` radians.
///
/// # Errors
/// A sentence where the outline encloses nothing.
pub fn leaf_mesh(outline: &[DVec2], fold: f64) -> Result<Mesh, String> {
    let foot =
        outline.iter().copied().reduce(|a, b| if b.y < a.y { b } else { a }).ok_or("the outline has no points")?;
    let top = outline.iter().map(|p| p.y - foot.y).fold(0.0, f64::max);
    if top <= 0.0 {
        return Err("the outline has no height".to_owned());
    }
    let mut points: Vec<DVec2> = outline.iter().map(|&p| (p - foot) / top).collect();
    points.dedup_by(|a, b| a.distance(*b) < 1e-6);
    if points.first().zip(points.last()).is_some_and(|(a, b)| points.len() > 1 && a.distance(*b) < 1e-6) {
        points.pop();
    }
    // Where the outline crosses the middle line it gets a corner, so that halves fold along it.
    let mut ring: Vec<[f64; 2]> = Vec::new();
    for (i, a) in points.iter().enumerate() {
        let b = points[(i + 1) % points.len()];
        ring.push([a.x, a.y]);
        if (a.x < 0.0) != (b.x < 0.0) && a.x != 0.0 && b.x != 0.0 {
            ring.push([0.0, a.y + (b.y - a.y) * a.x / (a.x - b.x)]);
        }
    }
    // Each half on its own: triangles must not cross the fold.
    let mut mesh = Mesh::default();
    for side in [-1.0, 1.0] {
        let half: Vec<[f64; 2]> = ring.iter().copied().filter(|p| p[0] * side >= 0.0).collect();
        let mut triangles: Vec<u32> = Vec::new();
        Earcut::new().earcut(half.iter().copied(), &[], &mut triangles);
        let first = mesh.points.len() as u32;
        let lift = |[x, y]: [f64; 2]| DVec3::new(x * libm::cos(fold), y, x.abs() * libm::sin(fold));
        mesh.points.extend(half.into_iter().map(lift));
        mesh.triangles.extend(triangles.chunks_exact(3).map(|t| [first + t[0], first + t[1], first + t[2]]));
    }
    if mesh.triangles.is_empty() {
        return Err("the outline encloses nothing".to_owned());
    }
    Ok(mesh)
}

/// A ball of diameter 1 whose top is at the origin: fruit.
#[must_use]
pub fn ball_mesh() -> Mesh {
    let [rings, sectors] = BALL;
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let (sin, cos) = {
            let angle = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            (libm::sin(angle), libm::cos(angle))
        };
        for sector in 0..sectors {
            let turn = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let normal = DVec3::new(sin * libm::cos(turn), -cos, sin * libm::sin(turn));
            mesh.points.push(normal * 0.5 + DVec3::Y * 0.5);
            mesh.normals.push(normal);
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let at = |ring: u32, sector: u32| ring * sectors + sector % sectors;
            let [a, b, c, d] = [at(ring, sector), at(ring, sector + 1), at(ring + 1, sector + 1), at(ring + 1, sector)];
            mesh.triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(|t| {
                let p = t.map(|i| mesh.points[i as usize]);
                (p[1] - p[0]).cross(p[2] - p[0]).length() > 1e-9
            }));
        }
    }
    mesh
}

impl LeavesSpec {
    /// Where leaves stand on `skeletons`, which one object shows, from `foot`; `stream` is theirs alone.
    ///
    /// # Errors
    /// [`SkinError::TooMany`].
    pub fn place(
        &self,
        skeletons: &[&Skeleton],
        foot: DVec3,
        digits: Digits,
        stream: &Stream,
    ) -> Result<Vec<Pose>, SkinError> {
        let ends: usize = skeletons.iter().map(|s| s.paths.len()).sum();
        let most = ends.saturating_mul(self.count as usize);
        if most > MOST_PRIMITIVES {
            return Err(SkinError::TooMany(most));
        }
        let bits = |p: DVec3| p.to_array().map(f64::to_bits);
        // Ends from which another step grew are no ends.
        let roots: std::collections::HashSet<[u64; 3]> =
            skeletons.iter().flat_map(|s| &s.nodes).filter(|n| n.parent.is_none()).map(|n| bits(n.position)).collect();
        let canopy = self.light.map(|light| (light, Canopy::new(skeletons, light.clump)));
        let directions = sky(16, 1.2);
        let mut poses = Vec::new();
        for (index, skeleton) in (0..).zip(skeletons) {
            let stream = stream.nth(index);
            for (end, _) in skeleton.ends(false) {
                let tip = skeleton.nodes[end as usize];
                if tip.parent.is_none() || roots.contains(&bits(tip.position)) {
                    continue;
                }
                let mut random = stream.nth(u64::from(end));
                if random.random::<f64>() >= self.share {
                    continue;
                }
                let start: f64 = random.random::<f64>() * 360.0;
                for i in 0..self.count {
                    let [roll, more]: [f64; 2] = std::array::from_fn(|_| random.random());
                    let back = self.along * f64::from(i) / f64::from(self.count);
                    let (at, way) = along_limb(skeleton, &tip, back);
                    let mut size = self.size * (1.0 + self.vary * (2.0 * more - 1.0));
                    if let Some((light, canopy)) = &canopy {
                        let hidden = canopy.hidden(at, &directions, light.clump * 1.5);
                        size *= light.sizes[1] + (light.sizes[0] - light.sizes[1]) * hidden;
                    }
                    if size > 0.0 {
                        let turn = (start + self.turn.0 * f64::from(i)).rem_euclid(360.0);
                        poses.push(self.pose(at - foot, way, Degrees(turn), roll, size, digits));
                    }
                }
            }
        }
        Ok(poses)
    }

    /// A leaf at `at` on a limb that goes along `way`.
    fn pose(&self, at: DVec3, way: DVec3, turn: Degrees, roll: f64, size: f64, digits: Digits) -> Pose {
        let side = rotation(way, turn.radians()) * way.any_orthonormal_vector();
        let along = turned_toward(way, side, self.angle.radians());
        let along = turned_toward(along, DVec3::NEG_Z, self.droop.radians());
        let facing = self.facing.map_or(DVec3::Z, |p| p.0);
        let along = if self.facing.is_some() { facing.cross(along).cross(facing).normalize_or(along) } else { along };
        // The upper side faces there as far as it can, and a little to either side.
        let across = along.cross(facing).normalize_or(along.any_orthonormal_vector());
        let across = rotation(along, (roll - 0.5) * 0.9) * across;
        Pose::new(digits.round_point(at), DMat3::from_cols(across, along, across.cross(along)) * size)
    }
}

/// The place on the limb that ends at `tip` this far back, and the way the limb goes there.
fn along_limb(skeleton: &Skeleton, tip: &SkeletonNode, mut back: f64) -> (DVec3, DVec3) {
    let mut node = *tip;
    let mut way = DVec3::Z;
    while let Some(parent) = node.parent.map(|p| skeleton.nodes[p as usize]) {
        let step = node.position - parent.position;
        let length = step.length();
        way = step.try_normalize().unwrap_or(way);
        if length >= back {
            return (node.position - way * back, way);
        }
        back -= length;
        node = parent;
    }
    (node.position, way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_become_folded_leaves() {
        let diamond = [[5.0, 1.0], [7.0, 4.0], [5.0, 9.0], [3.0, 4.0]].map(|[x, y]| DVec2::new(x, y));
        let mesh = leaf_mesh(&diamond, 0.5).unwrap();
        assert_eq!(mesh.triangles.len(), 2);
        let high = mesh.points.iter().map(|p| p.y).fold(0.0, f64::max);
        assert!((high - 1.0).abs() < 1e-12 && mesh.points.contains(&DVec3::ZERO));
        assert!(mesh.points.iter().all(|p| (p.z - p.x.abs() * libm::tan(0.5)).abs() < 1e-12));
        // The outline's area, and the same side up all over.
        let area: f64 = mesh
            .triangles
            .iter()
            .map(|t| {
                let p = t.map(|i| mesh.points[i as usize]);
                (p[1] - p[0]).cross(p[2] - p[0]).length() * 0.5
            })
            .sum();
        assert!((area - 16.0 / 64.0).abs() < 1e-9, "{area}");
        assert!(leaf_mesh(&[DVec2::ZERO, DVec2::X], 0.0).is_err());
    }

    #[test]
    fn a_ball_is_closed() {
        let mesh = ball_mesh();
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|t| {
                let p = t.map(|i| mesh.points[i as usize]);
                p[0].dot(p[1].cross(p[2])) / 6.0
            })
            .sum();
        assert!((0.4..0.53).contains(&volume.abs()), "{volume}");
    }
}
