//! What the README shows works as it stands there: its commands, its scene, its POV-Ray snippet.

mod support;

use std::fs;
use std::process::Command;

use support::{require_povray, root, succeed_in, text};

/// The fenced blocks of the README in this language.
fn blocks(language: &str) -> Vec<String> {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let fence = format!("```{language}\n");
    let blocks = readme.split(&fence).skip(1).filter_map(|rest| rest.split("```").next());
    let blocks: Vec<String> = blocks.map(str::to_owned).collect();
    assert!(!blocks.is_empty(), "README.md has no block of {language}");
    blocks
}

#[test]
fn the_tour_works() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    let mut commands = 0;
    for line in blocks("sh").iter().flat_map(|block| block.lines()) {
        let Some(line) = line.split('#').next().and_then(|l| l.trim().strip_prefix("lichtenberg ")) else { continue };
        let mut args: Vec<&str> = line.split_whitespace().collect();
        if args[0] == "render" {
            args.extend(["--size", "64x48"]);
        }
        succeed_in(folder.path(), &args);
        commands += 1;
    }
    assert!(commands >= 10);
    // And the snippet, on the export that the last of them made.
    fs::write(
        folder.path().join("mine.pov"),
        blocks("pov")[0].clone() + "camera { location <5, 10, -40> look_at <5, 8, 0> }\n",
    )
    .unwrap();
    let output = Command::new("povray")
        .current_dir(folder.path())
        .args(["+Imine.pov", "+Lparts", "-D", "-GR", "-GS", "-GD", "+W32", "+H24"])
        .output()
        .unwrap();
    let said = text(&output.stderr);
    assert!(output.status.success() && !said.contains("Warning"), "{said}");
}

#[test]
fn the_scene_works() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("twig.toml"), &blocks("toml")[0]).unwrap();
    succeed_in(folder.path(), &["check", "twig"]);
    succeed_in(folder.path(), &["export", "twig", "--to", "svg"]);
}
