//! Samples of a pixel.

use super::denoise::Guide;
use super::eye::Eye;
use super::film::Sample;
use super::sampling::{DIMENSIONS, numbers, on_lens};
use super::settings::RenderSettings;
use super::world::World;
use crate::bvh::Ray;
use crate::math::{Colour, DVec3};
use crate::model::Look;

/// Samples after which a pixel of background only is finished, and after so many more of which it is asked whether it needs others.
const FIRST: usize = 4;
/// As many in the natural look, where they come from neighbouring pixels too, and with a lens, where what is blurred may cover little.
const OPEN: usize = 8;
const LENS: usize = 16;
/// A pixel of the natural look is finished where the standard error of what it shows is below this, over the square root of the
/// number of samples that it may have: with 16, three of 255 in the midst of the scale.
const NOISE: f32 = 0.02;

/// Adds the samples of a pixel.
pub(super) fn sample(world: &World<'_>, view: &RenderSettings, eye: &Eye, x: u32, y: u32, samples: &mut Vec<Sample>) {
    let (px, py) = (f64::from(x), f64::from(y));
    let take = |ray: &Ray, u: &[f64; DIMENSIONS], number: u64| trace(world, view, eye, ray, u, number);
    if view.look == Look::Exact {
        let through = |[dx, dy]: [f64; 2]| take(&eye.ray(px + dx, py + dy), &[0.0; DIMENSIONS], 0);
        samples.push(through([0.5; 2]));
        let side = libm::round(libm::sqrt(f64::from(view.samples)));
        if side > 1.0 {
            for j in 0..side as u32 {
                for i in 0..side as u32 {
                    samples.push(through([i, j].map(|k| (f64::from(k) + 0.5) / side)));
                }
            }
        }
        return;
    }
    let pixel = u64::from(y) * u64::from(view.size[0]) + u64::from(x);
    for (n, u) in (0..).zip(numbers(x, y, view.samples)) {
        let [dx, dy] = match (view.samples, view.look) {
            (1, _) => [0.5; 2],
            (_, Look::Natural) => [u[0], u[1]].map(|u| 0.5 + tent(u)),
            _ => [u[0], u[1]],
        };
        let ray = match eye.camera.lens.is_pinhole() {
            true => eye.ray(px + dx, py + dy),
            false => eye.ray_through_lens(px + dx, py + dy, on_lens(x, y, n)),
        };
        samples.push(take(&ray, &u, pixel * u64::from(view.samples) + n));
        if samples.len().is_multiple_of(FIRST) && is_finished(view, eye, samples) {
            return;
        }
    }
}

/// A place by the weight of a tent from -1 to 1, for a number from 0 to 1: pixels share what lies at their edges, so that few samples
/// of a hard line make no teeth.
fn tent(u: f64) -> f64 {
    if u < 0.5 { libm::sqrt(2.0 * u) - 1.0 } else { 1.0 - libm::sqrt(2.0 - 2.0 * u) }
}

/// Does a pixel need no more samples?
fn is_finished(view: &RenderSettings, eye: &Eye, samples: &[Sample]) -> bool {
    let is_first = samples.len() == FIRST;
    if samples.iter().all(|s| s.object == 0) {
        return match (eye.camera.lens.is_pinhole(), view.look) {
            (false, _) => samples.len() >= LENS,
            (true, Look::Natural) => samples.len() >= OPEN,
            (true, _) => is_first,
        };
    }
    if view.look != Look::Natural || is_first {
        return false;
    }
    let guide = Guide::of(samples);
    guide.error() * (eye.camera.gain as f32) < NOISE / (view.samples as f32).sqrt()
}

/// The sample along a camera ray, the `number`th of the picture; `u` are its random numbers.
fn trace(world: &World<'_>, view: &RenderSettings, eye: &Eye, ray: &Ray, u: &[f64; DIMENSIONS], number: u64) -> Sample {
    let hazed = |far: f64, colour: Colour| world.model.hazed(ray.origin, ray.direction, far, colour);
    let Some(surface) = world.closest(ray, &eye.within, true) else {
        let Colour(seen) = match view.transparent {
            true => Colour([0.0; 3]),
            false => hazed(f64::INFINITY, world.model.sky.colour(ray.direction)),
        };
        return Sample {
            colour: seen,
            pigment: seen,
            alpha: if view.transparent { 0.0 } else { 1.0 },
            depth: f64::INFINITY,
            normal: DVec3::ZERO,
            point: DVec3::ZERO,
            cost: 0.0,
            level: 0,
            object: 0,
            branch: 0,
        };
    };
    let lit = match view.look {
        Look::Exact => world.exact(ray, &surface),
        Look::Studio => world.studio(ray, &surface, u),
        Look::Natural => world.natural(ray, &surface, u, number),
    };
    // The ground fades into the horizon.
    let share = match &world.model.ground {
        Some(ground) if surface.object.is_none() => ground.share(surface.point),
        _ => 1.0,
    };
    let behind = if view.transparent { Colour([0.0; 3]) } else { world.model.sky.at_horizon() };
    // The horizon has the colour of the haze.
    let faded = |colour: [f64; 3]| behind.mixed(hazed(surface.t, Colour(colour)), share).0;
    let (_, pigment) = world.material(&surface);
    Sample {
        colour: faded(lit),
        pigment: faded(pigment),
        alpha: if view.transparent { share } else { 1.0 },
        depth: (surface.point - eye.camera.at).dot(eye.frame[2]),
        normal: surface.normal,
        point: surface.point,
        cost: surface.cost,
        level: surface.level,
        object: surface.object.map_or(world.model.objects.len() as u32, |i| i) + 1,
        branch: surface.object.map_or(0, |_| surface.branch + 1),
    }
}
