//! What has grown, by where it is: who is near, relatives left out.

use rustc_hash::FxHashMap;

use crate::math::DVec3;

/// A piece of a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twig {
    pub from: DVec3,
    pub to: DVec3,
    /// Its number among all.
    number: u32,
    /// How far it keeps from other growth.
    apart: f64,
    ball: Ball,
}

/// The ball about a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    /// Its centre, twice.
    centre: DVec3,
    /// A little more than its diameter: more than rounding could bring others nearer.
    width: f64,
}

impl Ball {
    /// The ball about the segment from `a` to `b`.
    pub fn new(a: DVec3, b: DVec3) -> Self {
        Self { centre: a + b, width: a.distance(b) * (1.0 + 1e-9) }
    }

    /// Is the other surely farther than `reach`?
    fn is_beyond(&self, other: &Self, reach: f64) -> bool {
        let width = self.width + other.width + reach * (2.0 + 1e-9);
        (self.centre - other.centre).length_squared() > width * width
    }
}

/// The twigs near a node, but for itself and its ancestors.
pub(super) struct Near<'a> {
    all: &'a Neighbourhood,
    twigs: Vec<&'a Twig>,
    /// The node and its ancestors as far back as relatives are known.
    own: Vec<u32>,
}

impl Near<'_> {
    /// Does one come nearer to a segment than either keeps from other growth? Relatives, with a common ancestor not far back,
    /// start in the same place: they are not in each other's way.
    pub fn is_in_the_way(&self, from: DVec3, to: DVec3, apart: f64) -> bool {
        let ball = Ball::new(from, to);
        self.twigs.iter().any(|twig| {
            let apart = twig.apart.max(apart);
            !twig.ball.is_beyond(&ball, apart) && twig.distance(from, to) < apart && !self.is_kin(twig)
        })
    }

    /// How far the nearest is from `p`, or `most`.
    pub fn distance(&self, p: DVec3, most: f64) -> f64 {
        let ball = Ball::new(p, p);
        self.twigs.iter().fold(most, |most, twig| {
            if twig.ball.is_beyond(&ball, most) { most } else { twig.distance(p, p).min(most) }
        })
    }

    fn is_kin(&self, twig: &Twig) -> bool {
        self.all.ancestors(twig.number).take(self.own.len()).any(|ancestor| self.own.contains(&ancestor))
    }
}

/// All twigs, in cells of a grid.
pub(super) struct Neighbourhood {
    side: f64,
    cells: FxHashMap<[i64; 3], Vec<Twig>>,
    /// Of every twig the one before it, and its number in its own plant.
    nodes: Vec<(Option<u32>, u32)>,
}

impl Twig {
    /// The least distance between it and the segment from `a` to `b` (Ericson 2005, section 5.1.9).
    pub fn distance(&self, a: DVec3, b: DVec3) -> f64 {
        let (u, v, w) = (b - a, self.to - self.from, a - self.from);
        let (uu, vv, uv, uw, vw) = (u.dot(u), v.dot(v), u.dot(v), u.dot(w), v.dot(w));
        let apart = uu * vv - uv * uv;
        // Where the lines are nearest, within the first segment; parallel ones anywhere.
        let s = if apart > 0.0 { ((uv * vw - uw * vv) / apart).clamp(0.0, 1.0) } else { 0.0 };
        let t = if vv > 0.0 { (uv * s + vw) / vv } else { 0.0 };
        let t_within = t.clamp(0.0, 1.0);
        // Beyond the second's end: the first's nearest place to that end.
        let s = if t == t_within || uu <= 0.0 { s } else { ((uv * t_within - uw) / uu).clamp(0.0, 1.0) };
        (w + u * s - v * t_within).length()
    }
}

impl Neighbourhood {
    /// Nothing yet; `side` is the greatest distance at which the end of a twig is asked for.
    pub fn new(side: f64) -> Self {
        Self { side, cells: FxHashMap::default(), nodes: Vec::new() }
    }

