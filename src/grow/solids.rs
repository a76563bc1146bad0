//! Shapes that other steps grow: what a step waits for, and what it gets.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Method, Placement, Rank, Source, Space, Step, Target};
use crate::geom::{Shape, Solid, Voxels};
use crate::graph::{CostField, Measure};

fn measured(field: &mut CostField) -> Option<&mut Shape> {
    if let Measure::Shape(shape) = &mut field.measure { Some(shape) } else { None }
}

impl Step {
    /// Every shape in it.
    fn shapes_mut(&mut self) -> Vec<&mut Shape> {
        let mut shapes: Vec<&mut Shape> = Vec::new();
        match &mut self.method {
            Method::Segments(segments) => shapes.extend(&mut segments.inside),
            Method::Voxels(voxels) => {
                shapes.extend(voxels.cling.as_mut().map(|cling| &mut cling.to));
                shapes.extend(voxels.keep_from.as_mut().map(|(shape, _)| shape));
            }
            _ => {}
        }
        match &mut self.space {
            None => {}
            Some(Space::Voxels(space)) => {
                shapes.push(&mut space.shape);
                shapes.extend(&mut space.forbid);
            }
            Some(Space::Lattice(space)) => {
                shapes.push(&mut space.shape);
                shapes.extend(&mut space.forbid);
                shapes.extend(space.fields.iter_mut().filter_map(measured));
            }
            Some(Space::Scatter(space)) => {
                shapes.push(&mut space.shape);
                shapes.extend(&mut space.forbid);
                shapes.extend(space.clusters.as_mut().map(|clusters| &mut clusters.inside));
                shapes.extend(space.fields.iter_mut().filter_map(measured));
            }
        }
        let spread = match &mut self.source {
            Source::Spread(placement) => Some(placement),
            Source::Inside(shape) => {
                shapes.push(shape);
                None
            }
            Source::At(_) | Source::Steps(..) => None,
        };
        for placement in spread.into_iter().chain(self.endpoints.iter_mut().map(|set| &mut set.placement)) {
            match placement {
                Placement::Random { inside: Some(shape), .. } => shapes.push(shape),
                Placement::Near(near) => shapes.push(&mut near.inside),
                Placement::Random { .. } | Placement::At(_) | Placement::Through(_) => {}
            }
        }
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
        let mut found = BTreeSet::new();
        self.clone().shapes_mut().into_iter().for_each(|shape| visit(shape, &mut found));
        found.into_iter().collect()
    }

    /// The step with the solids that `grown` has in place of the steps that grew them.
    #[must_use]
    pub fn with_solids(&self, grown: &dyn Fn(usize) -> Option<Arc<Voxels>>) -> Self {
        let mut step = self.clone();
        step.shapes_mut().into_iter().for_each(|shape| *shape = shape.with_grown(grown));
        step
    }
}
