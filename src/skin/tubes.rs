//! The skin `mesh`: limbs as tubes that are joined into one smooth surface where one leaves another.
//!
//! Every limb is a tube of rings. Where a limb leaves another a patch of that one's wall is left out, and the limb's first
//! ring is sewn to its rim. A limb too thin or too crowded for that starts within the other as a closed tube of its own.

use std::collections::HashMap;

use crate::math::DVec3;
use crate::model::Mesh;
use crate::skeleton::Skeleton;

/// Sides of the rings of a limb that leaves no other; one that is sewn has as many as its patch has corners, others 8.
const SIDES: usize = 12;
/// Limbs thinner than this share of the one they leave start within it: the patch would be far wider than they are.
const THIN: f64 = 0.2;
/// A patch leaves at least this many columns of a limb's wall.
const WALL: usize = 4;

/// A limb on its way to a tube.
#[derive(Default)]
struct Limb {
    /// Places of its axis, and radii.
    axis: Vec<(DVec3, f64)>,
    /// The limb that it leaves, and where on its axis.
    from: Option<(usize, usize)>,
}

/// A ring of a tube.
struct Ring {
    /// Its first corner; the others follow.
    first: u32,
    /// Distance along the limb over its circumference: the texture's v.
    v: f64,
}

/// A place of a limb's wall that is left open: between which rings, and which columns.
#[derive(Clone, Copy)]
struct Patch {
    low: f64,
    high: f64,
    /// The limb that goes there.
    limb: usize,
    /// Columns that it takes.
    columns: usize,
}

/// The surface around `skeletons`, which one object shows, from `foot`.
#[must_use]
pub fn tubes(skeletons: &[&Skeleton], foot: DVec3) -> Mesh {
    let limbs = limbs(skeletons, foot);
    let mut builder = Builder::default();
    builder.plan(&limbs);
    // Limbs come after those that they leave.
    for (i, limb) in limbs.iter().enumerate() {
        builder.tube(i, limb);
    }
    let mut mesh = builder.mesh;
    mesh.smooth();
    mesh
}

/// The limbs of all skeletons: each from where it leaves another to its tip.
fn limbs(skeletons: &[&Skeleton], foot: DVec3) -> Vec<Limb> {
    let bits = |p: DVec3| p.to_array().map(f64::to_bits);
    let mut limbs: Vec<Limb> = Vec::new();
    // Where each place is: the limb, and the place on its axis.
    let mut places: HashMap<[u64; 3], (usize, usize)> = HashMap::new();
    for skeleton in skeletons {
        let mut own: HashMap<u32, usize> = HashMap::new();
        for node in &skeleton.nodes {
            let here = (node.position - foot, node.radius);
            let key = bits(here.0);
            let limb = match own.get(&node.branch) {
                Some(&limb) => limb,
                None => {
                    let parent = node.parent.map(|p| &skeleton.nodes[p as usize]);
                    // As thin as it is itself, but not without width.
                    let start = parent.map_or(here, |p| (p.position - foot, node.radius.max(p.radius * 0.2)));
                    let found = places.get(&bits(start.0)).copied();
                    // What starts at another's tip goes on from it.
                    let goes_on =
                        found.filter(|&(limb, at)| parent.is_none() && at + 1 == limbs[limb].axis.len() && at > 0);
                    let limb = goes_on.map_or(limbs.len(), |(limb, _)| limb);
                    if goes_on.is_none() {
                        limbs.push(Limb { axis: vec![start], from: found });
                    }
                    own.insert(node.branch, limb);
                    limb
                }
            };
            let axis = &mut limbs[limb].axis;
            if axis.last().is_none_or(|last| last.0 != here.0) {
                axis.push(here);
                places.entry(key).or_insert((limb, axis.len() - 1));
            } else {
                let at = axis.len() - 1;
                places.entry(key).or_insert((limb, at));
            }
        }
    }
    limbs
}

#[derive(Default)]
struct Builder {
    mesh: Mesh,
    /// The way of each limb that is sewn to another, where it leaves that.
    ways: HashMap<usize, DVec3>,
    /// How many columns of the other's wall each of them takes.
    columns: HashMap<usize, usize>,
    /// The rim of the patch that waits for each limb, counterclockwise seen from outside.
    rims: HashMap<usize, Vec<u32>>,
    /// The patches of each limb.
    patches: HashMap<usize, Vec<Patch>>,
}

