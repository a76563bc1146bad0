//! Pictures on their way to files: traced, by an outside renderer, or drawn.

use std::io::{self, Cursor, Write};
use std::path::Path;

use rayon::prelude::*;

use super::args::{Look, RenderArgs};
use super::error::Failure;
use super::shone::{Shone, Writing};
use crate::files::{Rgba, add_mattes, encode_exr, encode_png, encode_png16, write_whole};
use crate::math::{Progress, srgb_byte, to_srgb};
use crate::model::Model;
use crate::raster::{Layers, filmic};
use crate::scene::Resolved;
use crate::trace::{self, Picture, RenderSettings, World};

/// Samples a pixel where none are asked for, in the studio and the exact look.
const SAMPLES: [u32; 2] = [8, 9];
/// Bytes that a pixel takes at the peak, and with all that an EXR keeps of it.
const PIXEL_BYTES: [u64; 2] = [64, 640];

/// A finished picture.
pub enum Drawn {
    /// In linear light, with the names of its objects and limbs.
    Traced(Traced),
    /// Light over a photograph or over black.
    Shone(Shone),
    /// As a screen shows it.
    Screen(Rgba),
}

/// A traced picture.
pub struct Traced {
    picture: Picture,
    is_filmic: bool,
    objects: Vec<String>,
    branches: Vec<String>,
}

/// The look as the tracer calls it.
pub fn look(args: &RenderArgs) -> trace::Look {
    match args.look {
        Look::Studio => trace::Look::Studio,
        Look::Exact => trace::Look::Exact,
    }
}

/// Samples a pixel.
pub fn samples(args: &RenderArgs) -> u32 {
    args.samples.unwrap_or(SAMPLES[usize::from(args.look == Look::Exact)])
}

/// What is asked for of a picture of `size`, within `max_memory` bytes; `data` keeps what an EXR holds besides colours.
pub fn view(args: &RenderArgs, size: [u32; 2], data: bool, max_memory: u64) -> Result<RenderSettings, Failure> {
    let crop = args.crop.unwrap_or([0, 0, size[0], size[1]]);
    let [x, y, width, height] = crop;
    let fits = |from: u32, length: u32, whole: u32| from.checked_add(length).is_some_and(|end| end <= whole);
    if !fits(x, width, size[0]) || !fits(y, height, size[1]) {
        return Err(Failure::Usage(format!(
            "--crop {x},{y},{width},{height} does not lie within the picture of {} by {} pixels",
            size[0], size[1]
        )));
    }
    let needed = u64::from(width) * u64::from(height) * PIXEL_BYTES[usize::from(data)];
    if needed > max_memory {
        return Err(Failure::Usage(format!(
            "a picture of {width} by {height} pixels needs about {} MB of memory, more than the {} MB allowed: render it in parts, with --crop, or raise --max-memory",
            needed.div_ceil(1_000_000),
            max_memory / 1_000_000
        )));
    }
    Ok(RenderSettings {
        crop,
        transparent: args.transparent,
        data,
        ..RenderSettings::new(size, look(args), samples(args))
    })
}

/// Traces `view` of `model`.
pub fn trace(model: &Model, view: &RenderSettings, progress: &Progress) -> Result<Drawn, Failure> {
    let world = World::new(model);
    let picture = trace::render(&world, view, progress).map_err(|_| Failure::Stopped)?;
    let mut objects: Vec<String> = model.objects.iter().map(|o| o.name.clone()).collect();
    objects.push("ground".to_owned());
    // A drawing's white is white.
    let is_filmic = view.look == trace::Look::Studio && !model.is_flat;
    Ok(Drawn::Traced(Traced { picture, is_filmic, objects, branches: world.branch_names() }))
}

impl Drawn {
    /// The picture as a screen shows it.
    pub fn to_screen(&self) -> Rgba {
        match self {
            Self::Screen(picture) => picture.clone(),
            Self::Shone(shone) => shone.to_screen(),
            Self::Traced(traced) => Rgba {
                width: traced.picture.width,
                height: traced.picture.height,
                bytes: traced.encoded(srgb_byte, |alpha| libm::floor(alpha * 255.0 + 0.5) as u8),
            },
        }
    }

