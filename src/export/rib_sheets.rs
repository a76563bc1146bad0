//! Sky and ground in RIB: sheets of polygons with a colour at each corner, since no renderer's background is another's, and as
//! much of them as the camera sees, since nothing may reach behind it.

use serde::Serialize;

use super::decimal::plain_number as number;
use super::rib_text::{PLAIN, colour, triple};
use crate::math::{Colour, DVec3};
use crate::model::{Camera, Digits, FADE, Light, Model, Projection, Sky};

/// Squares across and down the picture.
const SQUARES: [u32; 2] = [16, 48];
/// Pixels along a square of a sky that is a picture, and most squares along a side.
const PIXELS: u32 = 4;
const MOST_SQUARES: u32 = 400;
/// Bytes of a corner as text, about: its place, its colour, its number.
const CORNER_TEXT: u64 = 100;
/// Sky and haze are seen as they are.
const CONSTANT: &str = "Surface \"constant\"";
/// Haze stands before the sky, at this share of its distance.
const BEFORE: f64 = 0.995;
/// The sky stands at so many times the distance of the farthest of the scene.
const BEHIND: f64 = 1.2;

/// A sheet of polygons.
#[derive(Debug, Serialize)]
pub(super) struct Sheet {
    pub name: &'static str,
    pub surface: String,
    pub body: String,
    /// Its greatest distance along the view.
    #[serde(skip)]
    pub far: f64,
}

/// The sky behind everything, and the ground, for a picture of `size` pixels.
pub(super) fn sheets(model: &Model, size: [u32; 2], digits: Digits) -> Vec<Sheet> {
    let ground = ground(model, size, digits);
    let camera = &model.camera;
    let far = model.bounds_of_all().corners().map(|p| depth(camera, p)).into_iter();
    let far = far.chain(ground.as_ref().map(|sheet| sheet.far));
    let wall = far.fold((camera.look_at - camera.at).length(), f64::max) * BEHIND;
    let count = sky_squares(model, size);
    let seen = |from, way: DVec3| model.hazed(from, way, f64::INFINITY, model.sky.colour(way));
    let mut grid = Grid::default();
    for square in squares(count, beyond(camera, size)) {
        let rays = square.map(|[x, y]| ray(camera, x, y));
        // To the wall, which stands across the view.
        grid.polygon(rays.map(|(from, way)| (at_depth(camera, from, way, wall), seen(from, way))).to_vec());
    }
    let sky = Sheet { name: "sky", surface: CONSTANT.to_owned(), body: grid.text(digits), far: wall };
    std::iter::once(sky).chain(haze(model, size, wall, digits)).chain(ground).collect()
}

/// What the ground has faded into, from where it ends to the horizon, before a sky that is another colour there.
fn haze(model: &Model, size: [u32; 2], wall: f64, digits: Digits) -> Option<Sheet> {
    let endless = model.ground.filter(|ground| ground.radius.is_none())?;
    let (Sky::Picture { .. }, camera) = (&model.sky, &model.camera) else { return None };
    let meets = |[x, y]: [f64; 2]| {
        let (from, way) = ray(camera, x, y);
        let is_below = way.z < 0.0 && from.z > endless.height;
        is_below.then(|| at_depth(camera, from, way, wall * BEFORE))
    };
    let mut grid = Grid::default();
    for square in squares([1, 1], beyond(camera, size)) {
        grid.polygon(clip(square, meets).into_iter().map(|p| (p, model.sky.at_horizon())).collect());
    }
    let is_seen = !grid.corners.is_empty();
    is_seen.then(|| Sheet { name: "haze", surface: CONSTANT.to_owned(), body: grid.text(digits), far: wall })
}

/// Squares across and down the sky.
fn sky_squares(model: &Model, size: [u32; 2]) -> [u32; 2] {
    match model.sky {
        Sky::Gradient { horizon, zenith } if horizon == zenith => [1, 1],
        Sky::Gradient { .. } => SQUARES,
        Sky::Picture { .. } => size.map(|side| (side / PIXELS).clamp(1, MOST_SQUARES)),
    }
}

/// Bytes that sheets take, and the text that they are a part of: it is filled in, and sealed.
pub(super) fn sheet_bytes_needed(model: &Model, size: [u32; 2]) -> u64 {
    let [across, down] = sky_squares(model, size).map(u64::from);
    let corners = 4 * (across * down + u64::from(SQUARES[0] * SQUARES[1]));
    corners * (size_of::<(DVec3, Colour)>() as u64 + 3 * CORNER_TEXT)
}

/// The part of the ground that the camera sees.
fn ground(model: &Model, size: [u32; 2], digits: Digits) -> Option<Sheet> {
    let (ground, camera) = (model.ground?, &model.camera);
    let radius = ground.radius.unwrap_or(ground.reach);
    // Where a ray meets the plane, if it does that in front of the camera and near enough.
    let meets = |[x, y]: [f64; 2]| {
        let (from, way) = ray(camera, x, y);
        let t = (ground.height - from.z) / way.z;
        let p = from + way * t;
        (t.is_finite() && t > 0.0 && p.truncate().length() <= radius).then_some(p)
    };
    let light = light_above(model);
    let material = &ground.material;
    let (Colour(own), Colour(horizon)) = (material.mean_colour(), model.sky.at_horizon());
    let lit = |i: usize| (material.ambient + material.diffuse * light[i]).max(1e-3);
    let mut grid = Grid::default();
    let mut far: f64 = 0.0;
    // It fades into the horizon, as POV-Ray's does: so bright that under this light it looks so.
    let shown = |p: DVec3| {
        let fade = (1.0 - p.truncate().length() / ground.reach) / FADE;
        let share = if ground.radius.is_some() { 1.0 } else { fade.clamp(0.0, 1.0) };
        (p, Colour([0, 1, 2].map(|i| own[i] * share + horizon[i] / lit(i) * (1.0 - share))))
    };
    for square in squares(SQUARES, beyond(camera, size)) {
        let corners: Vec<(DVec3, Colour)> = clip(square, meets).into_iter().map(shown).collect();
        far = corners.iter().map(|(p, _)| depth(camera, *p)).fold(far, f64::max);
        grid.polygon(corners);
    }
    let [ka, kd] = [material.ambient, material.diffuse].map(|x| number(x, PLAIN));
    let surface = format!("Surface \"matte\" \"float Ka\" [{ka}] \"float Kd\" [{kd}]");
    (!grid.corners.is_empty()).then(|| Sheet { name: "ground", surface, body: grid.text(digits), far })
}

