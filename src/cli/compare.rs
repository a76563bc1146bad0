//! `compare`: have pictures changed?

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Deserialize;

use super::args::CompareArgs;
use super::console::Console;
use super::error::Failure;
use super::guard::refuse_inputs;
use super::preview::{is_exr, is_png};
use super::{memory, output, shown};
use crate::compare::{Metric, Outcome, Pair, Panel, bytes_needed, changes, html, junit, measure, summary};
use crate::files::{Rgba, decode_exr, decode_linear, encode_png, picture_extent, write_bytes};
use crate::math::srgb_byte;
use crate::raster::{Layers, filmic};

/// Thresholds in a folder of expected pictures.
const CONFIG: &str = "compare.toml";

/// What `compare.toml` may say.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Config {
    /// What decides.
    metric: Option<Metric>,
    /// Above this pictures differ.
    threshold: Option<f64>,
    /// By name of the picture within the folder.
    file: BTreeMap<String, FileConfig>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct FileConfig {
    metric: Option<Metric>,
    threshold: Option<f64>,
}

/// A pair of files, with the name that both have.
struct Files {
    name: PathBuf,
    expected: PathBuf,
    actual: PathBuf,
    /// Bytes that comparing them takes; 0 where a file is missing or cannot be read.
    bytes_needed: u64,
}

impl Files {
    fn new(name: PathBuf, expected: PathBuf, actual: PathBuf) -> Self {
        let extents = [&expected, &actual].map(|path| picture_extent(path, is_exr(path)));
        let needed = match extents {
            [Some(e), Some(a)] => bytes_needed([e.pixels, a.pixels], [e.channels, a.channels]),
            _ => 0,
        };
        Self { name, expected, actual, bytes_needed: needed }
    }

    /// The name in reports and in `compare.toml`.
    fn shown(&self) -> String {
        shown::path(&self.name).replace('\\', "/")
    }
}

pub fn run(args: &CompareArgs, console: &Console) -> Result<(), Failure> {
    if args.update && !args.force && std::env::var("CI").is_ok_and(|v| v == "true" || v == "1") {
        return Err(Failure::Usage("--update is refused where CI=true, since nobody looks: add --force".to_owned()));
    }
    let config = read_config(args)?;
    let files = find(args)?;
    if files.is_empty() {
        return Err(Failure::Usage(format!("{} has no pictures (.png, .exr)", shown::path(&args.expected))));
    }
    guard_inputs(args, &files)?;
    let wants_panels = args.html.is_some();
    let max_memory = memory::held(args.max_memory).left();
    let compare_one = |files: &Files| -> Result<(Pair, Panel), Failure> {
        if console.is_stopped() {
            return Err(Failure::Stopped);
        }
        let (pair, panel, difference) = compare(args, &config, files, wants_panels, max_memory);
        if let (Some(folder), Some(picture)) = (&args.diff, difference) {
            output::write(&difference_path(folder, &files.name), |out| out.write_all(&png(&picture)))?;
        }
        Ok((pair, panel))
    };
    let mut panels: Vec<(Pair, Panel)> = Vec::new();
    for batch in batches(&files, max_memory) {
        panels.extend(batch.par_iter().map(compare_one).collect::<Result<Vec<_>, _>>()?);
    }
    let pairs: Vec<Pair> = panels.iter().map(|(pair, _)| pair.clone()).collect();
    for (pair, files) in pairs.iter().zip(&files) {
        say(pair, files, console);
    }
    if let Some(path) = &args.junit {
        output::write(path, |out| out.write_all(junit(&pairs).as_bytes()))?;
    }
    if let Some(path) = &args.html {
        output::write(path, |out| out.write_all(html(&panels).as_bytes()))?;
    }
    write_step_summary(&pairs)?;
    if !console.json {
        console.line(&summary(&pairs));
    }
    let failed = pairs.iter().filter(|pair| pair.outcome == Outcome::Failed).count();
    if args.update {
        return update(&pairs, &files, console);
    }
    if failed > 0 {
        return Err(Failure::Usage(format!("{} could not be compared", pictures(failed))));
    }
    match pairs.iter().filter(|pair| !pair.is_same()).count() {
        0 => Ok(()),
        count => Err(Failure::No(format!("not as expected: {}", pictures(count)))),
    }
}

