//! The real povray: every embedded scene, the include file in foreign scenes, failures and signals.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::support::sample::sample;
use crate::support::{lichtenberg, require_povray, run_in, scene_names, small_variant, succeed_in, text};
use lichtenberg::files::{Rgba, decode_png, stage_names};
use rayon::prelude::*;

/// Runs povray itself on `scene` in `folder`; it must succeed without a warning.
fn povray(folder: &Path, scene: &str, extra: &[&str]) -> Rgba {
    let output = Command::new("povray")
        .current_dir(folder)
        .args([&format!("+I{scene}"), "+Oout.png", "+W160", "+H120", "-D", "-P", "-GR", "-GS", "-GD"])
        .args(extra)
        .output()
        .expect("povray starts");
    let said = text(&output.stderr);
    assert!(output.status.success() && !said.contains("Warning"), "{said}");
    decode_png(&fs::read(folder.join("out.png")).unwrap()).unwrap()
}

/// The share of pixels that differ from the picture's corner by more than a trifle.
fn covered(picture: &Rgba) -> f64 {
    let pixels: Vec<&[u8]> = picture.bytes.chunks(4).collect();
    let differs = |p: &&&[u8]| p.iter().zip(pixels[0]).any(|(a, b)| a.abs_diff(*b) > 24);
    pixels.iter().filter(differs).count() as f64 / pixels.len() as f64
}

/// In the studio look, a sample; the figures of 2012, which differ in their trees alone, are rendered in the exact one by
/// `preview.rs`.
#[test]
fn every_scene_renders_without_a_warning() {
    require_povray();
    let names = scene_names().into_iter().filter(|name| !name.starts_with("papers/2012")).collect();
    let names = sample(names, 4);
    names.par_iter().for_each(|name| {
        let folder = tempfile::tempdir().unwrap();
        let common = ["render", name, "--with", "povray", "--size", "160x120", "-o", "{scene}.png"];
        let output = run_in(folder.path(), &[&common[..], &small_variant(name)].concat());
        let said = text(&output.stderr);
        assert!(output.status.success() && !said.contains("Warning"), "{name}: {said}");
        let path = folder.path().join(text(&output.stdout).trim());
        let picture = decode_png(&fs::read(&path).unwrap()).unwrap();
        assert_eq!((picture.width, picture.height), (160, 120));
        assert!(covered(&picture) > 0.005, "{name} is blank");
    });
}

/// Every stage, about a tree.
#[test]
fn every_stage_renders_without_a_warning() {
    require_povray();
    assert_eq!(stage_names().len(), 7);
    stage_names().par_iter().for_each(|stage| {
        let folder = tempfile::tempdir().unwrap();
        let change = format!("stage={stage}");
        let call = ["render", "elm", "--set", &change, "--with", "povray", "--size", "160x120", "--quality", "draft"];
        let output = run_in(folder.path(), &[&call[..], &["-o", "elm.png"]].concat());
        let said = text(&output.stderr);
        assert!(output.status.success() && !said.contains("Warning"), "{stage}: {said}");
        let picture = decode_png(&fs::read(folder.path().join("elm.png")).unwrap()).unwrap();
        let pixel = |y: usize| &picture.bytes[(y * 160 + 4) * 4..][..3];
        let between = pixel(2).iter().zip(pixel(117)).map(|(sky, ground)| sky.abs_diff(*ground)).max();
        assert!(between > Some(8), "{stage}: the ground is as the sky");
    });
}

/// The include file works untouched in somebody else's y-up scene: twice, upright on the ground, and from another
/// folder; and two exports under different names live together.
#[test]
fn the_include_file_is_a_good_guest() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    let parts = folder.path().join("parts");
    for (seed, name) in [("1", "oak"), ("2", "ash")] {
        succeed_in(
            folder.path(),
            &[
                "export",
                "elm",
                "--seed",
                seed,
                "--name",
                name,
                "--to",
                "pov",
                "-o",
                "parts",
                "--set",
                "grow.elm.to.twigs.count=40",
            ],
        );
    }
    fs::write(
        folder.path().join("mine.pov"),
        r#"#version 3.7;
global_settings { assumed_gamma 1.0 }
#declare Oak_Colour = rgb <1, 0, 0>;
#include "oak.inc"
#include "oak.inc"
#include "ash.inc"
camera { orthographic location <0, 6, -50> right x*32 up y*24 look_at <0, 6, 0> }
background { rgb 1 }
light_source { <-100, 200, -300> rgb 1 }
object { Oak translate -8*x }
object { Oak scale Ash_Height/Oak_Height rotate 90*y }
object { Ash translate 8*x }
#if (Oak_Height < 11 | Oak_Height > 13) #error "the height is wrong" #end
"#,
    )
    .unwrap();
    let inc = parts.join("oak.inc");
    let before = fs::read(&inc).unwrap();
    let picture = povray(folder.path(), "mine.pov", &["+Lparts"]);
    assert_eq!(fs::read(&inc).unwrap(), before);
    // Upright, foot on the ground: seen from 6 above ground over 24 units, the feet are in row 90 of 120.
    let dark = |y: usize| (0..160).filter(|x| picture.bytes[(y * 160 + x) * 4] < 200).count();
    assert!(dark(45) > 20, "the crowns are above");
    assert!((1..24).contains(&dark(86)), "the stems stand on the ground, thin: {}", dark(86));
    assert_eq!(dark(96), 0, "nothing is below the ground");
}

