//! Patterns over a material's colour: closed forms, which every renderer computes alike.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Object;
use crate::math::{Colour, DVec3};

/// What is drawn over a material's colour.
///
/// Both patterns follow the limb: their coordinates are along it, towards its upper side, and across.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Pattern {
    /// Fissures that run along the limb and part and meet again.
    Bark {
        /// Colour of the fissures.
        colour: Colour,
        /// Distance from fissure to fissure, in scene units; thinner limbs have none.
        #[schemars(range(min = 1e-6, max = 1e6))]
        size: f64,
    },
    /// Moss on the upper side of the limb.
    Moss {
        /// Colour of the moss.
        colour: Colour,
        /// Size of its patches, in scene units.
        #[schemars(range(min = 1e-6, max = 1e6))]
        size: f64,
    },
}

/// A sum of sines `sin(along . p + phase + bend sin(by . p))`, of which patterns are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Its wave vector: upper side, along the limb, across.
    pub along: [f64; 3],
    /// Its phase.
    pub phase: f64,
    /// How far another wave bends it.
    pub bend: f64,
    /// That other wave's vector.
    pub by: [f64; 3],
}

/// Bark's fissures are where this sum is near 0: nets drawn out along the limb.
pub const BARK: [Wave; 4] = [
    Wave { along: [3.1, 0.16, 1.2], phase: 0.4, bend: 1.1, by: [0.6, 0.31, -0.7] },
    Wave { along: [-1.4, 0.13, 2.9], phase: 1.9, bend: 1.0, by: [-0.8, 0.27, 0.5] },
    Wave { along: [1.9, -0.19, -2.6], phase: 4.1, bend: 1.2, by: [0.4, -0.36, 0.8] },
    Wave { along: [5.3, 0.43, 4.7], phase: 2.7, bend: 0.9, by: [-1.3, 0.71, 1.1] },
];

/// Moss is where the upper side's share and this sum are above a threshold.
pub const MOSS: [Wave; 3] = [
    Wave { along: [2.3, 1.9, 0.7], phase: 0.2, bend: 1.2, by: [-1.1, 0.8, 1.6] },
    Wave { along: [-1.1, 2.1, 2.2], phase: 2.3, bend: 1.1, by: [1.7, 0.9, -0.6] },
    Wave { along: [1.2, -2.4, 1.8], phase: 5.2, bend: 1.3, by: [0.8, 1.5, 1.2] },
];

impl Pattern {
    /// How narrow bark's fissures are.
    pub const FISSURE: f64 = 0.9;
    /// Moss: the weight of its patches, that of the upper side, and the threshold.
    pub const PATCH: [f64; 3] = [0.3, 0.9, 0.45];

    /// The colour drawn over the material's own.
    #[must_use]
    pub fn colour(&self) -> Colour {
        match *self {
            Self::Bark { colour, .. } | Self::Moss { colour, .. } => colour,
        }
    }

    /// The unit of its coordinates, in scene units.
    #[must_use]
    pub fn size(&self) -> f64 {
        match *self {
            Self::Bark { size, .. } | Self::Moss { size, .. } => size,
        }
    }

    /// Limbs below this radius show the pattern's mean alone.
    #[must_use]
    pub fn least_radius(&self) -> f64 {
        match *self {
            Self::Bark { size, .. } => size * 1.5,
            Self::Moss { .. } => 0.0,
        }
    }

    /// Its mean share.
    #[must_use]
    pub fn mean(&self) -> f64 {
        match self {
            Self::Bark { .. } => 0.3,
            Self::Moss { .. } => 0.0,
        }
    }

    /// The share of its colour at `p`, in units of its size along the limb's axes; 0 to 1.
    #[must_use]
    pub fn share(&self, p: DVec3) -> f64 {
        let sum = |waves: &[Wave]| {
            waves
                .iter()
                .map(|w| {
                    let (a, b) = (DVec3::from_array(w.along), DVec3::from_array(w.by));
                    libm::sin(a.dot(p) + w.phase + w.bend * libm::sin(b.dot(p)))
                })
                .sum::<f64>()
        };
        match self {
            Self::Bark { .. } => (1.0 - sum(&BARK).abs() * Self::FISSURE).max(0.0),
            Self::Moss { .. } => {
                let across = libm::sqrt(p.x * p.x + p.z * p.z).max(1e-6);
                let [patch, upper, least] = Self::PATCH;
                (sum(&MOSS) * patch + p.x / across * upper - least).clamp(0.0, 1.0)
            }
        }
    }
}

/// The axes of a limb at a ball: patterns and textures are laid along them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// A point of the limb's axis, from the object's foot.
    pub at: DVec3,
    /// Distance of that point along the limb.
    pub along: f64,
    /// Unit vectors: towards the upper side, along the limb, across.
    pub axes: [DVec3; 3],
}

impl Frame {
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
pub fn limb_frames(object: &Object) -> Vec<Frame> {
    let upright = |along: DVec3| {
        // Seen along a vertical limb the north is up.
        let up = if along.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z };
        let side = (up - along * up.dot(along)).normalize_or(DVec3::X);
        [side, along, along.cross(side)]
    };
    let origin = Frame { at: DVec3::ZERO, along: 0.0, axes: upright(DVec3::Z) };
    let mut frames: Vec<Option<Frame>> = vec![None; object.balls.len()];
    for &[from, to] in &object.segments {
        let (a, b) = (&object.balls[from as usize], &object.balls[to as usize]);
        let way = b.centre - a.centre;
        let along = way.normalize_or(DVec3::Z);
        let parent = frames[from as usize].unwrap_or(Frame { at: a.centre, along: 0.0, axes: upright(along) });
        frames[from as usize] = Some(parent);
        // A limb of its own starts upright again.
        let axes = if a.branch == b.branch {
            let side = parent.axes[0] - along * parent.axes[0].dot(along);
            side.try_normalize().map_or(upright(along), |side| [side, along, along.cross(side)])
        } else {
            upright(along)
        };
        frames[to as usize] = Some(Frame { at: b.centre, along: parent.along + way.length(), axes });
    }
    frames.into_iter().map(|frame| frame.unwrap_or(origin)).collect()
}
