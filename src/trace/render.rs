//! From a world to a picture: camera rays, samples, tiles.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::denoise::{self, Guide, denoise};
use super::eye::Eye;
use super::film::{Data, Picture, data, mean};
use super::sample::sample;
use super::settings::RenderSettings;
use super::smooth::{self, FaceKey, smooth};
use super::world::World;
use crate::math::{Cancelled, Progress};
use crate::model::Look;

/// Side of a tile, in pixels: small enough to balance the load, large enough for coherent rays.
const TILE: u32 = 16;
/// Renders `world`.
///
/// # Errors
/// [`Cancelled`] by `progress`.
pub fn render(world: &World<'_>, view: &RenderSettings, progress: &Progress) -> Result<Picture, Cancelled> {
    let [left, top, width, height] = view.crop;
    // A crop equals that part of the whole picture: filters need a margin.
    let margin = match view.look {
        Look::Exact => 0,
        Look::Studio => smooth::MARGIN,
        Look::Natural => denoise::MARGIN,
    };
    let (x, y) = (left.saturating_sub(margin), top.saturating_sub(margin));
    let right = (left + width + margin).min(view.size[0]);
    let bottom = (top + height + margin).min(view.size[1]);
    let wide = RenderSettings { crop: [x, y, right - x, bottom - y], ..*view };
    let Traced { mut picture, faces, guides } = trace_tiles(world, &wide, progress)?;
    match view.look {
        Look::Exact => {}
        Look::Studio => picture.pixels = smooth(picture.width, &picture.pixels, &faces),
        Look::Natural => picture.pixels = denoise(picture.width, &picture.pixels, &guides),
    }
    let mut shown = picture.cut([left - x, top - y, width, height]);
    let gain = world.model.camera.gain as f32;
    shown.pixels.iter_mut().for_each(|[r, g, b, _]| [r, g, b].into_iter().for_each(|c| *c *= gain));
    Ok(shown)
}

/// A picture, and what guides the filter of its look: in the studio look the face of each pixel where all its samples hit one face
/// of uniform colour.
struct Traced {
    picture: Picture,
    faces: Vec<Option<FaceKey>>,
    guides: Vec<Guide>,
}

/// Traces all tiles.
fn trace_tiles(world: &World<'_>, view: &RenderSettings, progress: &Progress) -> Result<Traced, Cancelled> {
    let eye = Eye::new(world, view.size);
    let [_, _, width, height] = view.crop;
    let mut tiles: Vec<(u32, u32)> =
        (0..height.div_ceil(TILE)).flat_map(|y| (0..width.div_ceil(TILE)).map(move |x| (x, y))).collect();
    tiles.sort_by_key(|&(x, y)| morton(x) | morton(y) << 1);
    // Has it a uniform colour? By [`Sample::object`]: background, objects, ground.
    let is_even: Vec<bool> = std::iter::once(false)
        .chain(world.model.objects.iter().map(|o| world.model.materials[o.material].1.pattern.is_none()))
        .chain(std::iter::once(true))
        .collect();
    let done = AtomicUsize::new(0);
    let tile = |&at: &(u32, u32)| {
        progress.check()?;
        let tile = trace_tile(world, view, &eye, at, &is_even);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report("render", done as f64 / tiles.len() as f64)?;
        Ok(tile)
    };
    let traced: Vec<TracedTile> = tiles.par_iter().map(tile).collect::<Result<_, Cancelled>>()?;
    let count = width as usize * height as usize;
    let kept = |look| if view.look == look { count } else { 0 };
    let mut whole = Traced {
        picture: Picture { width, height, pixels: vec![[0.0; 4]; count], data: Vec::new() },
        faces: vec![None; kept(Look::Studio)],
        guides: vec![Guide::default(); kept(Look::Natural)],
    };
    let data = traced.first().and_then(|tile| tile.data.first());
    whole.picture.data = data.map_or(Vec::new(), |&data| vec![data; count]);
    for (tile, &(tile_x, tile_y)) in traced.into_iter().zip(&tiles) {
        for (i, (x, y)) in places(tile_x, tile_y, width, height).enumerate() {
            let place = (y * width + x) as usize;
            whole.picture.pixels[place] = tile.pixels[i];
            copy(&mut whole.faces, place, &tile.faces, i);
            copy(&mut whole.guides, place, &tile.guides, i);
            copy(&mut whole.picture.data, place, &tile.data, i);
        }
    }
    Ok(whole)
}

/// Copies what is kept of a pixel, if it is.
fn copy<T: Copy>(to: &mut [T], at: usize, from: &[T], i: usize) {
    if let (Some(to), Some(from)) = (to.get_mut(at), from.get(i)) {
        *to = *from;
    }
}

/// A finished tile, pixel by pixel.
#[derive(Default)]
struct TracedTile {
    pixels: Vec<[f32; 4]>,
    faces: Vec<Option<FaceKey>>,
    guides: Vec<Guide>,
    data: Vec<Data>,
}

/// Traces one tile; `is_even` tells of each object whether it has one colour.
fn trace_tile(
    world: &World<'_>,
    view: &RenderSettings,
    eye: &Eye,
    (tile_x, tile_y): (u32, u32),
    is_even: &[bool],
) -> TracedTile {
    let [left, top, width, height] = view.crop;
    let mut tile = TracedTile::default();
    let mut samples = Vec::new();
    for (x, y) in places(tile_x, tile_y, width, height) {
        samples.clear();
        sample(world, view, eye, left + x, top + y, &mut samples);
        tile.pixels.push(mean(&samples));
        match view.look {
            Look::Exact => {}
            Look::Studio => {
                let one = FaceKey::of_all(samples.iter().map(|s| FaceKey::new(s.object, s.normal)));
                tile.faces.push(one.filter(|_| is_even[samples[0].object as usize]));
            }
            Look::Natural => tile.guides.push(Guide::of(&samples)),
        }
        if view.data {
            tile.data.push(data(&samples));
        }
    }
    tile
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