/// Refuses outputs that are compared, or say how.
fn guard_inputs(args: &CompareArgs, files: &[Files]) -> Result<(), Failure> {
    let config = config_path(args);
    let inputs = files.iter().flat_map(|files| [&files.expected, &files.actual]).chain([&config]);
    let mut outputs: Vec<PathBuf> = args.junit.iter().chain(&args.html).cloned().collect();
    if let Some(folder) = &args.diff {
        outputs.extend(files.iter().map(|files| difference_path(folder, &files.name)));
    }
    output::check(&outputs, true)?;
    refuse_inputs(inputs.map(PathBuf::as_path), &outputs)
}

/// Where the picture of a difference goes.
fn difference_path(folder: &Path, name: &Path) -> PathBuf {
    let mut path = folder.join(name).into_os_string();
    path.push(".flip.png");
    path.into()
}

/// Runs of `files` that can be compared side by side within `max_memory` bytes.
fn batches(files: &[Files], max_memory: u64) -> Vec<&[Files]> {
    let mut batches = Vec::new();
    let (mut start, mut sum) = (0, 0_u64);
    for (i, pair) in files.iter().enumerate() {
        let needed = pair.bytes_needed;
        sum = sum.saturating_add(needed);
        if sum > max_memory && i > start {
            batches.push(&files[start..i]);
            (start, sum) = (i, needed);
        }
    }
    batches.push(&files[start..]);
    batches
}

fn config_path(args: &CompareArgs) -> PathBuf {
    args.config.clone().unwrap_or_else(|| args.expected.join(CONFIG))
}

fn read_config(args: &CompareArgs) -> Result<Config, Failure> {
    let path = config_path(args);
    match fs::read_to_string(&path) {
        Ok(text) => {
            let config: Config =
                toml::from_str(&text).map_err(|e| Failure::Usage(format!("{}: {e}", shown::path(&path))))?;
            let thresholds = config.file.values().map(|file| file.threshold).chain([config.threshold]);
            match thresholds.flatten().find(|x| x.is_nan() || *x < 0.0) {
                Some(x) => Err(Failure::Usage(format!("{}: a threshold is 0 or more, not {x}", shown::path(&path)))),
                None => Ok(config),
            }
        }
        Err(error) if args.config.is_none() && is_not_there(&error) => Ok(Config::default()),
        Err(error) => Err(Failure::file("read", &path, &error)),
    }
}

/// Is it no file, or, beside two files, no folder?
fn is_not_there(error: &std::io::Error) -> bool {
    matches!(error.kind(), std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory)
}

/// The pairs: two files, or what both folders hold.
fn find(args: &CompareArgs) -> Result<Vec<Files>, Failure> {
    let (expected, actual) = (&args.expected, &args.actual);
    if expected.is_dir() != actual.is_dir() && expected.exists() && actual.exists() {
        return Err(Failure::Usage("compare takes two pictures or two folders, not one of each".to_owned()));
    }
    if !expected.is_dir() && !actual.is_dir() {
        let name = expected.file_name().map_or_else(PathBuf::new, PathBuf::from);
        if !actual.exists() && !expected.exists() {
            return Err(Failure::Usage(format!(
                "there is neither {} nor {}",
                shown::path(expected),
                shown::path(actual)
            )));
        }
        return Ok(vec![Files::new(name, expected.clone(), actual.clone())]);
    }
    let mut names = BTreeSet::new();
    for folder in [expected, actual] {
        if folder.exists() {
            list(folder, Path::new(""), &mut names).map_err(|e| Failure::file("read", folder, &e))?;
        }
    }
    Ok(names.into_iter().map(|name| Files::new(name.clone(), expected.join(&name), actual.join(&name))).collect())
}

/// The pictures below `folder`, by their paths within it.
fn list(folder: &Path, within: &Path, names: &mut BTreeSet<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder.join(within))? {
        let entry = entry?;
        let path = within.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            list(folder, &path, names)?;
        } else if is_png(&path) || is_exr(&path) {
            names.insert(path);
        }
    }
    Ok(())
}

