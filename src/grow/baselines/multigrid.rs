//! Multigrid by aggregation on a lattice, to precondition conjugate gradients with (Braess 1995): a coarser level has one cell
//! for two along each axis, and links that weigh what those between the finer cells do together.

use std::ops::{Add, Mul, Sub};

/// What corrections by constant pieces fall short of is made up for (Braess 1995, section 3).
const OVER: f32 = 1.8;
/// The coarsest level is no wider than this, and swept so often.
const COARSEST: usize = 4;
const SWEEPS: usize = 4;

/// Numbers of the levels, or of those who use them.
pub(super) trait Float:
    Copy + Default + From<f32> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}
impl Float for f32 {}
impl Float for f64 {}

/// The Laplacian of a lattice whose links have weights; cells that are not free are at 0.
pub(super) struct Level {
    size: [usize; 3],
    strides: Vec<usize>,
    /// The weights of links to the next cell along each axis.
    links: Vec<Vec<f32>>,
    /// The weights of all links of a cell.
    degree: Vec<f32>,
    /// Its inverse; 0 where a cell is not free, or has no link.
    inverse: Vec<f32>,
    right: Vec<f32>,
    x: Vec<f32>,
}

impl Level {
    /// A lattice of `size` cells that is linked, by weights of 1, where `is_linked` says so of a cell and the next along an axis.
    pub fn new(size: [usize; 3], is_linked: impl Fn(usize, usize) -> bool) -> Self {
        let mut level = Self::without_links(size);
        for cell in 0..level.x.len() {
            for (axis, stride) in level.strides.iter().enumerate() {
                let is_last = cell / stride % size[axis] + 1 == size[axis];
                if !is_last && is_linked(cell, cell + stride) {
                    level.links[axis][cell] = 1.0;
                    level.degree[cell] += 1.0;
                    level.degree[cell + stride] += 1.0;
                }
            }
        }
        level.invert();
        level
    }

    fn without_links(size: [usize; 3]) -> Self {
        let cells = size.iter().product();
        let axes = if size[2] == 1 { 2 } else { 3 };
        let strides = [1, size[0], size[0] * size[1]][..axes].to_vec();
        let [degree, inverse, right, x] = std::array::from_fn(|_| vec![0.0; cells]);
        Self { size, strides, links: vec![vec![0.0; cells]; axes], degree, inverse, right, x }
    }

    fn invert(&mut self) {
        self.inverse = self.degree.iter().map(|&degree| if degree > 0.0 { 1.0 / degree } else { 0.0 }).collect();
    }

    /// Sets a cell to 0 for ever.
    pub fn fix(&mut self, cell: usize) {
        self.inverse[cell] = 0.0;
    }

    /// May a cell have another value than 0?
    pub fn is_free(&self, cell: usize) -> bool {
        self.inverse[cell] > 0.0
    }

    /// The free cells up to `reach` from `cell` along each axis, ascending.
    pub fn cells_about(&self, cell: usize, reach: usize) -> Vec<usize> {
        let mut cells = vec![cell];
        for (axis, stride) in self.strides.iter().enumerate().rev() {
            let at = cell / stride % self.size[axis];
            let range = at.saturating_sub(reach)..=(at + reach).min(self.size[axis] - 1);
            let moved = |&from: &usize| range.clone().map(move |i| from - at * stride + i * stride);
            cells = cells.iter().flat_map(moved).collect();
        }
        cells.retain(|&cell| self.is_free(cell));
        cells
    }

    /// The sum of `x` over the neighbours of a cell, by the weights of the links.
    #[inline(always)]
    pub fn around<T: Float>(&self, cell: usize, x: &[T]) -> T {
        let mut sum = T::default();
        for (stride, links) in self.strides.iter().zip(&self.links) {
            if let Some(before) = cell.checked_sub(*stride) {
                sum = sum + T::from(links[before]) * x[before];
            }
            if let Some(&next) = x.get(cell + stride) {
                sum = sum + T::from(links[cell]) * next;
            }
        }
        sum
    }

    /// The Laplacian of `x` at a cell: what it is times its links less what is around it.
    #[inline(always)]
    pub fn laplacian<T: Float>(&self, cell: usize, x: &[T]) -> T {
        T::from(self.degree[cell]) * x[cell] - self.around(cell, x)
    }

    /// What `x` would be at a free cell for the Laplacian to be `right` there.
    #[inline(always)]
    pub fn balanced<T: Float>(&self, cell: usize, right: T, x: &[T]) -> T {
        T::from(self.inverse[cell]) * (right + self.around(cell, x))
    }

