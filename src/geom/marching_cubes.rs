//! Isosurfaces by marching cubes (Lorensen and Cline 1987). Ambiguous faces are resolved by their own four corners alone, so
//! that neighbouring cubes agree: the surface is a closed, consistently oriented 2-manifold.

use std::sync::OnceLock;

use super::Surface;
use crate::math::DVec3;

/// Least distance of a vertex from the samples, as a share of a grid step: no triangle is degenerate.
const CLEARANCE: f64 = 0.02;

/// The other two axes of each axis.
const OTHERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// The triangulation of a cube with given corners inside. A vertex is named by the cube's edge on which it lies.
#[derive(Clone, Debug, Default)]
struct Case {
    /// The edges that are cut.
    edges: Vec<u8>,
    /// Loops that are triangulated as a fan about a vertex in their middle.
    fans: Vec<Vec<u8>>,
    /// Triangles.
    triangles: Vec<[u8; 3]>,
}

/// The number of the corner with these coordinates, 0 or 1.
fn corner(at: [usize; 3]) -> usize {
    at[0] | at[1] << 1 | at[2] << 2
}

/// The number of the edge along `axis` through the corner `at`.
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

/// The triangulation for the corners inside, a bit each.
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
            // On an ambiguous face each run of inside corners is cut off separately: they are joined along edges only.
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
        // No diagonal lies on a face: the neighbouring cube might have the same one.
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

/// Two neighbouring layers of samples, a bit each, with a sample outside on every side.
struct SampleLayers {
    /// Samples along x and y, without those outside.
    size: [usize; 2],
    /// Words of a row.
    words: usize,
    /// The lower and the upper layer.
    bits: [Vec<u64>; 2],
}

impl SampleLayers {
    fn new(size: [usize; 2]) -> Self {
        let words = (size[0] + 2).div_ceil(64);
        let layer = || vec![0_u64; words * (size[1] + 2)];
        Self { size, words, bits: [layer(), layer()] }
    }

    /// The upper layer becomes the lower one; `is_inside` tells of the next, `None` is the one beyond the last.
    fn advance(&mut self, is_inside: Option<impl Fn(usize, usize) -> bool>) {
        self.bits.swap(0, 1);
        let upper = &mut self.bits[1];
        upper.fill(0);
        let Some(is_inside) = is_inside else { return };
        for y in 0..self.size[1] {
            let row = &mut upper[self.words * (y + 1)..self.words * (y + 2)];
            for x in 0..self.size[0] {
                row[(x + 1) / 64] |= u64::from(is_inside(x, y)) << ((x + 1) % 64);
            }
        }
    }

    /// Visits the cubes of row `y` that have corners inside and outside, with those inside as bits; 64 cubes at a time.
    fn for_each_cut(&self, y: usize, mut visit: impl FnMut(usize, u8)) {
        let words = self.words;
        let rows = [0, 1, 2, 3].map(|i| &self.bits[i / 2][words * (y + i % 2)..words * (y + i % 2 + 1)]);
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
                if x > self.size[0] {
                    break;
                }
                let corners = (0..4).fold(0, |corners, row| {
                    let pair = (own[row] >> bit & 1) | (after[row] >> bit & 1) << 1;
                    corners | (pair as u8) << (2 * row)
                });
                visit(x, corners);
            }
        }
    }
}

/// The vertices on the edges between two layers of samples, by the lower sample of each edge; `u32::MAX` where there is none.
struct EdgeVertices {
    /// Samples of a row, with those outside.
    row: usize,
    /// On edges along x and y in the lower and the upper layer.
    flat: [[Vec<u32>; 2]; 2],
    /// On edges along z.
    upright: Vec<u32>,
}

impl EdgeVertices {
    fn new(size: [usize; 2]) -> Self {
        let none = || vec![u32::MAX; (size[0] + 2) * (size[1] + 2)];
        Self { row: size[0] + 2, flat: [[none(), none()], [none(), none()]], upright: none() }
    }

