//! RIB in the renderers that read it, where they are on the PATH: Pixie and Aqsis beside our own exact look.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::support::sample::{sample, tests_all};
use crate::support::{embedded, lichtenberg, run_in, scene_names, small_variant, tell, text};
use lichtenberg::files::{Rgba, decode_png};
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{grow, model};
use lichtenberg::trace::{Look, RenderSettings, World, render};
use rayon::prelude::*;

/// Are both there? Under `./run-tests --all` they must be.
fn are_there() -> bool {
    let finds = |program: &str| Command::new(program).arg("-h").output().is_ok();
    let found = ["rndr", "sdrc", "aqsis", "aqsl"].into_iter().all(finds);
    assert!(found || !tests_all(), "these tests need Pixie and Aqsis on the PATH: see docs/rib.md");
    if !found {
        tell("Pixie and Aqsis are not on the PATH: RIB is not rendered (docs/rib.md)");
    }
    found
}

/// The scene without sky, ground, light and what stands about: its alpha is the silhouette of what has grown.
fn silhouette_template() -> String {
    let changed = |text: String, from: &str, to: &str| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    };
    let text = include_str!("../../templates/scene.rib").to_owned();
    // Fine enough that its own grain is none of it.
    let text = changed(text, "PixelSamples 8 8", "PixelSamples 16 16");
    let text = changed(text, "\"file\" \"rgb\"", "\"file\" \"rgba\"");
    let text = changed(text, "{% if stage %}", "{% if false %}");
    ["sheet in sheets", "light in lights", "map in maps"].into_iter().fold(text, |text, all| {
        let (one, _) = all.split_once(' ').unwrap();
        changed(text, &format!("{{% for {all} %}}"), &format!("{{% for {one} in [] %}}"))
    })
}

/// Colours are compared in pictures of this size, silhouettes in twice that, which shows twigs, and those of what is thinner still
/// in four times.
const SIZE: [u32; 2] = [160, 120];
const THIN: [&str; 3] = ["bolt-3d", "grove", "papers/2007-fig15"];

fn silhouette_size(scene: &str) -> [u32; 2] {
    SIZE.map(|side| side * if THIN.contains(&scene) { 4 } else { 2 })
}

/// Samples a pixel of our own, as many as the renderers take. (With 16 its grain is 2.5 of 255 off 256 samples where twigs are a
/// fifth of a pixel, as in willow and Fig. 20 of 2012; with 64 it is 1.1.)
const SAMPLES: &str = "64";

/// What both renderers make of a scene.
struct Row {
    scene: String,
    /// Silhouette overlap with the exact look, and mean difference of 255.
    pixie: [f64; 2],
    /// The same; the difference where all is asked for: Aqsis takes long.
    aqsis: (f64, Option<f64>),
}

fn picture(folder: &Path, file: &str) -> Rgba {
    decode_png(&fs::read(folder.join(file)).unwrap()).unwrap()
}

/// Coverage that both have over that which one has, pixel by pixel.
fn overlap(a: &[f64], b: &[f64]) -> f64 {
    let sum = |of: fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| of(*a, *b)).sum::<f64>();
    sum(f64::min) / sum(f64::max)
}

/// The coverage of pixels by what has grown, as the exact look has it.
fn silhouette(name: &str) -> Vec<f64> {
    let changes = small_variant(name);
    let changes: Vec<(&str, &str)> = changes.iter().filter_map(|change| change.split_once('=')).collect();
    let (scene, size) = (embedded(name, &changes), silhouette_size(name));
    let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
    let mut model = model(&scene, &grown, size, &Memory::default(), &Progress::default()).unwrap();
    model.ground = None;
    model.objects.retain(|object| !object.is_scenery);
    model.lights.clear();
    let settings = RenderSettings { transparent: true, ..RenderSettings::new(size, Look::Exact, 64) };
    let film = render(&World::new(&model), &settings, &Progress::default()).unwrap();
    film.pixels.iter().map(|p| f64::from(p[3])).collect()
}

