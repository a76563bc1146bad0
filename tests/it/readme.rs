//! What the README shows works as it stands there: its commands, its scene, its POV-Ray snippet.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::support::sample::tests_all;
use crate::support::{lichtenberg, require_povray, root, run_in, succeed_in, text};

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
        if args[0] == "render" && !args.contains(&"--size") {
            args.extend(["--size", "64x48"]);
        }
        // Two of many seeds show how.
        if let Some(list) = args.iter().position(|arg| *arg == "--seeds").filter(|_| !tests_all()) {
            args[list + 1] = "1-2";
        }
        commands += 1;
        if args.contains(&"--watch") {
            watch(folder.path(), &args);
            continue;
        }
        let output = run_in(folder.path(), &args);
        // Nothing has been accepted when pictures are first compared: the answer is no.
        let is_first = args[0] == "compare" && !args.contains(&"--update");
        assert_eq!(output.status.code(), Some(i32::from(is_first)), "{line}: {}", text(&output.stderr));
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

/// It goes on until it is interrupted, and has made its picture by then.
fn watch(folder: &Path, args: &[&str]) {
    let mut child = lichtenberg().current_dir(folder).args(args).spawn().unwrap();
    let begun = Instant::now();
    while !folder.join("mine.png").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no picture");
        std::thread::sleep(Duration::from_millis(50));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn the_scenes_work() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = blocks("toml");
    assert!(scenes.len() >= 4);
    for scene in scenes {
        fs::write(folder.path().join("scene.toml"), scene).unwrap();
        succeed_in(folder.path(), &["check", "scene"]);
        succeed_in(folder.path(), &["info", "scene", "--json"]);
    }
}
