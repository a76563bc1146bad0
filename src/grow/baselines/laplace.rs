//! Laplace's equation on a lattice, for the dielectric breakdown model.

use crate::graph::{Graph, Lattice, Node};

/// Solutions are this exact: the residual over the right side, both in the Euclidean norm.
const TOLERANCE: f64 = 1e-4;
/// Iterations at most; a solution is carried on by the next call.
const MOST_ITERATIONS: u32 = 500;
/// What modified incomplete Cholesky carries over of what it drops (Bridson 2008, Fig. 4.2).
const TAU: f64 = 0.97;
/// Below this share of the diagonal it is safer not modified.
const SIGMA: f64 = 0.25;

/// Potentials of all cells: 0 on what has grown, 1 on the other electrode, harmonic between them; borders and
/// forbidden nodes insulate.
pub(super) struct Laplace {
    strides: Vec<usize>,
    /// Links to the next cell along each axis exist.
    links: Vec<[bool; 3]>,
    is_free: Vec<bool>,
    potential: Vec<f64>,
    degree: Vec<f64>,
    factor: Vec<f64>,
    known: usize,
}

impl Laplace {
    /// The field of `generators` against `ends`.
    pub fn new(lattice: &Lattice, generators: &[Node], ends: impl Iterator<Item = Node>) -> Self {
        let size = lattice.window().size.map(|s| s as usize);
        let axes = if lattice.is_plane() { 2 } else { 3 };
        let strides: Vec<usize> = [1, size[0], size[0] * size[1]][..axes].to_vec();
        let cells = lattice.cells();
        let mut is_free = vec![false; cells];
        lattice.nodes().for_each(|node| is_free[lattice.cell(node)] = true);
        let mut links = vec![[false; 3]; cells];
        for cell in 0..cells {
            for axis in 0..axes {
                let along = cell / strides[axis] % size[axis];
                links[cell][axis] = along + 1 < size[axis] && is_free[cell] && is_free[cell + strides[axis]];
            }
        }
        let mut degree = vec![0.0; cells];
        for cell in 0..cells {
            for axis in (0..axes).filter(|&axis| links[cell][axis]) {
                degree[cell] += 1.0;
                degree[cell + strides[axis]] += 1.0;
            }
        }
        let mut potential = vec![0.5; cells];
        for end in ends.map(|node| lattice.cell(node)) {
            (is_free[end], potential[end]) = (false, 1.0);
        }
        for &generator in generators {
            let cell = lattice.cell(generator);
            (is_free[cell], potential[cell]) = (false, 0.0);
        }
        let mut laplace = Self { strides, links, is_free, potential, degree, factor: Vec::new(), known: 0 };
        laplace.factorise();
        laplace
    }

    /// The potential of a cell, from 0 to 1.
    pub fn potential(&self, cell: usize) -> f64 {
        self.potential[cell].clamp(0.0, 1.0)
    }

    /// Calls `visit` with each pair of linked cells.
    fn for_links(&self, mut visit: impl FnMut(usize, usize)) {
        for (cell, links) in self.links.iter().enumerate() {
            for (axis, stride) in self.strides.iter().enumerate() {
                if links[axis] {
                    visit(cell, cell + stride);
                }
            }
        }
    }

    /// The diagonal of the modified incomplete Cholesky factor, inverted.
    fn factorise(&mut self) {
        self.factor = vec![0.0; self.degree.len()];
        for cell in (0..self.degree.len()).filter(|&cell| self.is_free[cell]) {
            let mut e = self.degree[cell];
            for (axis, stride) in self.strides.iter().enumerate() {
                let Some(before) = cell.checked_sub(*stride).filter(|&b| self.links[b][axis] && self.is_free[b]) else {
                    continue;
                };
                let f = self.factor[before];
                let others = (0..self.strides.len()).filter(|&other| {
                    other != axis && self.links[before][other] && self.is_free[before + self.strides[other]]
                });
                e -= f * f * (1.0 + TAU * others.count() as f64);
            }
            let e = if e < SIGMA * self.degree[cell] { self.degree[cell] } else { e };
            self.factor[cell] = if e > 0.0 { 1.0 / e.sqrt() } else { 0.0 };
        }
    }