    /// Writes it to `path`, as its ending says, with what shaped it.
    pub fn write(&self, path: &Path, args: &RenderArgs, scene: &Resolved) -> Result<(), Failure> {
        let software = format!("lichtenberg {}", env!("CARGO_PKG_VERSION"));
        let document = scene.document().to_string();
        let how = how(args, scene).to_string();
        let texts = [
            ("Title", scene.title.as_str()),
            ("Software", software.as_str()),
            ("Scene", document.as_str()),
            ("View", how.as_str()),
        ];
        if let Self::Shone(shone) = self {
            return shone.write(path, Writing { is_deep: args.bits == "16", split: false }, &texts).map(drop);
        }
        write_whole(path, |out| match self {
            Self::Traced(traced) if is_exr(path) => {
                let mut layers = traced.layers();
                for (keyword, text) in texts {
                    // Standard attributes where there are any.
                    let keyword = if keyword == "Software" { "software" } else { keyword };
                    layers.texts.push((keyword.to_owned(), text.to_owned()));
                }
                let mut bytes = Cursor::new(Vec::new());
                encode_exr(&layers, &mut bytes)?;
                out.write_all(bytes.get_ref())
            }
            Self::Screen(_) if is_exr(path) => {
                Err(io::Error::other("only the built-in preview writes OpenEXR: leave out --with, or end it in .png"))
            }
            Self::Traced(traced) if args.bits == "16" => {
                let round = |x: f64| libm::floor(x * 65535.0 + 0.5) as u16;
                let values = traced.encoded(|linear| round(to_srgb(linear)), round);
                encode_png16([traced.picture.width, traced.picture.height], &values, &texts, out)
            }
            _ => encode_png(&self.to_screen(), &texts, out),
        })
        .map_err(|e| Failure::file("write", path, &e))
    }
}

/// Does the name end in `.exr`?
pub fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

/// What shapes a picture besides its scene.
fn how(args: &RenderArgs, scene: &Resolved) -> serde_json::Value {
    if scene.view.is_some() && args.with.is_none() && !args.schematic {
        return serde_json::json!({ "renderer": "glow", "size": scene.size });
    }
    if args.schematic {
        return serde_json::json!({ "renderer": "schematic", "size": scene.size });
    }
    serde_json::json!({
        "renderer": if args.with.is_some() { "povray" } else { "preview" },
        "size": scene.size,
        "crop": args.crop,
        "look": if args.look == Look::Studio { "studio" } else { "exact" },
        "samples": samples(args),
        "transparent": args.transparent,
    })
}

impl Traced {
    /// Red, green, blue by `encode` and alpha by `round`, not premultiplied.
    fn encoded<T: Copy + Send>(&self, encode: impl Fn(f64) -> T + Sync, round: impl Fn(f64) -> T + Sync) -> Vec<T> {
        let pixel = |p: &[f32; 4]| {
            let alpha = f64::from(p[3]);
            let show = |c: f32| {
                let linear = if alpha > 0.0 { f64::from(c) / alpha } else { 0.0 };
                encode(if self.is_filmic { filmic(linear) } else { linear })
            };
            [show(p[0]), show(p[1]), show(p[2]), round(alpha)]
        };
        let pixels: Vec<[T; 4]> = self.picture.pixels.par_iter().map(pixel).collect();
        pixels.into_flattened()
    }

    /// Every channel, with mattes of objects and limbs.
    fn layers(&self) -> Layers {
        let mut layers = self.picture.layers();
        if !self.picture.data.is_empty() {
            let objects: Vec<_> = self.picture.data.iter().map(|d| d.objects).collect();
            let branches: Vec<_> = self.picture.data.iter().map(|d| d.branches).collect();
            add_mattes(&mut layers, "CryptoObject", &self.objects, &objects);
            add_mattes(&mut layers, "CryptoBranch", &self.branches, &branches);
        }
        layers
    }
}
