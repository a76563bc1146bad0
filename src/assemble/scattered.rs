//! Places all over the ground that the camera sees: each cell of a grid has one, with numbers of its own wherever the camera is.

use rand::RngExt;

use crate::math::{DVec2, DVec3, Memory, OutOfMemory, Stream};
use crate::model::{Camera, Instance};

/// Things stand beyond the picture's edge by this share of the picture.
const BEYOND: f64 = 0.15;

/// A place on the ground, and numbers from 0 to 1 that are its own.
pub(super) struct Spot {
    pub at: DVec2,
    pub turn: f64,
    pub size: f64,
    pub kind: f64,
    pub fate: f64,
}

/// The spots that are `step` apart on the mean, as far as `reach` from the camera.
pub(super) fn spots(
    camera: &Camera,
    step: f64,
    reach: f64,
    stream: &Stream,
    memory: &Memory,
) -> Result<impl Iterator<Item = Spot>, OutOfMemory> {
    let cells = libm::ceil(reach / step) as i64;
    let count = (2 * cells as u64 + 1).saturating_pow(2);
    memory.ask(count.saturating_mul(size_of::<Instance>() as u64))?;
    let middle = [camera.at.x, camera.at.y].map(|x| libm::round(x / step) as i64);
    let rows = middle[1] - cells..=middle[1] + cells;
    Ok(rows.flat_map(move |j| {
        (middle[0] - cells..=middle[0] + cells).map(move |i| {
            let mut random = stream.nth(i as u64).nth(j as u64);
            let [x, y, turn, size, kind, fate]: [f64; 6] = std::array::from_fn(|_| random.random());
            Spot { at: DVec2::new((i as f64 + x) * step, (j as f64 + y) * step), turn, size, kind, fate }
        })
    }))
}

/// Does the camera see what stands within `radius` of a place on the ground?
pub(super) fn is_seen(camera: &Camera, at: DVec3, radius: f64) -> bool {
    let is_near = at.distance(camera.at) < 4.0 * radius;
    is_near || camera.project(at).is_some_and(|p| (-BEYOND..=1.0 + BEYOND).contains(&p.x) && p.y < 1.0 + 4.0 * BEYOND)
}
