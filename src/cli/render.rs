//! `render`: pictures of scenes.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::{Look, RenderArgs, Renderer, Show};
use super::compare::to_screen;
use super::console::Console;
use super::error::Failure;
use super::jobs::{Job, Jobs};
use super::preview::{Drawn, is_exr, samples, trace, view};
use super::sheet::{Tile, write_sheet};
use super::shone::Shone;
use super::write::{read_templates, write_pov, write_rib};
use super::{terminal, watch};
use crate::export::{Origin, Pov, Rib, RibOptions, RibShadows, SvgOptions, Templates, identifier, write_svg};
use crate::files::{Rgba, decode_exr, decode_png, draw_svg};
use crate::grow::MarkKind;
use crate::math::Progress;
use crate::model::Model;
use crate::render::{Povray, RibRenderer};
use crate::scene::Resolved;

pub fn run(args: &RenderArgs, threads: Option<usize>, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let keep = args.output.is_some() || args.sheet.is_none();
    let default = format!("{}.png", jobs.pattern);
    let outputs = jobs.outputs(args.output.as_ref().unwrap_or(&default))?;
    let traces = args.with.is_none() && !args.schematic;
    for output in &outputs {
        require_picture(Path::new(output), traces)?;
    }
    if let Some(sheet) = &args.sheet {
        require_picture(sheet, false)?;
    }
    if !args.schematic && args.show.iter().any(|show| show.mark().is_some()) {
        return Err(Failure::Usage("marks of the construction are drawn with --schematic".to_owned()));
    }
    if args.watch {
        return watch::run(args, threads, console);
    }
    let mut tiles = Vec::new();
    for (job, output) in jobs.list.iter().zip(&outputs) {
        let path = PathBuf::from(output);
        let begun = Instant::now();
        let screen = if keep && args.skip_existing && path.exists() {
            // Only a sheet needs what is there already.
            if args.sheet.is_none() {
                continue;
            }
            read_screen(&path).map_err(|e| Failure::Usage(format!("cannot read {output}: {e}")))?
        } else {
            let scene = jobs.load(job)?;
            let progress = console.progress(job.title());
            let drawn = draw(args, &jobs, job, &scene, is_exr(&path), threads, console, &progress)?;
            if keep {
                drawn.write(&path, args, &scene)?;
                report(&path, job, &scene, begun, console);
            }
            if args.sheet.is_none() && !args.show.contains(&Show::Terminal) {
                continue;
            }
            drawn.to_screen()
        };
        if args.show.contains(&Show::Terminal) {
            terminal::show(&screen, console)?;
        }
        tiles.push(Tile { picture: screen, label: job.label.clone() });
    }
    console.done();
    if let Some(sheet) = &args.sheet {
        write_sheet(sheet, &tiles)?;
        if console.json {
            console.result(&serde_json::json!({ "sheet": sheet, "pictures": tiles.len() }));
        } else {
            console.line(&sheet.display().to_string());
        }
    }
    Ok(())
}

fn require_picture(path: &Path, traces: bool) -> Result<(), Failure> {
    let is_png = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    if is_png || (traces && is_exr(path)) {
        return Ok(());
    }
    let endings = if traces { ".png or .exr" } else { ".png" };
    Err(Failure::Usage(format!("{} must end in {endings}: that is what can be written", path.display())))
}

pub fn report(path: &Path, job: &Job, scene: &Resolved, begun: Instant, console: &Console) {
    if console.json {
        console.result(&serde_json::json!({
            "file": path,
            "scene": job.name(),
            "seed": scene.seed,
            "size": scene.size,
            "seconds": begun.elapsed().as_secs_f64(),
        }));
    } else {
        console.line(&path.display().to_string());
    }
}

/// Options that say how rays are traced mean nothing where light is drawn.
fn refuse_tracing(args: &RenderArgs) -> Result<(), Failure> {
    let given = [
        ("--samples", args.samples.is_some()),
        ("--crop", args.crop.is_some()),
        ("--transparent", args.transparent),
        ("--look exact", args.look == Look::Exact),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(Failure::Usage(format!(
            "{option} is for scenes that are traced; this one has a [view], where light is drawn"
        ))),
        None => Ok(()),
    }
}

