//! What every way of growing ends with: radii, smoothing, ages, copies about an axis, and the numbers of branches.

use std::collections::HashMap;

use super::step::{MOST_NODES, bits};
use super::{GrowError, Method, Step};
use crate::skeleton::{Skeleton, SkeletonNode, bend, smooth};

impl Step {
    /// Radii, smoothing, ages and branches.
    pub(super) fn finish(&self, mut skeleton: Skeleton, grown: &[Option<&Skeleton>]) -> Result<Skeleton, GrowError> {
        // Growth without a graph knows its roots and limbs.
        let is_free = matches!(self.method, Method::Segments(_) | Method::Voxels(_));
        if self.repeat.is_none() {
            if !is_free {
                skeleton.root_paths();
            }
            let level = self.first_level(grown);
            // Fractal placement counts its iterations.
            if level > 0 {
                skeleton.nodes.iter_mut().for_each(|node| node.level += level);
            }
        }
        if matches!(self.method, Method::Regions(_)) {
            return Ok(skeleton);
        }
        let parts = self.parts();
        let nodes = self
            .strands
            .map_or(skeleton.nodes.len() as u64, |pieces| skeleton.paths.len() as u64 * (u64::from(pieces) + 1));
        let all = nodes.saturating_mul(u64::from(parts));
        if all > MOST_NODES {
            let key = if parts > 1 { "symmetry" } else { "strands" };
            let message = format!("{all} nodes are more than {MOST_NODES}: use fewer endpoints, pieces or parts");
            return Err(GrowError::Scene { place: format!("grow.{}.{key}", self.name), message });
        }
        if let Some(pieces) = self.strands {
            skeleton = skeleton.strands(pieces);
        }
        self.width.apply(&mut skeleton).map_err(|message| GrowError::Scene {
            place: format!("grow.{}.width", self.name),
            message: message.to_string(),
        })?;
        if self.smooth > 0.0 {
            smooth(&mut skeleton, self.smooth);
            skeleton = bend(&skeleton);
        }
        let has_limbs = is_free && self.strands.is_none() && self.smooth <= 0.0;
        self.age(&mut skeleton, has_limbs, grown);
        if let Some(symmetry) = &self.symmetry {
            skeleton = skeleton.symmetric(symmetry);
        }
        if !has_limbs || self.symmetry.is_some() {
            skeleton.number_branches();
        }
        Ok(skeleton)
    }

    /// The level of its first round: one more than what it grows from, where it belongs to a plant.
    pub(super) fn first_level(&self, grown: &[Option<&Skeleton>]) -> u16 {
        let levels = self.sources().iter().filter_map(|&step| grown[step]).flat_map(|s| &s.nodes).map(|n| n.level + 1);
        if self.width.starts_plant().is_some() { levels.max().unwrap_or(0) } else { 0 }
    }

    /// Carries on ages and largest radii from the steps that this one grows from; `has_limbs` where each node has the index of a
    /// path as its limb.
    fn age(&self, skeleton: &mut Skeleton, has_limbs: bool, grown: &[Option<&Skeleton>]) {
        if has_limbs && self.sources().is_empty() {
            return;
        }
        let known: HashMap<[u64; 3], &SkeletonNode> = self
            .sources()
            .iter()
            .filter_map(|&step| grown[step])
            .flat_map(|s| &s.nodes)
            .map(|node| (bits(node.position), node))
            .collect();
        let start = |root: &SkeletonNode| {
            // Widths along whole plants come later.
            let widest = |radius: f64| if radius > 0.0 { radius } else { f64::INFINITY };
            known.get(&bits(root.position)).map_or((0.0, f64::INFINITY), |node| (node.age, widest(node.radius)))
        };
        if has_limbs {
            skeleton.start_limbs_from(start);
        } else {
            skeleton.start_from(start);
        }
    }
}