    /// The upper layer becomes the lower one.
    fn advance(&mut self) {
        self.flat.swap(0, 1);
        for table in self.flat[1].iter_mut().chain([&mut self.upright]) {
            table.fill(u32::MAX);
        }
    }

    /// The vertex on the edge along `axis` from the corner `low` of the cube in row `y` at `x`.
    fn at(&mut self, axis: usize, [x, y]: [usize; 2], low: [usize; 3]) -> &mut u32 {
        let place = x + low[0] + self.row * (y + low[1]);
        if axis == 2 { &mut self.upright[place] } else { &mut self.flat[low[2]][axis][place] }
    }
}

/// The axis of an edge, and its lower corner.
fn edge_start(edge: u8) -> (usize, [usize; 3]) {
    let axis = usize::from(edge / 4);
    let mut low = [0; 3];
    let [b, c] = OTHERS[axis];
    (low[b], low[c]) = (usize::from(edge & 1), usize::from(edge >> 1 & 1));
    (axis, low)
}

impl Surface {
    /// The isosurface between samples inside and outside on a grid of `size` samples, in grid steps from its first sample.
    /// Beyond the grid everything is outside. `crossing` is the distance of the surface from a sample inside, as a share of
    /// the step to its neighbour outside: along an axis, upwards (`true`) or downwards.
    #[must_use]
    pub fn extract(
        size: [u32; 3],
        is_inside: impl Fn([u32; 3]) -> bool,
        crossing: impl Fn([u32; 3], usize, bool) -> f64,
    ) -> Self {
        let [nx, ny, nz] = size.map(|s| s as usize);
        let mut surface = Self::default();
        let mut layers = SampleLayers::new([nx, ny]);
        let mut vertices = EdgeVertices::new([nx, ny]);
        for z in 0..=nz {
            layers.advance((z < nz).then_some(|x: usize, y: usize| is_inside([x as u32, y as u32, z as u32])));
            vertices.advance();
            for y in 0..=ny {
                layers.for_each_cut(y, |x, corners| {
                    let case = &cases()[usize::from(corners)];
                    let mut cut = [0; 12];
                    for &e in &case.edges {
                        let (axis, low) = edge_start(e);
                        let known = vertices.at(axis, [x, y], low);
                        if *known == u32::MAX {
                            *known = surface.points.len() as u32;
                            let up = corners >> corner(low) & 1 == 1;
                            surface.points.push(vertex(axis, [x + low[0], y + low[1], z + low[2]], up, &crossing));
                        }
                        cut[usize::from(e)] = *known;
                    }
                    surface.add_case(case, &cut);
                });
            }
        }
        surface
    }

    /// Adds the triangles of a cube whose edges have the vertices `cut`.
    fn add_case(&mut self, case: &Case, cut: &[u32; 12]) {
        self.triangles.extend(case.triangles.iter().map(|t| t.map(|e| cut[usize::from(e)])));
        for ring in &case.fans {
            let middle = self.points.len() as u32;
            let at = |e: &u8| cut[usize::from(*e)];
            let sum: DVec3 = ring.iter().map(|e| self.points[at(e) as usize]).sum();
            self.points.push(sum / ring.len() as f64);
            let sides = ring.iter().zip(ring.iter().cycle().skip(1));
            self.triangles.extend(sides.map(|(a, b)| [middle, at(a), at(b)]));
        }
    }
}

/// Where the surface crosses the edge along `axis` from the sample `low`, counted with those outside; `up` where that one is
/// inside.
fn vertex(axis: usize, low: [usize; 3], up: bool, crossing: &impl Fn([u32; 3], usize, bool) -> f64) -> DVec3 {
    let mut inside = low;
    inside[axis] += usize::from(!up);
    // Samples of the grid are counted from 1 here.
    let share = crossing(inside.map(|c| c as u32 - 1), axis, up).clamp(CLEARANCE, 1.0 - CLEARANCE);
    let mut p = DVec3::from_array(inside.map(|c| c as f64 - 1.0));
    p[axis] += if up { share } else { -share };
    p
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
