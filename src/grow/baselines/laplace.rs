//! Laplace's equation on a lattice, for the dielectric breakdown model.

use super::multigrid::{Level, precondition, rebuild};
use crate::graph::{Graph, Lattice, Node};

/// Solutions are this exact: the residual over the right side, both in the Euclidean norm.
const TOLERANCE: f64 = 1e-4;
/// Iterations at most; a solution is carried on by the next call.
const MOST_ITERATIONS: u32 = 500;
/// Cells that grow between solutions everywhere, at most and as a share of all. What one changes fades with distance: until then
/// it is solved about it.
const EVERYWHERE: usize = 16;
const SHARE: f64 = 0.125;
/// So far about it, in cells along each axis, in the plane and in space: some thousands of cells.
const ABOUT: [usize; 2] = [24, 6];

/// Potentials of all cells: 0 on what has grown, 1 on the other electrode, harmonic between them; borders and
/// forbidden nodes insulate.
pub(super) struct Laplace {
    potential: Vec<f64>,
    /// The lattice, and coarser ones as they were at the last solution everywhere.
    levels: Vec<Level>,
    about: usize,
    /// The square of the residual's norm at which a solution is good enough.
    enough: f64,
    /// How many cells have grown, and since the last solution everywhere.
    grown: usize,
    since: usize,
    scratch: [Vec<f64>; 4],
}

impl Laplace {
    /// The field of `generators` against `ends`.
    pub fn new(lattice: &Lattice, generators: &[Node], ends: impl Iterator<Item = Node>) -> Self {
        let cells = lattice.cells();
        let mut is_node = vec![false; cells];
        lattice.nodes().for_each(|node| is_node[lattice.cell(node)] = true);
        let size = lattice.window().size.map(|s| s as usize);
        let mut finest = Level::new(size, |a, b| is_node[a] && is_node[b]);
        let mut potential = vec![0.5; cells];
        let fixed = ends.map(|node| (node, 1.0)).chain(generators.iter().map(|&node| (node, 0.0)));
        for (node, value) in fixed {
            let cell = lattice.cell(node);
            finest.fix(cell);
            potential[cell] = value;
        }
        let about = ABOUT[usize::from(!lattice.is_plane())];
        let scratch = std::array::from_fn(|_| vec![0.0; cells]);
        Self { potential, levels: vec![finest], about, enough: 0.0, grown: 0, since: 0, scratch }
    }

    /// The potential of a cell, from 0 to 1.
    pub fn potential(&self, cell: usize) -> f64 {
        self.potential[cell].clamp(0.0, 1.0)
    }

    /// Finds the potentials with `grown` at 0 too, from the last solution on: about it, and now and then everywhere.
    pub fn ground(&mut self, grown: &[usize]) {
        for &cell in grown {
            self.levels[0].fix(cell);
            self.potential[cell] = 0.0;
        }
        self.grown += grown.len();
        self.since += grown.len();
        if self.since >= EVERYWHERE || self.since as f64 > SHARE * self.grown as f64 {
            return self.solve_everywhere();
        }
        for &cell in grown {
            let cells = self.levels[0].cells_about(cell, self.about);
            self.solve(&cells, false);
        }
    }

    /// Finds all potentials.
    fn solve_everywhere(&mut self) {
        self.since = 0;
        rebuild(&mut self.levels);
        let finest = &self.levels[0];
        let cells: Vec<usize> = (0..self.potential.len()).filter(|&cell| finest.is_free(cell)).collect();
        // The right side is what the other electrode brings in.
        let [fixed, ..] = &mut self.scratch;
        fixed.clone_from(&self.potential);
        cells.iter().for_each(|&cell| fixed[cell] = 0.0);
        let right: f64 = cells.iter().map(|&cell| finest.around(cell, fixed)).sum();
        fixed.fill(0.0);
        self.enough = TOLERANCE * TOLERANCE * right.max(1.0);
        self.solve(&cells, true);
    }