    /// Solves with the factor: `L L^T z = r`.
    fn precondition(&self, r: &[f64], z: &mut [f64]) {
        for cell in 0..r.len() {
            if !self.is_free[cell] {
                z[cell] = 0.0;
                continue;
            }
            let mut sum = r[cell];
            for (axis, stride) in self.strides.iter().enumerate() {
                if cell >= *stride && self.links[cell - stride][axis] && self.is_free[cell - stride] {
                    sum += self.factor[cell - stride] * z[cell - stride];
                }
            }
            z[cell] = sum * self.factor[cell];
        }
        for cell in (0..r.len()).rev().filter(|&cell| self.is_free[cell]) {
            let mut sum = z[cell];
            for (axis, stride) in self.strides.iter().enumerate() {
                if self.links[cell][axis] && self.is_free[cell + stride] {
                    sum += self.factor[cell] * z[cell + stride];
                }
            }
            z[cell] = sum * self.factor[cell];
        }
    }

    /// The Laplacian of `x` (degree minus neighbours) at free cells, 0 elsewhere.
    fn laplacian(&self, x: &[f64], out: &mut [f64]) {
        for (cell, value) in out.iter_mut().enumerate() {
            *value = self.degree[cell] * x[cell];
        }
        self.for_links(|a, b| {
            out[a] -= x[b];
            out[b] -= x[a];
        });
        for (value, is_free) in out.iter_mut().zip(&self.is_free) {
            *value *= f64::from(u8::from(*is_free));
        }
    }

    /// Finds the potentials when all of `grown` is at 0: conjugate gradients from the last solution on.
    pub fn solve(&mut self, grown: impl Iterator<Item = usize>) {
        let mut count = 0;
        for cell in grown {
            (self.is_free[cell], self.potential[cell]) = (false, 0.0);
            count += 1;
        }
        // A stale factor still helps; a fresh one is worth its cost now and then.
        if count > self.known + 64 {
            self.factorise();
            self.known = count;
        }
        let cells = self.potential.len();
        let mut r = vec![0.0; cells];
        self.laplacian(&self.potential, &mut r);
        r.iter_mut().for_each(|x| *x = -*x);
        // The right side is what the other electrode brings in.
        let mut right = 0.0;
        self.for_links(|a, b| {
            let brings = |from: usize, to: usize| !self.is_free[from] && self.is_free[to];
            right += if brings(a, b) { self.potential[a] } else { 0.0 };
            right += if brings(b, a) { self.potential[b] } else { 0.0 };
        });
        let enough = TOLERANCE * TOLERANCE * right.max(1.0);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut z = vec![0.0; cells];
        self.precondition(&r, &mut z);
        let mut way = z.clone();
        let mut product = dot(&r, &z);
        let mut image = vec![0.0; cells];
        for _ in 0..MOST_ITERATIONS {
            if dot(&r, &r) <= enough {
                break;
            }
            self.laplacian(&way, &mut image);
            let step = product / dot(&way, &image);
            if !step.is_finite() {
                break;
            }
            for i in 0..cells {
                self.potential[i] += step * way[i];
                r[i] -= step * image[i];
            }
            self.precondition(&r, &mut z);
            let next = dot(&r, &z);
            let share = next / product;
            product = next;
            for i in 0..cells {
                way[i] = z[i] + share * way[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Neighbours;
    use crate::graph::Window;
    use crate::math::Weights;
    use crate::math::{DVec3, Stream};

    /// Between a row at 0 and a row at 1 the potential is even in the distance.
    #[test]
    fn is_linear_between_plates() {
        let window = Window::new(DVec3::ZERO, DVec3::new(12.0, 20.0, 0.0), 1.0, 2).unwrap();
        let four = Neighbours::try_from(4).unwrap();
        let lattice = Lattice::plain(window, four, &Stream::new(1, "plates"), Weights::default()).unwrap();
        let row = |y: u32| (0..13).map(move |x| [x, y, 0]).collect::<Vec<_>>();
        let low: Vec<Node> = row(0).into_iter().map(|at| lattice.node(at)).collect();
        let high = row(20).into_iter().map(|at| lattice.node(at));
        let mut laplace = Laplace::new(&lattice, &low, high);
        laplace.solve(low.iter().map(|&node| lattice.cell(node)));
        for y in 0..=20 {
            let found = laplace.potential(lattice.cell(lattice.node([5, y, 0])));
            assert!((found - f64::from(y) / 20.0).abs() < 1e-3, "{y}: {found}");
        }
    }
}
