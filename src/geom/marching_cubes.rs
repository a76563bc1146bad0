//! Isosurfaces by marching cubes whose cubes agree on every face: closed, consistently oriented 2-manifolds (Lorensen and
//! Cline 1987; what surfaces do on a face follows from that face's corners alone).

use std::sync::OnceLock;

use earcut::Earcut;

use crate::math::{DVec2, DVec3};

/// A surface of triangles, counterclockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Corners.
    pub points: Vec<DVec3>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
}

/// Crossings stay this far, as a share of a step, from the samples: no triangle is without area.
const CLEAR: f64 = 0.02;

/// The cube's three axes, and for each the other two.
const OTHERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// How a cube with given corners is cut: triangles of its edges; 12 is a point of its own in the middle of a loop.
#[derive(Clone, Debug, Default)]
struct Case {
    /// The edges that are cut.
    edges: Vec<u8>,
    /// Loops that need a point in their middle, as edges.
    fans: Vec<Vec<u8>>,
    /// Triangles of edges.
    triangles: Vec<[u8; 3]>,
}

/// The corner with these coordinates, 0 or 1.
fn corner(at: [usize; 3]) -> usize {
    at[0] | at[1] << 1 | at[2] << 2
}

/// The edge along `axis` from the corner with these coordinates; that along the axis does not matter.
fn edge(axis: usize, at: [usize; 3]) -> u8 {
    let [b, c] = OTHERS[axis];
    (axis * 4 + at[b] + 2 * at[c]) as u8
}

/// The four corners of each face, counterclockwise seen from outside.
fn faces() -> [[[usize; 3]; 4]; 6] {
    std::array::from_fn(|face| {
        let (axis, side) = (face / 2, face % 2);
        let [b, c] = OTHERS[axis];
        // (x, y, z), (y, x, z) and (z, x, y): only the second is left-handed.
        let is_right = axis != 1;
        let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
        std::array::from_fn(|i| {
            let [u, v] = ring[if (side == 1) == is_right { i } else { 3 - i }];
            let mut at = [0; 3];
            (at[axis], at[b], at[c]) = (side, u, v);
            at
        })
    })
}

/// Do two edges of the cube lie on one of its faces?
fn share_face(a: u8, b: u8) -> bool {
    let on = |e: u8| {
        let axis = usize::from(e / 4);
        let [p, q] = OTHERS[axis];
        [(p, e & 1), (q, e >> 1 & 1)]
    };
    on(a).iter().any(|face| on(b).contains(face))
}

/// The case of these corners, a bit each.
fn case(corners: u8) -> Case {
    let is_in = |at: [usize; 3]| corners >> corner(at) & 1 == 1;
    let mut next = [None::<u8>; 12];
    for ring in faces() {
        let between = |i: usize| {
            let (a, b) = (ring[i % 4], ring[(i + 1) % 4]);
            let axis = (0..3).find(|&axis| a[axis] != b[axis]).unwrap_or(0);
            edge(axis, a)
        };
        for i in 0..4 {
            // Every run of corners inside is cut off on its own, so that those inside are joined along edges alone.
            if !is_in(ring[i]) && is_in(ring[(i + 1) % 4]) {
                let leaves = (1..4).find(|&j| !is_in(ring[(i + 1 + j) % 4])).unwrap_or(3);
                next[usize::from(between(i))] = Some(between(i + leaves));
            }
        }
    }
    let edges = (0..12).filter(|&e| next[usize::from(e)].is_some()).collect();
    let mut case = Case { edges, ..Case::default() };
    let mut is_done = [false; 12];
    for start in 0..12_u8 {
        if is_done[usize::from(start)] || next[usize::from(start)].is_none() {
            continue;
        }
        let mut ring = Vec::new();
        let mut at = start;
        while !is_done[usize::from(at)] {
            is_done[usize::from(at)] = true;
            ring.push(at);
            at = next[usize::from(at)].unwrap_or(start);
        }
        let n = ring.len();
        // A diagonal on a face might be drawn by the cube behind it too.
        let is_free = |from: usize| (2..n - 1).all(|i| !share_face(ring[from], ring[(from + i) % n]));
        match (0..n).find(|&from| is_free(from)) {
            Some(from) => {
                case.triangles.extend((1..n - 1).map(|i| [ring[from], ring[(from + i) % n], ring[(from + i + 1) % n]]));
            }
            None => case.fans.push(ring),
        }
    }
    case
}

