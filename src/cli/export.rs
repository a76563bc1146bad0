//! `export`: scenes for other programs.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::slice;

use super::args::ExportArgs;
use super::choices::{Format, Shadows};
use super::console::Console;
use super::error::Failure;
use super::jobs::{Job, Jobs};
use super::memory::{self, ask_beside};
use super::output::{self, is_stdout};
use super::render::check_name;
use super::shown;
use super::write::{Written, read_templates, write_pov, write_rib};
use crate::export::{
    Pov, Rib, RibOptions, RibShadows, SvgOptions, Templates, obj_bytes_needed, ply_bytes_needed, write_obj, write_ply,
    write_svg,
};
use crate::geom::MarkKind;
use crate::math::Memory;
use crate::model::{Model, Object};
use crate::scene::Loaded;

pub fn run(args: &ExportArgs, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let pattern = args.name.as_ref().unwrap_or(&jobs.pattern);
    let names = jobs.outputs(OsStr::new(pattern))?;
    let names: Vec<String> = names.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    for name in &names {
        check_name(name)?;
    }
    let paths = jobs.outputs(args.output.join(pattern).as_os_str())?;
    let given = [
        ("--shadows", args.shadows.is_some()),
        ("--displace", args.displace),
        ("--detail", args.detail.is_some()),
        ("--gzip", args.gzip),
    ];
    if let Some((option, _)) = given.iter().find(|(_, is_given)| *is_given && args.to != Format::Rib) {
        return Err(Failure::Usage(format!("{option} is for RIB: use it with --to rib")));
    }
    let templates = read_templates(args.templates.as_deref())?;
    for name in args.templates.iter().flat_map(|folder| Templates::names().map(|name| folder.join(name))) {
        jobs.add_input(&name);
    }
    let folder_of = |path: &Path| path.parent().unwrap_or(Path::new(".")).to_owned();
    let files = names.iter().zip(&paths).flat_map(|(name, path)| {
        let folder = folder_of(path);
        args.to.files(name).into_iter().map(move |file| folder.join(file))
    });
    if is_stdout(&args.output) {
        return write_to_stdout(args, &jobs, console);
    }
    jobs.guard(&files.collect::<Vec<_>>())?;
    for ((job, name), path) in jobs.list.iter().zip(&names).zip(&paths) {
        let folder = &folder_of(path);
        let first = folder.join(format!("{name}.{}", args.to.ending()));
        if args.skip_existing && is_whole(&first) {
            continue;
        }
        let scene = jobs.load(job)?;
        let progress = console.progress(job.name());
        let model = jobs.model(&scene, &marks(args, &scene), console, &progress)?;
        let target = Target { folder, name, first: &first };
        let written = write(args, &target, &jobs, job, &scene, &model, &templates, console)?;
        console.done();
        for path in written {
            let memory = memory::told(&jobs.memory);
            let details = serde_json::json!({ "scene": job.name(), "seed": scene.recipe.seed, "memory": memory });
            console.wrote(&path, details);
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

/// Writes the one scene of `jobs` to standard output.
fn write_to_stdout(args: &ExportArgs, jobs: &Jobs, console: &Console) -> Result<(), Failure> {
    let ([job], Format::Svg | Format::Obj | Format::Ply) = (&jobs.list[..], args.to) else {
        return Err(Failure::Usage("standard output (-) takes one scene as svg, obj or ply".to_owned()));
    };
    output::check(slice::from_ref(&args.output), console.json)?;
    let scene = jobs.load(job)?;
    let model = jobs.model(&scene, &marks(args, &scene), console, &console.progress(job.name()))?;
    console.done();
    write_one(args.to, &args.output, &scene, &model, &jobs.memory)
}

/// The marks that are drawn.
fn marks(args: &ExportArgs, scene: &Loaded) -> Vec<MarkKind> {
    match args.to {
        Format::Svg if args.show.is_empty() => scene.show.clone(),
        Format::Svg => args.show.iter().filter_map(|&s| s.mark()).collect(),
        Format::Pov | Format::Rib | Format::Obj | Format::Ply => Vec::new(),
    }
}

/// Is the text there, to its end? Others than we may have left half of it, or none.
fn is_whole(path: &Path) -> bool {
    let mut end = [0];
    let read = File::open(path).and_then(|mut file| {
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut end)
    });
    read.is_ok() && end == *b"\n"
}

/// Writes `model` in a format of one file.
fn write_one(to: Format, path: &Path, scene: &Loaded, model: &Model, memory: &Memory) -> Result<(), Failure> {
    let needed = match to {
        Format::Obj => obj_bytes_needed(model),
        Format::Ply => ply_bytes_needed(model),
        Format::Svg | Format::Pov | Format::Rib => 0,
    };
    ask_beside(model, needed, memory)?;
    output::write(path, |out| match to {
        Format::Obj => write_obj(model, out),
        Format::Ply => write_ply(model, out),
        Format::Svg | Format::Pov | Format::Rib => write_svg(model, SvgOptions { size: scene.recipe.size }, out),
    })
}

/// Writes `model` in the format asked for; the files.
#[allow(clippy::too_many_arguments, reason = "a scene, where it goes, and who listens")]
fn write(
    args: &ExportArgs,
    target: &Target<'_>,
    jobs: &Jobs,
    job: &Job,
    scene: &Loaded,
    model: &Model,
    templates: &Templates,
    console: &Console,
) -> Result<Vec<PathBuf>, Failure> {
    match args.to {
        Format::Svg | Format::Obj | Format::Ply => {
            write_one(args.to, target.first, scene, model, &jobs.memory)?;
            Ok(vec![target.first.to_owned()])
        }
        Format::Pov => {
            let pov =
                Pov::new(model, templates, target.name, scene.recipe.size, &job.origin(scene.recipe.seed, "export"));
            Ok(told(write_pov(&pov, target.folder, target.name, args.force)?, console))
        }
        Format::Rib => {
            let origin = job.origin(scene.recipe.seed, "export");
            let shadows = args.shadows.map_or(RibShadows::default(), Shadows::of);
            let options =
                RibOptions { shadows, displace: args.displace, linear: false, detail: args.detail.unwrap_or(0.0) };
            if args.displace && model.objects.iter().any(leans) {
                console.note("note: displaced thorns stand upright: only those that are cones `lean`");
            }
            ask_beside(model, Rib::bytes_needed(model, scene.recipe.size, options), &jobs.memory)?;
            let rib = Rib::new(model, templates, target.name, scene.recipe.size, &origin, options);
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
        console.note(&format!("note: kept {}, which was edited; --force writes over it", shown::path(path)));
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