    /// Finds the potentials of `cells`, ascending, with the others as they are, by conjugate gradients: are these all that are
    /// free?
    fn solve(&mut self, cells: &[usize], is_all: bool) {
        let [r, z, way, image] = &mut self.scratch;
        let (levels, potential) = (&mut self.levels, &mut self.potential);
        let dot = |a: &[f64], b: &[f64]| cells.iter().map(|&c| a[c] * b[c]).sum::<f64>();
        let precondition = |levels: &mut [Level], r: &[f64], z: &mut [f64]| {
            if is_all {
                return precondition(levels, r, z);
            }
            // Gauss-Seidel there and back.
            cells.iter().for_each(|&c| z[c] = 0.0);
            cells.iter().chain(cells.iter().rev()).for_each(|&c| z[c] = levels[0].balanced(c, r[c], z));
        };
        cells.iter().for_each(|&c| (r[c], way[c]) = (-levels[0].laplacian(c, potential), 0.0));
        let mut product = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            if dot(r, r) <= self.enough {
                break;
            }
            precondition(levels, r, z);
            let before = std::mem::replace(&mut product, dot(r, z));
            cells.iter().for_each(|&c| way[c] = z[c] + product / before * way[c]);
            cells.iter().for_each(|&c| image[c] = levels[0].laplacian(c, way));
            let step = product / dot(way, image);
            if !step.is_finite() {
                break;
            }
            for &c in cells {
                potential[c] += step * way[c];
                r[c] -= step * image[c];
            }
        }
        // What is not among the next cells has to be 0.
        self.scratch.iter_mut().for_each(|x| cells.iter().for_each(|&c| x[c] = 0.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Neighbours;
    use crate::graph::Window;
    use crate::math::Weights;
    use crate::math::{DVec3, Stream};

    fn lattice(most: DVec3, neighbours: u32) -> Lattice {
        let axes = if most.z > 0.0 { 3 } else { 2 };
        let window = Window::new(DVec3::ZERO, most, 1.0, axes).unwrap();
        let neighbours = Neighbours::try_from(neighbours).unwrap();
        Lattice::plain(window, neighbours, &Stream::new(1, "plates"), Weights::default()).unwrap()
    }

    /// Between a row at 0 and a row at 1 the potential is even in the distance.
    #[test]
    fn is_linear_between_plates() {
        let lattice = lattice(DVec3::new(12.0, 20.0, 0.0), 4);
        let row = |y: u32| (0..13).map(move |x| [x, y, 0]).collect::<Vec<_>>();
        let low: Vec<Node> = row(0).into_iter().map(|at| lattice.node(at)).collect();
        let high = row(20).into_iter().map(|at| lattice.node(at));
        let mut laplace = Laplace::new(&lattice, &low, high);
        laplace.ground(&low.iter().map(|&node| lattice.cell(node)).collect::<Vec<_>>());
        for y in 0..=20 {
            let found = laplace.potential(lattice.cell(lattice.node([5, y, 0])));
            assert!((found - f64::from(y) / 20.0).abs() < 1e-3, "{y}: {found}");
        }
    }

    /// In space too.
    #[test]
    fn is_linear_in_space() {
        let lattice = lattice(DVec3::new(6.0, 9.0, 5.0), 6);
        let plate = |y: u32| (0..7).flat_map(move |x| (0..6).map(move |z| [x, y, z]));
        let low: Vec<Node> = plate(0).map(|at| lattice.node(at)).collect();
        let mut laplace = Laplace::new(&lattice, &low, plate(9).map(|at| lattice.node(at)));
        laplace.ground(&low.iter().map(|&node| lattice.cell(node)).collect::<Vec<_>>());
        for y in 0..=9 {
            let found = laplace.potential(lattice.cell(lattice.node([5, y, 2])));
            assert!((found - f64::from(y) / 9.0).abs() < 1e-3, "{y}: {found}");
        }
    }

    /// Solving about a cell that grew takes most of what it changed away, and solving everywhere all that counts: so much as
    /// [`TOLERANCE`] leaves.
    #[test]
    fn what_a_cell_changes_fades() {
        let lattice = lattice(DVec3::new(150.0, 150.0, 0.0), 8);
        let cell = |[x, y]: [u32; 2]| lattice.cell(lattice.node([x, y, 0]));
        // A bolt that goes this way and that.
        let bolt: Vec<usize> = (0..80).map(|i| cell([75 + i / 7 % 3 * i % 5, 150 - i])).collect();
        let field = || Laplace::new(&lattice, &[lattice.node([75, 150, 0])], (0..151).map(|x| lattice.node([x, 0, 0])));
        let [mut steps, mut idle] = [field(), field()];
        for (count, &grown) in bolt.iter().enumerate() {
            steps.ground(&[grown]);
            let mut whole = field();
            whole.ground(&bolt[..=count]);
            whole.solve_everywhere();
            let apart = |one: &Laplace| {
                let all = one.potential.iter().zip(&whole.potential);
                all.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            if steps.since == 0 {
                let cells: Vec<usize> = (0..lattice.cells()).filter(|&c| steps.levels[0].is_free(c)).collect();
                let residual = cells.iter().map(|&c| steps.levels[0].laplacian(c, &steps.potential)).map(|r| r * r);
                assert!(residual.sum::<f64>() <= 1.01 * steps.enough, "{count}");
                idle.potential.clone_from(&steps.potential);
            } else {
                idle.potential[grown] = 0.0;
                assert!(apart(&steps) < 0.5 * apart(&idle), "{count}: {} {}", apart(&steps), apart(&idle));
            }
        }
    }
}