fn cases() -> &'static [Case; 256] {
    static CASES: OnceLock<Box<[Case; 256]>> = OnceLock::new();
    CASES.get_or_init(|| Box::new(std::array::from_fn(|corners| case(corners as u8))))
}

impl Surface {
    /// The surface between samples inside and outside on a grid of `size` samples, in steps of the grid from its first
    /// sample. `is_inside` tells of a sample; all beyond the grid are outside. `crossing` tells how far the surface is from
    /// a sample inside, as a share of the step to the neighbour along the axis that is outside, up (`true`) or down.
    #[must_use]
    pub fn extract(
        size: [u32; 3],
        is_inside: impl Fn([u32; 3]) -> bool,
        crossing: impl Fn([u32; 3], usize, bool) -> f64,
    ) -> Self {
        let [nx, ny, nz] = size.map(|s| s as usize);
        let mut points: Vec<DVec3> = Vec::new();
        let mut triangles = Vec::new();
        // Bits of two layers of samples, with one outside on each side; and the points on their edges.
        let words = (nx + 2).div_ceil(64);
        let mut layers = [vec![0_u64; words * (ny + 2)], vec![0_u64; words * (ny + 2)]];
        let none = || vec![u32::MAX; (nx + 2) * (ny + 2)];
        // Along x and y in the lower and the upper layer, and along z between them.
        let mut flat = [[none(), none()], [none(), none()]];
        let mut upright = none();
        for z in 0..=nz {
            layers.swap(0, 1);
            flat.swap(0, 1);
            layers[1].fill(0);
            for y in 0..if z < nz { ny } else { 0 } {
                let row = &mut layers[1][words * (y + 1)..words * (y + 2)];
                for x in 0..nx {
                    let bit = u64::from(is_inside([x as u32, y as u32, z as u32]));
                    row[(x + 1) / 64] |= bit << ((x + 1) % 64);
                }
            }
            for table in flat[1].iter_mut().chain([&mut upright]) {
                table.fill(u32::MAX);
            }
            for y in 0..=ny {
                let rows = [0, 1, 2, 3].map(|i| &layers[i / 2][words * (y + i % 2)..words * (y + i % 2 + 1)]);
                for word in 0..words {
                    let own = rows.map(|row| row[word]);
                    let after = rows.map(|row| row[word] >> 1 | row.get(word + 1).map_or(0, |&w| w << 63));
                    let any = own.iter().chain(&after).fold(0, |all, &w| all | w);
                    let all = own.iter().chain(&after).fold(u64::MAX, |all, &w| all & w);
                    let mut mixed = any & !all;
                    while mixed != 0 {
                        let bit = mixed.trailing_zeros() as usize;
                        mixed &= mixed - 1;
                        let x = word * 64 + bit;
                        if x > nx {
                            break;
                        }
                        let corners = (0..4).fold(0, |corners, row| {
                            let pair = (own[row] >> bit & 1) | (after[row] >> bit & 1) << 1;
                            corners | (pair as u8) << (2 * row)
                        });
                        let case = &cases()[usize::from(corners)];
                        let mut cut = [0; 12];
                        for &e in &case.edges {
                            let axis = usize::from(e / 4);
                            let mut low = [0; 3];
                            let [b, c] = OTHERS[axis];
                            (low[b], low[c]) = (usize::from(e & 1), usize::from(e >> 1 & 1));
                            let place = x + low[0] + (nx + 2) * (y + low[1]);
                            let known = if axis == 2 { &mut upright[place] } else { &mut flat[low[2]][axis][place] };
                            if *known == u32::MAX {
                                *known = points.len() as u32;
                                let up = corners >> corner(low) & 1 == 1;
                                let mut inside = [x + low[0], y + low[1], z + low[2]];
                                inside[axis] += usize::from(!up);
                                // Samples of the grid begin at 1 here.
                                let share = crossing(inside.map(|c| c as u32 - 1), axis, up).clamp(CLEAR, 1.0 - CLEAR);
                                let mut p = DVec3::from_array(inside.map(|c| c as f64 - 1.0));
                                p[axis] += if up { share } else { -share };
                                points.push(p);
                            }
                            cut[usize::from(e)] = *known;
                        }
                        triangles.extend(case.triangles.iter().map(|t| t.map(|e| cut[usize::from(e)])));
                        for ring in &case.fans {
                            let middle = points.len() as u32;
                            let at = |e: &u8| cut[usize::from(*e)];
                            let sum: DVec3 = ring.iter().map(|e| points[at(e) as usize]).sum();
                            points.push(sum / ring.len() as f64);
                            let sides = ring.iter().zip(ring.iter().cycle().skip(1));
                            triangles.extend(sides.map(|(a, b)| [middle, at(a), at(b)]));
                        }
                    }
                }
            }
        }
        Self { points, triangles }
    }