/// The part of a square of the picture whose points `meets` knows in the world, as they are there: cut off where it begins to.
fn clip(square: [[f64; 2]; 4], meets: impl Fn([f64; 2]) -> Option<DVec3>) -> Vec<DVec3> {
    let mut found = Vec::new();
    for (i, from) in square.into_iter().enumerate() {
        let to = square[(i + 1) % 4];
        let ends = [from, to].map(&meets);
        found.extend(ends[0]);
        if let [Some(p), None] | [None, Some(p)] = ends {
            let [mut within, mut without] = if ends[0].is_some() { [from, to] } else { [to, from] };
            let mut last = p;
            // To a millionth of the square.
            for _ in 0..20 {
                let middle = [0, 1].map(|axis| (within[axis] + without[axis]) * 0.5);
                match meets(middle) {
                    Some(p) => (within, last) = (middle, p),
                    None => without = middle,
                }
            }
            found.push(last);
        }
    }
    found
}

/// Distance along the view.
fn depth(camera: &Camera, p: DVec3) -> f64 {
    (p - camera.at).dot(camera.frame()[2])
}

/// Where a ray is at this distance along the view.
fn at_depth(camera: &Camera, from: DVec3, way: DVec3, far: f64) -> DVec3 {
    from + way * ((far - depth(camera, from)) / depth(camera, camera.at + way))
}

/// How far sheets reach beyond each edge of a picture of `size` pixels, as fractions of it: a pixel, and as far as a lens blurs what
/// is far or as near as a quarter of what is sharp.
fn beyond(camera: &Camera, size: [u32; 2]) -> [f64; 2] {
    let blur = match camera.projection {
        Projection::Perspective { angle } => {
            3.0 * camera.lens.aperture / camera.lens.focus / libm::tan(angle * 0.5) / 4.0
        }
        Projection::Parallel { .. } => 0.0,
    };
    [1.0 / f64::from(size[0]) + blur, 1.0 / f64::from(size[1]) + blur * camera.aspect]
}

/// The corners of squares that cover a picture and what is this far beyond its edges, as fractions of it.
fn squares([across, down]: [u32; 2], beyond: [f64; 2]) -> impl Iterator<Item = [[f64; 2]; 4]> {
    let at = move |i: u32, n: u32, axis: usize| f64::from(i) / f64::from(n) * (1.0 + 2.0 * beyond[axis]) - beyond[axis];
    (0..down).flat_map(move |y| {
        (0..across).map(move |x| {
            [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]].map(|[x, y]| [at(x, across, 0), at(y, down, 1)])
        })
    })
}

/// What the lights without regard to shadows add up to on level ground, by colour.
fn light_above(model: &Model) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for light in &model.lights {
        if let Light::Sun { towards, colour: Colour(c), .. } = light {
            (0..3).for_each(|i| sum[i] += c[i] * towards.z.max(0.0));
        }
    }
    sum
}

/// Polygons with a colour at each corner.
#[derive(Default)]
struct Grid {
    counts: Vec<usize>,
    corners: Vec<(DVec3, Colour)>,
}

impl Grid {
    /// Adds one, if it is one.
    fn polygon(&mut self, corners: Vec<(DVec3, Colour)>) {
        if corners.len() >= 3 {
            self.counts.push(corners.len());
            self.corners.extend(corners);
        }
    }

    fn text(&self, digits: Digits) -> String {
        let mut text = String::new();
        let mut list = |head: &str, gap: &str, items: &mut dyn Iterator<Item = String>| {
            text.push_str(head);
            for (i, item) in items.enumerate() {
                text.push_str(if i > 0 { gap } else { "" });
                text.push_str(&item);
            }
            text.push(']');
        };
        list("PointsPolygons [", " ", &mut self.counts.iter().map(usize::to_string));
        list("\n[", " ", &mut (0..self.corners.len()).map(|i| i.to_string()));
        list("\n\"P\" [", "\n", &mut self.corners.iter().map(|&(p, _)| triple(p, digits)));
        list("\n\"Cs\" [", "\n", &mut self.corners.iter().map(|&(_, c)| colour(c)));
        text
    }
}

/// Where a fraction of the picture, from the top left, looks: a direction of length 1 and where it starts.
fn ray(camera: &Camera, x: f64, y: f64) -> (DVec3, DVec3) {
    let [right, up, forwards] = camera.frame();
    let (across, upwards) = (x - 0.5, (0.5 - y) / camera.aspect);
    match camera.projection {
        Projection::Perspective { angle } => {
            let wide = 2.0 * libm::tan(angle * 0.5);
            (camera.at, (forwards + right * (across * wide) + up * (upwards * wide)).normalize())
        }
        Projection::Parallel { width } => (camera.at + right * (across * width) + up * (upwards * width), forwards),
    }
}
