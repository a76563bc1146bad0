//! What has grown, by where it is: who is near, relatives left out.

use rustc_hash::FxHashMap;

use crate::math::DVec3;

/// A piece of a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twig {
    pub from: DVec3,
    pub to: DVec3,
    /// The node before it.
    parent: Option<u32>,
    /// Its number in its own plant.
    own: u32,
    /// How far it keeps from other growth.
    apart: f64,
    /// The twig before it in its cell.
    before: u32,
}

/// A twig that is near a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neighbour {
    pub twig: Twig,
    /// Do they have a common ancestor not far back? Relatives start in the same place: they are not in each other's way.
    pub is_kin: bool,
}

impl Neighbour {
    /// Does a segment come nearer to it than either keeps from other growth?
    pub fn is_in_the_way(&self, from: DVec3, to: DVec3, apart: f64) -> bool {
        !self.is_kin && self.twig.distance(from, to) < self.twig.apart.max(apart)
    }
}

/// All twigs, in cells of a grid.
pub(super) struct Neighbourhood {
    side: f64,
    cells: FxHashMap<[i64; 3], u32>,
    twigs: Vec<Twig>,
}

const NONE: u32 = u32::MAX;

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
    /// Nothing yet; `side` is the greatest distance at which anything is asked for.
    pub fn new(side: f64) -> Self {
        Self { side, cells: FxHashMap::default(), twigs: Vec::new() }
    }

    pub fn len(&self) -> u32 {
        self.twigs.len() as u32
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        // Far from where any number ends.
        p.to_array().map(|c| libm::floor(c / self.side).clamp(-1e18, 1e18) as i64)
    }

    /// Adds a piece of a limb with the number of the one before it, its own number in its plant, and how far it keeps from
    /// other growth; its number here.
    pub fn add(&mut self, from: DVec3, to: DVec3, parent: Option<u32>, own: u32, apart: f64) -> u32 {
        let number = self.len();
        let before = self.cells.insert(self.cell(to), number).unwrap_or(NONE);
        self.twigs.push(Twig { from, to, parent, own, apart, before });
        number
    }

    /// The number of a node in its own plant.
    pub fn own(&self, node: u32) -> u32 {
        self.twigs[node as usize].own
    }

    fn ancestors(&self, node: u32, kin: usize) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(Some(node), |&n| self.twigs[n as usize].parent).take(kin + 1)
    }

    /// All that comes within `reach` of `p`, but for the node `of` and its ancestors, as far as `kin` nodes back; so far common
    /// ancestors make relatives too.
    pub fn gather(&self, p: DVec3, reach: f64, of: u32, kin: usize, near: &mut Vec<Neighbour>) {
        self.gather_from(0, p, reach, of, kin, near);
    }

    /// The same of twigs with the number `first` or a later one.
    pub fn gather_from(&self, first: u32, p: DVec3, reach: f64, of: u32, kin: usize, near: &mut Vec<Neighbour>) {
        near.clear();
        let [x, y, z] = self.cell(p);
        for dz in -1..=1 {
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let mut next = self.cells.get(&[x + dx, y + dy, z + dz]).copied().unwrap_or(NONE);
                    // The last comes first.
                    while next != NONE && next >= first {
                        let twig = self.twigs[next as usize];
                        if twig.distance(p, p) <= reach && self.ancestors(of, kin).all(|a| a != next) {
                            near.push(Neighbour { twig, is_kin: self.is_kin(next, of, kin) });
                        }
                        next = twig.before;
                    }
                }
            }
        }
    }

    fn is_kin(&self, one: u32, other: u32, kin: usize) -> bool {
        self.ancestors(one, kin).any(|a| self.ancestors(other, kin).any(|b| a == b))
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
            let found = all.twigs[0].distance(a, b);
            let mut least = f64::INFINITY;
            for i in 0..=60 {
                for j in 0..=60 {
                    let (s, t) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                    least = least.min(((a + (b - a) * s) - (c + (d - c) * t)).length());
                }
            }
            prop_assert!(found <= least + 1e-9 && found > least - 0.12, "{} {}", found, least);
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
        let stranger = all.add(at(5.0), at(6.0), None, NONE, 0.0);
        let sister = all.add(at(4.0), at(4.0) + DVec3::Y, Some(4), 9, 0.0);
        let mut near = Vec::new();
        all.gather(at(5.0), 3.5, 5, 2, &mut near);
        // 5, 4 and 3 are its own; 2 is farther back; what leaves 4 is kin.
        let mut found: Vec<(u32, bool)> = near.iter().map(|near| (near.twig.own, near.is_kin)).collect();
        found.sort_unstable();
        assert_eq!(found, [(2, false), (9, true), (NONE, false)]);
        assert!(all.own(sister) == 9 && all.own(stranger) == NONE);
    }
}
