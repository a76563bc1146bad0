//! Lights along what shines.

use super::LightsSpec;
use crate::math::{Colour, DVec3};
use crate::model::Light;
use crate::skeleton::Skeleton;
use crate::skin::shining;

/// Lights along the core of what grew: evenly spaced along its paths.
pub(super) fn lights_along(skeletons: &[&Skeleton], at: DVec3, spec: &LightsSpec) -> Vec<Light> {
    let core = shining(skeletons).filter(|(.., is_core)| *is_core);
    let pieces: Vec<(DVec3, DVec3)> = core.map(|(from, to, _)| (from.position, to.position)).collect();
    let length: f64 = pieces.iter().map(|(a, b)| (*b - *a).length()).sum();
    let Colour(colour) = spec.colour;
    let one = Colour(colour.map(|c| c / f64::from(spec.count)));
    let mut lights = Vec::new();
    let mut gone = 0.0;
    for (a, b) in pieces {
        let step = (b - a).length();
        let next = |made: usize| length * (made as f64 + 0.5) / f64::from(spec.count);
        while lights.len() < spec.count as usize && gone + step > next(lights.len()) {
            let p = a + (b - a) * ((next(lights.len()) - gone) / step);
            lights.push(Light::Point { at: p + at, colour: one, shadow: false, fade: Some(spec.fade) });
        }
        gone += step;
    }
    lights
}