/// Not mirrored: a scene with its one arm to the right, seen from the front, has it on the right.
#[test]
fn the_shape_is_not_mirrored() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    let arm = [
        "--set",
        "grow.cactus.to.arms.at=[[1.5, 0, 5]]",
        "--set",
        "camera.turn=0",
        "--set",
        "camera.room=0",
        "--size",
        "160x120",
        "--set",
        "stage=studio",
        "-o",
        "out.png",
    ];
    succeed_in(folder.path(), &[&["render", "cactus", "--with", "povray"], &arm[..]].concat());
    let front = decode_png(&fs::read(folder.path().join("out.png")).unwrap()).unwrap();
    succeed_in(folder.path(), &[&["render", "cactus", "--schematic"], &arm[..]].concat());
    let drawn = decode_png(&fs::read(folder.path().join("out.png")).unwrap()).unwrap();
    // The arm draws the middle of the upper part to its side of the stem.
    let middle = |picture: &Rgba, is_ink: &dyn Fn(&[u8]) -> bool, rows: std::ops::Range<usize>| {
        let ink = rows.flat_map(|y| (0..160).map(move |x| (x, y))).filter(|(x, y)| {
            let at = (y * 160 + x) * 4;
            is_ink(&picture.bytes[at..at + 4])
        });
        let columns: Vec<f64> = ink.map(|(x, _)| x as f64).collect();
        columns.iter().sum::<f64>() / columns.len() as f64
    };
    let green = |p: &[u8]| p[1] > p[0] && p[1] > p[2];
    let black = |p: &[u8]| p[0] < 128;
    let shift = |picture: &Rgba, is_ink: &dyn Fn(&[u8]) -> bool| {
        middle(picture, is_ink, 25..55) - middle(picture, is_ink, 75..100)
    };
    let (front, drawn) = (shift(&front, &green), shift(&drawn, &black));
    assert!(front > 4.0 && drawn > 4.0, "the arm is not on the right: {front}, {drawn}");
}

/// The schematic and povray see the same silhouette from the same camera.
#[test]
fn schematic_and_povray_agree() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    for (scene, size) in [("papers/2008-fig01", "160x120"), ("papers/2008-fig06", "160x120")] {
        let thick =
            format!("grow.{}.width={{ constant = 0.05 }}", if scene.contains("fig06") { "few" } else { "centre" });
        let common = [
            scene,
            "--size",
            size,
            "-o",
            "out.png",
            "--set",
            &thick,
            "--set",
            "sky={ horizon = [1, 1, 1], zenith = [1, 1, 1] }",
        ];
        let mut pictures = Vec::new();
        for how in [&["render", "--schematic"][..], &["render", "--with", "povray", "--look", "exact"]] {
            // Without a ground both have white behind.
            let ground = if scene.contains("fig06") {
                &["--set", "ground={ colour = [1, 1, 1], height = -100 }"][..]
            } else {
                &[]
            };
            succeed_in(folder.path(), &[how, &common, ground].concat());
            pictures.push(decode_png(&fs::read(folder.path().join("out.png")).unwrap()).unwrap());
        }
        let ink = |p: &Rgba| p.bytes.chunks(4).map(|p| p[0] < 160).collect::<Vec<_>>();
        let (a, b) = (ink(&pictures[0]), ink(&pictures[1]));
        let union = a.iter().zip(&b).filter(|(a, b)| **a || **b).count() as f64;
        let both = a.iter().zip(&b).filter(|(a, b)| **a && **b).count() as f64;
        assert!(both / union > 0.7, "{scene}: {}", both / union);
    }
}

#[test]
fn a_missing_povray_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let output = lichtenberg()
        .current_dir(folder.path())
        .env("PATH", folder.path())
        .args(["render", "cactus", "--with", "povray"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("apt-get install povray"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_failed_parse_repeats_povrays_words() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(folder.path().join("mine/scene.pov"), "#version 3.7;\nnonsense {{ title }}\n").unwrap();
    let output = run_in(folder.path(), &["render", "cactus", "--with", "povray", "--templates", "mine"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("scene.pov") && said.contains("line 3") && said.contains("Parse Error"), "{said}");
    assert!(!folder.path().join("cactus.png").exists());
}

/// SIGTERM and SIGINT end us and the child, and leave nothing behind.
#[test]
fn signals_stop_the_child() {
    require_povray();
    for (signal, code) in [("TERM", 143), ("INT", 130)] {
        let folder = tempfile::tempdir().unwrap();
        let mut child = lichtenberg()
            .current_dir(folder.path())
            .env("TMPDIR", folder.path())
            .args(["render", "elm", "--with", "povray", "--size", "4000x4000"])
            .spawn()
            .unwrap();
        let is_rendering = || files(folder.path()).iter().any(|f| f.ends_with("scene.ini"));
        let begun = Instant::now();
        while !is_rendering() {
            assert!(begun.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(50));
        }
        std::thread::sleep(Duration::from_millis(500));
        Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(code));
        assert_eq!(files(folder.path()), Vec::<String>::new(), "something is left behind");
        // povray had this folder as its own: no process does now.
        let of = |pid: &str| fs::read_link(format!("/proc/{pid}/cwd")).is_ok_and(|cwd| cwd.starts_with(folder.path()));
        let left =
            fs::read_dir("/proc").unwrap().filter(|e| of(&e.as_ref().unwrap().file_name().to_string_lossy())).count();
        assert_eq!(left, 0, "povray is still running");
    }
}

fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.path().is_dir() {
            found.extend(files(&entry.path()));
        }
        found.push(entry.path().display().to_string());
    }
    found
}
