//! The house keeps its order: stages import only earlier ones, files stay small, docs are current.

mod support;

use std::fs;

use support::{files_below, root, succeed_in};

/// The stages in the order of data; those of one row are siblings, which never import each other.
const STAGES: &[&[&str]] = &[
    &["math"],
    &["raster"],
    &["geom"],
    &["bvh"],
    &["graph"],
    &["plan"],
    &["skeleton"],
    &["grow"],
    &["model"],
    &["export", "trace", "glow", "compare"],
    &["files"],
    &["scene"],
    &["render"],
    &["cli"],
];

fn row(stage: &str) -> usize {
    STAGES
        .iter()
        .position(|row| row.contains(&stage))
        .unwrap_or_else(|| panic!("`{stage}` has no place in the order of stages"))
}

/// The stages that a source text names as `crate::stage`, alone or in a braced list.
fn imports(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for part in text.split("crate::").skip(1) {
        let names: Vec<&str> = match part.strip_prefix('{') {
            Some(list) => list.split('}').next().unwrap_or("").split(',').collect(),
            None => vec![part],
        };
        for name in names {
            let name: String = name.trim().chars().take_while(|c| c.is_ascii_lowercase() || *c == '_').collect();
            if !name.is_empty() {
                found.push(name);
            }
        }
    }
    found
}

#[test]
fn stages_import_only_earlier_ones() {
    let src = root().join("src");
    let mut stages = 0;
    for entry in fs::read_dir(&src).unwrap() {
        let path = entry.unwrap().path();
        if !path.is_dir() {
            continue;
        }
        stages += 1;
        let stage = path.file_name().unwrap().to_str().unwrap().to_owned();
        for file in files_below(&path, "rs") {
            // Comments may name any stage.
            let code: String = fs::read_to_string(&file)
                .unwrap()
                .lines()
                .filter(|l| !l.trim_start().starts_with("//"))
                .collect::<Vec<_>>()
                .join("\n");
            for import in imports(&code) {
                assert!(
                    import == stage || row(&import) < row(&stage),
                    "{} imports `{import}`, which is not before `{stage}`",
                    file.display()
                );
            }
        }
    }
    assert!(stages >= 10);
    assert_eq!(imports("use crate::{math, plan::x}; crate::graph::y"), ["math", "plan", "graph"]);
}

#[test]
fn the_library_does_without_the_commands_crates() {
    for file in files_below(&root().join("src"), "rs") {
        if file.components().any(|c| c.as_os_str() == "cli") || file.ends_with("main.rs") {
            continue;
        }
        let code = fs::read_to_string(&file).unwrap();
        for name in ["clap", "indicatif", "miette", "signal_hook", "epaint_default_fonts"] {
            assert!(!code.contains(&format!("{name}::")), "{} uses {name}", file.display());
        }
    }
}

#[test]
fn files_stay_readable() {
    let mut files = files_below(&root().join("src"), "rs");
    files.extend(files_below(&root().join("tests"), "rs"));
    for file in files {
        let lines = fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= 600, "{} has {lines} lines: which concept wants a file of its own?", file.display());
    }
}

#[test]
fn the_scene_reference_is_current() {
    let made = succeed_in(&root(), &["schema", "--markdown"]);
    let kept = fs::read_to_string(root().join("docs/scene.md")).unwrap_or_default();
    assert!(made == kept, "docs/scene.md is old: cargo run -- schema --markdown > docs/scene.md");
}

#[test]
fn the_gallery_shows_every_scene() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    for name in support::scene_names() {
        assert!(readme.contains(&format!("`{name}`")), "README.md does not show `{name}`");
        let picture = format!("renders/gallery/{}.webp", name.replace('/', "-"));
        assert!(readme.contains(&picture) && root().join(&picture).is_file(), "README.md does not show {picture}");
    }
}
