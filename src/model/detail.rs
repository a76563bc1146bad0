//! Level of detail: limbs without what a picture is too coarse to show.

use super::{Ball, Camera, Limbs, Object, Projection};
use crate::geom::segment_parameter;

impl Object {
    /// The side of a pixel where the object comes nearest to `camera`, in the object's own units, when the picture is `width`
    /// pixels wide; 0 where it reaches the camera.
    #[must_use]
    pub fn pixel(&self, camera: &Camera, width: u32) -> f64 {
        let [.., forwards] = camera.frame();
        let side = |depth: f64| match camera.projection {
            Projection::Parallel { width: seen } => seen / f64::from(width),
            Projection::Perspective { angle } => 2.0 * depth.max(0.0) * libm::tan(angle * 0.5) / f64::from(width),
        };
        let pixels = self.instances.iter().map(|&place| {
            let depths = self.body.placed_balls(place).map(|(p, radius)| (p - camera.at).dot(forwards) - radius);
            side(depths.fold(f64::INFINITY, f64::min)) / place.scale
        });
        pixels.fold(f64::INFINITY, f64::min)
    }
}

impl Limbs {
    /// These limbs with fewer balls: those are left out that lie, with their radii, within `error` of the cone between two others
    /// of their limb, and ends of limbs that come no farther than `error` out of the ball before them. Forks stay.
    ///
    /// Segments must be in order: what leads to a ball before what leaves it.
    #[must_use]
    pub fn within(&self, error: f64) -> Self {
        let mut links = Links::of(self);
        self.shorten(error, &mut links);
        let mut is_kept = vec![true; self.balls.len()];
        let mut segments = Vec::new();
        let mut limb = Vec::new();
        for &[from, to] in &self.segments {
            if links.is_cut[to as usize] {
                is_kept[to as usize] = false;
            } else if !links.is_passed(self, from, to) {
                limb.clear();
                limb.extend([from, to]);
                let mut last = to;
                while let Some(next) = links.child[last as usize].filter(|&next| links.is_passed(self, last, next)) {
                    limb.push(next);
                    last = next;
                }
                self.join(&limb, error, &mut is_kept, &mut segments);
            }
        }
        self.renumbered(&is_kept, segments)
    }

    /// Bytes that [`Self::within`] takes, what it gives included.
    #[must_use]
    pub fn bytes_within(&self) -> u64 {
        const BOOKS: usize = 40;
        (size_of_val(&self.segments[..]) + self.balls.len() * (size_of::<Ball>() + BOOKS)) as u64
    }

    /// Cuts ends of limbs: a ball with nothing left behind it, that comes with all that was cut there no farther than `error`
    /// out of the ball before it.
    fn shorten(&self, error: f64, links: &mut Links) {
        let mut left = links.children.clone();
        // From each middle, how far it reaches, or what was cut behind it.
        let mut reach: Vec<f64> = self.balls.iter().map(|ball| ball.radius).collect();
        for &[from, to] in self.segments.iter().rev() {
            let (a, b) = (from as usize, to as usize);
            let far = self.balls[a].centre.distance(self.balls[b].centre) + reach[b];
            if links.parents[b] == 1 && left[b] == 0 && far <= self.balls[a].radius + error {
                reach[a] = reach[a].max(far);
                links.is_cut[b] = true;
                left[a] -= 1;
            }
        }
        for &[from, to] in self.segments.iter().filter(|[_, to]| !links.is_cut[*to as usize]) {
            links.child[from as usize] = Some(to);
        }
    }

    /// Joins what is kept of `limb`, ball by ball as far as one cone stands for those between.
    fn join(&self, limb: &[u32], error: f64, is_kept: &mut [bool], segments: &mut Vec<[u32; 2]>) {
        let ball = |i: usize| &self.balls[limb[i] as usize];
        let mut from = 0;
        while from + 1 < limb.len() {
            let mut to = from + 1;
            let stands = |to: usize| (from + 1..to).all(|i| stands_for(ball(from), ball(to), ball(i), error));
            while to + 1 < limb.len() && to - from < MOST && stands(to + 1) {
                to += 1;
            }
            (from + 1..to).for_each(|i| is_kept[limb[i] as usize] = false);
            segments.push([limb[from], limb[to]]);
            from = to;
        }
    }

    /// The balls that are kept, joined by `segments`.
    fn renumbered(&self, is_kept: &[bool], mut segments: Vec<[u32; 2]>) -> Self {
        let mut names = vec![0; self.balls.len()];
        let mut balls = Vec::new();
        let kept = self.beyond.iter().zip(is_kept).filter(|(_, is_kept)| **is_kept);
        let beyond = kept.map(|(&beyond, _)| beyond).collect();
        for (i, ball) in self.balls.iter().enumerate().filter(|&(i, _)| is_kept[i]) {
            names[i] = balls.len() as u32;
            balls.push(*ball);
        }
        segments.iter_mut().flatten().for_each(|i| *i = names[*i as usize]);
        Self { balls, segments, beyond, ..*self }
    }
}

