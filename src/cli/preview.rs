//! Pictures on their way to files: traced, by an outside renderer, or drawn.

use std::io;
use std::path::{Path, PathBuf};

use super::args::RenderArgs;
use super::choices::{self, Quality, Renderer};
use super::error::Failure;
use super::output;
use crate::files::{Rgba, encode_png};
use crate::glow::{Pass, ShineError};
use crate::math::{Memory, Progress};
use crate::model::{Look, Model, Stroke};
use crate::picture::{self, Depth, Shone, ShoneError, Traced};
use crate::scene::Loaded;
use crate::trace::{RenderSettings, World};

/// Bytes that a pixel takes while it is traced; and with all that an EXR keeps of it.
const FILM_BYTES: [u64; 2] = [32, 164];
/// And what guides its filter in the natural look, with what that filters.
const GUIDE_BYTES: u64 = 96;
/// The same while it is written, when the scene is gone: of an EXR also layers, these once more, and what they are packed to.
const PIXEL_BYTES: [u64; 2] = [64, 520];

/// A finished picture.
pub enum Drawn {
    /// In linear light, with the names of its objects and limbs.
    Traced(Traced),
    /// Light over a photograph or over black.
    Shone(Shone),
    /// As a screen shows it.
    Screen(Rgba),
}

/// What a scene becomes a picture by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Means {
    /// A drawing: strokes on white, and marks of the construction.
    Schematic,
    /// Light, where the scene has a view.
    Glow,
    /// Our own tracer.
    Preview,
    /// A renderer that is installed.
    Outside(Renderer),
}

/// What `scene` becomes a picture by: one that shows its construction is drawn, unless a look is asked for.
pub fn means(args: &RenderArgs, scene: &Loaded) -> Means {
    let is_drawn = args.schematic || (!scene.show.is_empty() && args.look.is_none());
    match args.with {
        Some(renderer) => Means::Outside(renderer),
        None if is_drawn => Means::Schematic,
        None if scene.recipe.view.is_some() => Means::Glow,
        None => Means::Preview,
    }
}

/// The look that is asked for, or else the scene's.
pub fn look(args: &RenderArgs, scene: &Loaded) -> Look {
    args.look.map_or(scene.recipe.look, choices::Look::traced)
}

/// Samples a pixel.
pub fn samples(args: &RenderArgs, look: Look) -> u32 {
    let of_quality = args.quality.map(Quality::samples);
    args.samples.or(of_quality).unwrap_or(if look == Look::Exact { 9 } else { Quality::Good.samples() })
}

/// What is asked for of a picture of `scene`, within `memory`; `data` keeps what an EXR holds besides colours.
pub fn view(args: &RenderArgs, scene: &Loaded, data: bool, memory: &Memory) -> Result<RenderSettings, Failure> {
    let size = scene.recipe.size;
    let crop = args.crop.unwrap_or([0, 0, size[0], size[1]]);
    let [x, y, width, height] = crop;
    let fits = |from: u32, length: u32, whole: u32| from.checked_add(length).is_some_and(|end| end <= whole);
    if !fits(x, width, size[0]) || !fits(y, height, size[1]) {
        return Err(Failure::Usage(format!(
            "--crop {x},{y},{width},{height} does not lie within the picture of {} by {} pixels",
            size[0], size[1]
        )));
    }
    memory.ask(pixels([width, height]) * PIXEL_BYTES[usize::from(data)]).map_err(|error| {
        Failure::Usage(format!(
            "a picture of {width} by {height} pixels needs {error}: render it in parts, with --crop, or raise --max-memory"
        ))
    })?;
    let look = look(args, scene);
    Ok(RenderSettings {
        crop,
        transparent: args.transparent,
        data,
        ..RenderSettings::new(size, look, samples(args, look))
    })
}

