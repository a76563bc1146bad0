//! All layers of light of strokes.

use rayon::prelude::*;

use super::Canvas;
use super::convolve::{LightPlane, convolve};
use super::coverage::cover;
use super::near::{NearError, NearField, NearParameters};
use super::scatter::Scattering;
use super::temperature::black_body;
use crate::math::{Cancelled, DVec2, Memory, Progress, power};
use crate::model::{GlowSpec, Stroke};
use crate::plan::PlanError;

/// Most rows of the picture on which halo and clouds are computed.
const COARSE: u32 = 480;
/// Samples of the scattering function from 0 to 90 degrees.
const ANGLES: usize = 2048;
/// Samples along each side of a pixel near the centre of a kernel.
const SUPERSAMPLES: i64 = 8;

/// A render pass of light, as compositors use them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pass {
    /// The main channel.
    Core,
    /// Side branches.
    Branches,
    /// The glow around both, by path cost.
    Glow,
    /// Light scattered by the atmosphere.
    Halo,
    /// Illumination of the photograph, to be multiplied by its colours.
    Cloud,
}

impl Pass {
    /// All of them, in the order of compositing.
    pub const ALL: [Self; 5] = [Self::Core, Self::Branches, Self::Glow, Self::Halo, Self::Cloud];

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Core => "core",
            Self::Branches => "branches",
            Self::Glow => "glow",
            Self::Halo => "halo",
            Self::Cloud => "cloud",
        }
    }
}

/// The intensity of each pixel, and a common colour.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its pass.
    pub pass: Pass,
    /// Its colour in linear Rec. 709.
    pub colour: [f64; 3],
    /// The intensity of each pixel of the canvas, at least 0.
    pub values: Vec<f32>,
}

/// Why there is no light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShineError {
    /// A parameter of the scene is out of range.
    #[error("{message}")]
    Scene {
        /// The object's name.
        object: String,
        /// What is wrong.
        message: String,
    },
    /// Cancelled by its [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The layers of light of `strokes` on `canvas`, of the scene with this seed; strokes of equal temperature share layers. Lattices
/// of glows ask for their `memory`.
///
/// # Errors
/// [`ShineError`].
pub fn shine(
    strokes: &[Stroke],
    canvas: &Canvas,
    has_plate: bool,
    seed: u64,
    memory: &Memory,
    progress: &Progress,
) -> Result<Vec<Layer>, ShineError> {
    let mut layers: Vec<Layer> = Vec::new();
    for (i, stroke) in strokes.iter().enumerate() {
        progress.report("glow", i as f64 / strokes.len() as f64)?;
        let glow = &stroke.glow;
        let light = libm::exp2(glow.exposure) * glow.intensity;
        let colour = black_body(glow.temperature);
        let mut add = |pass: Pass, values: Vec<f32>| match layers
            .iter_mut()
            .find(|layer| layer.pass == pass && layer.colour == colour)
        {
            Some(layer) => layer.values.par_iter_mut().zip(values).for_each(|(sum, x)| *sum += x),
            None => layers.push(Layer { pass, colour, values }),
        };
        let thickest = stroke.pieces.iter().flat_map(|p| p.radii).fold(f64::MIN_POSITIVE, f64::max);
        let dim = |radius: f64| power(radius / thickest, glow.dim);
        for (pass, is_core, strength) in [(Pass::Core, true, glow.core), (Pass::Branches, false, glow.branches)] {
            let pieces = stroke.pieces.iter().filter(|piece| piece.is_core == is_core);
            if strength * light > 0.0 && pieces.clone().next().is_some() {
                add(pass, cover(canvas, 1, pieces, |radius| dim(radius) * strength * light));
            }
        }
        if glow.near.strength * light > 0.0 && !stroke.pieces.is_empty() {
            let parameters = NearParameters { stroke, canvas, seed, memory, progress };
            add(Pass::Glow, near(&parameters, (glow.near.strength * light) as f32)?);
        }
        let has_halo = glow.halo.strength > 0.0;
        let has_cloud = glow.cloud.strength > 0.0 && has_plate;
        if (has_halo || has_cloud) && light > 0.0 {
            let [halo, cloud] = broad(stroke, canvas, has_halo, &dim);
            let scale = f64::from(coarseness(canvas));
            for (is_there, pass, plane, strength) in
                [(has_halo, Pass::Halo, halo, glow.halo.strength), (has_cloud, Pass::Cloud, cloud, glow.cloud.strength)]
            {
                if is_there {
                    let factor = (strength * light) as f32;
                    add(pass, each(canvas, |p| plane.at(p.x / scale, p.y / scale) * factor));
                }
            }
        }
    }
    layers.sort_by_key(|layer| layer.pass);
    Ok(layers)
}

