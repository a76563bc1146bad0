//! Irregular trees through the whole program: bad input, form, meshes, levels, shade.

use std::fs;

use crate::support::{embedded, export_changed, refuses, run_in, succeed_in, text};
use lichtenberg::files::decode_ply;
use lichtenberg::geom::ClosedMesh;
use lichtenberg::grow::Grown;
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::{Loaded, grow, model};

const TREE: &str = r#"
title = "Tree"
[shape.crown]
sector = { at = [0, 0, 2], angle = 90, radius = 1.5 }
[space.first]
shape.union = [{ cylinder = { from = [0, 0, 0], to = [0, 0, 2.2], radius = 0.15 } }, "crown"]
nodes.scatter = { spacing = 0.3 }
[space.tuft]
shape.sector = { angle = 60, radius = 1 }
nodes.scatter = { spacing = 0.3 }
[grow.trunk]
space = "first"
from.at = [[0, 0, 0]]
to.crown = { count = 8, inside = "crown" }
width.length = { root = 0.2, z = 0.6 }
form = {}
[grow.limbs]
space = "tuft"
from.ends = "trunk"
repeat = { times = 2, size = 0.6 }
to.all = { count = 3 }
width.length = { z = 0.4 }
[object.tree]
grow = ["trunk", "limbs"]
"#;

/// Every mistake is one clear error that names its place, and nothing is written.
#[test]
fn bad_input_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n").unwrap();
    fs::write(
        at.join("across.svg"),
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="M4 9V0"/><path d="M2 9L7 5L3 0"/></svg>"#,
    )
    .unwrap();
    let crown = "sector = { at = [0, 0, 2], angle = 90, radius = 1.5 }";
    for (from, to, place, says) in [
        // Nothing fits between two balls that do not meet.
        (
            crown,
            "intersection = [{ sphere = { centre = [0, 0, 0], radius = 0.1 } }, { sphere = { centre = [9, 9, 9], radius = 0.1 } }]",
            "grow.trunk.to.crown",
            "only 0 of 8 endpoints",
        ),
        (
            r#"shape.union = [{ cylinder = { from = [0, 0, 0], to = [0, 0, 2.2], radius = 0.15 } }, "crown"]"#,
            r#"shape.intersection = ["crown", { sphere = { centre = [0, 0, -9], radius = 1 } }]"#,
            "space.first.nodes",
            "no node fits",
        ),
        ("from.at = [[0, 0, 0]]", "from.at = [[0, 0, -4]]", "grow.trunk.from", "outside the space"),
        // A stem that ends below the crown.
        ("to = [0, 0, 2.2], radius = 0.15", "to = [0, 0, 0.9], radius = 0.15", "", ""),
        (
            r#"nodes.scatter = { spacing = 0.3 }
[space.tuft]"#,
            r#"nodes.scatter = { spacing = 0.3, radius = 0.35 }
[space.tuft]"#,
            "",
            "",
        ),
        (
            "nodes.scatter = { spacing = 0.3 }\n[space.tuft]",
            "nodes.scatter = { spacing = 0.3, radius = 0.4, longest = 3 }\n[space.tuft]",
            "space.first.nodes.scatter",
            "no `longest`",
        ),
        (
            "nodes.scatter = { spacing = 0.3 }\n[space.tuft]",
            "nodes.scatter = { spacing = 0.001 }\n[space.tuft]",
            "space.first.nodes.scatter.spacing",
            "nodes are too many",
        ),
        (crown, "mesh = { file = \"open.obj\" }", "shape.crown", "the mesh is open"),
        (crown, "revolve = { sketch = \"across.svg\", to = [0, 0, 3] }", "shape.crown", "crosses its axis"),
        ("size = 0.6 }", "size = 0.6, lifespan = { first = 0 } }", "grow.limbs.repeat.lifespan.first", "from 1 to 64"),
        (
            "size = 0.6 }",
            "size = 0.6, lifespan = { first = 2, loss.chances = [[0.5, 1]] } }",
            "lifespan.loss.chances",
            "add up to 1",
        ),
        ("count = 3 }", "count = [0, 0] }", "grow.limbs.to.all.count", "no round has an endpoint"),
        ("count = 3 }", "count = 2.5 }", "grow.limbs.to.all.count", "whole numbers"),
        ("count = 8,", "count = [8, 3],", "grow.trunk.to.crown.count", "needs `repeat`"),
        ("times = 2", "times = 60", "grow.limbs.repeat.times", "memory for"),
        ("repeat = { times = 2, size = 0.6 }\n", "", "grow.limbs", ""),
        ("width.length = { z = 0.4 }", "width.pipe = { }", "grow.limbs.width", "same kind"),
        ("from.ends = \"trunk\"\nrepeat", "from.ends = \"limbs\"\nrepeat", "grow.limbs", "waits for itself"),
        (
            "grow = [\"trunk\", \"limbs\"]",
            "grow = [\"trunk\"]\nleaves.l = { shape = \"oka\", size = 1, count = 1, along = 0, material = \"bark\" }",
            "leaves.l.shape",
            "did you mean `oak`",
        ),
        (
            "spacing = 0.3 }\n[grow.trunk]",
            "spacing = 0.3, sectors = 7 }\n[grow.trunk]",
            "space.tuft.nodes.scatter",
            "6, 8 or 24",
        ),
    ] {
        if !says.is_empty() {
            refuses(at, TREE, [from, to], place, says);
            continue;
        }
        // Fine, or an error that says what to do: never a crash.
        let output = export_changed(at, TREE, [from, to]);
        let said = text(&output.stderr);
        assert!(!said.contains("internal error") && matches!(output.status.code(), Some(0 | 2)), "{said}");
        let _ = fs::remove_dir_all(at.join("out"));
    }
}

