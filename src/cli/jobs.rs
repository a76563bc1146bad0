//! Many at once: scenes, seeds and sweeps become jobs, each with its own output.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::iter;
use std::path::{Path, PathBuf};

use super::args::{LimitArgs, SceneArgs, Seeds, Sweep};
use super::console::Console;
use super::error::Failure;
use super::guard::refuse_inputs;
use super::memory;
use super::{pattern, shown};
use crate::export::Origin;
use crate::files::{FileRead, Folder, Reads, embedded_scenes};
use crate::geom::MarkKind;
use crate::grow::Grown;
use crate::math::{Memory, Progress, unknown};
use crate::model::Model;
use crate::scene::{self, Loaded, Override, Source};

/// More pictures than this in one call are a slip of the hand.
const MOST_JOBS: usize = 100_000;
/// A scene file may have this many bytes.
const MOST_BYTES: u64 = 4 << 20;

/// One scene with one seed and one value of everything that is swept.
#[derive(Clone, Debug)]
pub struct Job {
    source: Source,
    overrides: Vec<Override>,
    /// The scene's name as it was given, for headers.
    given: PathBuf,
    /// What patterns stand for: `scene`, `seed`, and each swept path, whole and its last key.
    values: BTreeMap<String, String>,
    /// The frame of an animation.
    frame: Option<u32>,
    /// What tells this job from the others, in words.
    pub label: String,
}

/// All jobs of a call.
pub struct Jobs {
    /// The jobs, in order.
    pub list: Vec<Job>,
    /// The pattern that tells their outputs apart.
    pub pattern: String,
    size: Option<[u32; 2]>,
    /// What may be taken, and what is thought to be.
    pub memory: Memory,
    reads: Reads,
}

/// The text of the scene called `name`, a file, or else an embedded one; `reads` records what it reads.
pub fn find_scene(name: &Path, limits: &LimitArgs, reads: &Reads, console: &Console) -> Result<Source, Failure> {
    let embedded = embedded_scenes();
    let inside = embedded.iter().find(|(known, ..)| Path::new(known) == name);
    let mut with_ending = name.as_os_str().to_owned();
    with_ending.push(".toml");
    let candidates = [name.to_owned(), PathBuf::from(with_ending)];
    let file = candidates.iter().find(|path| path.is_file());
    if let Some(path) = file {
        if inside.is_some() {
            console.note(&format!("note: taking the file {}, not the embedded scene of that name", shown::path(path)));
        }
        let source = read_scene(path, limits)?;
        reads.add(FileRead { name: source.name.clone(), path: path.clone() });
        return Ok(source.recorded(reads));
    }
    if let Some((name, text, folder)) = inside {
        let source = Source { name: name.clone(), text: (*text).to_owned(), folder: folder.clone() };
        return Ok(source.recorded(reads));
    }
    let hint = unknown("scene file or embedded scene", &shown::path(name), embedded.iter().map(|(name, ..)| name));
    Err(Failure::Usage(hint))
}

fn read_scene(path: &Path, limits: &LimitArgs) -> Result<Source, Failure> {
    let wrong = |error: &std::io::Error| Failure::file("read", path, error);
    let size = path.metadata().map_err(|e| wrong(&e))?.len();
    if size > MOST_BYTES {
        return Err(Failure::Usage(format!("{} has {size} bytes: that is no scene", shown::path(path))));
    }
    let text = std::fs::read(path).map_err(|e| wrong(&e))?;
    let text = String::from_utf8(text)
        .map_err(|_| Failure::Usage(format!("{} is not UTF-8 text: that is no scene", shown::path(path))))?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = if limits.confined {
        let allowed = iter::once(folder).chain(limits.allow.iter().map(PathBuf::as_path));
        let place = |path: &Path| path.canonicalize().map_err(|error| Failure::file("read", path, &error));
        Folder::Confined(folder.to_owned(), allowed.map(place).collect::<Result<_, _>>()?)
    } else {
        Folder::Disk(folder.to_owned())
    };
    Ok(Source { name: shown::path(path), text, folder })
}

