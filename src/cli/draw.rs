//! One picture: traced, shone, drawn, or by an outside renderer.

use std::fs;
use std::path::Path;
use std::time::Instant;

use super::args::RenderArgs;
use super::choices::{self, Renderer};
use super::console::Console;
use super::error::Failure;
use super::jobs::{Job, Jobs};
use super::memory::ask_beside;
use super::preview::{Drawn, Means, means, shine, trace, view};
use super::write::{read_templates, write_pov, write_rib};
use super::{memory, output};
use crate::export::{Origin, Pov, Rib, RibOptions, RibShadows, SvgOptions, Templates, write_svg};
use crate::files::{Rgba, Scratch, decode_light, decode_png, draw_svg};
use crate::geom::MarkKind;
use crate::math::{Memory, Progress};
use crate::model::{Look, Model};
use crate::render::{Povray, RibRenderer};
use crate::scene::Loaded;
use crate::trace::RenderSettings;

pub fn report(path: &Path, jobs: &Jobs, job: &Job, scene: &Loaded, begun: Instant, console: &Console) {
    let details = serde_json::json!({
        "scene": job.name(),
        "seed": scene.recipe.seed,
        "size": scene.recipe.size,
        "seconds": begun.elapsed().as_secs_f64(),
        "memory": memory::told(&jobs.memory),
    });
    output::tell(path, details, console);
}

/// What `scene` becomes a picture by; `data` is asked of an EXR.
///
/// # Errors
/// Options that mean nothing there: marks where nothing is drawn, how rays are traced where lines or light are.
pub fn checked_means(args: &RenderArgs, scene: &Loaded, data: bool) -> Result<Means, Failure> {
    let means = means(args, scene);
    let is_schematic = means == Means::Schematic;
    if !is_schematic && args.show.iter().any(|show| show.mark().is_some()) {
        return Err(Failure::Usage("marks of the construction are drawn with --schematic".to_owned()));
    }
    if !is_schematic && means != Means::Glow {
        return Ok(means);
    }
    let given = [
        ("--samples", args.samples.is_some()),
        ("--quality", args.quality.is_some()),
        ("--crop", args.crop.is_some()),
        ("--transparent", args.transparent),
        ("--look exact", args.look == Some(choices::Look::Exact)),
        ("--look natural", args.look == Some(choices::Look::Natural)),
        ("--bits 16", is_schematic && args.bits == "16"),
        ("EXR", is_schematic && data),
    ];
    let why = if is_schematic {
        "this one has `show`, and is drawn as a schematic: add --look studio, or exact, to trace it"
    } else {
        "this one has a [view], where light is drawn"
    };
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(Failure::Usage(format!("{option} is for scenes that are traced; {why}"))),
        None => Ok(means),
    }
}

/// The picture of one scene.
#[allow(clippy::too_many_arguments, reason = "a scene, how it is drawn, and who listens")]
pub fn draw(
    args: &RenderArgs,
    jobs: &Jobs,
    job: &Job,
    scene: &Loaded,
    data: bool,
    threads: Option<usize>,
    console: &Console,
    progress: &Progress,
) -> Result<Drawn, Failure> {
    // What is wrong with the call is said before long work.
    match checked_means(args, scene, data)? {
        Means::Schematic => draw_schematic(args, jobs, scene, console, progress),
        Means::Glow => {
            let model = jobs.model(scene, &[], console, progress)?;
            shine(scene, &model.strokes, &jobs.memory, progress).map(Drawn::Shone)
        }
        Means::Preview => {
            let view = view(args, scene, data, &jobs.memory)?;
            let model = jobs.model(scene, &[], console, progress)?;
            trace(&model, &view, &jobs.memory, progress)
        }
        Means::Outside(renderer) => {
            let view = view(args, scene, data, &jobs.memory)?;
            let model = Model { look: view.look, ..jobs.model(scene, &[], console, progress)? };
            let templates = read_templates(args.templates.as_deref())?;
            let folder = Scratch::new()
                .map_err(|e| Failure::Usage(format!("cannot make a folder for the renderer's files: {e}")))?;
            let origin = job.origin(scene.recipe.seed, "render");
            let files = Files { model: &model, templates: &templates, folder: folder.path(), origin: &origin };
            let size = view.size;
            let picture = match renderer {
                Renderer::Povray => files.render_pov(args, &view, threads, console, progress),
                Renderer::Pixie => files.render_rib(RibRenderer::Pixie, size, &jobs.memory, progress),
                Renderer::Aqsis => files.render_rib(RibRenderer::Aqsis, size, &jobs.memory, progress),
            }?;
            Ok(Drawn::Screen(cut(&picture, view.crop)))
        }
    }
}

