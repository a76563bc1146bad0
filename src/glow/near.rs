//! The glow of strokes by a second distance field (Xu and Mould 2008, section 3, Figs 3 and 4).

use std::collections::HashMap;

use super::Canvas;
use crate::graph::{Graph, Lattice, LatticeError, Node, Window};
use crate::math::{DVec2, Memory, OutOfMemory, Progress, Stream};
use crate::model::Stroke;
use crate::plan::{Goal, PlanError, mean_cost, plan};

/// Default resolution: lattice steps over the height of the view.
const GRAINS: f64 = 720.0;
/// Peak memory a node, in bytes, together with the other field, which is computed at the same time.
const NODE_BYTES: u64 = 128;
/// Extent of the glow, in multiples of T: `exp(-9)` is invisible.
const REACH: f64 = 3.0;

/// Why there is no field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum NearError {
    /// The lattice cannot be constructed.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The lattice exceeds the memory limit.
    #[error("its lattice of {0} nodes needs {1}: use a coarser `grain`")]
    Memory(u64, OutOfMemory),
    /// The search failed or was cancelled.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// The parameters of the fields of a stroke.
#[derive(Clone, Copy)]
pub(super) struct NearParameters<'a> {
    pub stroke: &'a Stroke,
    pub canvas: &'a Canvas,
    pub seed: u64,
    pub memory: &'a Memory,
    pub progress: &'a Progress,
}

/// V at the nodes of a lattice.
pub(super) struct NearField {
    origin: DVec2,
    spacing: f64,
    size: [u32; 2],
    values: Vec<f32>,
}

impl NearParameters<'_> {
    /// The glow of the core of the stroke, or of its branches: separately, since where a thin branch leaves a thick channel its
    /// T would cut a piece out of the channel's glow.
    ///
    /// # Errors
    /// [`NearError`].
    pub fn field(&self, is_core: bool) -> Result<NearField, NearError> {
        let near = &self.stroke.glow.near;
        let (neighbours, weights) = (near.neighbours, near.weights);
        let window = self.window()?;
        let stream = Stream::new(self.seed, &format!("glow/{}", self.stroke.name));
        let lattice = Lattice::plain(window, neighbours, &stream, weights)?;
        let (generators, thickness) = self.generators(&lattice, is_core);
        let mean = mean_cost(neighbours, weights)?;
        let plan = plan(&lattice, &generators, Goal::Everything, self.progress)?;
        let range = lattice.weight_range();
        let costs = plan.costs(lattice.nodes());
        let nearest = plan.labels(lattice.nodes());
        let mut values = vec![0.0_f32; lattice.cells()];
        for (value, (cost, source)) in values.iter_mut().zip(costs.iter().zip(&nearest)) {
            let (Some(cost), Some(source)) = (cost, source) else { continue };
            let distance = range.real(*cost) / mean * window.spacing;
            // V = exp(-(d / T)^2)
            let ratio = distance / thickness[source].max(f64::MIN_POSITIVE);
            *value = libm::exp(-ratio * ratio) as f32;
        }
        let origin = window.position([0; 3]).truncate();
        Ok(NearField { origin, spacing: window.spacing, size: [window.size[0], window.size[1]], values })
    }

    /// The lattice's window: the canvas with a margin, from beyond which no glow is visible.
    fn window(&self) -> Result<Window, NearError> {
        let (near, canvas) = (&self.stroke.glow.near, self.canvas);
        let spacing = near.grain.unwrap_or(canvas.frame.extent[1] / GRAINS);
        let thickest = self.stroke.pieces.iter().flat_map(|p| p.radii).fold(0.0, f64::max) * near.spread;
        let margin = (thickest * REACH).min(canvas.frame.extent[1]) + spacing;
        let corners = [[0, canvas.size[1]], [canvas.size[0], 0]]
            .map(|[x, y]| canvas.to_scene(DVec2::new(f64::from(x), f64::from(y))));
        let [low, high] = [corners[0] - margin, corners[1] + margin].map(|p| p.extend(0.0));
        let window = Window::new(low, high, spacing, 2)?;
        let needed = window.nodes().saturating_mul(NODE_BYTES);
        self.memory.ask(needed).map_err(|error| NearError::Memory(window.nodes(), error))?;
        Ok(window)
    }

    /// The nodes along the stroke, and T at each: the greatest of several.
    fn generators(&self, lattice: &Lattice, is_core: bool) -> (Vec<Node>, HashMap<Node, f64>) {
        let spacing = lattice.window().spacing;
        let mut thickness: HashMap<Node, f64> = HashMap::new();
        let mut generators = Vec::new();
        for piece in self.stroke.pieces.iter().filter(|piece| piece.is_core == is_core) {
            let span = piece.ends[1] - piece.ends[0];
            let steps = libm::ceil(span.length() / spacing * 2.0).max(1.0) as u32;
            for step in 0..=steps {
                let t = f64::from(step) / f64::from(steps);
                let Some(node) = lattice.nearest((piece.ends[0] + span * t).extend(0.0)) else { continue };
                let own = (piece.radii[0] + (piece.radii[1] - piece.radii[0]) * t) * self.stroke.glow.near.spread;
                let known = thickness.entry(node).or_insert_with(|| {
                    generators.push(node);
                    own
                });
                *known = known.max(own);
            }
        }
        (generators, thickness)
    }
}

impl NearField {
    /// V at a point of the scene, bilinearly interpolated.
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

    /// T is a length: at distance T from a straight stroke V is 1/e, whatever the weights.
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
                let progress = Progress::default();
                let parameters = NearParameters {
                    stroke: &stroke,
                    canvas: &canvas,
                    seed: 1,
                    memory: &Memory::default(),
                    progress: &progress,
                };
                let field = parameters.field(true).unwrap();
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
