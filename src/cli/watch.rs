//! `render --watch`: the picture follows the scene's files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use notify::{RecommendedWatcher, RecursiveMode, Watcher};

use super::args::RenderArgs;
use super::choices::Show;
use super::console::Console;
use super::draw::{checked_means, draw, report};
use super::error::Failure;
use super::jobs::Jobs;
use super::output::is_stdout;
use super::preview::{Drawn, Means, is_exr, trace, view};
use super::{pattern, shown, terminal};
use crate::math::Progress;
use crate::trace::RenderSettings;

/// The first picture is this many times smaller, with one sample a pixel.
const COARSE: u32 = 4;
/// How often we look whether to stop.
const POLL: Duration = Duration::from_millis(50);
/// Files are written in several strokes: a change counts when it has been quiet for so long.
const QUIET: Duration = Duration::from_millis(80);

/// The files that a scene is read from, and their folders, which are watched.
struct Sources {
    watcher: RecommendedWatcher,
    files: Arc<Mutex<BTreeSet<PathBuf>>>,
    folders: BTreeSet<PathBuf>,
    /// What is written is no source, even where it is read.
    output: Option<PathBuf>,
}

impl Sources {
    /// Of no files yet; their changes are sent.
    fn new(output: &Path, changes: Sender<()>) -> Result<Self, Failure> {
        let files = Arc::new(Mutex::new(BTreeSet::new()));
        let known = Arc::clone(&files);
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            let Ok(event) = event else { return };
            let known = known.lock().unwrap_or_else(PoisonError::into_inner);
            // Reading a file is no change of it.
            if !event.kind.is_access() && event.paths.iter().any(|path| known.contains(path)) {
                let _ = changes.send(());
            }
        })
        .map_err(|error| Failure::Usage(format!("cannot watch for changes: {error}")))?;
        Ok(Self { watcher, files, folders: BTreeSet::new(), output: place(output) })
    }

    /// Follows `file`, whether it is there or not, and what it links to.
    fn follow(&mut self, file: &Path) -> Result<(), Failure> {
        for path in place(file).into_iter().chain(file.canonicalize()) {
            if self.output.as_ref() == Some(&path) {
                continue;
            }
            if let Some(folder) = path.parent().filter(|folder| !self.folders.contains(*folder)) {
                self.watcher
                    .watch(folder, RecursiveMode::NonRecursive)
                    .map_err(|error| Failure::Usage(format!("cannot watch {}: {error}", shown::path(folder))))?;
                self.folders.insert(folder.to_owned());
            }
            self.files.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
        }
        Ok(())
    }
}

/// The path of `file` from the root, or of the first folder on the way to it that is missing.
fn place(file: &Path) -> Option<PathBuf> {
    let name = file.file_name()?;
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match folder.canonicalize() {
        Ok(folder) => Some(folder.join(name)),
        Err(_) => place(folder),
    }
}

/// Renders whenever a file that the scene is read from changes, until interrupted.
pub fn run(args: &RenderArgs, threads: Option<usize>, console: &Console) -> Result<(), Failure> {
    let [scene] = &args.scene.scenes[..] else {
        return Err(Failure::Usage("--watch follows one scene".to_owned()));
    };
    if !scene.is_file() {
        let scene = shown::path(scene);
        return Err(Failure::Usage(format!("--watch follows a scene file; `{scene}` is none (see `new`)")));
    }
    let output = output(args)?;
    let (send, changes) = channel();
    let mut sources = Sources::new(&output, send)?;
    sources.follow(scene)?;
    let sources = Mutex::new(sources);

    loop {
        // Work on an outdated scene stops at the next change, all work at a signal.
        let outdated = Arc::new(AtomicBool::new(false));
        let progress = console.progress_until(&shown::path(scene), Arc::clone(&outdated));
        let result = std::thread::scope(|threads_here| {
            let work = threads_here.spawn(|| once(args, &output, &sources, threads, console, &progress));
            loop {
                let has_changed = changes.recv_timeout(POLL).is_ok();
                if has_changed || console.is_stopped() {
                    outdated.store(true, Ordering::Relaxed);
                }
                if work.is_finished() {
                    return work.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                }
            }
        });
        console.done();
        match result {
            _ if console.is_stopped() => return Err(Failure::Stopped),
            Ok(()) | Err(Failure::Stopped) => {}
            // A mistake in the scene is shown, and mended by the next change.
            Err(failure) => failure.print(console),
        }
        if !outdated.load(Ordering::Relaxed) {
            wait(console, &changes)?;
        }
        while changes.recv_timeout(QUIET).is_ok() {}
    }
}