    /// Every point moved by `place`.
    #[must_use]
    pub fn map(mut self, place: impl Fn(DVec3) -> DVec3) -> Self {
        self.points.iter_mut().for_each(|p| *p = place(*p));
        self
    }

    /// The normal of each point: the mean of those around it, by area.
    #[must_use]
    pub fn normals(&self) -> Vec<DVec3> {
        vertex_normals(&self.points, &self.triangles)
    }

    /// The volume within, negative where it is turned inside out.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let sixfold = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| self.points[i as usize]);
            a.dot(b.cross(c))
        };
        self.triangles.iter().map(sixfold).sum::<f64>() / 6.0
    }

    /// The area of all triangles.
    #[must_use]
    pub fn area(&self) -> f64 {
        let twice = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| self.points[i as usize]);
            (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(twice).sum::<f64>() * 0.5
    }

    /// Smooths away the steps of the grid, keeping the volume nearly: `rounds` of a step towards the mean of the
    /// neighbours and a larger one back (Taubin 1995).
    pub fn smooth(&mut self, rounds: u32) {
        const STEPS: [f64; 2] = [0.5, -0.53];
        for step in (0..rounds).flat_map(|_| STEPS) {
            let mut sums = vec![(DVec3::ZERO, 0_u32); self.points.len()];
            // Each edge of a closed surface is met twice, once in each direction.
            for t in &self.triangles {
                for i in 0..3 {
                    let sum = &mut sums[t[i] as usize];
                    *sum = (sum.0 + self.points[t[(i + 1) % 3] as usize], sum.1 + 1);
                }
            }
            for (p, (sum, count)) in self.points.iter_mut().zip(sums) {
                if count > 0 {
                    *p += (sum / f64::from(count) - *p) * step;
                }
            }
        }
    }

    /// Is every edge shared by exactly two triangles that run along it in opposite directions, are the triangles around
    /// every point one ring, and has no triangle the same corner twice? What [`Surface::extract`] yields is.
    #[must_use]
    pub fn is_closed_manifold(&self) -> bool {
        let mut edges: Vec<[u32; 2]> =
            self.triangles.iter().flat_map(|t| (0..3).map(|i| [t[i], t[(i + 1) % 3]])).collect();
        edges.sort_unstable();
        let is_once = edges.windows(2).all(|pair| pair[0] != pair[1]);
        let is_paired = edges.iter().all(|&[a, b]| a != b && edges.binary_search(&[b, a]).is_ok());
        // Around each point the triangles lead from one neighbour to the next.
        let mut corners: Vec<[u32; 3]> =
            self.triangles.iter().flat_map(|t| (0..3).map(|i| [t[i], t[(i + 1) % 3], t[(i + 2) % 3]])).collect();
        corners.sort_unstable();
        is_once
            && is_paired
            && corners.chunk_by(|a, b| a[0] == b[0]).all(|around| {
                let mut at = around[0][1];
                let next = |at: u32| around.binary_search_by_key(&at, |c| c[1]).ok().map(|i| around[i][2]);
                (1..=around.len()).all(|count| {
                    at = next(at).unwrap_or(u32::MAX);
                    (at == around[0][1]) == (count == around.len())
                })
            })
    }
}

/// The normal of each of `points`, of length 1: the mean of those of the `triangles` around it, by area.
#[must_use]
pub fn vertex_normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&i| normals[i as usize] += normal);
    }
    normals.into_iter().map(|n| n.normalize_or(DVec3::Z)).collect()
}

