//! The mean cost of least-cost paths by length.

use super::{Goal, plan};
use crate::geom::Neighbours;
use crate::graph::{Graph, Lattice, LatticeError, Node, Window};
use crate::math::{Progress, Stream, Weights};

/// Distance at which it is measured, in lattice steps: about the extent of a glow. Nearer, a step costs more, since there are
/// fewer paths to choose from; far away a tenth less.
const REACH: u32 = 16;
/// Nodes along the line in the plane, and along each side of the plane in space.
const ACROSS: [u32; 2] = [2048, 48];

/// The mean cost per lattice step of least-cost paths from a line (in space, from a plane), as a real number: the divisor
/// that converts costs to lengths. With alpha 3 it is a third of the mean weight with 4 neighbours, and under a tenth with 8.
///
/// # Errors
/// [`LatticeError::Weights`] where weights are out of range.
pub fn mean_cost(neighbours: Neighbours, weights: Weights) -> Result<f64, LatticeError> {
    let [wide, square] = ACROSS;
    let (size, along) =
        if neighbours.is_plane() { ([wide, REACH + 1, 1], 1) } else { ([square, square, REACH + 1], 2) };
    let window = Window { spacing: 1.0, origin: [0; 3], size };
    let lattice = Lattice::plain(window, neighbours, &Stream::new(0, "mean cost"), weights)?;
    let at = |rank: u32| {
        let is_there = |node: &Node| window.nearest(lattice.position(*node)).is_some_and(|at| at[along] == rank);
        lattice.nodes().filter(is_there).collect::<Vec<_>>()
    };
    let (line, ends) = (at(0), at(REACH));
    // It is never cancelled, and weights are in range.
    let Ok(plan) = plan(&lattice, &line, Goal::Nodes(&ends), &Progress::default()) else {
        return Err(LatticeError::Empty);
    };
    let range = lattice.weight_range();
    let sum: f64 = ends.iter().filter_map(|&node| plan.cost(node)).map(|cost| range.real(cost)).sum();
    Ok(sum / ends.len() as f64 / f64::from(REACH))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::power;

    fn mean(neighbours: u32, weights: Weights) -> f64 {
        mean_cost(Neighbours::try_from(neighbours).unwrap(), weights).unwrap()
    }

    /// Least-cost paths pay far less for a step than the mean weight of an edge.
    #[test]
    fn paths_pay_less_than_the_mean() {
        // The mean of R^alpha over (1, max).
        let mean_weight = |max: f64, alpha: f64| (power(max, alpha + 1.0) - 1.0) / ((alpha + 1.0) * (max - 1.0));
        let ratio4 = |max, alpha| mean(4, Weights { max, alpha }) / mean_weight(max, alpha);
        let ratio8 = |max, alpha| mean(8, Weights { max, alpha }) / mean_weight(max, alpha);
        let (four, eight) = (ratio4(10.0, 3.0), ratio8(10.0, 3.0));
        assert!((0.27..0.38).contains(&four), "{four}");
        assert!(eight < 0.1, "{eight}");
        assert!(ratio4(10.0, 1.0) > four && ratio8(10.0, 1.0) > eight);
        // In space there is more to choose from.
        let space = mean(6, Weights { max: 10.0, alpha: 3.0 }) / mean_weight(10.0, 3.0);
        assert!(space < four, "{space}");
        // Without chance a step costs what it weighs.
        assert!((mean(4, Weights { max: 1.0, alpha: 1.0 }) - 1.0).abs() < 1e-6);
    }
}
