//! The examples: the crate as its users call it, without TOML.

use std::fs;
use std::process::Command;

use crate::support::{example, root, text};

/// What an example prints.
fn run(name: &str) -> Vec<u8> {
    let output = Command::new(example(name)).output().expect("the example starts");
    assert!(output.status.success(), "{name}: {}", text(&output.stderr));
    output.stdout
}

#[test]
fn a_tree_comes_from_rust() {
    let inc = text(&run("tree"));
    assert!(inc.contains("#declare Tree_Height"), "{}", &inc[..200]);
    assert!(inc.matches("cone{").count() > 200);
    assert_eq!(inc, text(&run("tree")), "the same bytes every time");
}

#[test]
fn a_bolt_is_over_the_picture() {
    let picture = image::load_from_memory(&run("bolt")).expect("a PNG").to_rgb8();
    let plate = image::open(root().join("scenes/skies/dusk-launch-pad.jpg")).expect("the photograph").to_rgb8();
    assert_eq!(picture.dimensions(), plate.dimensions());
    let brighter = picture.pixels().zip(plate.pixels()).filter(|(a, b)| a[0] > b[0].saturating_add(60)).count();
    assert!(brighter > 500, "{brighter} pixels shine");
}

#[test]
fn paths_are_planned_on_a_graph_of_ones_own() {
    // 40 roads cost 400, the ferry to 50 and ten roads back 250.
    assert_eq!(text(&run("own_graph")), "12 towns, cost 250\n");
}

/// The river keeps to the valley, whose middle is a sine.
#[test]
fn a_field_of_ones_own_shapes_paths() {
    let svg = text(&run("own_field"));
    let fill = svg.lines().filter(|line| line.starts_with('M')).count();
    assert!(svg.contains("#2255aa") && fill > 50, "{fill} strokes");
}

#[test]
fn pictures_are_compared() {
    let said = text(&run("compare"));
    let moved: f64 = said.lines().last().unwrap().split([' ', ',']).nth(1).unwrap().parse().unwrap();
    assert!(said.starts_with("same: 0\n") && moved > 0.005, "{said}");
}

#[test]
fn examples_are_short() {
    for name in ["tree", "bolt", "own_graph", "own_field", "compare"] {
        let lines = fs::read_to_string(root().join(format!("examples/{name}.rs"))).unwrap().lines().count();
        assert!(lines < 60, "{name} has {lines} lines");
    }
}
