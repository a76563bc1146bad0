//! What a call is thought to take of memory, against what the process took at its peak, as the kernel counts it.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;

use crate::support::sample::sample;
use crate::support::{embedded, scene_names, succeed_in};
use rayon::prelude::*;
use serde_json::Value;

/// An estimate may be so many times the peak, or the peak the estimate.
const OFF: f64 = 1.5;

/// What makes most of each part: growth and model, texts, triangles, a picture, and one with all its layers.
const VERBS: [(&str, &[&str]); 5] = [
    ("info", &["info", "SCENE", "--json"]),
    ("rib", &["export", "SCENE", "--to", "rib", "--json"]),
    ("ply", &["export", "SCENE", "--to", "ply", "--json"]),
    ("png", &["render", "SCENE", "--size", "320x240", "--look", "studio", "--samples", "1", "-o", "a.png", "--json"]),
    ("exr", &["render", "SCENE", "--size", "640x480", "--look", "studio", "--samples", "1", "-o", "a.exr", "--json"]),
];

/// Estimate and peak of a call, in bytes. What is grown side by side where a thread is free, which estimates count, is grown one
/// after the other where none is: the highest peak of up to three calls.
fn told(folder: &Path, args: &[&str]) -> [f64; 2] {
    let once = || {
        let said = succeed_in(folder, args);
        let line: Value = serde_json::from_str(said.lines().next().unwrap()).unwrap();
        ["estimated", "peak"].map(|key| line["memory"][key].as_f64().unwrap())
    };
    let [estimate, mut peak] = once();
    for _ in 0..2 {
        if estimate > peak * OFF {
            peak = peak.max(once()[1]);
        }
    }
    [estimate, peak]
}

/// Is `verb` one for the scene?
fn suits(verb: &str, scene: &str) -> bool {
    let recipe = embedded(scene, &[]).recipe;
    match verb {
        "ply" => recipe.objects.iter().all(|object| object.mesh.is_some() || object.skin.is_mesh()),
        // Light has other layers and no samples.
        "exr" | "png" => recipe.view.is_none(),
        _ => true,
    }
}

/// Every verb's estimate of every scene - of a sample, unless all are asked for; a table of them is written.
#[test]
fn estimates_are_near_the_peak() {
    let rows: Vec<(String, [f64; 2])> = sample(scene_names(), 6)
        .par_iter()
        .flat_map_iter(|scene| {
            let folder = tempfile::tempdir().unwrap();
            let run = |(verb, args): &(&str, &[&str])| {
                let args: Vec<&str> =
                    args.iter().map(|&arg| if arg == "SCENE" { scene.as_str() } else { arg }).collect();
                suits(verb, scene).then(|| (format!("{scene} {verb}"), told(folder.path(), &args)))
            };
            VERBS.iter().filter_map(run).collect::<Vec<_>>()
        })
        .collect();
    let row = |(name, [estimate, peak]): &(String, [f64; 2])| {
        format!("| {name} | {:.0} | {:.0} | {:.2} |", estimate / 1e6, peak / 1e6, estimate / peak)
    };
    let table: Vec<String> = rows.iter().map(row).collect();
    let head = "| scene, verb | estimated, MB | peak, MB | ratio |\n|---|---|---|---|\n";
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("estimates.md"), head.to_owned() + &table.join("\n"))
        .unwrap();
    let is_off = |(_, [estimate, peak]): &&(String, [f64; 2])| *estimate > peak * OFF || *peak > estimate * OFF;
    let off: Vec<String> = rows.iter().filter(is_off).map(row).collect();
    assert!(off.is_empty(), "{off:#?}");
}