/// Waits for a change.
fn wait(console: &Console, changes: &std::sync::mpsc::Receiver<()>) -> Result<(), Failure> {
    loop {
        if console.is_stopped() {
            return Err(Failure::Stopped);
        }
        match changes.recv_timeout(POLL) {
            Ok(()) => return Ok(()),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Err(Failure::Usage("changes are no longer seen".to_owned())),
        }
    }
}

fn output(args: &RenderArgs) -> Result<PathBuf, Failure> {
    // The scene may be wrong as yet: its own name is enough.
    let name = args.scene.scenes[0].file_stem().map_or("scene".into(), |n| n.to_string_lossy());
    let pattern = args.output.clone().unwrap_or_else(|| "{scene}.png".into());
    let values = BTreeMap::from([("scene".to_owned(), name.into_owned())]);
    match pattern::fill(pattern.as_os_str(), &values) {
        Ok(path) if is_stdout(&path) => Err(Failure::Usage("--watch writes a file, not standard output".to_owned())),
        Ok(path) => Ok(path),
        Err(_) => Err(Failure::Usage("with --watch, {scene} is the only pattern".to_owned())),
    }
}

/// Once the whole way, coarse first.
fn once(
    args: &RenderArgs,
    output: &Path,
    sources: &Mutex<Sources>,
    threads: Option<usize>,
    console: &Console,
    progress: &Progress,
) -> Result<(), Failure> {
    let begun = Instant::now();
    let jobs = Jobs::new(&args.scene, console)?;
    let [job] = &jobs.list[..] else { return Err(Failure::Usage("--watch follows one scene".to_owned())) };
    let loaded = jobs.load(job);
    for read in jobs.reads() {
        sources.lock().unwrap_or_else(PoisonError::into_inner).follow(&read.path)?;
    }
    let scene = loaded?;
    jobs.guard(&[output.to_owned()])?;
    let finish = |drawn: Drawn| -> Result<(), Failure> {
        drawn.write(output, args, &scene)?;
        if args.show.contains(&Show::Terminal) {
            terminal::show(&drawn.to_screen(), console)?;
        }
        report(output, &jobs, job, &scene, begun, console);
        Ok(())
    };
    if checked_means(args, &scene, is_exr(output))? != Means::Preview {
        return finish(draw(args, &jobs, job, &scene, is_exr(output), threads, console, progress)?);
    }
    let fine = view(args, &scene, is_exr(output), &jobs.memory)?;
    let model = jobs.model(&scene, &[], console, progress)?;
    let less = |x: u32| (x / COARSE).max(1);
    let size = fine.size.map(less);
    // A corner that rounding would put outside lies at the edge.
    let corner = [0, 1].map(|i| (fine.crop[i] / COARSE).min(size[i] - 1));
    let extent = [0, 1].map(|i| less(fine.crop[i + 2]).min(size[i] - corner[i]));
    let coarse = RenderSettings { size, crop: [corner[0], corner[1], extent[0], extent[1]], samples: 1, ..fine };
    finish(trace(&model, &coarse, &jobs.memory, progress)?)?;
    finish(trace(&model, &fine, &jobs.memory, progress)?)
}
