//! Patterns where they are seen: laid along limbs, or spread over what has none.

use crate::math::DVec3;
use crate::model::pattern::{Expr, Figure};
use crate::model::{LimbFrame, Limbs, Pattern, limb_frames};

/// A pattern laid along limbs.
pub(super) struct Laid {
    figure: Figure,
    share: Expr,
    /// The axes of the limb at each ball.
    frames: Vec<LimbFrame>,
}

/// A pattern over what has no limbs.
pub(super) struct Spread {
    mean: f64,
    size: f64,
    share: Option<Expr>,
}

impl Spread {
    /// Over the ground, where limbs have their way up to the sky.
    pub fn on_ground(pattern: Pattern) -> Self {
        let figure = pattern.figure();
        Self { mean: figure.mean(), size: figure.size(), share: Some(figure.share()) }
    }

    /// Over a mesh, which has no limbs that a pattern could follow: it shows the mean of those that do.
    pub fn on_mesh(pattern: Pattern) -> Self {
        let figure = pattern.figure();
        let share = (!figure.follows_limbs()).then(|| figure.share());
        Self { mean: figure.mean(), size: figure.size(), share }
    }

    /// Its share at a place, which exporters have with y up; the mean of what is not `seen`.
    pub fn at(&self, p: DVec3, seen: bool) -> f64 {
        let share = self.share.as_ref().filter(|_| seen);
        share.map_or(self.mean, |share| share.at(DVec3::new(p.x, p.z, p.y) / self.size))
    }
}

/// Directions about a point, in the limb's coordinates, at whose ends POV-Ray asks for a pattern to find its slope, and how far away
/// they are in units of its size.
const PYRAMID: [DVec3; 4] = [
    DVec3::new(0.942_809_041, -0.333_333_333, 0.0),
    DVec3::new(-0.471_404_521, -0.333_333_333, 0.816_496_581),
    DVec3::new(-0.471_404_521, -0.333_333_333, -0.816_496_581),
    DVec3::new(0.0, 1.0, 0.0),
];
const STEP: f64 = 0.02;

impl Laid {
    pub fn new(pattern: Pattern, limbs: &Limbs) -> Self {
        let figure = pattern.figure();
        Self { figure, share: figure.share(), frames: limb_frames(limbs) }
    }

    /// The pattern's share at `p`, on the limb of a ball of this radius, and the slope of its height there; the mean of what is not
    /// `seen`.
    pub fn at(&self, ball: u32, radius: f64, p: DVec3, seen: bool) -> (f64, DVec3) {
        let figure = &self.figure;
        let (mean, clarity) = (figure.mean(), figure.clarity(radius));
        if clarity == 0.0 || !seen {
            return (mean, DVec3::ZERO);
        }
        let frame = &self.frames[ball as usize];
        let at = frame.local(p) / figure.size();
        let share = self.share.at(at);
        let height = figure.height() * clarity;
        let slope = match height == 0.0 {
            true => DVec3::ZERO,
            false => {
                // Of a slope the four add up to four thirds.
                let rise = PYRAMID.iter().map(|&way| way * self.share.at(at + way * STEP)).sum::<DVec3>();
                let [x, y, z] = frame.axes;
                (x * rise.x + y * rise.y + z * rise.z) * (height * 0.75 / STEP)
            }
        };
        (mean + (share - mean) * clarity, slope)
    }
}