    pub fn len(&self) -> u32 {
        self.nodes.len() as u32
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        // Far from where any number ends.
        p.to_array().map(|c| libm::floor(c / self.side).clamp(-1e18, 1e18) as i64)
    }

    /// Adds a piece of a limb with the number of the one before it, its own number in its plant, and how far it keeps from
    /// other growth; its number here.
    pub fn add(&mut self, from: DVec3, to: DVec3, parent: Option<u32>, own: u32, apart: f64) -> u32 {
        let number = self.len();
        let twig = Twig { from, to, number, apart, ball: Ball::new(from, to) };
        self.cells.entry(self.cell(to)).or_default().push(twig);
        self.nodes.push((parent, own));
        number
    }

    /// The number of a node in its own plant.
    pub fn own(&self, node: u32) -> u32 {
        self.nodes[node as usize].1
    }

    /// A node and those before it.
    fn ancestors(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(Some(node), |&n| self.nodes[n as usize].0)
    }

    /// All that comes within `reach` of `p`, and a little more, with the number `first` or a later one, but for the node `of` and
    /// its ancestors, as far as `kin` nodes back.
    pub fn near(&self, first: u32, p: DVec3, reach: f64, of: u32, kin: usize) -> Near<'_> {
        let own: Vec<u32> = self.ancestors(of).take(kin + 1).collect();
        let ([x, y, z], ball) = (self.cell(p), Ball::new(p, p));
        let mut twigs = Vec::new();
        let around = || -1..=1;
        for (dz, dy, dx) in around().flat_map(|dz| around().flat_map(move |dy| around().map(move |dx| (dz, dy, dx)))) {
            let Some(cell) = self.cells.get(&[x + dx, y + dy, z + dz]) else { continue };
            // The last come first.
            let fresh = cell.iter().rev().take_while(|twig| twig.number >= first);
            twigs.extend(fresh.filter(|twig| !twig.ball.is_beyond(&ball, reach) && !own.contains(&twig.number)));
        }
        Near { all: self, twigs, own }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// No two places of the segments are nearer, and some are as near, to what samples show.
        #[test]
        fn distances_are_least(p in prop::array::uniform12(-2.0..2.0)) {
            let [a, b, c, d] = [0, 3, 6, 9].map(|i| DVec3::new(p[i], p[i + 1], p[i + 2]));
            let mut all = Neighbourhood::new(9.0);
            all.add(c, d, None, 0, 0.0);
            let found = all.cells[&all.cell(d)][0].distance(a, b);
            let mut least = f64::INFINITY;
            for i in 0..=60 {
                for j in 0..=60 {
                    let (s, t) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                    least = least.min(((a + (b - a) * s) - (c + (d - c) * t)).length());
                }
            }
            prop_assert!(found <= least + 1e-9 && found > least - 0.12, "{} {}", found, least);
            prop_assert!(!all.cells[&all.cell(d)][0].ball.is_beyond(&Ball::new(a, b), found));
        }
    }

    #[test]
    fn relatives_are_left_out() {
        let mut all = Neighbourhood::new(4.0);
        let at = |x: f64| DVec3::new(x, 0.0, 0.0);
        let mut parent = None;
        for i in 0..6 {
            parent = Some(all.add(at(f64::from(i) - 1.0), at(f64::from(i)), parent, i, 0.0));
        }
        let stranger = all.add(at(5.0), at(6.0), None, u32::MAX, 0.0);
        let sister = all.add(at(4.0), at(4.0) + DVec3::Y, Some(4), 9, 0.0);
        let near = all.near(0, at(5.0), 3.5, 5, 2);
        // 5, 4 and 3 are its own; 2 is farther back; what leaves 4 is kin.
        let mut found: Vec<(u32, bool)> = near.twigs.iter().map(|t| (all.own(t.number), near.is_kin(t))).collect();
        found.sort_unstable();
        assert_eq!(found, [(2, false), (9, true), (u32::MAX, false)]);
        assert!(all.own(sister) == 9 && all.own(stranger) == u32::MAX);
    }
}