/// Along every limb of every plant width never grows towards the tip, nor do limbs float. Returns how many plants there are.
pub fn widths_fall(name: &str, scene: &Loaded, grown: &[Grown]) -> usize {
    let is_plant = |name: &str| scene.recipe.steps.iter().any(|s| s.name == name && s.width.starts_plant().is_some());
    let plants = grown.iter().filter(|step| is_plant(&step.name));
    for step in plants.clone() {
        for (from, to) in step.skeleton.segments() {
            assert!(to.radius <= from.radius, "{name}: {} grows from {} to {}", step.name, from.radius, to.radius);
        }
    }
    plants.count()
}

/// Levels and leaves are objects of their own, and what a scene declares by them is there.
#[test]
fn levels_and_leaves_are_declared() {
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["export", "oak-summer", "--to", "pov", "-o", "."]);
    let inc = fs::read_to_string(folder.path().join("oak-summer.inc")).unwrap();
    for name in [
        "Oak_Summer_Tree_Level_0",
        "Oak_Summer_Tree_Level_3",
        "Oak_Summer_Tree_Oak_1",
        "Oak_Summer_Tree_Oak_9",
        "Oak_Summer_Tree_Oak_1_One",
        "Oak_Summer",
    ] {
        assert!(inc.contains(&format!("#declare {name} =")), "{name} is missing");
    }
    let leaves = inc.matches("object{Oak_Summer_Tree_Oak_1_One matrix<").count();
    assert!(leaves > 10_000, "{leaves} leaves");
    // One mesh serves them all, whatever their colour; what stands about the tree is elsewhere.
    assert_eq!(inc.matches("mesh2 {").count(), 1);
    let stage = fs::read_to_string(folder.path().join("oak-summer-stage.inc")).unwrap();
    for name in ["Terrain", "Grass_1", "Grass_5", "Background_Wood"] {
        assert!(stage.contains(&format!("#declare Oak_Summer_Stage_{name} =")), "{name} is missing");
    }
}

/// The mesh of a whole tree is closed and oriented; what has spheres and cones is no mesh.
#[test]
fn trees_become_closed_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("tree.toml"), TREE.to_owned() + "skin = \"mesh\"\n").unwrap();
    succeed_in(at, &["export", "tree.toml", "--to", "ply"]);
    let mesh = decode_ply(&fs::read(at.join("tree.ply")).unwrap()).unwrap();
    assert!(mesh.triangles.len() > 500);
    ClosedMesh::new(mesh.points, mesh.triangles).unwrap();
    succeed_in(at, &["export", "tree.toml", "--to", "obj"]);
    let obj = fs::read_to_string(at.join("tree.obj")).unwrap();
    assert!(obj.contains("\nvt ") && obj.lines().any(|l| l.starts_with("f ") && l.contains('/')));
    let output = run_in(at, &["export", "oak", "--to", "obj"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("skin = \"mesh\""));
}

/// A tree in the other's shade grows away from it; alone it does not.
#[test]
fn trees_compete_for_light() {
    let lean = |alone: bool| {
        let far = [("grow.right.from.at", "[[41.7, 0, 0]]"), ("shape.right-crown.sector.at", "[41.7, 0, 2]")];
        let stem = (
            "space.right.shape",
            r#"{ union = [{ cylinder = { from = [41.7, 0, 0], to = [41.7, 0, 2.3], radius = 0.25 } }, "right-crown"] }"#,
        );
        let changes: Vec<_> = if alone { far.into_iter().chain([stem]).collect() } else { Vec::new() };
        let scene = embedded("two-trees", &changes);
        let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
        let left = grown.iter().find(|g| g.name == "left-limbs").unwrap();
        lichtenberg::skeleton::measure_from(&left.skeleton, left.foot).lean
    };
    let (alone, beside) = (lean(true), lean(false));
    assert!(beside < alone - 0.03, "{beside} beside another, {alone} alone");
}

/// Limbs keep out of what is forbidden.
#[test]
fn obstacles_are_kept_clear() {
    let scene = embedded("hedge-against-wall", &[]);
    let grown = grow(&scene, &[], &Memory::default(), &Progress::default()).unwrap();
    let model = model(&scene, &grown, [64, 64], &Memory::default(), &Progress::default()).unwrap();
    let inside = model
        .objects
        .iter()
        .filter_map(|o| Some((o.body.limbs()?, o.instances[0].at)))
        .flat_map(|(limbs, at)| limbs.balls.iter().map(move |b| b.centre + at))
        .filter(|p| p.x.abs() < 4.9 && p.y > 0.68 && p.y < 0.92 && p.z < 2.5)
        .count();
    // Smoothing may graze it.
    assert!(inside < 20, "{inside} places within the wall");
}