impl Builder {
    /// Decides which limbs are sewn to those that they leave: thick ones first, each with a stretch for itself.
    fn plan(&mut self, limbs: &[Limb]) {
        let mut order: Vec<usize> = (0..limbs.len()).filter(|&i| limbs[i].from.is_some()).collect();
        order.sort_by(|&a, &b| limbs[b].axis[0].1.total_cmp(&limbs[a].axis[0].1).then(a.cmp(&b)));
        for i in order {
            let Some((parent, at)) = limbs[i].from else { continue };
            let stem = &limbs[parent];
            let (p, thick) = stem.axis[at];
            // The limb's own radius, past its collar's beginning.
            let Some(&(out, thin)) = limbs[i].axis.iter().find(|(q, _)| q.distance(p) > thick) else { continue };
            if at == 0 || at + 1 >= stem.axis.len() || thin < thick * THIN || thin > thick * 0.97 {
                continue;
            }
            let before = stem.axis[at - 1].0;
            let along = (stem.axis[at + 1].0 - before).normalize_or(DVec3::Z);
            let way = (out - p).normalize_or(along);
            let sin = libm::sqrt((1.0 - way.dot(along) * way.dot(along)).max(0.0));
            if sin < 0.35 {
                continue;
            }
            let sides = self.columns.get(&parent).map_or_else(|| sides(stem), |columns| 2 * columns + 2);
            if sides <= WALL {
                continue;
            }
            let half = libm::asin((thin / thick).min(1.0)) / std::f64::consts::TAU * sides as f64;
            let columns = (libm::round(2.0 * half) as usize).clamp(1, sides - WALL);
            let lengths = lengths(stem);
            // Where it comes through the wall, and how much of the wall it takes.
            let middle = lengths[at] + thick * way.dot(along) / sin;
            let reach = thin * 1.15 / sin;
            let (low, high) = (middle - reach, middle + reach);
            let own = self.patches.entry(parent).or_default();
            let is_free = own.iter().all(|patch| high < patch.low || low > patch.high);
            if low > 0.0 && high < lengths[lengths.len() - 1] * 0.98 && is_free {
                own.push(Patch { low, high, limb: i, columns });
                self.ways.insert(i, way);
                self.columns.insert(i, columns);
            }
        }
        self.patches.values_mut().for_each(|patches| patches.sort_by(|a, b| a.low.total_cmp(&b.low)));
    }

    fn tube(&mut self, index: usize, limb: &Limb) {
        let rim = self.rims.remove(&index);
        let patches = self.patches.remove(&index).unwrap_or_default();
        let lengths = lengths(limb);
        let whole = lengths[lengths.len() - 1];
        if whole <= 0.0 {
            return;
        }
        let count = rim.as_ref().map_or_else(|| sides(limb), Vec::len);
        // A sewn limb begins where it is out of the other.
        let start = rim.as_ref().map_or(0.0, |rim| {
            let reach = rim.iter().map(|&i| self.mesh.points[i as usize].distance(limb.axis[0].0)).fold(0.0, f64::max);
            (reach * 1.08).min(whole * 0.9)
        });
        let mut stations: Vec<f64> = lengths.iter().copied().filter(|&s| s > start && s < whole).collect();
        stations.insert(0, start);
        stations.retain(|&s| patches.iter().all(|patch| s < patch.low || s > patch.high));
        stations.extend(patches.iter().flat_map(|patch| [patch.low, patch.high]).filter(|&s| s > start));
        stations.sort_by(f64::total_cmp);
        stations.dedup_by(|a, b| (*a - *b).abs() < whole * 1e-6);
        let mut rings: Vec<Ring> = Vec::new();
        let mut side: Option<DVec3> = None;
        let mut v = 0.0;
        let mut last = start;
        for &s in &stations {
            let (centre, radius, along) = at(limb, &lengths, s);
            // Carried along without twist.
            let carried = side.map(|side| side - along * side.dot(along)).and_then(DVec3::try_normalize);
            let x = carried.unwrap_or_else(|| self.first_side(rim.as_deref(), centre, along));
            side = Some(x);
            let y = along.cross(x);
            v += (s - last) / (std::f64::consts::TAU * radius.max(whole * 1e-6));
            last = s;
            let first = self.mesh.points.len() as u32;
            for k in 0..count {
                let turn = std::f64::consts::TAU * k as f64 / count as f64;
                let out = x * libm::cos(turn) + y * libm::sin(turn);
                self.mesh.points.push(centre + out * radius);
            }
            rings.push(Ring { first, v });
        }
        if let Some(rim) = &rim {
            self.sew(rim, &rings[0], count);
        } else {
            self.cap(&rings[0], limb.axis[0].0, count, false);
        }
        for (pair, s) in rings.windows(2).zip(&stations) {
            let patch = patches.iter().find(|patch| (patch.low - s).abs() < whole * 1e-6);
            self.wall(&pair[0], &pair[1], count, patch, limb, &lengths);
        }
        if let Some(ring) = rings.last() {
            self.cap(ring, limb.axis[limb.axis.len() - 1].0, count, true);
        }
    }

