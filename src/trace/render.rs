//! From a world to a picture: camera rays, samples, tiles.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::film::{Data, Picture, Sample, data, mean};
use super::sampling::numbers;
use super::smooth::{FaceKey, MARGIN, smooth};
use super::world::{Within, World};
use crate::bvh::Ray;
use crate::math::{Cancelled, Colour, DVec3, Progress};
use crate::model::{Camera, Projection};

/// Side of a tile, in pixels: small enough to balance the load, large enough for coherent rays.
const TILE: u32 = 16;
/// Samples after which a pixel of background only is finished.
const FIRST: usize = 4;

/// How a world is lit and sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// As POV-Ray: local illumination, and POV-Ray's samples.
    Exact,
    /// Light from the whole sky, soft shadows of the sun, ambient occlusion.
    #[default]
    Studio,
}

/// The parameters of a rendering.
#[derive(Clone, Copy, Debug)]
pub struct RenderSettings {
    /// Size of the whole picture, in pixels.
    pub size: [u32; 2],
    /// The crop window: left, top, width, height, in pixels.
    pub crop: [u32; 4],
    /// The look.
    pub look: Look,
    /// Samples a pixel. In the exact look, 1 is the pixel's centre; n is POV-Ray's `+AM1` with `+R` the square root of n: a grid and
    /// the centre.
    pub samples: u32,
    /// Omit the sky: alpha is the coverage by objects and ground.
    pub transparent: bool,
    /// Record [`Data`].
    pub data: bool,
}

impl RenderSettings {
    /// A whole picture of this size.
    #[must_use]
    pub fn new(size: [u32; 2], look: Look, samples: u32) -> Self {
        Self { size, crop: [0, 0, size[0], size[1]], look, samples, transparent: false, data: false }
    }
}

/// The generator of camera rays.
struct Eye {
    camera: Camera,
    /// Right, up and forwards.
    frame: [DVec3; 3],
    size: [f64; 2],
    /// Perspective: distance of the image plane of height 1. Parallel: width of the image plane.
    scale: f64,
    within: Vec<Within>,
}

impl Eye {
    fn new(world: &World<'_>, size: [u32; 2]) -> Self {
        let camera = world.model.camera;
        let within = match camera.projection {
            Projection::Perspective { .. } => world.within(camera.at),
            Projection::Parallel { .. } => Vec::new(),
        };
        let size = size.map(f64::from);
        let scale = match camera.projection {
            Projection::Perspective { angle } => 0.5 * size[0] / size[1] / libm::tan(angle * 0.5),
            Projection::Parallel { width } => width,
        };
        Self { camera, frame: camera.frame(), size, scale, within }
    }

    /// The ray through a point of the picture in pixel coordinates (`reference/povray.md`).
    fn ray(&self, x: f64, y: f64) -> Ray {
        let [right, up, forwards] = self.frame;
        let [width, height] = self.size;
        let aspect = width / height;
        let (u, v) = (x / width - 0.5, 0.5 - y / height);
        match self.camera.projection {
            Projection::Perspective { .. } => {
                Ray::new(self.camera.at, (forwards * self.scale + right * (aspect * u) + up * v).normalize())
            }
            Projection::Parallel { .. } => {
                Ray::new(self.camera.at + (right * u + up * (v / aspect)) * self.scale, forwards)
            }
        }
    }
}

/// Renders `world`.
///
/// # Errors
/// [`Cancelled`] by `progress`.
pub fn render(world: &World<'_>, view: &RenderSettings, progress: &Progress) -> Result<Picture, Cancelled> {
    let [left, top, width, height] = view.crop;
    if view.look == Look::Exact {
        return Ok(trace_tiles(world, view, progress)?.0);
    }
    // A crop equals that part of the whole picture: smoothing needs a margin.
    let (x, y) = (left.saturating_sub(MARGIN), top.saturating_sub(MARGIN));
    let right = (left + width + MARGIN).min(view.size[0]);
    let bottom = (top + height + MARGIN).min(view.size[1]);
    let wide = RenderSettings { crop: [x, y, right - x, bottom - y], ..*view };
    let (mut picture, faces) = trace_tiles(world, &wide, progress)?;
    picture.pixels = smooth(picture.width, &picture.pixels, &faces);
    Ok(picture.cut([left - x, top - y, width, height]))
}