fn pixels([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}

/// Traces `view` of `model` within `memory`.
pub fn trace(model: &Model, view: &RenderSettings, memory: &Memory, progress: &Progress) -> Result<Drawn, Failure> {
    let [_, _, width, height] = view.crop;
    let guides = if view.look == Look::Natural { GUIDE_BYTES } else { 0 };
    let film = pixels([width, height]) * (FILM_BYTES[usize::from(view.data)] + guides);
    let needed = World::bytes_needed(model) + film;
    memory
        .beside(model.bytes() as u64)
        .ask(needed)
        .map_err(|error| Failure::Usage(format!("tracing the scene needs {error}: raise --max-memory")))?;
    picture::trace(model, view, progress).map(Drawn::Traced).map_err(|_| Failure::Stopped)
}

/// The light of `strokes` over the photograph of `scene`, or over black.
pub fn shine(scene: &Loaded, strokes: &[Stroke], memory: &Memory, progress: &Progress) -> Result<Shone, Failure> {
    let recipe = &scene.recipe;
    let Some(backdrop) = &recipe.view else {
        return Err(Failure::Usage(format!("{} has no [view]: only such scenes shine", recipe.title)));
    };
    let shone = Shone::new(backdrop, recipe.size, strokes, recipe.seed, memory, progress);
    shone.map_err(|error| match error {
        ShoneError::Shine(ShineError::Cancelled(_)) => Failure::Stopped,
        ShoneError::Shine(ShineError::Scene { object, message }) => {
            Failure::Scene(scene.error(&format!("object.{object}.glow.near.grain"), message))
        }
        ShoneError::Memory { .. } => Failure::Usage(error.to_string()),
    })
}

/// Writes `shone` to `path`, as its ending says, in a file a pass where `split`; returns the files.
pub fn write_shone(
    shone: &Shone,
    path: &Path,
    depth: Depth,
    split: bool,
    texts: &[(&str, &str)],
) -> Result<Vec<PathBuf>, Failure> {
    if !is_exr(path) {
        if split {
            return Err(Failure::Usage("--split writes OpenEXR: end the picture in .exr".to_owned()));
        }
        output::write(path, |out| shone.write_png(depth, texts, out))?;
        return Ok(vec![path.to_owned()]);
    }
    if !split {
        output::write(path, |out| shone.write_exr(texts, out))?;
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    for pass in shone.passes() {
        let file = pass_file(path, pass);
        output::write(&file, |out| shone.write_pass(pass, texts, out))?;
        files.push(file);
    }
    Ok(files)
}

/// The file of one pass of the picture `path`.
pub fn pass_file(path: &Path, pass: Pass) -> PathBuf {
    path.with_extension(format!("{}.exr", pass.name()))
}

/// Bits of a channel as the command line has them.
pub fn depth(bits: &str) -> Depth {
    if bits == "16" { Depth::Sixteen } else { Depth::Eight }
}

impl Drawn {
    /// The picture as a screen shows it.
    pub fn to_screen(&self) -> Rgba {
        match self {
            Self::Screen(picture) => picture.clone(),
            Self::Shone(shone) => shone.to_screen(),
            Self::Traced(traced) => traced.to_screen(),
        }
    }

    /// Writes it to `path`, as its ending says, with what shaped it.
    pub fn write(&self, path: &Path, args: &RenderArgs, scene: &Loaded) -> Result<(), Failure> {
        let software = format!("lichtenberg {}", env!("CARGO_PKG_VERSION"));
        let document = scene.document().to_string();
        let how = how(args, scene).to_string();
        let texts = [
            ("Title", scene.recipe.title.as_str()),
            ("Software", software.as_str()),
            ("Scene", document.as_str()),
            ("View", how.as_str()),
        ];
        if let Self::Shone(shone) = self {
            return write_shone(shone, path, depth(&args.bits), false, &texts).map(drop);
        }
        output::write(path, |out| match self {
            Self::Traced(traced) if is_exr(path) => traced.write_exr(&texts, out),
            Self::Screen(_) if is_exr(path) => {
                Err(io::Error::other("only the built-in preview writes OpenEXR: leave out --with, or end it in .png"))
            }
            Self::Traced(traced) if args.bits == "16" => traced.write_png16(&texts, out),
            _ => encode_png(&self.to_screen(), &texts, out),
        })
    }
}

/// Does the name end in `.exr`?
pub fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

/// Does the name end in `.png`?
pub fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// What shapes a picture besides its scene.
fn how(args: &RenderArgs, scene: &Loaded) -> serde_json::Value {
    let renderer = match means(args, scene) {
        means @ (Means::Glow | Means::Schematic) => {
            let renderer = if means == Means::Glow { "glow" } else { "schematic" };
            return serde_json::json!({ "renderer": renderer, "size": scene.recipe.size });
        }
        Means::Preview => "preview",
        Means::Outside(renderer) => renderer.name(),
    };
    serde_json::json!({
        "renderer": renderer,
        "size": scene.recipe.size,
        "crop": args.crop,
        "look": look(args, scene).name(),
        "quality": args.quality.map(Quality::name),
        "samples": samples(args, look(args, scene)),
        "transparent": args.transparent,
    })
}
