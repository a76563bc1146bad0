//! `export`: scenes for other programs.

use std::path::{Path, PathBuf};

use super::args::{ExportArgs, Format, Shadows};
use super::console::Console;
use super::error::Failure;
use super::jobs::{Job, Jobs};
use super::render::check_name;
use super::write::{Written, note_patterns, read_templates, write_pov, write_rib};
use crate::export::{Pov, Rib, RibOptions, RibShadows, SvgOptions, Templates, write_obj, write_ply, write_svg};
use crate::files::write_atomic;
use crate::geom::MarkKind;
use crate::model::{Model, Object};
use crate::scene::Loaded;

pub fn run(args: &ExportArgs, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let names = jobs.outputs(args.name.as_ref().unwrap_or(&jobs.pattern))?;
    let folder_pattern = format!("{}/{}", args.output, args.name.as_ref().unwrap_or(&jobs.pattern));
    let paths = jobs.outputs(&folder_pattern)?;
    for name in &names {
        check_name(name)?;
    }
    let given = [("--shadows", args.shadows.is_some()), ("--displace", args.displace), ("--gzip", args.gzip)];
    if let Some((option, _)) = given.iter().find(|(_, is_given)| *is_given && args.to != Format::Rib) {
        return Err(Failure::Usage(format!("{option} is for RIB: use it with --to rib")));
    }
    let templates = read_templates(args.templates.as_deref())?;
    for name in args.templates.iter().flat_map(|folder| Templates::names().map(|name| folder.join(name))) {
        jobs.add_input(&name);
    }
    let folder_of = |path: &str| Path::new(path).parent().unwrap_or(Path::new(".")).to_owned();
    let files = names.iter().zip(&paths).flat_map(|(name, path)| {
        let folder = folder_of(path);
        args.to.files(name).into_iter().map(move |file| folder.join(file))
    });
    jobs.guard(&files.collect::<Vec<_>>())?;
    for ((job, name), path) in jobs.list.iter().zip(&names).zip(&paths) {
        let folder = &folder_of(path);
        let first = folder.join(format!("{name}.{}", args.to.ending()));
        if args.skip_existing && first.exists() {
            continue;
        }
        let scene = jobs.load(job)?;
        let progress = console.progress(job.name());
        let show: Vec<MarkKind> = match args.to {
            Format::Svg if args.show.is_empty() => scene.show.clone(),
            Format::Svg => args.show.iter().filter_map(|&s| s.mark()).collect(),
            Format::Pov | Format::Rib | Format::Obj | Format::Ply => Vec::new(),
        };
        let model = jobs.model(&scene, &show, console, &progress)?;
        let target = Target { folder, name, first: &first };
        let written = write(args, &target, job, &scene, &model, &templates, console)?;
        console.done();
        for path in written {
            if console.json {
                console.result(&serde_json::json!({ "file": path, "scene": job.name(), "seed": scene.recipe.seed }));
            } else {
                console.line(&path.display().to_string());
            }
        }
    }
    Ok(())
}

/// Where a scene goes.
struct Target<'a> {
    folder: &'a Path,
    name: &'a str,
    /// The file that stands for all.
    first: &'a Path,
}

/// Writes `model` in the format asked for; the files.
fn write(
    args: &ExportArgs,
    target: &Target<'_>,
    job: &Job,
    scene: &Loaded,
    model: &Model,
    templates: &Templates,
    console: &Console,
) -> Result<Vec<PathBuf>, Failure> {
    match args.to {
        Format::Svg => {
            write_atomic(target.first, |out| write_svg(model, SvgOptions { size: scene.recipe.size }, out))
                .map_err(|e| Failure::file("write", target.first, &e))?;
            Ok(vec![target.first.to_owned()])
        }
        Format::Obj | Format::Ply => {
            let wrong = |e: std::io::Error| match e.kind() {
                std::io::ErrorKind::InvalidInput => Failure::Usage(format!("{}: {e}", job.name())),
                _ => Failure::file("write", target.first, &e),
            };
            let obj = args.to == Format::Obj;
            write_atomic(target.first, |out| if obj { write_obj(model, out) } else { write_ply(model, out) })
                .map_err(wrong)?;
            Ok(vec![target.first.to_owned()])
        }
        Format::Pov => {
            let pov =
                Pov::new(model, templates, target.name, scene.recipe.size, &job.origin(scene.recipe.seed, "export"));
            Ok(told(write_pov(&pov, target.folder, target.name, args.force)?, console))
        }
        Format::Rib => {
            let origin = job.origin(scene.recipe.seed, "export");
            let shadows = args.shadows.map_or(RibShadows::None, Shadows::of);
            let options = RibOptions { shadows, displace: args.displace };
            if args.displace && model.objects.iter().any(leans) {
                console.note("note: displaced thorns stand upright: only those that are cones `lean`");
            }
            let rib = Rib::new(model, templates, target.name, scene.recipe.size, &origin, options);
            note_patterns(&rib, console);
            Ok(told(write_rib(&rib, target.folder, target.name, args.gzip, args.force)?, console))
        }
    }
}

/// Do its thorns lean?
fn leans(object: &Object) -> bool {
    object.body.limbs().and_then(|limbs| limbs.thorns).is_some_and(|thorns| thorns.lean > 0.0)
}

/// The files written; tells of those that were left alone.
fn told(written: Written, console: &Console) -> Vec<PathBuf> {
    for path in &written.kept {
        console.note(&format!("note: kept {}, which was edited; --force writes over it", path.display()));
    }
    written.files
}

impl Shadows {
    fn of(self) -> RibShadows {
        match self {
            Self::None => RibShadows::None,
            Self::Rays => RibShadows::Rays,
            Self::Maps => RibShadows::Maps,
        }
    }
}