/// Traces all tiles; a pixel has a face where all its samples hit one face of uniform colour.
fn trace_tiles(
    world: &World<'_>,
    view: &RenderSettings,
    progress: &Progress,
) -> Result<(Picture, Vec<Option<FaceKey>>), Cancelled> {
    let eye = Eye::new(world, view.size);
    let [left, top, width, height] = view.crop;
    let mut tiles: Vec<(u32, u32)> =
        (0..height.div_ceil(TILE)).flat_map(|y| (0..width.div_ceil(TILE)).map(move |x| (x, y))).collect();
    tiles.sort_by_key(|&(x, y)| morton(x) | morton(y) << 1);
    // Has it a uniform colour? By [`Sample::object`]: background, objects, ground.
    let is_even: Vec<bool> = std::iter::once(false)
        .chain(world.model.objects.iter().map(|o| world.model.materials[o.material].1.pattern.is_none()))
        .chain(std::iter::once(true))
        .collect();
    let face = |s: &Sample| FaceKey::new(s.object, s.normal);
    let done = AtomicUsize::new(0);
    let traced: Vec<TracedTile> = tiles
        .par_iter()
        .map(|&(tile_x, tile_y)| {
            progress.check()?;
            let mut tile = TracedTile::default();
            let mut samples = Vec::new();
            for (x, y) in places(tile_x, tile_y, width, height) {
                samples.clear();
                sample(world, view, &eye, left + x, top + y, &mut samples);
                tile.pixels.push(mean(&samples));
                let one = FaceKey::of_all(samples.iter().map(face));
                tile.faces.push(one.filter(|_| is_even[samples[0].object as usize]));
                if view.data {
                    tile.data.push(data(&samples));
                }
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.report("render", done as f64 / tiles.len() as f64)?;
            Ok(tile)
        })
        .collect::<Result<_, Cancelled>>()?;
    let count = width as usize * height as usize;
    let mut picture = Picture { width, height, pixels: vec![[0.0; 4]; count], data: Vec::new() };
    let mut faces = vec![None; count];
    picture.data = traced.first().and_then(|tile| tile.data.first()).map_or(Vec::new(), |&data| vec![data; count]);
    for (tile, &(tile_x, tile_y)) in traced.into_iter().zip(&tiles) {
        for (i, (x, y)) in places(tile_x, tile_y, width, height).enumerate() {
            let place = (y * width + x) as usize;
            picture.pixels[place] = tile.pixels[i];
            faces[place] = tile.faces[i];
            if view.data {
                picture.data[place] = tile.data[i];
            }
        }
    }
    Ok((picture, faces))
}

/// A finished tile, pixel by pixel.
#[derive(Default)]
struct TracedTile {
    pixels: Vec<[f32; 4]>,
    faces: Vec<Option<FaceKey>>,
    data: Vec<Data>,
}

/// The pixels of a tile of a picture of this size.
fn places(tile_x: u32, tile_y: u32, width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    let rows = tile_y * TILE..((tile_y + 1) * TILE).min(height);
    rows.flat_map(move |y| (tile_x * TILE..((tile_x + 1) * TILE).min(width)).map(move |x| (x, y)))
}

/// The bits of `x` interleaved with zeros, half of a Morton code.
fn morton(x: u32) -> u64 {
    (0..32).fold(0, |spread, bit| spread | (u64::from(x) >> bit & 1) << (2 * bit))
}

/// Adds the samples of a pixel.
fn sample(world: &World<'_>, view: &RenderSettings, eye: &Eye, x: u32, y: u32, samples: &mut Vec<Sample>) {
    let (px, py) = (f64::from(x), f64::from(y));
    let take = |dx: f64, dy: f64, u: &[f64; 6]| trace(world, view, eye, &eye.ray(px + dx, py + dy), u);
    match view.look {
        Look::Exact => {
            samples.push(take(0.5, 0.5, &[0.0; 6]));
            let side = libm::round(libm::sqrt(f64::from(view.samples)));
            if side > 1.0 {
                for j in 0..side as u32 {
                    for i in 0..side as u32 {
                        samples.push(take((f64::from(i) + 0.5) / side, (f64::from(j) + 0.5) / side, &[0.0; 6]));
                    }
                }
            }
        }
        Look::Studio => {
            for u in numbers(x, y, view.samples) {
                let [dx, dy] = if view.samples == 1 { [0.5; 2] } else { [u[0], u[1]] };
                samples.push(take(dx, dy, &u));
                if samples.len() == FIRST && samples.iter().all(|s| s.object == 0) {
                    return;
                }
            }
        }
    }
}

/// The sample along a camera ray; `u` are its random numbers.
fn trace(world: &World<'_>, view: &RenderSettings, eye: &Eye, ray: &Ray, u: &[f64; 6]) -> Sample {
    let Some(surface) = world.closest(ray, &eye.within) else {
        let Colour(sky) = if view.transparent { Colour([0.0; 3]) } else { world.model.sky.colour(ray.direction) };
        return Sample {
            colour: sky,
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
    };
    // The ground fades into the horizon.
    let share = match &world.model.ground {
        Some(ground) if surface.object.is_none() => ground.share(surface.point),
        _ => 1.0,
    };
    let Colour(behind) = if view.transparent { Colour([0.0; 3]) } else { world.model.sky.at_horizon() };
    Sample {
        colour: [0, 1, 2].map(|i| lit[i] * share + behind[i] * (1.0 - share)),
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
