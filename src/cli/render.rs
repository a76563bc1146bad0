//! `render`: pictures of scenes.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::RenderArgs;
use super::choices::{Look, Renderer, Show};
use super::compare::to_screen;
use super::console::Console;
use super::draw::{draw, report};
use super::error::Failure;
use super::jobs::Jobs;
use super::output::{self, is_stdout};
use super::preview::{is_exr, is_png};
use super::sheet::{Tile, write_sheet};
use super::shown;
use super::{terminal, watch};
use crate::export::identifier;
use crate::files::{Rgba, decode_exr, decode_png};

pub fn run(args: &RenderArgs, threads: Option<usize>, console: &Console) -> Result<(), Failure> {
    let mut jobs = Jobs::new(&args.scene, console)?;
    let keep = args.output.is_some() || args.sheet.is_none();
    let default = PathBuf::from(format!("{}.png", jobs.pattern));
    let outputs = jobs.outputs(args.output.as_ref().unwrap_or(&default).as_os_str())?;
    check(args, &outputs)?;
    if args.watch {
        return watch::run(args, threads, console);
    }
    let written: Vec<PathBuf> = outputs.iter().filter(|_| keep).chain(&args.sheet).cloned().collect();
    output::check(&written, console.json || args.show.contains(&Show::Terminal))?;
    jobs.guard(&written)?;
    note_look(args, console);
    let mut tiles = Vec::new();
    for (i, path) in outputs.iter().enumerate() {
        let job = &jobs.list[i];
        let begun = Instant::now();
        let screen = if keep && args.skip_existing && is_whole(path) {
            // Only a sheet needs what is there already.
            if args.sheet.is_none() {
                continue;
            }
            read_screen(path)?
        } else {
            let scene = jobs.load(job)?;
            let progress = console.progress(job.title());
            let drawn = draw(args, &jobs, job, &scene, is_exr(path), threads, console, &progress)?;
            if keep {
                drawn.write(path, args, &scene)?;
                report(path, &jobs, job, &scene, begun, console);
            }
            if args.sheet.is_none() && !args.show.contains(&Show::Terminal) {
                continue;
            }
            drawn.to_screen()
        };
        if args.show.contains(&Show::Terminal) {
            terminal::show(&screen, console)?;
        }
        let taken = screen.bytes.len() as u64;
        tiles.push(Tile { picture: screen, label: job.label.clone() });
        // Kept until the sheet is made.
        jobs.memory = jobs.memory.beside(taken);
    }
    console.done();
    if let Some(sheet) = &args.sheet {
        write_sheet(sheet, &tiles)?;
        if console.json {
            console.result(&serde_json::json!({ "sheet": sheet.to_string_lossy(), "pictures": tiles.len() }));
        } else {
            output::tell(sheet, serde_json::Value::Null, console);
        }
    }
    Ok(())
}

/// Refuses pictures that cannot be written.
fn check(args: &RenderArgs, outputs: &[PathBuf]) -> Result<(), Failure> {
    let traces = args.with.is_none() && !args.schematic;
    for output in outputs {
        require_picture(output, traces)?;
    }
    if let Some(sheet) = &args.sheet {
        require_picture(sheet, false)?;
    }
    Ok(())
}

/// Tells that RIB has one look, where another is asked for.
fn note_look(args: &RenderArgs, console: &Console) {
    if matches!(args.with, Some(Renderer::Pixie | Renderer::Aqsis)) && args.look != Some(Look::Exact) {
        console.note("note: RIB shows the exact look (--look exact); others are the preview's and POV-Ray's");
    }
}

fn require_picture(path: &Path, traces: bool) -> Result<(), Failure> {
    if is_png(path) || is_stdout(path) || (traces && is_exr(path)) {
        return Ok(());
    }
    let endings = if traces { ".png or .exr" } else { ".png" };
    Err(Failure::Usage(format!(
        "{} must end in {endings}, after a name: that is what can be written",
        shown::path(path)
    )))
}

/// Is the picture there, to its end? Others than we may have left half of it.
fn is_whole(path: &Path) -> bool {
    if is_exr(path) {
        return read_screen(path).is_ok();
    }
    // The last chunk of PNG, whose checksum is always the same (section 11.2.5).
    fs::read(path).is_ok_and(|bytes| bytes.ends_with(b"\0\0\0\0IEND\xae\x42\x60\x82"))
}

/// A picture that is there already, as a screen shows it.
fn read_screen(path: &Path) -> Result<Rgba, Failure> {
    let wrong = |reason: &dyn Display| Failure::Usage(format!("cannot read {}: {reason}", shown::path(path)));
    if !is_exr(path) {
        return decode_png(&fs::read(path).map_err(|e| wrong(&e))?).map_err(|e| wrong(&e));
    }
    let file = File::open(path).map_err(|e| wrong(&e))?;
    let layers = decode_exr(BufReader::new(file)).map_err(|e| wrong(&e))?;
    to_screen(&layers, true).ok_or_else(|| wrong(&"it has no channels R, G and B"))
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
