//! Frames along limbs, which patterns and textures are laid along.

use super::Limbs;
use crate::math::DVec3;

/// The axes of a limb at a ball: patterns and textures are laid along them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbFrame {
    /// A point of the limb's axis, from the object's foot.
    pub at: DVec3,
    /// Distance of that point along the limb.
    pub along: f64,
    /// Unit vectors: towards the upper side, along the limb, across.
    pub axes: [DVec3; 3],
}

impl LimbFrame {
    /// `p` in the limb's coordinates: towards the upper side, along, across.
    #[must_use]
    pub fn local(&self, p: DVec3) -> DVec3 {
        let d = p - self.at;
        DVec3::new(d.dot(self.axes[0]), d.dot(self.axes[1]) + self.along, d.dot(self.axes[2]))
    }
}

/// The frame of each ball: that of the segment that ends there, carried along from its parent without twist (Bishop
/// 1975); a root has that of its first segment.
#[must_use]
pub fn limb_frames(limbs: &Limbs) -> Vec<LimbFrame> {
    let upright = |along: DVec3| {
        // Seen along a vertical limb the north is up.
        let up = if along.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z };
        let side = (up - along * up.dot(along)).normalize_or(DVec3::X);
        [side, along, along.cross(side)]
    };
    let origin = LimbFrame { at: DVec3::ZERO, along: 0.0, axes: upright(DVec3::Z) };
    let mut frames: Vec<Option<LimbFrame>> = vec![None; limbs.balls.len()];
    for &[from, to] in &limbs.segments {
        let (a, b) = (&limbs.balls[from as usize], &limbs.balls[to as usize]);
        let way = b.centre - a.centre;
        let along = way.normalize_or(DVec3::Z);
        let parent = frames[from as usize].unwrap_or(LimbFrame { at: a.centre, along: 0.0, axes: upright(along) });
        frames[from as usize] = Some(parent);
        // A limb of its own starts upright again.
        let axes = if a.branch == b.branch {
            let side = parent.axes[0] - along * parent.axes[0].dot(along);
            side.try_normalize().map_or(upright(along), |side| [side, along, along.cross(side)])
        } else {
            upright(along)
        };
        frames[to as usize] = Some(LimbFrame { at: b.centre, along: parent.along + way.length(), axes });
    }
    frames.into_iter().map(|frame| frame.unwrap_or(origin)).collect()
}
