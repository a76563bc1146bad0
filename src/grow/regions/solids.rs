//! Shapes that other steps grow: what a step waits for, and what it gets.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::geom::{Shape, Solid, Voxels};
use crate::grow::rounds::{Rank, Target};
use crate::grow::step::{Generators, Step};

/// Adds the steps whose solids `shape` is made of.
fn visit(shape: &Shape, found: &mut BTreeSet<usize>) {
    match shape.solid() {
        Solid::Grown(step, _) => {
            found.insert(*step);
        }
        Solid::Shell { of, .. } => visit(of, found),
        Solid::Sampled(sampled) => visit(sampled.shape(), found),
        Solid::Placed { shape, .. } => visit(shape, found),
        Solid::Union(of) | Solid::Intersection(of) | Solid::Difference(of) => {
            of.iter().for_each(|shape| visit(shape, found));
        }
        _ => {}
    }
}

impl Step {
    /// Every shape in it, but for those of its method.
    fn shapes_mut(&mut self) -> Vec<&mut Shape> {
        let mut shapes: Vec<&mut Shape> = self.space.as_mut().map(|space| space.shapes_mut()).unwrap_or_default();
        match &mut self.source {
            Generators::Spread(random) => shapes.extend(&mut random.inside),
            Generators::Inside(shape) => shapes.push(shape),
            Generators::At(_) | Generators::Steps(..) => {}
        }
        shapes.extend(self.endpoints.iter_mut().filter_map(|set| set.placement.shape_mut()));
        if let Some(repeat) = &mut self.repeat {
            for turn in &mut repeat.turns {
                if let Target::From(shape, _) = &mut turn.target {
                    shapes.push(shape);
                }
            }
            for influence in &mut repeat.influences {
                if let Rank::Near(shape) | Rank::Far(shape) = &mut influence.rank {
                    shapes.push(shape);
                }
            }
        }
        shapes
    }

    /// The steps whose solids its shapes are made of, by index.
    #[must_use]
    pub fn solids(&self) -> Vec<usize> {
        let mut found = BTreeSet::new();
        self.method.shapes().into_iter().for_each(|shape| visit(shape, &mut found));
        self.clone().shapes_mut().into_iter().for_each(|shape| visit(shape, &mut found));
        found.into_iter().collect()
    }

    /// The step with the solids that `grown` has in place of the steps that grew them.
    #[must_use]
    pub fn with_solids(&self, grown: &dyn Fn(usize) -> Option<Arc<Voxels>>) -> Self {
        let mut step = self.clone();
        if let Some(method) = step.method.with_shapes(&|shape| shape.with_grown(grown)) {
            step.method = method;
        }
        step.shapes_mut().into_iter().for_each(|shape| *shape = shape.with_grown(grown));
        step
    }
}
