//! What several tests share.

pub mod plants;
pub mod rib;
pub mod sample;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use lichtenberg::files::embedded_scenes;
use lichtenberg::scene::{Loaded, Override, Source, load};

/// The command under test, not told that CI runs it: only a test says so.
pub fn lichtenberg() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lichtenberg"));
    for name in ["CI", "GITHUB_ACTIONS", "GITHUB_STEP_SUMMARY"] {
        command.env_remove(name);
    }
    command
}

/// Runs the command in `folder` with `args`.
pub fn run_in(folder: &Path, args: &[&str]) -> Output {
    lichtenberg().current_dir(folder).args(args).output().expect("the command starts")
}

/// Runs the command in `folder`; it must succeed. Returns what it printed on stdout.
pub fn succeed_in(folder: &Path, args: &[&str]) -> String {
    let output = run_in(folder, args);
    assert!(output.status.success(), "{args:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// The scene `base` with `from` changed to `to` is refused with one clear error, that names `place` and says `says`; nothing is
/// written.
pub fn refuses(folder: &Path, base: &str, [from, to]: [&str; 2], place: &str, says: &str) {
    let output = export_changed(folder, base, [from, to]);
    let said = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(!said.contains("panicked"), "{said}");
    assert_eq!(output.status.code(), Some(2), "{to}: {said}");
    assert!(said.contains(place) && said.contains(says), "{to}: {said}");
    assert!(!folder.join("out").exists(), "{to} left something");
}

/// What becomes of the scene `base` with `from` changed to `to`, exported to the folder `out`.
pub fn export_changed(folder: &Path, base: &str, [from, to]: [&str; 2]) -> Output {
    assert!(base.contains(from), "{from}");
    std::fs::write(folder.join("changed.toml"), base.replacen(from, to, 1)).expect("a scene is written");
    run_in(folder, &["export", "changed.toml", "--to", "pov", "-o", "out"])
}

/// Tells it on stderr, past the capture of tests that pass.
pub fn tell(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The names of all embedded scenes.
pub fn scene_names() -> Vec<String> {
    embedded_scenes().into_iter().map(|(name, ..)| name).collect()
}

/// An embedded scene with overrides.
pub fn embedded(name: &str, overrides: &[(&str, &str)]) -> Loaded {
    let (name, text, folder) = embedded_scenes().into_iter().find(|(n, ..)| n == name).expect("an embedded scene");
    let overrides: Vec<_> = overrides
        .iter()
        .map(|(path, value)| Override { path: (*path).to_owned(), value: (*value).to_owned() })
        .collect();
    let source = Source { name, text: text.to_owned(), folder };
    load(&source, &overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// What makes a small variant of a heavy scene, as arguments: povray parses thousands of strands a second, and lights them by
/// the hundred. Grass and far plants take other renderers longer than the scene itself, and are nothing but silhouettes: one of a
/// thousand samples differs.
pub fn small_variant(name: &str) -> Vec<&'static str> {
    let own = match name {
        "papers/2007-fig15" | "moss" => Some("grow.moss.to.tips.count=5000"),
        "papers/2007-fig16" | "papers/2007-fig10" => Some("space.block.nodes.lattice.spacing=2"),
        "cracked-ground" => Some("space.mud.nodes.lattice.spacing=0.28"),
        "fur" => Some("object.fur.tile.count=[2, 1]"),
        _ => None,
    };
    let recipe = embedded(name, &[]).recipe;
    let grass = recipe.ground.and_then(|ground| ground.grass).map(|_| "ground.grass.reach=1");
    let far = recipe.background.map(|_| "background.share=0");
    own.into_iter().chain(grass).chain(far).flat_map(|change| ["--set", change]).collect()
}

/// The real povray; without it the tests fail with a hint, they are not skipped.
pub fn require_povray() {
    let found = Command::new("povray").arg("--version").output();
    assert!(found.is_ok(), "these tests need povray: run ./run-tests, or apt-get install povray povray-includes");
}

/// Runs a script in the interpreter that Debian's OpenImageIO belongs to; returns what it printed.
pub fn openimageio(folder: &Path, script: &str, args: &[&str]) -> String {
    let output = Command::new("/usr/bin/python3").current_dir(folder).args(["-c", script]).args(args).output();
    let output = output.expect("/usr/bin/python3");
    assert!(
        output.status.success(),
        "OpenImageIO (run ./run-tests, or apt-get install python3-openimageio): {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// A program of `examples/` as `cargo test` has just built it; built now if it was not, as with `cargo test --test it`.
pub fn example(name: &str) -> PathBuf {
    let here = std::env::current_exe().expect("our own path");
    let program = here.parent().and_then(Path::parent).expect("target/PROFILE/deps").join("examples").join(name);
    let changed = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    let mut sources = files_below(&root().join("src"), "rs");
    sources.extend(files_below(&root().join("examples"), "rs"));
    let newest = sources.iter().filter_map(|path| changed(path)).max();
    if changed(&program) < newest {
        let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
        let status = Command::new(cargo)
            .current_dir(root())
            .args(["test", "--quiet", "--no-run", "--example", name])
            .status()
            .expect("cargo starts");
        assert!(status.success(), "{name} is built");
    }
    program
}

/// The words of a panic.
pub fn panic_text(cause: &dyn std::any::Any) -> String {
    let plain = cause.downcast_ref::<&str>().map(|&text| text.to_owned());
    plain.or_else(|| cause.downcast_ref::<String>().cloned()).unwrap_or_default()
}

/// The root of the repository.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Every file below `folder` whose name ends in `.ending`; all of them where that is empty.
pub fn files_below(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(files_below(&path, ending));
        } else if ending.is_empty() || path.extension().is_some_and(|e| e == ending) {
            files.push(path);
        }
    }
    files.sort();
    files
}