/// Compares a pair; the difference in colours where there is one.
fn compare(
    args: &CompareArgs,
    config: &Config,
    files: &Files,
    wants_panel: bool,
    max_memory: u64,
) -> (Pair, Panel, Option<Rgba>) {
    // The most specific level that says anything of a metric decides; a threshold goes with its own level's metric.
    let own = config.file.get(&files.shown()).copied().unwrap_or_default();
    let levels = [
        (args.metric.map(Metric::from), args.threshold),
        (own.metric, own.threshold),
        (config.metric, config.threshold),
    ];
    let with_metric = levels.iter().position(|(metric, _)| metric.is_some()).unwrap_or(levels.len() - 1);
    let metric = levels[with_metric].0.unwrap_or_default();
    let threshold =
        levels[..=with_metric].iter().find_map(|(_, threshold)| *threshold).unwrap_or_else(|| metric.threshold());
    let mut pair = Pair {
        name: files.shown(),
        outcome: Outcome::Same,
        reason: None,
        measures: None,
        metric,
        threshold,
        changes: Vec::new(),
    };
    let mut panel = Panel::default();
    let needed = files.bytes_needed;
    if needed > max_memory {
        let [needed, most] = [needed.div_ceil(1_000_000), max_memory / 1_000_000];
        let reason = format!("comparing them needs about {needed} MB of memory, more than the {most} MB allowed");
        (pair.outcome, pair.reason) = (Outcome::Failed, Some(reason));
        return (pair, panel, None);
    }
    let [expected, actual] = [&files.expected, &files.actual].map(|path| read(path));
    if wants_panel {
        let shown = |picture: &Option<Result<(Layers, bool), String>>| match picture {
            Some(Ok((layers, is_hdr))) => to_screen(layers, *is_hdr).map(|picture| png(&picture)),
            _ => None,
        };
        (panel.expected, panel.actual) = (shown(&expected), shown(&actual));
    }
    let ((expected, is_hdr), (actual, _)) = match (expected, actual) {
        (Some(Ok(expected)), Some(Ok(actual))) => (expected, actual),
        (Some(Err(reason)), _) | (_, Some(Err(reason))) => {
            (pair.outcome, pair.reason) = (Outcome::Failed, Some(reason));
            return (pair, panel, None);
        }
        (None, _) => {
            (pair.outcome, pair.reason) = (Outcome::New, Some("there is no expected picture".to_owned()));
            return (pair, panel, None);
        }
        (_, None) => {
            (pair.outcome, pair.reason) = (Outcome::Missing, Some("there is no actual picture".to_owned()));
            return (pair, panel, None);
        }
    };
    if let (Some(old), Some(new)) = (expected.text("Scene"), actual.text("Scene")) {
        pair.changes = changes(old, new);
    }
    if let (Some(old), Some(new)) = (expected.text("View"), actual.text("View")) {
        pair.changes.extend(changes(old, new).into_iter().map(|change| format!("render: {change}")));
    }
    match measure(&expected, &actual, &args.channels, is_hdr) {
        Ok(mut measures) => {
            if metric.of(&measures) > threshold {
                pair.outcome = Outcome::Different;
            } else {
                pair.changes.clear();
            }
            // Of many pictures only what is asked for is kept.
            let map = std::mem::take(&mut measures.map);
            let wants_diff = args.diff.is_some() && pair.outcome == Outcome::Different;
            let difference = (wants_panel || wants_diff).then(|| heat(expected.width, expected.height, &map));
            if wants_panel {
                panel.difference = difference.as_ref().map(png);
            }
            pair.measures = Some(measures);
            (pair, panel, difference.filter(|_| wants_diff))
        }
        Err(reason) => {
            // Another size is a difference; a channel that is not there cannot be compared.
            let is_size = (expected.width, expected.height) != (actual.width, actual.height);
            pair.outcome = if is_size { Outcome::Different } else { Outcome::Failed };
            pair.reason = Some(reason.to_string());
            (pair, panel, None)
        }
    }
}