impl Jobs {
    pub fn new(args: &SceneArgs, console: &Console) -> Result<Self, Failure> {
        let seeds: Vec<Option<u64>> = match (&args.seeds, args.seed) {
            (Some(Seeds(seeds)), _) => seeds.iter().map(|&s| Some(s)).collect(),
            (None, seed) => vec![seed],
        };
        let frames: Vec<Option<u32>> = match &args.frames {
            Some(frames) => frames.clone().map(Some).collect(),
            None => vec![None],
        };
        let sweeps = args.sweep.iter().map(|sweep| sweep.values.len());
        let count =
            [seeds.len(), frames.len(), args.scenes.len()].into_iter().chain(sweeps).fold(1, usize::saturating_mul);
        if count > MOST_JOBS {
            return Err(Failure::Usage(format!(
                "{count} pictures in one call are a slip of the hand: {MOST_JOBS} at most"
            )));
        }
        let mut list = Vec::new();
        let reads = Reads::default();
        for given in &args.scenes {
            let source = find_scene(given, &args.limits, &reads, console)?;
            for (&seed, &frame) in seeds.iter().flat_map(|seed| frames.iter().map(move |frame| (seed, frame))) {
                for choice in choices(&args.sweep) {
                    list.push(Job::new(args, &source, given, (seed, seeds.len() > 1), frame, &choice));
                }
            }
        }
        let pattern = pattern(args, seeds.len() > 1);
        let memory = memory::held(args.limits.max_memory);
        Ok(Self { list, pattern, size: args.size, memory, reads })
    }

    /// The output of each job by `pattern`.
    pub fn outputs(&self, pattern: &OsStr) -> Result<Vec<PathBuf>, Failure> {
        let outputs: Vec<PathBuf> =
            self.list.iter().map(|job| job.output(pattern)).collect::<Result<_, _>>().map_err(Failure::Usage)?;
        let mut seen = BTreeMap::new();
        for (output, job) in outputs.iter().zip(&self.list) {
            if let Some(other) = seen.insert(output, job) {
                return Err(Failure::Usage(format!(
                    "`{}` would be written twice ({} and {}): put {} in its name",
                    shown::path(output),
                    other.label,
                    job.label,
                    self.pattern
                )));
            }
        }
        Ok(outputs)
    }

    /// Reads the scene of `job`; its size is the call's or the scene's own.
    pub fn load(&self, job: &Job) -> Result<Loaded, Failure> {
        let size = self.size.map(|[w, h]| Override { path: "size".to_owned(), value: format!("[{w}, {h}]") });
        let overrides: Vec<Override> = job.overrides.iter().cloned().chain(size).collect();
        Ok(scene::load_frame(&job.source, &overrides, job.frame.map(f64::from))?)
    }

    /// Notes that the call reads `path` besides its scenes.
    pub fn add_input(&self, path: &Path) {
        self.reads.add(FileRead { name: shown::path(path), path: path.to_owned() });
    }

    /// Refuses `outputs` that a scene reads, before anything grows: every scene is read for what it names.
    pub fn guard(&self, outputs: &[PathBuf]) -> Result<(), Failure> {
        let mut known = BTreeSet::new();
        for job in &self.list {
            let named: Vec<&Override> = job.overrides.iter().filter(|o| o.path != "seed").collect();
            let key: Vec<&str> = named.iter().flat_map(|o| [o.path.as_str(), &o.value]).collect();
            if known.insert((job.name(), key)) {
                self.load(job)?;
            }
        }
        refuse_inputs(self.reads.files().iter().map(|read| read.path.as_path()), outputs)
    }

    /// The files that scenes have named so far, whether they could be read or not.
    pub fn reads(&self) -> Vec<FileRead> {
        self.reads.files()
    }

    /// Grows a scene.
    pub fn grow(
        &self,
        scene: &Loaded,
        show: &[MarkKind],
        console: &Console,
        progress: &Progress,
    ) -> Result<Vec<Grown>, Failure> {
        let grown = scene::grow(scene, show, &self.memory, progress)?;
        for step in grown.iter().filter(|step| step.dropped > 0) {
            console.note(&format!(
                "warning: step `{}` dropped {} endpoints that no path reaches",
                step.name, step.dropped
            ));
        }
        Ok(grown)
    }

    /// The whole way from a job to its model.
    pub fn model(
        &self,
        scene: &Loaded,
        show: &[MarkKind],
        console: &Console,
        progress: &Progress,
    ) -> Result<Model, Failure> {
        let grown = self.grow(scene, show, console, progress)?;
        Ok(scene::model(scene, &grown, scene.recipe.size, &self.memory, progress)?)
    }
}

