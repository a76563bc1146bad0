//! `new`: embedded scenes can be taken and work where they then are; nothing that they read is written over.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::sample::sample;
use crate::support::{lichtenberg, run_in, scene_names, succeed_in, text};
use lichtenberg::files::decode_png;

/// Every file below `folder`, by its path in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path);
        }
    }
    found
}

#[test]
fn scenes_can_be_taken() {
    let folder = tempfile::tempdir().unwrap();
    let names = sample(scene_names(), 30);
    // All in one folder: scenes share assets.
    let mut checks = lichtenberg();
    checks.current_dir(folder.path()).arg("check");
    for name in &names {
        let mine = format!("my-{}", name.replace('/', "-"));
        succeed_in(folder.path(), &["new", &mine, "--like", name]);
        checks.arg(format!("{mine}.toml"));
    }
    let output = checks.output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout).lines().filter(|line| line.ends_with(": good")).count(), names.len());
    // Beside the scenes there is nothing that an output could take the place of.
    for file in files(folder.path()) {
        let is_beside = file.parent() == Some(folder.path());
        assert_eq!(is_beside, file.extension().is_some_and(|e| e == "toml") && !is_asset(&file), "{}", file.display());
    }
}

fn is_asset(file: &Path) -> bool {
    file.components().any(|part| part.as_os_str() == "assets")
}

#[test]
fn each_scene_brings_what_it_reads() {
    for (name, read) in [
        ("painted-leaf", vec!["assets/painted-leaf.png"]),
        ("papers/2012-fig23-a", vec!["assets/2012-fig23.toml"]),
        ("papers/2008-fig12", vec!["skies/dusk-launch-pad-matte.png", "skies/dusk-launch-pad.jpg"]),
        ("bonsai", vec!["assets/pot.obj", "assets/soil.obj"]),
        ("elm", vec![]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let said = succeed_in(folder.path(), &["new", "mine", "--like", name]);
        let mut written: Vec<&str> = said.lines().filter(|line| *line != "mine.toml").collect();
        written.sort_unstable();
        assert_eq!(written, read, "{name}");
        succeed_in(folder.path(), &["check", "mine"]);
    }
}

/// A scene's picture has its name, as its map once had.
#[test]
fn outputs_leave_assets_alone() {
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["new", "painted-leaf"]);
    let map = folder.path().join("assets/painted-leaf.png");
    let before = fs::read(&map).unwrap();
    succeed_in(folder.path(), &["render", "painted-leaf.toml", "--size", "48x64", "--samples", "1"]);
    assert!(folder.path().join("painted-leaf.png").is_file());
    assert_eq!(fs::read(&map).unwrap(), before);
    // What was changed since is not written over by another scene that shares it.
    fs::write(&map, "mine").unwrap();
    let output = run_in(folder.path(), &["new", "other", "--like", "painted-leaf"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("painted-leaf.png is there already, and another file"));
    assert!(!folder.path().join("other.toml").exists());
}

/// `--watch` follows every file that a scene is read from, wherever it is, also one that is not there yet.
#[test]
fn watch_follows_what_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let write = |name: &str, text: &str| {
        fs::create_dir_all(at(name).parent().unwrap()).unwrap();
        fs::write(at(name), text).unwrap();
    };
    write("scenes/mine.toml", "include = \"../bases/twig.toml\"\ntitle = \"Mine\"\n");
    let base = "[space.air]\nshape.box = { min = [-1, 0], max = [1, 2] }\n\
        nodes.lattice = { spacing = 0.1, neighbours = 8 }\n\
        [grow.twig]\nspace = \"air\"\nfrom.at = [[0, 0]]\nto.tips = { count = 5 }\nwidth.constant = 0.04\n\
        [object.twig]\ngrow = [\"twig\"]\n";
    let mut child = lichtenberg()
        .current_dir(at("scenes"))
        .args(["render", "mine.toml", "--watch", "--size", "48x48", "-o", "out.png"])
        .stdout(Stdio::null())
        .stderr(fs::File::create(at("said.txt")).unwrap())
        .spawn()
        .unwrap();
    let wait_for = |what: &str, is_there: &dyn Fn() -> bool| {
        let begun = Instant::now();
        while !is_there() {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "no {what}: {}",
                fs::read_to_string(at("said.txt")).unwrap()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    let said = |words: &str| fs::read_to_string(at("said.txt")).is_ok_and(|said| said.contains(words));
    wait_for("complaint", &|| said("cannot read `../bases/twig.toml`"));
    write("bases/twig.toml", base);
    let picture = at("scenes/out.png");
    let is_whole = || fs::read(&picture).is_ok_and(|b| decode_png(&b).is_ok_and(|p| p.width == 48));
    wait_for("picture", &is_whole);
    let first = fs::read(&picture).unwrap();
    write("bases/twig.toml", &base.replace("width.constant = 0.04", "width.constant = 0.4"));
    wait_for("new picture", &|| is_whole() && fs::read(&picture).unwrap() != first);
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
