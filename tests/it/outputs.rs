//! What is written: never in place of what is read, the same bytes in every process; and reports that end.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use crate::command::TWIG;
use crate::support::{files_below, lichtenberg, run_in, succeed_in, text};

/// The command must refuse, name `output`, and change no file.
fn keeps(folder: &Path, args: &[&str], output: &str) {
    let contents = || {
        let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (fs::read(&path).ok(), path)).collect::<Vec<_>>()
    };
    let before = contents();
    let refused = run_in(folder, args);
    let said = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{args:?}: {said}");
    assert!(said.contains(&format!("{output} is an output")), "{args:?}: {said}");
    assert!(contents() == before, "{args:?} changed a file");
}

/// An embedded scene with everything that it reads beside it.
fn new_scene(name: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["new", name]);
    folder
}

#[test]
fn no_output_replaces_an_input() {
    let folder = new_scene("painted-leaf");
    let at = |name: &str| folder.path().join(name);
    let scene = fs::read_to_string(at("painted-leaf.toml")).unwrap().replace("assets/painted-leaf.png", "map.png");
    fs::rename(at("assets/painted-leaf.png"), at("map.png")).unwrap();
    fs::write(at("map.toml"), scene).unwrap();
    fs::hard_link(at("map.png"), at("hard.png")).unwrap();
    keeps(folder.path(), &["render", "map.toml"], "map.png");
    keeps(folder.path(), &["render", "map.toml", "-o", "./hard.png"], "./hard.png");
    keeps(folder.path(), &["render", "map.toml", "-o", "other.png", "--sheet", "map.png"], "map.png");
    // Also where another scene of the call reads it.
    fs::rename(at("map.png"), at("plain.png")).unwrap();
    fs::write(at("other.toml"), fs::read_to_string(at("map.toml")).unwrap().replace("map.png", "plain.png")).unwrap();
    fs::write(at("plain.toml"), TWIG).unwrap();
    keeps(folder.path(), &["render", "plain.toml", "other.toml"], "plain.png");
}

#[test]
fn no_export_replaces_an_input() {
    let folder = new_scene("vine");
    let scene = fs::read_to_string(folder.path().join("vine.toml")).unwrap();
    fs::write(folder.path().join("vine.toml"), scene.replace("assets/vine.svg", "vine.svg")).unwrap();
    fs::rename(folder.path().join("assets/vine.svg"), folder.path().join("vine.svg")).unwrap();
    keeps(folder.path(), &["export", "vine.toml", "--to", "svg"], "./vine.svg");
    let folder = new_scene("broken-vase");
    keeps(
        &folder.path().join("assets"),
        &["export", "../broken-vase.toml", "--to", "obj", "--name", "vase"],
        "./vase.obj",
    );
}

#[test]
fn no_strike_replaces_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    succeed_in(folder.path(), &["render", "elm", "--size", "64x48", "--samples", "1", "-o", "p.png"]);
    let strike = ["strike", "p.png", "--to", "0.5,0.6"];
    keeps(folder.path(), &[&strike[..], &["-o", "p.png"]].concat(), "p.png");
    keeps(folder.path(), &[&strike[..], &["-o", "new.png", "--sheet", "p.png"]].concat(), "p.png");
    // A frame must not take the place of the next one's photograph.
    for frame in [1, 2] {
        fs::copy(at("p.png"), at(&format!("f{frame}.png"))).unwrap();
    }
    let frames = ["strike", "f#.png", "--frames", "1-2", "--to", "0.5,0.6"];
    keeps(folder.path(), &[&frames[..], &["-o", "f#.png"]].concat(), "f1.png");
}

#[test]
fn no_comparison_replaces_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["render", "elm", "--size", "32x32", "--samples", "1", "-o", "a.png"]);
    fs::copy(folder.path().join("a.png"), folder.path().join("b.png")).unwrap();
    for option in ["--html", "--junit"] {
        keeps(folder.path(), &["compare", "a.png", "b.png", option, "b.png"], "b.png");
    }
}