    /// The side of a tube's first ring at which corners begin: the rim's first corner, or any.
    fn first_side(&self, rim: Option<&[u32]>, centre: DVec3, along: DVec3) -> DVec3 {
        let towards = rim.map_or(DVec3::ZERO, |rim| self.mesh.points[rim[0] as usize] - centre);
        (towards - along * towards.dot(along)).normalize_or(along.any_orthonormal_vector())
    }

    /// The wall between two rings, but for the columns of `patch`, whose rim is kept for its limb.
    fn wall(&mut self, a: &Ring, b: &Ring, count: usize, patch: Option<&Patch>, limb: &Limb, lengths: &[f64]) {
        let open = patch.map(|patch| {
            // The columns about the limb's way.
            let (centre, ..) = at(limb, lengths, (patch.low + patch.high) * 0.5);
            (self.facing(a, b, count, patch, centre), patch)
        });
        let is_open = |k: usize| open.is_some_and(|(first, patch)| (k + count - first) % count < patch.columns);
        for k in (0..count).filter(|&k| !is_open(k)) {
            let next = (k + 1) % count;
            let corner = |ring: &Ring, k: usize| ring.first + k as u32;
            let (p, q, r, s) = (corner(a, k), corner(a, next), corner(b, next), corner(b, k));
            let uv = |ring: &Ring, k: usize| [k as f64 / count as f64, ring.v];
            self.face([p, q, r], [uv(a, k), uv(a, k + 1), uv(b, k + 1)]);
            self.face([p, r, s], [uv(a, k), uv(b, k + 1), uv(b, k)]);
        }
        if let Some((first, patch)) = open {
            let column = |i: usize| ((first + i) % count) as u32;
            let lower = (0..=patch.columns).map(|i| a.first + column(i));
            let upper = (0..=patch.columns).rev().map(|i| b.first + column(i));
            self.rims.insert(patch.limb, lower.chain(upper).collect());
        }
    }

    /// The first of the columns that `patch` opens: its limb comes through the middle of them.
    fn facing(&self, a: &Ring, b: &Ring, count: usize, patch: &Patch, centre: DVec3) -> usize {
        let target = self.ways.get(&patch.limb).copied().unwrap_or(DVec3::Z);
        let middle = |first: usize| {
            let sum = (0..=patch.columns).fold(DVec3::ZERO, |sum, i| {
                let k = (first + i) % count;
                sum + self.mesh.points[a.first as usize + k] + self.mesh.points[b.first as usize + k]
            });
            sum / (2 * patch.columns + 2) as f64 - centre
        };
        let score = |first: usize| middle(first).normalize_or_zero().dot(target);
        (0..count).fold(0, |best, first| if score(first) > score(best) { first } else { best })
    }

    /// Sews a rim to the first ring of its limb, both counterclockwise and with as many corners.
    fn sew(&mut self, rim: &[u32], ring: &Ring, count: usize) {
        // The turn of the ring that keeps the seams shortest.
        let far = |turn: usize| {
            (0..count).fold(0.0, |sum, k| {
                let (p, q) = (rim[k] as usize, ring.first as usize + (k + turn) % count);
                sum + self.mesh.points[p].distance_squared(self.mesh.points[q])
            })
        };
        let turn = (0..count).fold(0, |best, turn| if far(turn) < far(best) { turn } else { best });
        for k in 0..count {
            let (p, q) = (rim[k], rim[(k + 1) % count]);
            let (s, r) = (ring.first + ((k + turn) % count) as u32, ring.first + ((k + 1 + turn) % count) as u32);
            let u = |k: usize| k as f64 / count as f64;
            self.face([p, q, r], [[u(k), -0.2], [u(k + 1), -0.2], [u(k + 1), 0.0]]);
            self.face([p, r, s], [[u(k), -0.2], [u(k + 1), 0.0], [u(k), 0.0]]);
        }
    }

    /// Closes a tube at a point.
    fn cap(&mut self, ring: &Ring, point: DVec3, count: usize, is_tip: bool) {
        let centre = self.mesh.points.len() as u32;
        self.mesh.points.push(point);
        for k in 0..count {
            let (p, q) = (ring.first + k as u32, ring.first + ((k + 1) % count) as u32);
            let u = |k: usize| k as f64 / count as f64;
            let tip = [u(k) + 0.5 / count as f64, ring.v + if is_tip { 0.1 } else { -0.1 }];
            if is_tip {
                self.face([p, q, centre], [[u(k), ring.v], [u(k + 1), ring.v], tip]);
            } else {
                self.face([q, p, centre], [[u(k + 1), ring.v], [u(k), ring.v], tip]);
            }
        }
    }

