//! The house keeps its order: stages and files import only earlier ones, files and functions stay small, docs are current.

use std::collections::BTreeSet;
use std::fs;

use crate::house::graph::{Edges, circles, edges, report};
use crate::house::modules::House;
use crate::support::{files_below, root, scene_names, succeed_in};

/// The stages in the order of data; those of one row are siblings, which never import each other.
const STAGES: &[&[&str]] = &[
    &["math"],
    &["raster"],
    &["geom"],
    &["bvh", "model"],
    &["graph"],
    &["plan"],
    &["skeleton"],
    &["grow"],
    &["skin"],
    &["assemble"],
    &["export", "trace", "glow", "compare"],
    &["files"],
    &["picture"],
    &["scene"],
    &["render"],
    &["cli"],
];

/// Functions of 60 lines and more that read better whole, each with its reason.
const LONG: &[(&str, &str)] = &[
    ("bvh/tree.rs::walk", "the inner loop of every ray, generic over what it looks for"),
    ("cli/compare.rs::compare", "one pair of pictures, case after case"),
    ("cli/strike.rs::load", "where a stroke goes, from many options, each with its refusal"),
    ("cli/strike.rs::run", "photograph by photograph: read, grow, shine, write"),
    ("grow/baselines/dbm.rs::grow_cluster", "the published loop, in its order"),
    ("grow/paths/grammar.rs::endpoints", "the turtle's alphabet, a row a letter"),
    ("grow/regions/labels.rs::finer", "a lattice, its mask, its costs: each made from the last"),
    ("grow/rounds/growth.rs::sprout", "a subgraph from its nodes to its limbs"),
    ("scene/findings.rs::of", "a row for each quantity"),
];

fn house() -> (House, Edges) {
    let house = House::read(&root().join("src"));
    let edges = edges(&house);
    assert!(house.files.len() > 100 && edges.len() > 300, "the sources were read");
    (house, edges)
}

/// The stage that a file is of; none for the crate's root.
fn stage(file: &str) -> Option<&str> {
    file.split_once('/').map(|(stage, _)| stage)
}

fn row(stage: &str) -> usize {
    let row = STAGES.iter().position(|row| row.contains(&stage));
    row.unwrap_or_else(|| panic!("`{stage}` has no place in the order of stages"))
}

#[test]
fn stages_import_only_earlier_ones() {
    let (house, edges) = house();
    for (&(from, to), names) in &edges {
        let [from, to] = [from, to].map(|f| house.files[f].as_str());
        let (Some(stage_from), Some(stage_to)) = (stage(from), stage(to)) else { continue };
        assert!(
            stage_from == stage_to || row(stage_to) < row(stage_from),
            "{from} uses {names:?} of {to}, and `{stage_to}` is not before `{stage_from}`"
        );
    }
}

#[test]
fn files_do_not_use_each_other_in_circles() {
    let (house, edges) = house();
    let circles = circles(house.files.len(), &edges);
    assert!(circles.is_empty(), "{}", report(&house));
}

#[test]
fn nothing_is_handed_on_unnamed() {
    let (house, _) = house();
    for module in &house.modules {
        for used in module.uses.iter().filter(|u| u.is_public) {
            assert!(used.alias != "*", "{}:{}: name what is handed on", house.files[module.file], used.line);
        }
    }
}

#[test]
fn functions_stay_short() {
    let (house, _) = house();
    let named = |f: &crate::house::modules::Function| format!("{}::{}", house.files[f.file], f.name);
    let long: BTreeSet<String> = house.functions.iter().filter(|f| f.lines >= 60).map(named).collect();
    let allowed: BTreeSet<String> = LONG.iter().map(|(name, _)| (*name).to_owned()).collect();
    let new: Vec<_> = long.difference(&allowed).collect();
    assert!(new.is_empty(), "60 lines or more, which steps want a name? {new:?}");
    let short: Vec<_> = allowed.difference(&long).collect();
    assert!(short.is_empty(), "short now, take them off: {short:?}");
    assert!(LONG.iter().all(|(_, reason)| !reason.is_empty()));
}

/// What renderers read is a pure description.
#[test]
fn the_model_imports_nothing_of_growth() {
    let (house, edges) = house();
    for &(from, to) in edges.keys() {
        let [from, to] = [from, to].map(|f| house.files[f].as_str());
        if stage(from) == Some("model") {
            assert!(matches!(stage(to), Some("model" | "math" | "raster" | "geom")), "{from} uses {to}");
        }
    }
}

/// The reading above finds what it is for, however it is written.
#[test]
fn circles_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |path: &str, text: &str| {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("lib.rs", "pub mod a;\npub mod b;");
    write(
        "a/mod.rs",
        "mod one;\nmod two;\nmod three;\npub use one::{One, make as made};\npub use two::Two;\npub use three::three;",
    );
    // Through the folder's door, by a list in a list, by a path in code, by a string of serde's.
    write("a/one.rs", "use {super::{Two}, crate::b};\npub struct One(Two);\npub fn make() { b::four::<u8>() }");
    write("a/two.rs", "// super::One\npub struct Two;\n#[serde(default = \"super::three\")]\nfn two() {}");
    write(
        "a/three.rs",
        "pub fn three() -> &'static str { super::made(); r#\"super::One\"# }\n#[cfg(test)]\nmod tests {\n    use crate::b::lone;\n}",
    );
    // Only tests of the others name this one, and it names none.
    write("b.rs", "pub fn four<T>() {}\npub fn lone() {}\n#[cfg(test)]\nuse crate::a::One;");
    let house = House::read(folder.path());
    let edges = edges(&house);
    let told: Vec<String> = edges
        .iter()
        .map(|((from, to), names)| {
            let names: Vec<&str> = names.iter().map(|(_, name)| name.as_str()).collect();
            format!("{} {} {}", house.files[*from], house.files[*to], names.join(" "))
        })
        .collect();
    assert_eq!(
        told,
        [
            "a/one.rs a/two.rs super::Two",
            "a/one.rs b.rs b::four",
            "a/two.rs a/three.rs super::three",
            "a/three.rs a/one.rs super::made",
        ]
    );
    let circles = circles(house.files.len(), &edges);
    assert_eq!(circles.len(), 1);
    assert_eq!(circles[0].len(), 3);
}

/// The crates that only the command needs are not named outside of it.
#[test]
fn the_library_does_without_the_commands_crates() {
    let manifest: toml::Table = fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    let optional: Vec<String> = manifest["dependencies"]
        .as_table()
        .unwrap()
        .iter()
        .filter(|(_, written)| written.get("optional").is_some_and(|o| o.as_bool() == Some(true)))
        .map(|(name, _)| name.replace('-', "_"))
        .collect();
    assert!(optional.contains(&"clap".to_owned()), "{optional:?}");
    let (house, _) = house();
    for module in &house.modules {
        let file = &house.files[module.file];
        if stage(file) == Some("cli") {
            continue;
        }
        let imported = module.uses.iter().map(|u| (u.line, &u.path[0]));
        for (line, first) in imported.chain(module.paths.iter().map(|(line, path)| (*line, &path[0]))) {
            assert!(!optional.contains(first), "{file}:{line} uses {first}");
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
    for name in scene_names() {
        assert!(readme.contains(&format!("`{name}`")), "README.md does not show `{name}`");
        let picture = format!("renders/gallery/{}.webp", name.replace('/', "-"));
        assert!(readme.contains(&picture) && root().join(&picture).is_file(), "README.md does not show {picture}");
    }
}