/// The glow of a stroke's core and branches, the brighter of both at each pixel.
fn near(parameters: &NearParameters<'_>, factor: f32) -> Result<Vec<f32>, ShineError> {
    let NearParameters { stroke, canvas, .. } = *parameters;
    let field = |is_core: bool| {
        if stroke.pieces.iter().all(|piece| piece.is_core != is_core) {
            return Ok(None);
        }
        parameters.field(is_core).map(Some).map_err(|error| match error {
            NearError::Plan(PlanError::Cancelled(cancelled)) => ShineError::Cancelled(cancelled),
            error => ShineError::Scene { object: stroke.name.clone(), message: error.to_string() },
        })
    };
    let (core, branches) = rayon::join(|| field(true), || field(false));
    let (core, branches) = (core?, branches?);
    let at = |field: &Option<NearField>, p: DVec2| field.as_ref().map_or(0.0, |field| field.at(p));
    let brightest = |p: DVec2| at(&core, p).max(at(&branches, p));
    Ok(each(canvas, |p| brightest(canvas.to_scene(p)) * factor))
}

/// The value at the centre of each pixel.
fn each(canvas: &Canvas, value: impl Fn(DVec2) -> f32 + Sync) -> Vec<f32> {
    let width = canvas.size[0] as usize;
    let mut values = vec![0.0; canvas.pixels()];
    values.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, out) in row.iter_mut().enumerate() {
            *out = value(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        }
    });
    values
}

/// The size of a coarse pixel, in pixels.
fn coarseness(canvas: &Canvas) -> u32 {
    canvas.size[1].div_ceil(COARSE).max(1)
}

/// The halo and the illumination of clouds by a stroke of unit light, on a coarse picture.
fn broad(stroke: &Stroke, canvas: &Canvas, has_halo: bool, dim: &dyn Fn(f64) -> f64) -> [LightPlane; 2] {
    let scale = coarseness(canvas);
    let size = canvas.size.map(|s| s.div_ceil(scale) as usize);
    let GlowSpec { core, branches, halo, cloud, .. } = stroke.glow;
    let part = |is_core: bool| cover(canvas, scale, stroke.pieces.iter().filter(|p| p.is_core == is_core), dim);
    let light: Vec<f32> =
        part(true).iter().zip(part(false)).map(|(a, b)| a * core as f32 + b * branches as f32).collect();

    // Height of the view in coarse pixels.
    let height = canvas.frame.extent[1] / canvas.frame.pixel / f64::from(scale);
    let focal = 0.5 * height / libm::tan(halo.angle.to_radians() * 0.5);
    let scattering = Scattering::new(halo.thickness, halo.q);
    let step = std::f64::consts::FRAC_PI_2 / ANGLES as f64;
    let table: Vec<f64> = if has_halo {
        (0..=ANGLES).into_par_iter().map(|i| scattering.at(libm::cos(i as f64 * step))).collect()
    } else {
        vec![0.0; ANGLES + 1]
    };
    let air = |r: f64| {
        let at = libm::atan(r / focal) / step;
        let low = (at as usize).min(ANGLES - 1);
        table[low] + (table[low + 1] - table[low]) * (at - low as f64)
    };
    let far = cloud.distance * height;
    // A point light at the distance `far` from a plane: inverse square times the cosine.
    let falloff = |r: f64| {
        let d2 = 1.0 + (r / far) * (r / far);
        1.0 / (d2 * d2.sqrt())
    };
    let kernel = |dx: i64, dy: i64| pixel_mean(dx, dy, |r| [air(r), falloff(r)]);
    let share = normalisation(height as i64, kernel);
    convolve(&LightPlane { size, values: light }, |dx, dy| {
        let [a, b] = kernel(dx, dy);
        [(a * share[0]) as f32, (b * share[1]) as f32]
    })
}

/// The mean of a function of the radius over the pixel at an offset: supersampled near the centre, where it varies most.
fn pixel_mean(dx: i64, dy: i64, value: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let at = |x: f64, y: f64| value((x * x + y * y).sqrt());
    if dx.abs() > 1 || dy.abs() > 1 {
        return at(dx as f64, dy as f64);
    }
    let mut sum = [0.0; 2];
    for j in 0..SUPERSAMPLES {
        for i in 0..SUPERSAMPLES {
            let offset = |i: i64| (i as f64 + 0.5) / SUPERSAMPLES as f64 - 0.5;
            let [a, b] = at(dx as f64 + offset(i), dy as f64 + offset(j));
            sum = [sum[0] + a, sum[1] + b];
        }
    }
    sum.map(|x| x / (SUPERSAMPLES * SUPERSAMPLES) as f64)
}

/// The factors by which kernels sum to 1 over a square of `reach` pixels to each side: light is conserved.
fn normalisation(reach: i64, kernel: impl Fn(i64, i64) -> [f64; 2] + Sync) -> [f64; 2] {
    let add = |s: [f64; 2], k: [f64; 2]| [s[0] + k[0], s[1] + k[1]];
    let rows: Vec<[f64; 2]> =
        (-reach..=reach).into_par_iter().map(|y| (-reach..=reach).map(|x| kernel(x, y)).fold([0.0; 2], add)).collect();
    rows.into_iter().fold([0.0; 2], add).map(|w| if w > 0.0 { 1.0 / w } else { 0.0 })
}