/// A picture and whether it is one of high dynamic range; `None` where there is no file.
fn read(path: &Path) -> Option<Result<(Layers, bool), String>> {
    let source = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
        Err(error) => return Some(Err(format!("cannot read {}: {error}", shown::path(path)))),
    };
    let is_exr = is_exr(path);
    let layers = if is_exr {
        decode_exr(source).map_err(|e| e.to_string())
    } else {
        decode_linear(source).map_err(|e| e.to_string())
    };
    Some(layers.map(|layers| (layers, is_exr)).map_err(|error| format!("cannot read {}: {error}", shown::path(path))))
}

/// The colours of a picture as a screen shows them, over black.
pub fn to_screen(layers: &Layers, is_hdr: bool) -> Option<Rgba> {
    let pixels = layers.pixels(["R", "G", "B"])?;
    let byte = |x: f32| {
        let linear = f64::from(x);
        srgb_byte(if is_hdr { filmic(linear) } else { linear })
    };
    let bytes = pixels.iter().flat_map(|p| [byte(p[0]), byte(p[1]), byte(p[2]), 255]).collect();
    Some(Rgba { width: layers.width, height: layers.height, bytes })
}

/// FLIP in colours: black, red, yellow, white.
fn heat(width: u32, height: u32, map: &[f32]) -> Rgba {
    let ramp = |x: f32, from: f32| ((x - from) * 3.0).clamp(0.0, 1.0) * 255.0;
    let colour = |&x: &f32| [ramp(x, 0.0) as u8, ramp(x, 1.0 / 3.0) as u8, ramp(x, 2.0 / 3.0) as u8, 255];
    Rgba { width, height, bytes: map.iter().flat_map(colour).collect() }
}

fn png(picture: &Rgba) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Writing to memory does not fail.
    let _ = encode_png(picture, &[], &mut bytes);
    bytes
}

/// A line a pair, and an annotation where GitHub runs us.
fn say(pair: &Pair, files: &Files, console: &Console) {
    if console.json {
        console.result(&serde_json::json!(pair));
    } else {
        console.line(&pair.line());
    }
    if !pair.is_same() && runs_on_github() {
        let annotation = shown::annotation(&files.expected, &pair.line());
        // Not among lines of JSON; GitHub reads both streams.
        if console.json { console.note(&annotation) } else { console.line(&annotation) }
    }
}

fn runs_on_github() -> bool {
    std::env::var("GITHUB_ACTIONS").is_ok_and(|v| v == "true")
}

/// A table in the summary of a step of GitHub Actions.
fn write_step_summary(pairs: &[Pair]) -> Result<(), Failure> {
    let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|_| runs_on_github()).map(PathBuf::from) else {
        return Ok(());
    };
    let mut text = format!("{}\n\n| picture | outcome | |\n| --- | --- | --- |\n", summary(pairs));
    for pair in pairs.iter().filter(|pair| !pair.is_same()) {
        let [name, told] = [&pair.name, &pair.told()].map(|text| shown::cell(text));
        text.push_str(&format!("| {name} | {} | {told} |\n", pair.outcome.name()));
    }
    fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(&path)
        .and_then(|mut file| file.write_all(text.as_bytes()))
        .map_err(|e| Failure::file("write", &path, &e))
}

fn pictures(count: usize) -> String {
    if count == 1 { "1 picture".to_owned() } else { format!("{count} pictures") }
}

/// Accepts what is there as expected.
fn update(pairs: &[Pair], files: &[Files], console: &Console) -> Result<(), Failure> {
    let mut refused = 0;
    for (pair, files) in pairs.iter().zip(files) {
        match pair.outcome {
            Outcome::Different | Outcome::New => {
                let bytes = fs::read(&files.actual).map_err(|e| Failure::file("read", &files.actual, &e))?;
                write_bytes(&files.expected, &bytes).map_err(|e| Failure::file("write", &files.expected, &e))?;
                console.note(&format!("accepted {}", shown::path(&files.expected)));
            }
            Outcome::Missing | Outcome::Failed => refused += 1,
            Outcome::Same => {}
        }
    }
    if refused > 0 {
        return Err(Failure::Usage(format!(
            "{} could not be accepted: delete what is no longer wanted",
            pictures(refused)
        )));
    }
    Ok(())
}