/// The pattern that tells the outputs of all jobs apart.
fn pattern(args: &SceneArgs, has_seeds: bool) -> String {
    let mut pattern = "{scene}".to_owned();
    if has_seeds {
        pattern.push_str("_{seed}");
    }
    if args.frames.is_some() {
        pattern.push_str("_{frame}");
    }
    for sweep in args.sweep.iter().filter(|sweep| sweep.values.len() > 1) {
        pattern.push_str(&format!("_{{{}}}", sweep.path));
    }
    pattern
}

impl Job {
    /// The job of a scene `given` with one seed, whether it is one of several, one frame, and one value of each sweep.
    fn new(
        args: &SceneArgs,
        source: &Source,
        given: &Path,
        (seed, is_one_of_seeds): (Option<u64>, bool),
        frame: Option<u32>,
        choice: &[(&str, &str)],
    ) -> Self {
        let stem = given.file_stem().map_or("scene".into(), |s| s.to_string_lossy());
        let mut overrides = args.set.clone();
        let mut values = BTreeMap::from([("scene".to_owned(), stem.to_string())]);
        let mut label = Vec::new();
        if let Some(seed) = seed {
            overrides.push(Override { path: "seed".to_owned(), value: seed.to_string() });
            values.insert("seed".to_owned(), seed.to_string());
        }
        if args.scenes.len() > 1 {
            label.push(stem.to_string());
        }
        if let Some(frame) = frame {
            values.insert("frame".to_owned(), format!("{frame:04}"));
            label.push(format!("frame {frame}"));
        }
        if is_one_of_seeds {
            label.push(format!("seed {}", seed.unwrap_or_default()));
        }
        for &(path, value) in choice {
            overrides.push(Override { path: path.to_owned(), value: value.to_owned() });
            let key = path.rsplit('.').next().unwrap_or(path);
            label.push(format!("{key} {value}"));
            for name in [path, key] {
                values.insert(name.to_owned(), value.to_owned());
            }
        }
        Self { source: source.clone(), overrides, given: given.to_owned(), values, frame, label: label.join(", ") }
    }

    /// Its output by `pattern`: `{key}` stands for a value, `####` for its frame with as many digits.
    fn output(&self, pattern: &OsStr) -> Result<PathBuf, String> {
        let name = pattern::fill(pattern, &self.values)?;
        let numbered = self.frame.and_then(|frame| pattern::number(&name, frame));
        Ok(numbered.unwrap_or(name))
    }

    /// The scene's name in messages.
    pub fn name(&self) -> &str {
        &self.source.name
    }

    /// What it is called while it is worked on.
    pub fn title(&self) -> &str {
        if self.label.is_empty() { self.name() } else { &self.label }
    }

    /// The command that repeats what was made, without paths.
    pub fn origin(&self, seed: u64, verb: &str) -> Origin {
        let scene = self.given.file_name().map_or("scene".into(), |n| n.to_string_lossy());
        // Names of embedded scenes have folders.
        let scene = self.given.to_str().filter(|given| self.source.name == *given).map_or(scene, Into::into);
        let sets = self.overrides.iter().filter(|o| o.path != "seed").map(|o| format!(" --set {}={}", o.path, o.value));
        Origin { command: format!("lichtenberg {verb} {scene} --seed {seed}{}", sets.collect::<String>()), seed }
    }
}

/// Every combination of one value each.
fn choices(sweeps: &[Sweep]) -> Vec<Vec<(&str, &str)>> {
    sweeps.iter().fold(vec![Vec::new()], |all, sweep| {
        let mut more = Vec::new();
        for chosen in &all {
            for value in &sweep.values {
                let mut chosen: Vec<(&str, &str)> = chosen.clone();
                chosen.push((&sweep.path, value));
                more.push(chosen);
            }
        }
        more
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_multiply() {
        let sweep = |path: &str, values: &[&str]| Sweep {
            path: path.to_owned(),
            values: values.iter().map(|v| (*v).to_owned()).collect(),
        };
        assert_eq!(choices(&[sweep("a", &["1", "2"]), sweep("b", &["x", "y", "z"])]).len(), 6);
        assert_eq!(choices(&[]).len(), 1);
    }
}