    fn face(&mut self, corners: [u32; 3], uvs: [[f64; 2]; 3]) {
        self.mesh.triangles.push(corners);
        self.mesh.uvs.push(uvs);
    }
}

/// How many sides a limb's rings have.
fn sides(limb: &Limb) -> usize {
    if limb.from.is_none() { SIDES } else { 8 }
}

/// How far each place of a limb's axis is along it.
fn lengths(limb: &Limb) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for pair in limb.axis.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + pair[1].0.distance(pair[0].0));
    }
    lengths
}

/// The place, radius and way of a limb at this distance along it.
fn at(limb: &Limb, lengths: &[f64], s: f64) -> (DVec3, f64, DVec3) {
    let i = lengths.partition_point(|&l| l <= s).clamp(1, lengths.len() - 1);
    let ((a, ra), (b, rb)) = (limb.axis[i - 1], limb.axis[i]);
    let share = ((s - lengths[i - 1]) / (lengths[i] - lengths[i - 1]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let way = (b - a).normalize_or(DVec3::Z);
    // At a corner between both of its sides.
    let way =
        if share < 1e-9 && i > 1 { (way + (a - limb.axis[i - 2].0).normalize_or(way)).normalize_or(way) } else { way };
    (a + (b - a) * share, ra + (rb - ra) * share, way)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::ClosedMesh;
    use crate::skeleton::SkeletonNode;

    /// A stem with a limb, a twig on that, and a thin twig on the stem.
    fn tree() -> Skeleton {
        let mut skeleton = Skeleton::default();
        let mut limb = |branch: u32, parent: Option<u32>, from: DVec3, to: DVec3, radii: [f64; 2], pieces: u32| {
            let mut parent = parent;
            for i in 0..=pieces {
                let t = f64::from(i) / f64::from(pieces);
                skeleton.nodes.push(SkeletonNode {
                    position: from + (to - from) * t,
                    parent,
                    cost: 0.0,
                    age: 0.0,
                    radius: radii[0] + (radii[1] - radii[0]) * t,
                    branch,
                    level: 0,
                    class: 0,
                });
                parent = Some(skeleton.nodes.len() as u32 - 1);
            }
        };
        limb(0, None, DVec3::ZERO, DVec3::new(0.0, 0.0, 8.0), [1.0, 0.2], 16);
        limb(1, Some(6), DVec3::new(0.0, 0.0, 3.0), DVec3::new(5.0, 0.5, 6.0), [0.5, 0.1], 10);
        limb(2, Some(22), DVec3::new(2.5, 0.25, 4.5), DVec3::new(3.0, 3.0, 6.0), [0.18, 0.05], 6);
        limb(3, Some(10), DVec3::new(0.0, 0.0, 5.0), DVec3::new(-2.0, -1.0, 6.0), [0.05, 0.02], 4);
        skeleton
    }

    /// The surface is closed, agrees which side is out, and is one piece but for the thin twig.
    #[test]
    fn limbs_are_joined() {
        let tree = tree();
        let mesh = tubes(&[&tree], DVec3::ZERO);
        let closed = ClosedMesh::new(mesh.points.clone(), mesh.triangles.clone()).unwrap();
        assert!(closed.distance(DVec3::new(0.0, 0.0, 2.0)) < 0.0 && closed.distance(DVec3::new(3.0, -2.0, 2.0)) > 0.0);
        let mut piece: Vec<usize> = (0..mesh.points.len()).collect();
        fn root(piece: &mut [usize], mut i: usize) -> usize {
            while piece[i] != i {
                i = piece[i];
            }
            i
        }
        for t in &mesh.triangles {
            for pair in [[t[0], t[1]], [t[1], t[2]]] {
                let [a, b] = pair.map(|i| root(&mut piece, i as usize));
                piece[a] = b;
            }
        }
        let pieces = (0..piece.len()).filter(|&i| piece[i] == i).count();
        assert_eq!(pieces, 2, "the stem with its two limbs, and the twig that starts within");
        assert_eq!((mesh.normals.len(), mesh.uvs.len()), (mesh.points.len(), mesh.triangles.len()));
        // Normals point out of the solid.
        let out =
            mesh.points.iter().zip(&mesh.normals).filter(|(p, n)| closed.distance(**p + **n * 0.01) > 0.0).count();
        assert!(out * 100 > mesh.points.len() * 97, "{out} of {}", mesh.points.len());
    }
}
