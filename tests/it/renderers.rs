//! RIB in the renderers that read it, where they are on the PATH: Pixie and Aqsis beside our own exact look.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::sample::{sample, tests_all};
use crate::support::{embedded, run_in, scene_names, small_variant, succeed_in, tell, text};
use lichtenberg::files::{Rgba, decode_png};
use lichtenberg::math::Progress;
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

/// A scene of what has grown alone, lit by constant light: its alpha is the silhouette.
const SILHOUETTE: &str = r##"##RenderMan RIB-Structure 1.1
version 3.03
Option "searchpath" "string archive" [".:&"]
Option "searchpath" "string shader" [".:&"]
Format {{ width }} {{ height }} 1
Display "{{ stem }}.tif" "file" "rgba"
Quantize "rgba" 65535 0 65535 0
PixelSamples 8 8
PixelFilter "box" 1 1
ShadingRate 0.5
{% if camera.fov %}
Projection "perspective" "fov" [{{ camera.fov }}]
{% else %}
Projection "orthographic"
ScreenWindow {{ camera.window }}
{% endif %}
Clipping {{ camera.clipping }}
ConcatTransform [{{ camera.matrix }}]
WorldBegin
LightSource "ambientlight" 1 "float intensity" [1] "color lightcolor" [1 1 1]
ReadArchive "{{ stem }}.archive.rib"
WorldEnd
"##;

const SIZE: [&str; 2] = ["--size", "160x120"];

/// What both renderers make of a scene.
struct Row {
    scene: String,
    /// Silhouette overlap with the exact look, and mean difference of 255, of Pixie, of Aqsis.
    found: [(f64, f64); 2],
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
    let changes: Vec<&str> = small_variant(name).into_iter().skip(1).collect();
    let changes: Vec<(&str, &str)> = changes.iter().filter_map(|change| change.split_once('=')).collect();
    let scene = embedded(name, &changes);
    let grown = grow(&scene, &[], u64::MAX, &Progress::default()).unwrap();
    let mut model = model(&scene, &grown, [160, 120], &Progress::default()).unwrap();
    model.ground = None;
    let settings = RenderSettings { transparent: true, ..RenderSettings::new([160, 120], Look::Exact, 64) };
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
    fs::write(at.join("silhouette/scene.rib"), SILHOUETTE).unwrap();
    let common = [&["render", scene, "--look", "exact"], &SIZE[..], &small_variant(scene)].concat();
    succeed_in(at, &[&common[..], &["--samples", "16", "-o", "exact.png"]].concat());
    let alpha = silhouette(scene);
    let found = ["pixie", "aqsis"].map(|renderer| {
        let by = [&common[..], &["--with", renderer, "-o", "by.png"]].concat();
        let silent = |args: &[&str]| {
            let output = run_in(at, args);
            assert!(
                output.status.success() && output.stderr.is_empty(),
                "{scene} {renderer}: {}",
                text(&output.stderr)
            );
        };
        silent(&by);
        let shown = picture(at, "by.png");
        silent(&[&by[..], &["--templates", "silhouette"]].concat());
        let alphas = picture(at, "by.png").bytes.into_iter().skip(3).step_by(4).map(|a| f64::from(a) / 255.0);
        // Aqsis multiplies alpha by coverage once more: of a white ribbon of a fifth of a pixel red is 0.2, alpha 0.04.
        let theirs: Vec<f64> = alphas.map(|a| if renderer == "aqsis" { a.sqrt() } else { a }).collect();
        (overlap(&alpha, &theirs), difference(&picture(at, "exact.png"), &shown))
    });
    let row = Row { scene: scene.to_owned(), found };
    tell(&row.line());
    row
}

impl Row {
    /// As a row of a table in Markdown.
    fn line(&self) -> String {
        let [pixie, aqsis] = self.found.map(|(overlap, difference)| format!("{overlap:.3} | {difference:.2}"));
        format!("| {} | {pixie} | {aqsis} |", self.scene)
    }
}

/// Both are silent about every scene in space - a sample, unless all are asked for - and show what the exact look shows.
#[test]
fn scenes_are_what_we_show() {
    if !are_there() {
        return;
    }
    let in_space = scene_names().into_iter().filter(|name| !embedded(name, &[]).recipe.is_flat).collect();
    let rows: Vec<Row> = sample(in_space, 8).par_iter().map(|name| compare(name)).collect();
    let mut table =
        "| scene | Pixie: overlap | difference | Aqsis: overlap | difference |\n|---|---|---|---|---|\n".to_owned();
    rows.iter().for_each(|row| table += &(row.line() + "\n"));
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("renderers.md"), table).unwrap();
    let bad: Vec<String> = rows
        .iter()
        .filter(|row| {
            let [(pixie, difference), (aqsis, _)] = row.found;
            !(pixie >= 0.97 && difference <= 3.0 && aqsis >= 0.9)
        })
        .map(Row::line)
        .collect();
    assert!(bad.is_empty(), "{bad:#?}");
}