/// Balls that one cone may stand for.
const MOST: usize = 64;

/// Does the cone between `a` and `b` pass within `error` of `ball`, in place and in radius together?
fn stands_for(a: &Ball, b: &Ball, ball: &Ball, error: f64) -> bool {
    let along = segment_parameter(ball.centre, a.centre, b.centre);
    let off = ball.centre.distance(a.centre.lerp(b.centre, along));
    off + (a.radius + (b.radius - a.radius) * along - ball.radius).abs() <= error
}

/// How balls hang together.
struct Links {
    parents: Vec<u32>,
    children: Vec<u32>,
    /// One of the children that are not cut.
    child: Vec<Option<u32>>,
    is_cut: Vec<bool>,
}

impl Links {
    fn of(limbs: &Limbs) -> Self {
        let n = limbs.balls.len();
        let (mut parents, mut children) = (vec![0; n], vec![0; n]);
        for &[from, to] in &limbs.segments {
            children[from as usize] += 1;
            parents[to as usize] += 1;
        }
        Self { parents, children, child: vec![None; n], is_cut: vec![false; n] }
    }

    /// Does one limb pass through `ball` on its way to `next`?
    fn is_passed(&self, limbs: &Limbs, ball: u32, next: u32) -> bool {
        let i = ball as usize;
        self.parents[i] == 1 && self.children[i] == 1 && limbs.balls[i].branch == limbs.balls[next as usize].branch
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::math::DVec3;

    fn ball(centre: DVec3, radius: f64) -> Ball {
        Ball { centre, radius, cost: 0.0, branch: 0, level: 0 }
    }

    /// How far `p`, with `radius`, is from the nearest cone or ball of `limbs`.
    fn off(limbs: &Limbs, from: &Ball) -> f64 {
        let lone = limbs.balls.iter().map(|b| b.centre.distance(from.centre) + from.radius - b.radius);
        let cones = limbs.segments.iter().map(|&[a, b]| {
            let (a, b) = (&limbs.balls[a as usize], &limbs.balls[b as usize]);
            let along = segment_parameter(from.centre, a.centre, b.centre);
            let radius = a.radius + (b.radius - a.radius) * along;
            a.centre.lerp(b.centre, along).distance(from.centre) + (radius - from.radius).abs()
        });
        lone.chain(cones).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        /// Nothing of a tree that wanders at random is farther from what is left than the error; with none, all is left but what
        /// lies within others.
        #[test]
        fn nothing_strays(steps in prop::collection::vec((0_u32..6, -1.0..1.0, -1.0..1.0, 0.01..0.3), 1..60), error in 0.0..0.5) {
            let mut limbs = Limbs { balls: vec![ball(DVec3::ZERO, 0.3)], ..Limbs::default() };
            for (i, (back, x, y, radius)) in (1_u32..).zip(steps) {
                let from = i - 1 - back.saturating_sub(3).min(i - 1);
                limbs.balls.push(ball(limbs.balls[from as usize].centre + DVec3::new(x, y, 0.5), radius));
                limbs.segments.push([from, i]);
            }
            let fewer = limbs.within(error);
            for ball in &limbs.balls {
                prop_assert!(off(&fewer, ball) <= error + 1e-12);
            }
            prop_assert_eq!(fewer.segments.len() + 1, fewer.balls.len());
            for (i, &[from, to]) in fewer.segments.iter().enumerate() {
                prop_assert!(from == 0 || fewer.segments[..i].iter().any(|&[_, b]| b == from));
                prop_assert!(to != 0);
            }
        }
    }

    #[test]
    fn a_straight_limb_is_one_cone() {
        let balls = (0..50).map(|i| ball(DVec3::Z * f64::from(i), 1.0 - f64::from(i) * 0.01)).collect();
        let segments = (0..49).map(|i| [i, i + 1]).collect();
        let limbs = Limbs { balls, segments, ..Limbs::default() };
        let fewer = limbs.within(1e-9);
        assert_eq!(fewer.segments, [[0, 1]]);
        assert_eq!(fewer.balls, [limbs.balls[0], limbs.balls[49]]);
    }

    /// A short twig goes, a fork stays.
    #[test]
    fn ends_are_cut() {
        let at = |x: f64, z: f64| ball(DVec3::new(x, 0.0, z), 0.1);
        let balls = vec![at(0.0, 0.0), at(0.0, 5.0), at(3.0, 8.0), at(-0.04, 5.04), at(-0.08, 5.08), at(-3.0, 8.0)];
        let limbs = Limbs { balls, segments: vec![[0, 1], [1, 2], [1, 3], [3, 4], [1, 5]], ..Limbs::default() };
        assert_eq!(limbs.within(0.12).segments, [[0, 1], [1, 2], [1, 3]]);
        assert_eq!(limbs.within(0.11).balls.len(), 5);
    }
}