/// Attributes of OpenEXR once came from a map whose order differed in every process.
#[test]
fn every_process_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["render", "cactus", "--size", "64x48", "--samples", "1", "-o", "plate.png"]);
    let small = ["--size", "40x30", "--samples", "1"];
    let calls: [&[&str]; 11] = [
        &["render", "cactus", "-o", "OUT.exr"],
        &["render", "cactus", "-o", "OUT.png"],
        &["render", "cactus", "--schematic", "-o", "OUT.png"],
        &["render", "night-bolt", "--size", "64x48", "-o", "OUT.exr"],
        &["strike", "plate.png", "--to", "0.5,0.6", "-o", "OUT.exr"],
        &["export", "cactus", "--to", "pov", "-o", "OUT"],
        &["export", "cactus", "--to", "rib", "-o", "OUT"],
        &["export", "storm", "--to", "svg", "-o", "OUT"],
        &["export", "cactus", "--set", "object.cactus.skin=mesh", "--to", "obj", "-o", "OUT"],
        &["export", "cactus", "--set", "object.cactus.skin=mesh", "--to", "ply", "-o", "OUT"],
        &["compare", "plate.png", "plate.png", "--html", "OUT.html", "--junit", "OUT.xml", "--json"],
    ];
    for call in calls {
        let is_traced = call[0] == "render" && call[1] == "cactus" && !call.contains(&"--schematic");
        let made = ["1", "2", "3", "8"].map(|threads| {
            let place = folder.path().join(threads);
            fs::create_dir_all(&place).unwrap();
            let args = call.iter().map(|arg| arg.replace("OUT", &format!("{threads}/x")));
            let args: Vec<String> = args.chain(["--threads".to_owned(), threads.to_owned()]).collect();
            let args: Vec<&str> =
                args.iter().map(String::as_str).chain(small.into_iter().filter(|_| is_traced)).collect();
            succeed_in(folder.path(), &args);
            let files = files_below(&place, "");
            let bytes: Vec<_> = files
                .iter()
                .map(|file| (file.strip_prefix(&place).unwrap().to_owned(), fs::read(file).unwrap()))
                .collect();
            fs::remove_dir_all(&place).unwrap();
            bytes
        });
        assert!(!made[0].is_empty() && made.iter().all(|files| *files == made[0]), "{call:?}");
    }
}

#[test]
fn reports_end() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = |name: &str, points: &str| {
        let scene = TWIG.replace("[[0, 0]]", points);
        fs::write(folder.path().join(name), scene).unwrap();
        let checked = run_in(folder.path(), &["check", name]);
        assert_eq!(checked.status.code(), Some(2));
        text(&checked.stderr)
    };
    // A mistake beyond the column that the report's printer can number.
    let far = wrong("far.toml", &format!("[{} [0]]", "[0, 0],".repeat(12_000)));
    assert!(far.contains("far.toml:7:84"), "{far}");
    assert!(far.lines().all(|line| line.chars().count() < 160), "{far}");
    // A mistake in each of thousands.
    let many = wrong("many.toml", &format!("[{}]", "0, ".repeat(20_000)));
    assert!(many.contains("more") && many.len() < 30_000, "{}: {}", many.len(), &many[..many.len().min(2000)]);
    let json = run_in(folder.path(), &["check", "many.toml", "--json"]);
    let json: serde_json::Value = serde_json::from_str(text(&json.stdout).lines().next().unwrap()).unwrap();
    assert!(json["more"].as_u64().unwrap() > 19_000 && json["errors"].as_array().unwrap().len() == 20, "{json}");
}

#[test]
fn products_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let values = |key: &str| format!("{key}={}", (0..400).map(|i| i.to_string()).collect::<Vec<_>>().join(","));
    let sweeps = ["grow.tree.smooth", "seed", "size"].map(values);
    let args = ["render", "elm", "--sweep", &sweeps[0], "--sweep", &sweeps[1], "--sweep", &sweeps[2]];
    let refused = run_in(folder.path(), &args);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("64000000 pictures"), "{}", text(&refused.stderr));
}

/// A device that is always full stands for a full disk.
#[test]
fn what_cannot_be_written_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["render", "elm", "--size", "32x32", "--samples", "1", "-o", "a.png"]);
    fs::copy(folder.path().join("a.png"), folder.path().join("b.png")).unwrap();
    let verbs: [&[&str]; 8] = [
        &["list"],
        &["man"],
        &["schema"],
        &["completions", "bash"],
        &["info", "elm", "--json"],
        &["compare", "a.png", "b.png"],
        &["new", "pine"],
        &["export", "elm", "--to", "svg"],
    ];
    for args in verbs {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = lichtenberg().current_dir(folder.path()).args(args).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(text(&output.stderr).contains("cannot write to standard output"), "{args:?}");
    }
    // A reader that has enough is none.
    let mut child = lichtenberg().arg("schema").stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full.svg")).unwrap();
    let refused = run_in(folder.path(), &["export", "elm", "--to", "svg", "--name", "full"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(folder.path().join("full.svg").is_symlink());
}
