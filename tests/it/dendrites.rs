//! Dendrites, surfaces, regions and letters of Xu and Mould 2007: what they promise, and what bad input gets.

use std::fs;

use crate::support::{embedded, run_in, text};
use lichtenberg::grow::Grown;
use lichtenberg::math::{DVec3, Memory, Progress};
use lichtenberg::model::Model;
use lichtenberg::scene::{grow, model};
use proptest::prelude::*;

fn grown(name: &str, overrides: &[(&str, &str)]) -> (Vec<Grown>, Model) {
    let scene = embedded(name, overrides);
    let grown = grow(&scene, &[], &Memory::new(8 << 30), &Progress::default()).unwrap();
    let model = model(&scene, &grown, [160, 120], &Memory::default(), &Progress::default()).unwrap();
    (grown, model)
}

/// Every edge of a mesh is run along once in each direction.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(|t| (0..3).map(|i| [t[i], t[(i + 1) % 3]])).collect();
    edges.sort_unstable();
    edges.windows(2).all(|pair| pair[0] != pair[1]) && edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok())
}

/// By distance and by cost, with and without smoothing; outwards is outside.
#[test]
fn isosurfaces_are_closed() {
    for (skin, more) in [
        ("{ isosurface = { smooth = 0 } }", ("size", "[160, 120]")),
        ("{ isosurface = { spacing = 0.3, smooth = 4 } }", ("size", "[160, 120]")),
        ("{ isosurface = { of = \"cost\", smooth = 1 } }", ("grow.coral.width.taper.to", "0.8")),
    ] {
        let (_, model) = grown("papers/2007-table1-coral", &[("object.coral.skin", skin), more]);
        let (mesh, _) = model.objects[0].body.mesh().unwrap();
        assert!(mesh.triangles.len() > 1000 && is_closed(&mesh.triangles), "{skin}");
        let sixfold = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.points[i as usize]);
            a.dot(b.cross(c))
        };
        assert!(mesh.triangles.iter().map(sixfold).sum::<f64>() > 0.0, "{skin} is inside out");
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{skin}");
    }
}

/// The width is the level: a straight limb of radius 1 has the surface of a capsule.
#[test]
fn an_isosurface_has_the_limbs_width() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("limb.toml"),
        r#"