fn difference(a: &Rgba, b: &Rgba) -> f64 {
    let colours = |p: &Rgba| p.bytes.chunks(4).flat_map(|p| p[..3].to_vec()).collect::<Vec<_>>();
    let (a, b) = (colours(a), colours(b));
    a.iter().zip(&b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}

fn compare(scene: &str) -> Row {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir(at.join("silhouette")).unwrap();
    fs::write(at.join("silhouette/scene.rib"), silhouette_template()).unwrap();
    let common = [&["render", scene, "--look", "exact"], &small_variant(scene)[..]].concat();
    let [size, twice] = [SIZE, silhouette_size(scene)].map(|[w, h]| format!("{w}x{h}"));
    let exact = run_in(at, &[&common[..], &["--size", &size, "--samples", SAMPLES, "-o", "exact.png"]].concat());
    assert!(exact.status.success(), "{scene}: {}", text(&exact.stderr));
    let alpha = silhouette(scene);
    let by = |renderer: &str, extra: &[&str]| {
        let output = run_in(at, &[&common[..], &["--with", renderer, "-o", "by.png"], extra].concat());
        // What growing warns of, and no more.
        let is_silent = text(&output.stderr) == text(&exact.stderr);
        assert!(output.status.success() && is_silent, "{scene} {renderer}: {}", text(&output.stderr));
        picture(at, "by.png")
    };
    let colours = |renderer: &str| difference(&picture(at, "exact.png"), &by(renderer, &["--size", &size]));
    let alphas = |renderer: &str| -> Vec<f64> {
        let shown = by(renderer, &["--size", &twice, "--templates", "silhouette"]);
        shown.bytes.chunks(4).map(|p| f64::from(p[3]) / 255.0).collect()
    };
    // Aqsis multiplies alpha by coverage once more: of a white ribbon of a fifth of a pixel red is 0.2, alpha 0.04.
    let by_aqsis: Vec<f64> = alphas("aqsis").into_iter().map(f64::sqrt).collect();
    let row = Row {
        scene: scene.to_owned(),
        pixie: [overlap(&alpha, &alphas("pixie")), colours("pixie")],
        aqsis: (overlap(&alpha, &by_aqsis), tests_all().then(|| colours("aqsis"))),
    };
    tell(&row.line());
    row
}

impl Row {
    /// Is Pixie's or Aqsis' silhouette, or what Pixie's colours are off by, out of bounds?
    fn misses(&self) -> bool {
        self.pixie[0] < 0.97 || self.pixie[1] > 3.0 || self.aqsis.0 < 0.9
    }

    /// As a row of a table in Markdown.
    fn line(&self) -> String {
        let ([overlap, off], (aqsis, aqsis_off)) = (self.pixie, self.aqsis);
        let aqsis_off = aqsis_off.map_or(String::new(), |off| format!("{off:.2}"));
        format!("| {} | {overlap:.3} | {off:.2} | {aqsis:.3} | {aqsis_off} |", self.scene)
    }
}

/// Scenes that take neither renderer long: samples are of these; `./run-tests --all` takes all, `LICHTENBERG_TEST_SCENES=a,b` those.
const QUICK: [&str; 23] = [
    "cracked-ground",
    "crystals",
    "fur",
    "moss",
    "papers/2007-fig13-solid",
    "papers/2007-table1-coral",
    "papers/2008-fig05",
    "papers/2008-fig07",
    "papers/2008-fig08",
    "papers/2012-fig09",
    "papers/2012-fig10",
    "papers/2012-fig12",
    "papers/2012-fig13",
    "papers/2012-fig14",
    "papers/2012-fig23-c",
    "papers/2012-fig23-e",
    "papers/2012-fig23-j",
    "papers/2012-fig23-m",
    "papers/2012-fig23-n",
    "papers/amin-fig1",
    "papers/amin-fig3",
    "roots-over-rock",
    "trellis",
];

/// Both are silent about every scene in space - a sample, unless all are asked for - and show what the exact look shows.
#[test]
fn scenes_are_what_we_show() {
    if !are_there() {
        return;
    }
    let named = std::env::var("LICHTENBERG_TEST_SCENES").ok();
    let is_asked = |name: &str| match &named {
        Some(named) => named.split(',').any(|asked| asked == name),
        None => tests_all() || QUICK.contains(&name),
    };
    let in_space = |name: &String| is_asked(name) && !embedded(name, &[]).recipe.is_flat;
    let in_space = scene_names().into_iter().filter(in_space).collect();
    let rows: Vec<Row> = sample(in_space, 8).par_iter().map(|name| compare(name)).collect();
    let mut table =
        "| scene | Pixie: overlap | difference | Aqsis: overlap | difference |\n|---|---|---|---|---|\n".to_owned();
    rows.iter().for_each(|row| table += &(row.line() + "\n"));
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("renderers.md"), table).unwrap();
    let bad: Vec<String> = rows.iter().filter(|row| row.misses()).map(Row::line).collect();
    assert!(bad.is_empty(), "{bad:#?}");
}

/// A shader that does not compile is told in its compiler's words, and nothing is left.
#[test]
fn broken_shaders_are_told() {
    if !are_there() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(folder.path().join("mine/pattern.sl"), "surface {{ name }}(float x = 1;) { Ci = nowhere; }\n").unwrap();
    for (renderer, compiler) in [("pixie", "sdrc"), ("aqsis", "aqsl")] {
        let few = ["--set", "grow.elm.to.twigs.count=20", "--templates", "mine", "-o", "out.png"];
        let output = run_in(folder.path(), &[&["render", "elm", "--with", renderer][..], &few].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(said.contains(compiler) && said.contains("bark.sl"), "{said}");
        assert!(!folder.path().join("out.png").exists());
    }
}

/// INT ends renderer and call.
#[test]
fn signals_stop_the_renderer() {
    if !are_there() {
        return;
    }
    for renderer in ["pixie", "aqsis"] {
        let folder = tempfile::tempdir().unwrap();
        let mut child = lichtenberg()
            .current_dir(folder.path())
            .env("TMPDIR", folder.path())
            .args(["render", "elm", "--with", renderer, "--size", "4000x3000", "-o", "out.png"])
            .spawn()
            .unwrap();
        // The renderer has our folder of scratch as its own.
        let of = |pid: &str| fs::read_link(format!("/proc/{pid}/cwd")).is_ok_and(|cwd| cwd.starts_with(folder.path()));
        let own = child.id().to_string();
        let running = || {
            let all = fs::read_dir("/proc").unwrap().flatten().map(|e| e.file_name().to_string_lossy().into_owned());
            all.filter(|pid| *pid != own && of(pid)).count()
        };
        let begun = Instant::now();
        while running() == 0 {
            assert!(begun.elapsed() < Duration::from_secs(60), "{renderer} does not start");
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(300));
        Command::new("kill").args(["-INT", &own]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert_eq!(running(), 0, "{renderer} is still running");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "something is left behind");
    }
}
