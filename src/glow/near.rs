//! The paper's glow: a second distance field, from the stroke (Xu and Mould 2008, section 3, Figs 3 and 4).

use std::collections::HashMap;

use super::Canvas;
use crate::graph::{Graph, Lattice, LatticeError, Node, Window};
use crate::math::{DVec2, DVec3, Progress, Stream};
use crate::model::Stroke;
use crate::plan::{Goal, PlanError, mean_cost, plan};

/// The default grain: so many lattice steps from the bottom of a view to its top.
const GRAINS: f64 = 720.0;
/// Bytes that a node takes at the peak, with those of the other field, which is made at the same time.
const NODE_BYTES: u64 = 128;
/// Beyond so many times T there is nothing left to see: `exp(-9)`.
const REACH: f64 = 3.0;

/// A picture of V on a lattice.
pub(super) struct NearField {
    origin: DVec2,
    spacing: f64,
    size: [u32; 2],
    values: Vec<f32>,
}

impl NearField {
    /// The glow of the core of `stroke`, or of its branches, around `canvas`: apart, since where a thin branch leaves a
    /// thick channel its T would bite a piece out of the other's glow.
    ///
    /// # Errors
    /// [`PlanError::Cancelled`], and a sentence where weights or the grain do not fit.
    pub fn new(
        stroke: &Stroke,
        is_core: bool,
        canvas: &Canvas,
        seed: u64,
        max_memory: u64,
        progress: &Progress,
    ) -> Result<Self, Result<String, PlanError>> {
        if stroke.glow.near.neighbours.count() == 4 {
            Self::with::<4>(stroke, is_core, canvas, seed, max_memory, progress)
        } else {
            Self::with::<8>(stroke, is_core, canvas, seed, max_memory, progress)
        }
    }

    fn with<const N: usize>(
        stroke: &Stroke,
        is_core: bool,
        canvas: &Canvas,
        seed: u64,
        max_memory: u64,
        progress: &Progress,
    ) -> Result<Self, Result<String, PlanError>> {
        let near = &stroke.glow.near;
        let spacing = near.grain.unwrap_or(canvas.frame.extent[1] / GRAINS);
        let thickest = stroke.pieces.iter().flat_map(|p| p.radii).fold(0.0, f64::max) * near.spread;
        // What comes in from beyond the border is seen too.
        let margin = (thickest * REACH).min(canvas.frame.extent[1]) + spacing;
        let corners = [[0, canvas.size[1]], [canvas.size[0], 0]]
            .map(|[x, y]| canvas.to_scene(DVec2::new(f64::from(x), f64::from(y))));
        let wrong = |error: LatticeError| Ok(error.to_string());
        let [low, high] = [corners[0] - margin, corners[1] + margin].map(|p| p.extend(0.0));
        let window = Window::new(low, high, spacing, 2).map_err(wrong)?;
        let needed = window.nodes().saturating_mul(NODE_BYTES);
        if needed > max_memory {
            return Err(Ok(format!(
                "its lattice of {} nodes needs about {} MB of memory, more than the {} MB allowed: use a coarser `grain`",
                window.nodes(),
                needed.div_ceil(1_000_000),
                max_memory / 1_000_000
            )));
        }
        let stream = Stream::new(seed, &format!("glow/{}", stroke.name));
        let lattice: Lattice<N> = Lattice::plain(window, &stream, near.weights).map_err(wrong)?;

        // T at each node that the stroke passes; the thickest where several are.
        let mut thickness: HashMap<Node, f64> = HashMap::new();
        let mut generators = Vec::new();
        for piece in stroke.pieces.iter().filter(|piece| piece.is_core == is_core) {
            let way = piece.ends[1] - piece.ends[0];
            let steps = libm::ceil(way.length() / spacing * 2.0).max(1.0) as u32;
            for step in 0..=steps {
                let t = f64::from(step) / f64::from(steps);
                let Some(node) = lattice.nearest((piece.ends[0] + way * t).extend(0.0)) else { continue };
                let own = (piece.radii[0] + (piece.radii[1] - piece.radii[0]) * t) * near.spread;
                let known = thickness.entry(node).or_insert_with(|| {
                    generators.push(node);
                    own
                });
                *known = known.max(own);
            }
        }
        let mean = mean_cost::<N>(near.weights).map_err(|e| Ok(e.to_string()))?;
        let plan = plan(&lattice, &generators, Goal::Everything, progress).map_err(Err)?;
        let range = lattice.weight_range();
        let costs = plan.costs(lattice.nodes());
        let nearest = plan.labels(lattice.nodes());
        let mut values = vec![0.0_f32; lattice.cells()];
        for (value, (cost, source)) in values.iter_mut().zip(costs.iter().zip(&nearest)) {
            let (Some(cost), Some(source)) = (cost, source) else { continue };
            let distance = range.real(*cost) / mean * spacing;
            let over = distance / thickness[source].max(f64::MIN_POSITIVE);
            *value = libm::exp(-over * over) as f32;
        }
        let origin: DVec3 = window.position([0; 3]);
        Ok(Self { origin: origin.truncate(), spacing, size: [window.size[0], window.size[1]], values })
    }

