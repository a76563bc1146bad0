//! `export`: scenes for other programs.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::args::{ExportArgs, Format};
use super::console::Console;
use super::error::Failure;
use super::jobs::Jobs;
use super::render::check_name;
use crate::export::{Pov, SvgOptions, Templates, write_obj, write_ply, write_svg};
use crate::files::{encode_exr, is_edited, seal, write_bytes, write_whole};
use crate::grow::MarkKind;

pub fn run(args: &ExportArgs, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let names = jobs.outputs(args.name.as_ref().unwrap_or(&jobs.pattern))?;
    let folder_pattern = format!("{}/{}", args.output, args.name.as_ref().unwrap_or(&jobs.pattern));
    let paths = jobs.outputs(&folder_pattern)?;
    for name in &names {
        check_name(name)?;
    }
    let templates = read_templates(args.templates.as_deref())?;
    for ((job, name), path) in jobs.list.iter().zip(&names).zip(&paths) {
        let folder = Path::new(path).parent().unwrap_or(Path::new("."));
        let first = folder.join(format!("{name}.{}", args.to.ending()));
        if args.skip_existing && first.exists() {
            continue;
        }
        let scene = jobs.load(job)?;
        let progress = console.progress(job.name());
        let show: Vec<MarkKind> = match args.to {
            Format::Svg if args.show.is_empty() => scene.show.clone(),
            Format::Svg => args.show.iter().filter_map(|&s| s.mark()).collect(),
            Format::Pov | Format::Obj | Format::Ply => Vec::new(),
        };
        let model = jobs.model(&scene, &show, console, &progress)?;
        let written = match args.to {
            Format::Svg => {
                write_whole(&first, |out| write_svg(&model, SvgOptions { size: scene.size }, out))
                    .map_err(|e| Failure::file("write", &first, &e))?;
                vec![first]
            }
            Format::Obj | Format::Ply => {
                let wrong = |e: std::io::Error| match e.kind() {
                    std::io::ErrorKind::InvalidInput => Failure::Usage(format!("{}: {e}", job.name())),
                    _ => Failure::file("write", &first, &e),
                };
                let obj = args.to == Format::Obj;
                write_whole(&first, |out| if obj { write_obj(&model, out) } else { write_ply(&model, out) })
                    .map_err(wrong)?;
                vec![first]
            }
            Format::Pov => {
                let pov = Pov::new(&model, &templates, name, scene.size, &job.origin(scene.seed, "export"));
                let written = write_pov(&pov, folder, name, args.force)?;
                for path in &written.kept {
                    console.note(&format!("note: kept {}, which was edited; --force writes over it", path.display()));
                }
                written.files
            }
        };
        console.done();
        for path in written {
            if console.json {
                console.result(&serde_json::json!({ "file": path, "scene": job.name(), "seed": scene.seed }));
            } else {
                console.line(&path.display().to_string());
            }
        }
    }
    Ok(())
}

/// The templates, those in `folder` in place of the program's own.
pub fn read_templates(folder: Option<&Path>) -> Result<Templates, Failure> {
    let mut templates = Templates::default();
    let Some(folder) = folder else { return Ok(templates) };
    let mut found = false;
    for name in Templates::names() {
        let path = folder.join(name);
        match fs::read_to_string(&path) {
            Ok(text) => {
                templates.replace(name, text);
                found = true;
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(error) => return Err(Failure::file("read", &path, &error)),
        }
    }
    if found {
        return Ok(templates);
    }
    let names: Vec<_> = Templates::names().collect();
    Err(Failure::Usage(format!("{} has none of the templates {}", folder.display(), names.join(", "))))
}

/// What [`write_pov`] did.
pub struct Written {
    /// Files written.
    pub files: Vec<PathBuf>,
    /// Files left alone because they were edited.
    pub kept: Vec<PathBuf>,
}

/// Writes NAME.inc, always, and NAME.pov and NAME.ini, unless they were edited.
pub fn write_pov(pov: &Pov<'_>, folder: &Path, name: &str, force: bool) -> Result<Written, Failure> {
    let inc = folder.join(format!("{name}.inc"));
    let failure = |path: &Path, error: std::io::Error| match error.kind() {
        // The template's own error says which it is.
        std::io::ErrorKind::InvalidData => Failure::Usage(error.to_string()),
        _ => Failure::file("write", path, &error),
    };
    // Filled in before anything is written, so that a wrong template changes no file.
    let texts = [
        (folder.join(format!("{name}.pov")), "//", pov.scene()),
        (folder.join(format!("{name}.ini")), ";", pov.settings()),
    ];
    let mut filled = Vec::new();
    for (path, comment, text) in texts {
        filled.push((seal(comment, &text.map_err(|e| failure(&path, e))?), path));
    }
    write_whole(&inc, |out| pov.write_inc(out)).map_err(|e| failure(&inc, e))?;
    let mut written = Written { files: vec![inc], kept: Vec::new() };
    if let Some((sky, strength)) = pov.sky() {
        let path = folder.join(format!("{name}-sky.exr"));
        write_whole(&path, |out| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            encode_exr(&sky.layers(strength), &mut bytes)?;
            out.write_all(bytes.get_ref())
        })
        .map_err(|e| failure(&path, e))?;
        written.files.push(path);
    }
    for (text, path) in filled {
        let edited = match fs::read_to_string(&path) {
            Ok(old) => is_edited(&old),
            Err(error) => error.kind() != std::io::ErrorKind::NotFound,
        };
        if edited && !force {
            written.kept.push(path);
            continue;
        }
        write_bytes(&path, text.as_bytes()).map_err(|e| failure(&path, e))?;
        written.files.push(path);
    }
    Ok(written)
}