/// The picture of one scene.
#[allow(clippy::too_many_arguments, reason = "a scene, how it is drawn, and who listens")]
pub fn draw(
    args: &RenderArgs,
    jobs: &Jobs,
    job: &Job,
    scene: &Resolved,
    data: bool,
    threads: Option<usize>,
    console: &Console,
    progress: &Progress,
) -> Result<Drawn, Failure> {
    if args.schematic {
        let marks: Vec<MarkKind> = args.show.iter().filter_map(|&s| s.mark()).collect();
        let marks = if marks.is_empty() { scene.show.clone() } else { marks };
        let model = jobs.model(scene, &marks, console, progress)?;
        let mut svg = Vec::new();
        write_svg(&model, SvgOptions { size: scene.size }, &mut svg)
            .map_err(|e| Failure::Usage(format!("cannot draw the schematic: {e}")))?;
        return draw_svg(&String::from_utf8_lossy(&svg), &[])
            .map(Drawn::Screen)
            .map_err(|e| Failure::Usage(e.to_string()));
    }
    if let Some(view) = scene.view.as_ref().filter(|_| args.with.is_none()) {
        refuse_tracing(args)?;
        let model = jobs.model(scene, &[], console, progress)?;
        return Shone::new(scene, view, &model.strokes, jobs.max_memory(), progress).map(Drawn::Shone);
    }
    // What is wrong with the call is said before long work.
    let view = view(args, scene.size, data, jobs.max_memory())?;
    let model = jobs.model(scene, &[], console, progress)?;
    let Some(with) = args.with else { return trace(&model, &view, progress) };
    let templates = read_templates(args.templates.as_deref())?;
    let folder = tempfile::Builder::new()
        .prefix("lichtenberg-")
        .tempdir()
        .map_err(|e| Failure::Usage(format!("cannot make a folder for the renderer's files: {e}")))?;
    let name = "scene";
    let renderer = match with {
        Renderer::Povray => None,
        Renderer::Pixie => Some(RibRenderer::Pixie),
        Renderer::Aqsis => Some(RibRenderer::Aqsis),
    };
    if let Some(renderer) = renderer {
        if args.look == Look::Studio {
            console.note("note: RIB shows the exact look; the studio look is the preview's and POV-Ray's");
        }
        let origin = job.origin(scene.seed, "render");
        let picture = render_rib(renderer, &model, &templates, folder.path(), scene.size, &origin, progress)?;
        return Ok(Drawn::Screen(cut(&picture, view.crop)));
    }
    let pov = Pov::new(&model, &templates, name, scene.size, &job.origin(scene.seed, "render"));
    write_pov(&pov, folder.path(), name, true)?;
    let povray = Povray {
        size: scene.size,
        crop: view.crop,
        samples: libm::round(libm::sqrt(f64::from(samples(args)))) as u32,
        declare: (args.look == Look::Exact).then(|| format!("{}=1", pov.exact())),
        threads,
    };
    let rendered = povray.render(folder.path(), "scene.pov", "scene.png", progress)?;
    for warning in &rendered.warnings {
        console.note(&format!("povray: {warning}"));
    }
    let picture = fs::read(folder.path().join("scene.png"))
        .map_err(|e| Failure::Outside(format!("povray's picture cannot be read: {e}")))?;
    let picture =
        decode_png(&picture).map_err(|e| Failure::Outside(format!("povray's picture cannot be read: {e}")))?;
    Ok(Drawn::Screen(cut(&picture, view.crop)))
}

/// The picture of a renderer that reads RIB.
fn render_rib(
    renderer: RibRenderer,
    model: &Model,
    templates: &Templates,
    folder: &Path,
    size: [u32; 2],
    origin: &Origin,
    progress: &Progress,
) -> Result<Rgba, Failure> {
    let shadows = match renderer {
        RibRenderer::Pixie => RibShadows::Rays,
        RibRenderer::Aqsis => RibShadows::Maps,
    };
    let rib = Rib::new(model, templates, "scene", size, origin, RibOptions { shadows, displace: false });
    write_rib(&rib, folder, "scene", false, true)?;
    renderer.render(folder, "scene.rib", "scene.tif", progress)?;
    let wrong = |e: String| Failure::Outside(format!("{}'s picture cannot be read: {e}", renderer.program()));
    let bytes = fs::read(folder.join("scene.tif")).map_err(|e| wrong(e.to_string()))?;
    let picture = decode_png(&bytes).map_err(|e| wrong(e.to_string()))?;
    if picture.bytes.chunks_exact(4).all(|pixel| pixel[..3] == picture.bytes[..3]) {
        return Err(wrong("it is blank".to_owned()));
    }
    Ok(picture)
}

/// A picture that is there already, as a screen shows it.
fn read_screen(path: &Path) -> Result<Rgba, String> {
    let bytes = fs::read(path).map_err(|e| e.to_string())?;
    if !is_exr(path) {
        return decode_png(&bytes).map_err(|e| e.to_string());
    }
    to_screen(&decode_exr(&bytes).map_err(|e| e.to_string())?, true)
        .ok_or_else(|| "it has no channels R, G and B".to_owned())
}

/// A part of a picture: left, top, width, height.
fn cut(picture: &Rgba, [left, top, width, height]: [u32; 4]) -> Rgba {
    let rows = (top..top + height).flat_map(|y| {
        let from = (y as usize * picture.width as usize + left as usize) * 4;
        picture.bytes[from..from + width as usize * 4].iter().copied()
    });
    Rgba { width, height, bytes: rows.collect() }
}

/// A name for files and declarations: letters, digits, `_`, `-` and dots within.
pub fn check_name(name: &str) -> Result<(), Failure> {
    let fits = name.starts_with(|c: char| c.is_ascii_alphanumeric())
        && name.len() <= 100
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "_-.+".contains(c))
        && !name.eq_ignore_ascii_case("povray")
        && identifier(name) != "Fig_";
    if fits {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{name:?} is no name for files: use a letter or digit, then letters, digits, `_`, `-` and `.`, 100 at most (and not `povray`, whose .ini would replace POV-Ray's own)"
    )))
}