    /// V at a place in the scene, even between nodes.
    pub fn at(&self, p: DVec2) -> f32 {
        let at = (p - self.origin) / self.spacing;
        let clamp = |x: f64, size: u32| x.clamp(0.0, f64::from(size - 1) - 1e-9).max(0.0);
        let (x, y) = (clamp(at.x, self.size[0]), clamp(at.y, self.size[1]));
        let (x0, y0) = (x as usize, y as usize);
        let (fx, fy) = ((x - x0 as f64) as f32, (y - y0 as f64) as f32);
        let [width, height] = self.size.map(|s| s as usize);
        let value = |x: usize, y: usize| self.values[y.min(height - 1) * width + x.min(width - 1)];
        let row = |y: usize| value(x0, y) * (1.0 - fx) + value(x0 + 1, y) * fx;
        row(y0) * (1.0 - fy) + row(y0 + 1) * fy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Neighbours;
    use crate::math::Weights;
    use crate::model::{GlowSpec, NearGlow, Piece, ViewFrame, ViewSpec};

    /// T is a length: at distance T from a straight stroke there is 1/e of its light, whatever the weights are.
    #[test]
    fn t_is_in_pixels() {
        let size = [160, 160];
        let frame = ViewFrame::new(&ViewSpec { height: Some(160.0), ..ViewSpec::default() }, size);
        let canvas = Canvas::new(frame, size);
        for (neighbours, alpha) in [(4, 1.0), (8, 1.0), (4, 3.0), (8, 3.0)] {
            for t in [8.0, 16.0] {
                let near = NearGlow {
                    strength: 1.0,
                    spread: 1.0,
                    grain: Some(1.0),
                    weights: Weights { max: 10.0, alpha },
                    neighbours: Neighbours::new(neighbours).unwrap(),
                };
                let pieces = vec![Piece {
                    ends: [DVec2::new(80.0, -50.0), DVec2::new(80.0, 210.0)],
                    radii: [t, t],
                    is_core: true,
                }];
                let stroke = Stroke { name: "s".to_owned(), pieces, glow: GlowSpec { near, ..GlowSpec::default() } };
                let field = NearField::new(&stroke, true, &canvas, 1, 1 << 30, &Progress::default()).unwrap();
                let mean = |x: f64| {
                    let sum: f64 = (0..160).map(|y| f64::from(field.at(DVec2::new(x, f64::from(y))))).sum();
                    sum / 160.0
                };
                let found = (mean(80.0 - t) + mean(80.0 + t)) * 0.5;
                assert!((found - 0.368).abs() < 0.1, "{neighbours} {alpha} {t}: {found}");
                assert!(mean(80.0) > 0.99 && mean(80.0 + 2.5 * t) < 0.05);
            }
        }
    }
}