title = "Limb"
[space.air]
shape.box = { min = [-3, -3, 0], max = [3, 3, 8] }
nodes.lattice = { spacing = 0.25, neighbours = 6 }
weights = { max = 1 }
[grow.limb]
space = "air"
from.at = [[0, 0, 2]]
to.tip = { at = [[0, 0, 6]] }
width.constant = 1
[object.limb]
grow = ["limb"]
skin.isosurface = { smooth = 0 }
"#,
    )
    .unwrap();
    let output = run_in(folder.path(), &["export", "limb.toml", "--to", "ply"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let ply = fs::read_to_string(folder.path().join("limb.ply")).unwrap();
    let count: usize = ply.lines().find_map(|l| l.strip_prefix("element vertex ")).unwrap().parse().unwrap();
    let body = ply.split("end_header\n").nth(1).unwrap();
    for line in body.lines().take(count) {
        let p: Vec<f64> = line.split_whitespace().take(3).map(|n| n.parse().unwrap()).collect();
        let p = DVec3::new(p[0], p[1], p[2]);
        // The foot is moved to where the object stands.
        let axis = DVec3::new(0.0, 0.0, p.z.clamp(2.0, 6.0));
        assert!(((p - axis).length() - 1.0).abs() < 0.02, "{p}");
    }
}

/// Regions share the space out: together they fill it, refined or not, and each is closed.
#[test]
fn regions_fill_their_space() {
    let block = "{ box = { min = [-20, -20, -20], max = [20, 20, 20] } }";
    for refine in ["0", "1"] {
        let (grown, _) = grown(
            "papers/2007-fig10",
            &[
                ("space.block.shape", block),
                ("grow.rock.from.spread.apart", "12"),
                ("grow.rock.by.regions.keep", "[]"),
                ("grow.rock.by.regions.smooth", "0"),
                ("grow.rock.by.regions.refine", refine),
            ],
        );
        let surfaces = &grown[0].regions.as_ref().unwrap().surfaces;
        assert_eq!(surfaces.len(), 20);
        assert!(surfaces.iter().all(|surface| surface.is_closed_manifold() && surface.volume() > 0.0));
        let whole: f64 = surfaces.iter().map(|surface| surface.volume()).sum();
        // Up to the border, half a step beyond the last nodes at most.
        assert!((whole / 64_000.0 - 1.0).abs() < 0.08, "{refine}: {whole}");
    }
}

/// A finer border has more triangles, about where the coarse one is.
#[test]
fn refinement_keeps_the_rock() {
    let with = |refine: &str| {
        let block = "{ box = { min = [-20, -20, -20], max = [20, 20, 20] } }";
        let overrides = [
            ("space.block.shape", block),
            ("grow.rock.from.spread.apart", "16"),
            ("grow.rock.from.spread.count", "10"),
            ("grow.rock.by.regions.refine", refine),
        ];
        grown("papers/2007-fig10", &overrides).0[0].regions.as_ref().unwrap().surfaces[0].clone()
    };
    let (coarse, fine) = (with("0"), with("1"));
    assert!(fine.is_closed_manifold() && fine.triangles.len() > 3 * coarse.triangles.len());
    assert!((fine.volume() / coarse.volume() - 1.0).abs() < 0.1, "{} {}", fine.volume(), coarse.volume());
}

/// Regions a node or two across are refined too, and a gap wider than a region leaves none of it.
#[test]
fn thin_regions_do_no_harm() {
    let flat = |by: &str| {
        let overrides = [
            ("space.tissue.shape", "{ box = { min = [0, 0], max = [40, 40] } }"),
            ("grow.cells.from.spread", "{ count = 1000 }"),
            ("grow.cells.by.regions", by),
        ];
        grown("cells", &overrides).0[0].regions.as_ref().unwrap().surfaces.len()
    };
    assert!(flat("{ refine = 1 }") > 900);
    assert!(flat("{ gap = 0.6 }") < 1000);
    let overrides = [
        ("space.mud.shape", "{ box = { min = [-2, -2, -2], max = [2, 2, 2] } }"),
        ("grow.plates.from.spread", "{ count = 300 }"),
        ("grow.plates.by.regions", "{ gap = 0.5 }"),
    ];
    let surfaces = grown("cracked-ground", &overrides).0[0].regions.as_ref().unwrap().surfaces.clone();
    assert!(surfaces.len() < 300 && surfaces.iter().all(|surface| surface.volume() > 0.0));
}

/// The lichen keeps out of the rock, and near it.
#[test]
fn lichen_stays_on_the_rock() {
    let (grown, _) = grown("papers/2007-fig16", &[("grow.lichen.smooth", "0")]);
    let rock = grown.iter().find(|g| g.name == "rock").unwrap().regions.as_ref().unwrap().solid();
    let lichen = &grown.iter().find(|g| g.name == "lichen").unwrap().skeleton;
    let off: Vec<f64> = lichen.nodes.iter().map(|node| rock.distance(node.position)).collect();
    assert!(off.iter().all(|&d| d > 0.0 && d <= 2.6 + 1e-6));
    // Some of it leaves the surface briefly.
    assert!(off.iter().any(|&d| d > 1.4));
}

/// On the lattice and off it, in the plane and in space, in large steps and in single ones: every particle touches the one that
/// it came to, and overlaps none.
#[test]
fn aggregates_touch() {
    for (name, step) in [("papers/2007-fig11", "aggregate"), ("aggregate", "aggregate")] {
        for lattice in [true, false] {
            for walk in ["fast", "textbook"] {
                let space = name != "aggregate";
                let shape = if space {
                    "{ box = { min = [-25, -25], max = [25, 25] } }"
                } else {
                    "{ box = { min = [-9, -9, -9], max = [9, 9, 9] } }"
                };
                let by = format!("{{ particles = 250, lattice = {lattice}, walk = \"{walk}\" }}");
                let mut overrides = vec![("grow.aggregate.by.dla", &*by)];
                overrides.push((if space { "space.sheet.shape" } else { "space.room.shape" }, shape));
                if space {
                    overrides.push(("grow.imitation.by.fractal.distance", "20"));
                    overrides.push(("grow.imitation.to.ends.apart", "2"));
                }
                let (grown, _) = grown(name, &overrides);
                let nodes = &grown.iter().find(|g| g.name == step).unwrap().skeleton.nodes;
                assert!(nodes.len() > 200, "{name} {by}: {}", nodes.len());
                for (i, node) in nodes.iter().enumerate().skip(1) {
                    let parent = nodes[node.parent.unwrap() as usize].position;
                    assert!(((node.position - parent).length() - 1.0).abs() < 1e-6, "{name} {by}: {i}");
                    let others = nodes[..i].iter().map(|other| (other.position - node.position).length());
                    assert!(others.fold(f64::INFINITY, f64::min) > 1.0 - 1e-6, "{name} {by}: {i} overlaps");
                }
            }
        }
    }
}

/// Every strand has the colour of the picture where it starts.
#[test]
fn strands_are_painted() {
    let (_, model) = grown("papers/2007-fig14-left", &[]);
    assert_eq!(model.objects.len(), 2);
    let middle = |i: usize| {
        let balls = &model.objects[i].body.limbs().unwrap().balls;
        balls.iter().map(|ball| ball.centre.x).sum::<f64>() / balls.len() as f64
    };
    let colour = |i: usize| model.materials[model.objects[i].material].1.colour.hex();
    let [left, right] = if middle(0) < middle(1) { [0, 1] } else { [1, 0] };
    assert_eq!((&*colour(left), &*colour(right)), ("006633", "993300"));
    // Limbs are numbered anew in each.
    for object in &model.objects {
        let balls = &object.body.limbs().unwrap().balls;
        assert!(balls.iter().any(|ball| ball.branch == 0));
        assert!(balls.iter().all(|ball| (ball.branch as usize) < balls.len()));
    }
}

/// Letters in space are those of the plane, upright.
#[test]
fn letters_stand_upright() {
    let (grown, _) = grown("papers/2007-fig13-solid", &[]);
    let nodes = &grown[0].skeleton.nodes;
    let high = nodes.iter().map(|n| n.position.z).fold(0.0, f64::max);
    let deep = nodes.iter().map(|n| n.position.y.abs()).fold(0.0, f64::max);
    assert!((6.5..8.0).contains(&high) && deep <= 1.01, "{high} {deep}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Endpoints of an iteration are as many as the pseudocode says, no farther from the structure before than it says, and paths
    /// never cross.
    #[test]
    fn fractal_placement_keeps_its_distances(
        seed in 1..1000_u32, beta in 2..5_u32, alpha in 1.3..3.0_f64, at in any::<bool>()
    ) {
        let place = if at { "at" } else { "within" };
        let by = format!(
            "{{ distance = 60, attenuation = {alpha:?}, branching = {beta}, iterations = 3, place = \"{place}\" }}"
        );
        let scene = [
            ("seed", &*seed.to_string()),
            ("grow.fourth.by.fractal", &by),
            ("grow.fourth.to.ends", "{ count = 6 }"),
            ("grow.fourth.smooth", "0"),
        ];
        let (grown, _) = grown("papers/2007-fig07", &scene);
        let fourth = grown.iter().find(|g| g.name == "fourth").unwrap();
        let skeleton = &fourth.skeleton;
        for level in 0..3_u16 {
            let ends: Vec<_> =
                skeleton.paths.iter().map(|p| &skeleton.nodes[p.end as usize]).filter(|n| n.level == level).collect();
            let expected = 6.0 * (0..level).map(|_| f64::from(beta)).product::<f64>();
            prop_assert!(ends.len() as f64 <= expected, "{} {expected}", ends.len());
            let before: Vec<DVec3> = if level == 0 {
                vec![DVec3::ZERO]
            } else {
                skeleton.nodes.iter().filter(|n| n.level < level).map(|n| n.position).collect()
            };
            let d = 60.0 / (0..level).map(|_| alpha).product::<f64>();
            for end in ends {
                let nearest = before.iter().map(|p| (*p - end.position).length()).fold(f64::INFINITY, f64::min);
                // What edges hand on is the distance to a step.
                let fits = if at { (nearest - d).abs() <= 1.5 } else { nearest <= d + 1.0 };
                prop_assert!(fits, "{level}: {nearest} {d}");
            }
        }
    }
}

/// One clear error each, with the place; nothing hangs or takes all memory.
#[test]
fn bad_input_gets_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bad.ttf"), b"no font at all").unwrap();
    fs::write(folder.path().join("bad.png"), b"\x89PNG\r\n\x1a\nnothing").unwrap();
    let mut white = Vec::new();
    image::RgbImage::from_pixel(8, 8, image::Rgb([255; 3]))
        .write_to(&mut std::io::Cursor::new(&mut white), image::ImageFormat::Png)
        .unwrap();
    fs::write(folder.path().join("white.png"), white).unwrap();
    fs::write(folder.path().join("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let flat = |shape: &str, grow: &str, object: &str| {
        format!(
            "title = \"T\"\n[space.s]\nshape.{shape}\nnodes.lattice = {{ spacing = 1, neighbours = 4 }}\n[grow.g]\nspace = \"s\"\n{grow}\n[object.o]\ngrow = [\"g\"]\n{object}\n"
        )
    };
    let square = "box = { min = [0, 0], max = [40, 40] }";
    let paths = "from.at = [[20, 20]]\nto.all = { count = 5 }\nwidth.constant = 1";
    let cases = [
        (
            flat("letters = { text = \"A\", font = \"bad.ttf\", size = 40 }", paths, ""),
            "not a TrueType or OpenType font",
        ),
        (flat("letters = { text = \"A\", font = \"none.ttf\", size = 40 }", paths, ""), "cannot read `none.ttf`"),
        (flat("letters = { text = \"   \", size = 40 }", paths, ""), "no outlines"),
        (flat("picture = { file = \"bad.png\", height = 40 }", paths, ""), "bad.png"),
        (flat("picture = { file = \"white.png\", height = 40 }", paths, ""), "nothing in it is darker"),
        (flat("mesh = { file = \"open.obj\" }", paths, ""), "open"),
        (flat("shell = { of = { box = { min = [0, 0], max = [1, 1] } } }", paths, ""), "a shell needs"),
        (flat("grown = \"g\"", paths, ""), "only steps with `by.regions` are shapes"),
        (flat("grown = \"x\"", paths, ""), "there is no step `x`"),
        (
            flat(square, "from.at = [[20, 20]]\nto.all = { count = 0 }\nwidth.constant = 1", ""),
            "expected whole numbers from 1",
        ),
        (
            flat(
                square,
                "from.at = [[20, 20]]\nby.fractal = { distance = 10, branching = 90, attenuation = 1.01 }\nto.all = { count = 5 }\nwidth.constant = 1",
                "",
            ),
            "there would be",
        ),
        (
            flat(
                square,
                "from.at = [[20, 20]]\nby.fractal = { distance = 1 }\nto.all = { count = 5 }\nwidth.constant = 1",
                "",
            ),
            "no iteration",
        ),
        (flat(square, "from.spread = { count = 3 }\nby.regions = {}", ""), "`skin = \"surface\"`"),
        (
            flat(square, "from.spread = { count = 3 }\nby.regions = {}\nwidth.constant = 1", "skin = \"surface\""),
            "no `width`",
        ),
        (
            flat(square, "from.spread = { count = 3 }\nby.regions = { keep = [[90, 90]] }", "skin = \"surface\""),
            "lies in no region",
        ),
        (flat(square, "from.spread = { count = 0 }\nby.regions = {}", "skin = \"surface\""), "expected"),
        (flat(square, "from.at = [[20, 20]]\nby.dla = { particles = 0 }\nwidth.constant = 1", ""), "expected"),
        (flat(square, paths, "skin = \"surface\""), "is that of regions"),
        (flat(square, paths, "skin.isosurface = { spacing = 1e-5 }"), "samples are too many"),
        (
            flat(
                square,
                "from.at = [[20, 20]]\nwidth.constant = 1\nto.all.grammar = { axiom = \"F\", rules = { F = \"FFFFFF\" }, iterations = 30, angle = 20, step = 1 }",
                "",
            ),
            "symbols",
        ),
        (
            flat(
                "union = [{ box = { min = [0, 0], max = [9, 9] } }, { box = { min = [20, 20], max = [29, 29] } }]",
                "from.at = [[5, 5]]\nto.all = { at = [[25, 25]] }\nwidth.constant = 1",
                "",
            ),
            "no path reaches the endpoint",
        ),
        (flat("letters = { text = \"A\", size = 40, depth = 4 }", paths, ""), "no `depth` in the plane"),
        (
            flat(square, "from.at = [[20, 20]]\nby.dla = { particles = 9 }\nwidth.constant = 1", "")
                .replace("[grow.g]", "forbid.box = { min = [0, 0], max = [5, 5] }\n[grow.g]"),
            "nothing forbidden",
        ),
        (flat(square, paths, "thorns = { length = 1, radius = 1, apart = 1e-5 }"), "primitives are more"),
        (
            flat(
                square,
                "from.at = [[20, 20]]\nto.all = { count = 900 }\nwidth.constant = 1\nstrands = 1000\nsymmetry = { fold = 360 }",
                "",
            ),
            "nodes are more than",
        ),
        (flat(square, paths, "paint = { file = \"bad.png\" }"), "bad.png"),
        (
            flat(square, paths, "skin = \"spheres\"\nthorns = { length = 1, radius = 1, apart = 1 }"),
            "belongs to limbs of cones",
        ),
    ];
    for (i, (scene, expected)) in cases.iter().enumerate() {
        let name = format!("{i}.toml");
        fs::write(folder.path().join(&name), scene).unwrap();
        let output = run_in(folder.path(), &["render", &name, "-o", "out.png", "--size", "64x48"]);
        let said = text(&output.stderr).replace('\n', " ");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ").replace("│ ", "").replace("| ", "");
        assert_eq!(output.status.code(), Some(2), "{scene}\n{said}");
        assert!(said.contains(expected), "{scene}\n{expected}: {said}");
        assert!(!said.contains("internal error") && !folder.path().join("out.png").exists());
    }
}
