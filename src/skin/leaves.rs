//! Leaves, fruit and blossom: one small mesh each, declared once and set along the ends of limbs.

use rand::RngExt;
use schemars::JsonSchema;
use serde::Deserialize;

use super::leaf_tints::{LeafTints, Tinting};
use crate::grow::{Canopy, sky};
use crate::math::{DMat3, DVec3, Degrees, Point, Ref, Stream, rotated_toward, rotation};
use crate::model::{BodyError, Digits, Material, Pose};
use crate::skeleton::{Skeleton, SkeletonNode};

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
    /// Colours by leaf, in place of the material's.
    #[serde(default)]
    pub tints: Option<LeafTints>,
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

impl LeavesSpec {
    /// Bytes that their poses on `skeletons` take at their peak, and as much for each leaf as `leaf` says.
    #[must_use]
    pub fn bytes_needed(&self, skeletons: &[&Skeleton], leaf: u64) -> u64 {
        let ends: usize = skeletons.iter().map(|s| s.paths.len()).sum();
        let leaves = ends as f64 * f64::from(self.count) * self.share;
        // A list of unknown length is half empty at worst; meshes are rounded into copies.
        (leaves * (size_of::<(Pose, u8)>() as f64 * 1.5 + leaf as f64 * 2.5)) as u64
    }

    /// Where leaves stand on `skeletons`, which one object shows, from `foot`, and the group that each is in of those of its tints;
    /// `stream` is theirs alone.
    ///
    /// # Errors
    /// [`BodyError::TooMany`].
    pub fn place(
        &self,
        skeletons: &[&Skeleton],
        foot: DVec3,
        digits: Digits,
        stream: &Stream,
    ) -> Result<Vec<(Pose, u8)>, BodyError> {
        let ends: usize = skeletons.iter().map(|s| s.paths.len()).sum();
        let most = ends.saturating_mul(self.count as usize);
        BodyError::check_count(most)?;
        let bits = |p: DVec3| p.to_array().map(f64::to_bits);
        // Ends from which another step grew are no ends.
        let roots: std::collections::HashSet<[u64; 3]> =
            skeletons.iter().flat_map(|s| &s.nodes).filter(|n| n.parent.is_none()).map(|n| bits(n.position)).collect();
        let canopy = self.light.map(|light| (light, Canopy::new(skeletons, light.clump)));
        let directions = sky(16, 1.2);
        let tinting = self.tints.as_ref().map(|tints| Tinting::new(tints, skeletons));
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
                let mut shoot = tinting.as_ref().map(|tinting| tinting.shoot(&random));
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
                        let pose = self.pose(at - foot, way, Degrees(turn), roll, size, digits);
                        poses.push((pose, shoot.as_mut().map_or(0, |group| group(at))));
                    }
                }
            }
        }
        Ok(poses)
    }

    /// A leaf at `at` on a limb that goes along `way`.
    fn pose(&self, at: DVec3, way: DVec3, turn: Degrees, roll: f64, size: f64, digits: Digits) -> Pose {
        let side = rotation(way, turn.radians()) * way.any_orthonormal_vector();
        let along = rotated_toward(way, side, self.angle.radians());
        let along = rotated_toward(along, DVec3::NEG_Z, self.droop.radians());
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
