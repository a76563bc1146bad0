//! `render`: pictures of scenes.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::{RenderArgs, Switch};
use super::console::Console;
use super::error::Failure;
use super::export::{read_templates, write_pov};
use super::jobs::{Job, Jobs};
use super::sheet::{Tile, write_sheet};
use crate::export::{Pov, SvgOptions, identifier, write_svg};
use crate::files::{Rgba, decode_png, draw_svg, encode_png, write_whole};
use crate::grow::MarkKind;
use crate::render::Povray;
use crate::scene::Resolved;

pub fn run(args: &RenderArgs, threads: Option<usize>, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let keep = args.output.is_some() || args.sheet.is_none();
    let default = format!("{}.png", jobs.pattern);
    let outputs = jobs.outputs(args.output.as_ref().unwrap_or(&default))?;
    for output in &outputs {
        require_png(Path::new(output))?;
    }
    if let Some(sheet) = &args.sheet {
        require_png(sheet)?;
    }
    let mut tiles = Vec::new();
    for (job, output) in jobs.list.iter().zip(&outputs) {
        let path = PathBuf::from(output);
        let begun = Instant::now();
        let picture = if keep && args.skip_existing && path.exists() {
            let bytes = fs::read(&path).map_err(|e| Failure::file("read", &path, &e))?;
            let made = decode_png(&bytes).map_err(|e| Failure::Usage(format!("cannot read {output}: {e}")));
            // Only a sheet needs what is there already.
            if args.sheet.is_some() { Some(made?) } else { None }
        } else {
            let scene = jobs.load(job)?;
            let picture = draw(args, &jobs, job, &scene, threads, console)?;
            if keep {
                write_picture(&path, &picture, &scene)?;
                report(&path, job, &scene, begun, console);
            }
            Some(picture)
        };
        if let Some(picture) = picture.filter(|_| args.sheet.is_some()) {
            tiles.push(Tile { picture, label: job.label.clone() });
        }
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

fn require_png(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Ok(());
    }
    Err(Failure::Usage(format!("{} must end in .png: that is what can be written", path.display())))
}

fn report(path: &Path, job: &Job, scene: &Resolved, begun: Instant, console: &Console) {
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

/// The picture of one scene.
fn draw(
    args: &RenderArgs,
    jobs: &Jobs,
    job: &Job,
    scene: &Resolved,
    threads: Option<usize>,
    console: &Console,
) -> Result<Rgba, Failure> {
    let progress = console.progress(if job.label.is_empty() { job.name() } else { &job.label });
    if args.schematic {
        let show: Vec<MarkKind> =
            if args.show.is_empty() { scene.show.clone() } else { args.show.iter().map(|&s| s.into()).collect() };
        let model = jobs.model(scene, &show, console, &progress)?;
        let mut svg = Vec::new();
        write_svg(&model, SvgOptions { size: scene.size }, &mut svg)
            .map_err(|e| Failure::Usage(format!("cannot draw the schematic: {e}")))?;
        return draw_svg(&String::from_utf8_lossy(&svg), &[]).map_err(Failure::Usage);
    }
    let model = jobs.model(scene, &[], console, &progress)?;
    let templates = read_templates(args.templates.as_deref())?;
    let folder = tempfile::Builder::new()
        .prefix("lichtenberg-")
        .tempdir()
        .map_err(|e| Failure::Usage(format!("cannot make a folder for povray's files: {e}")))?;
    let name = "scene";
    let pov = Pov::new(&model, &templates, name, scene.size, &job.origin(scene.seed, "render"));
    write_pov(&pov, folder.path(), name, true)?;
    let povray = Povray { size: scene.size, antialias: args.antialias == Switch::On, threads };
    let rendered = povray.render(folder.path(), "scene.pov", "scene.png", &progress)?;
    for warning in &rendered.warnings {
        console.note(&format!("povray: {warning}"));
    }
    let picture = fs::read(folder.path().join("scene.png"))
        .map_err(|e| Failure::Outside(format!("povray's picture cannot be read: {e}")))?;
    decode_png(&picture).map_err(|e| Failure::Outside(format!("povray's picture cannot be read: {e}")))
}

/// Writes a picture that carries what shaped it.
fn write_picture(path: &Path, picture: &Rgba, scene: &Resolved) -> Result<(), Failure> {
    let software = format!("lichtenberg {}", env!("CARGO_PKG_VERSION"));
    let document = scene.document().to_string();
    let texts = [("Title", scene.title.as_str()), ("Software", software.as_str()), ("Scene", document.as_str())];
    write_whole(path, |out| encode_png(picture, &texts, out)).map_err(|e| Failure::file("write", path, &e))
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