/// What `rings` enclose, as triangles of the plane: outer ones run counterclockwise, holes the other way.
#[must_use]
pub fn fill(rings: &[Vec<DVec2>]) -> Surface {
    let area = |ring: &[DVec2]| {
        let after = ring.iter().cycle().skip(1);
        ring.iter().zip(after).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    };
    let contains = |ring: &[DVec2], p: DVec2| {
        let after = ring.iter().cycle().skip(1);
        let crosses = |(a, b): (&DVec2, &DVec2)| {
            (a.y <= p.y) != (b.y <= p.y) && a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x
        };
        ring.iter().zip(after).filter(|&edge| crosses(edge)).count() % 2 == 1
    };
    let (outer, holes): (Vec<&Vec<DVec2>>, Vec<&Vec<DVec2>>) = rings.iter().partition(|ring| area(ring) > 0.0);
    // A hole belongs to the least ring around it.
    let owner = |hole: &[DVec2]| {
        let around = (0..outer.len()).filter(|&i| contains(outer[i], hole[0]));
        around.min_by(|&a, &b| area(outer[a]).total_cmp(&area(outer[b])))
    };
    let mut owned: Vec<Vec<&Vec<DVec2>>> = vec![Vec::new(); outer.len()];
    for hole in holes {
        if let Some(owner) = owner(hole) {
            owned[owner].push(hole);
        }
    }
    let mut surface = Surface::default();
    for (ring, holes) in outer.iter().zip(owned) {
        let mut points: Vec<[f64; 2]> = ring.iter().map(|p| p.to_array()).collect();
        let mut starts: Vec<u32> = Vec::new();
        for hole in holes {
            starts.push(points.len() as u32);
            points.extend(hole.iter().map(|p| p.to_array()));
        }
        let mut triangles: Vec<u32> = Vec::new();
        Earcut::new().earcut(points.iter().copied(), &starts, &mut triangles);
        let first = surface.points.len() as u32;
        surface.points.extend(points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)));
        surface.triangles.extend(triangles.chunks_exact(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
    }
    surface
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// All 256 cubes alone, and noise, where most faces are ambiguous.
    #[test]
    fn surfaces_are_closed_manifolds() {
        for corners in 1..=255_u32 {
            let surface =
                Surface::extract([2, 2, 2], |[x, y, z]| corners >> (x | y << 1 | z << 2) & 1 == 1, |_, _, _| 0.3);
            assert!(surface.is_closed_manifold() && surface.volume() > 0.0, "{corners:08b}");
        }
    }

    proptest! {
        #[test]
        fn noise_has_manifold_surfaces(seed in any::<u64>(), size in 1..70_u32, share in 1..9_u64) {
            let is_inside = |[x, y, z]: [u32; 3]| {
                crate::math::mix(seed ^ u64::from(x | y << 8 | z << 16)) % 10 < share
            };
            let surface = Surface::extract([size, 7, 5], is_inside, |[x, ..], axis, up| {
                f64::from(x % 3) * 0.4 + axis as f64 * 0.1 + f64::from(up) * 0.05
            });
            prop_assert!(surface.is_closed_manifold());
            let count = (0..size * 35).filter(|i| is_inside([i % size, i / size % 7, i / size / 7])).count();
            prop_assert_eq!(count == 0, surface.triangles.is_empty());
        }
    }

    #[test]
    fn a_ball_has_its_volume_and_keeps_it() {
        let d = |at: [u32; 3]| (DVec3::from_array(at.map(f64::from)) - DVec3::splat(20.0)).length() - 15.0;
        let mut surface = Surface::extract(
            [41; 3],
            |at| d(at) < 0.0,
            |at, axis, up| {
                let mut other = at;
                other[axis] = other[axis].wrapping_add_signed(if up { 1 } else { -1 });
                d(at) / (d(at) - d(other))
            },
        );
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 15.0_f64 * 15.0 * 15.0;
        assert!((surface.volume() / exact - 1.0).abs() < 0.005, "{}", surface.volume() / exact);
        surface.smooth(10);
        assert!((surface.volume() / exact - 1.0).abs() < 0.01, "{}", surface.volume() / exact);
        assert!(surface.is_closed_manifold());
    }

    #[test]
    fn open_surfaces_are_told() {
        let mut surface = Surface::extract([3; 3], |_| true, |_, _, _| 0.5);
        assert!(surface.is_closed_manifold());
        surface.triangles.pop();
        assert!(!surface.is_closed_manifold());
    }
}