/// What files of renderers are called.
const SCENE: &str = "scene";

/// A drawing of the construction, or black strokes on white.
fn draw_schematic(
    args: &RenderArgs,
    jobs: &Jobs,
    scene: &Loaded,
    console: &Console,
    progress: &Progress,
) -> Result<Drawn, Failure> {
    let marks: Vec<MarkKind> = args.show.iter().filter_map(|&s| s.mark()).collect();
    let marks = if marks.is_empty() { scene.show.clone() } else { marks };
    let model = jobs.model(scene, &marks, console, progress)?;
    let mut svg = Vec::new();
    write_svg(&model, SvgOptions { size: scene.recipe.size }, &mut svg)
        .map_err(|e| Failure::Usage(format!("cannot draw the schematic: {e}")))?;
    draw_svg(&String::from_utf8_lossy(&svg), &[]).map(Drawn::Screen).map_err(|e| Failure::Usage(e.to_string()))
}

/// How far limbs may be from their place in a picture made at once, in pixels. What is left out is no wider than twice that, and
/// would cover as small a share of the pixels that it crosses; many such twigs are seen (bolt-3d, at a sixteenth).
const UNSEEN: f64 = 1.0 / 64.0;

/// What an outside renderer reads.
struct Files<'a> {
    model: &'a Model,
    templates: &'a Templates,
    folder: &'a Path,
    origin: &'a Origin,
}

impl Files<'_> {
    /// The picture of POV-Ray.
    fn render_pov(
        &self,
        args: &RenderArgs,
        view: &RenderSettings,
        threads: Option<usize>,
        console: &Console,
        progress: &Progress,
    ) -> Result<Rgba, Failure> {
        let pov = Pov::new(self.model, self.templates, SCENE, view.size, self.origin);
        let povray = Povray {
            size: view.size,
            crop: view.crop,
            samples: libm::round(libm::sqrt(f64::from(view.samples))) as u32,
            declares: match (view.look, args.quality) {
                (Look::Exact, _) => vec![format!("{}=1", pov.exact())],
                (Look::Natural, Some(quality)) => vec![format!("{}={}", pov.quality(), quality.level())],
                _ => vec![],
            },
            threads,
        };
        write_pov(&pov, self.folder, SCENE, true)?;
        let rendered = povray.render(self.folder, "scene.pov", "scene.png", progress)?;
        for warning in &rendered.warnings {
            console.note(&format!("povray: {warning}"));
        }
        let wrong = |e: String| Failure::Outside(format!("povray's picture cannot be read: {e}"));
        let picture = fs::read(self.folder.join("scene.png")).map_err(|e| wrong(e.to_string()))?;
        decode_png(&picture).map_err(|e| wrong(e.to_string()))
    }

    /// The picture of a renderer that reads RIB.
    fn render_rib(
        &self,
        renderer: RibRenderer,
        size: [u32; 2],
        memory: &Memory,
        progress: &Progress,
    ) -> Result<Rgba, Failure> {
        let shadows = match renderer {
            RibRenderer::Pixie => RibShadows::Rays,
            RibRenderer::Aqsis => RibShadows::Maps,
        };
        let options = RibOptions { shadows, displace: false, linear: true, detail: UNSEEN };
        ask_beside(self.model, Rib::bytes_needed(self.model, size, options), memory)?;
        let rib = Rib::new(self.model, self.templates, SCENE, size, self.origin, options);
        let written = write_rib(&rib, self.folder, SCENE, false, true)?;
        for file in written.files.iter().filter(|file| file.extension().is_some_and(|ending| ending == "sl")) {
            renderer.compile(self.folder, &file.file_name().unwrap_or_default().to_string_lossy(), progress)?;
        }
        renderer.render(self.folder, "scene.rib", "scene.tif", progress)?;
        let wrong = |e: String| Failure::Outside(format!("{}'s picture cannot be read: {e}", renderer.program()));
        let bytes = fs::read(self.folder.join("scene.tif")).map_err(|e| wrong(e.to_string()))?;
        let picture = decode_light(&bytes).map_err(|e| wrong(e.to_string()))?;
        if picture.bytes.chunks_exact(4).all(|pixel| pixel[..3] == picture.bytes[..3]) {
            return Err(wrong("it is blank".to_owned()));
        }
        Ok(picture)
    }
}

/// A part of a picture: left, top, width, height.
fn cut(picture: &Rgba, [left, top, width, height]: [u32; 4]) -> Rgba {
    let rows = (top..top + height).flat_map(|y| {
        let from = (y as usize * picture.width as usize + left as usize) * 4;
        picture.bytes[from..from + width as usize * 4].iter().copied()
    });
    Rgba { width, height, bytes: rows.collect() }
}