    /// Gauss-Seidel over the cells of one colour, 0 or 1, as on a chessboard: they do not wait for each other.
    fn sweep(&mut self, colour: usize) {
        let [nx, ny, nz] = self.size;
        for (y, z) in (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z))) {
            let row = nx * (y + ny * z);
            for cell in (row + (y + z + colour) % 2..row + nx).step_by(2) {
                self.x[cell] = self.balanced(cell, self.right[cell], &self.x);
            }
        }
    }

    /// Calls `visit` with every cell and the one of the coarser level `next` that it is in.
    fn for_parents(&self, next: &Self, mut visit: impl FnMut(usize, usize)) {
        let [nx, ny, nz] = self.size;
        for (y, z) in (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z))) {
            let (row, parents) = (nx * (y + ny * z), next.size[0] * (y / 2 + next.size[1] * (z / 2)));
            (0..nx).for_each(|x| visit(row + x, parents + x / 2));
        }
    }

    /// The coarser level, if this is not the coarsest.
    fn coarser(&self) -> Option<Self> {
        if self.size.iter().all(|&size| size <= COARSEST) {
            return None;
        }
        let mut next = Self::without_links(self.size.map(|size| size.div_ceil(2)));
        let mut parents = vec![0; self.x.len()];
        self.for_parents(&next, |cell, parent| parents[cell] = parent);
        for (cell, &parent) in parents.iter().enumerate().filter(|(cell, _)| self.is_free(*cell)) {
            next.degree[parent] += self.degree[cell];
            for (axis, stride) in self.strides.iter().enumerate() {
                let weight = self.links[axis][cell];
                if weight > 0.0 && self.is_free(cell + stride) {
                    if parents[cell + stride] == parent {
                        next.degree[parent] -= 2.0 * weight;
                    } else {
                        next.links[axis][parent] += weight;
                    }
                }
            }
        }
        next.invert();
        Some(next)
    }
}

/// Makes the coarser levels anew, down to the coarsest.
pub(super) fn rebuild(levels: &mut Vec<Level>) {
    levels.truncate(1);
    while let Some(next) = levels.last().and_then(Level::coarser) {
        levels.push(next);
    }
}

/// An approximate solution whose Laplacian is `right`, to `x`: symmetric and definite, so conjugate gradients may use it.
pub(super) fn precondition(levels: &mut [Level], right: &[f64], x: &mut [f64]) {
    let finest = &mut levels[0];
    finest.right.iter_mut().zip(right).for_each(|(to, from)| *to = *from as f32);
    finest.x.fill(0.0);
    cycle(levels);
    x.iter_mut().zip(&levels[0].x).for_each(|(to, from)| *to = f64::from(*from));
}

/// A W-cycle from what `x` is: Gauss-Seidel there and back, and between them corrections by the coarser levels.
fn cycle(levels: &mut [Level]) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    if coarser.is_empty() {
        for _ in 0..SWEEPS {
            [0, 1, 0].into_iter().for_each(|colour| level.sweep(colour));
        }
        return;
    }
    [0, 1].into_iter().for_each(|colour| level.sweep(colour));
    let next = &mut coarser[0];
    next.x.fill(0.0);
    let mut right = std::mem::take(&mut next.right);
    right.fill(0.0);
    level.for_parents(next, |cell, parent| {
        if level.is_free(cell) {
            right[parent] += level.right[cell] - level.laplacian(cell, &level.x);
        }
    });
    next.right = right;
    cycle(coarser);
    cycle(coarser);
    let (next, mut x) = (&coarser[0], std::mem::take(&mut level.x));
    level.for_parents(next, |cell, parent| {
        if level.is_free(cell) {
            x[cell] += OVER * next.x[parent];
        }
    });
    level.x = x;
    [1, 0].into_iter().for_each(|colour| level.sweep(colour));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// `x` times its Laplacian.
    fn energy(level: &Level, x: &[f64]) -> f64 {
        (0..x.len()).map(|cell| x[cell] * level.laplacian(cell, x)).sum()
    }

    proptest! {
        /// What is constant on the cells of the coarser level has the same energy there; a cycle takes more than half of the
        /// error's away.
        #[test]
        fn levels_agree(
            size in [1..9_usize, 1..9_usize, 1..5_usize],
            draws in prop::collection::vec(0..10_u8, 9 * 9 * 5),
            values in prop::collection::vec(-1.0..1.0_f64, 9 * 9 * 5),
        ) {
            let mut fine = Level::new(size, |a, b| draws[a] > 1 && draws[b] > 1);
            let cells = size.iter().product::<usize>();
            (0..cells).filter(|&cell| draws[cell] == 9).for_each(|cell| fine.fix(cell));
            let right: Vec<f64> = (0..cells).map(|cell| if fine.is_free(cell) { values[cell] } else { 0.0 }).collect();
            if let Some(coarse) = fine.coarser() {
                let mut x = vec![0.0; cells];
                fine.for_parents(&coarse, |cell, parent| x[cell] = if fine.is_free(cell) { values[parent] } else { 0.0 });
                let coarse_x: Vec<f64> = values[..coarse.x.len()].to_vec();
                prop_assert!((energy(&fine, &x) - energy(&coarse, &coarse_x)).abs() < 1e-4);
            }
            // Laplacians have such solutions only: x is one, and a cycle from 0 comes nearer to it.
            let image: Vec<f64> =
                (0..cells).map(|cell| if fine.is_free(cell) { fine.laplacian(cell, &right) } else { 0.0 }).collect();
            let mut levels = vec![fine];
            rebuild(&mut levels);
            let mut found = vec![0.0; cells];
            precondition(&mut levels, &image, &mut found);
            let error: Vec<f64> = right.iter().zip(&found).map(|(a, b)| a - b).collect();
            prop_assert!(energy(&levels[0], &error) <= 0.5 * energy(&levels[0], &right) + 1e-9);
        }
    }
}
