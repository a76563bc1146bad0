//! The command from outside: outputs, exit codes, and one clear error for every bad input.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::{lichtenberg, run_in, scene_names, succeed_in, text};

/// A scene that reads no file.
pub const TWIG: &str = r#"title = "Twig"
[space.sheet]
shape.box = { min = [-1, 0], max = [1, 2] }
nodes.lattice = { spacing = 0.1, neighbours = 8 }
[grow.twig]
space = "sheet"
from.at = [[0, 0]]
to.tips = { count = 5 }
width.constant = 0.02
[object.twig]
grow = ["twig"]
"#;

fn folder_with(name: &str, text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    folder
}

/// The command must fail with `code`, and say `words`, each; and write nothing.
fn fails(folder: &Path, args: &[&str], code: i32, words: &[&str]) {
    let before = fs::read_dir(folder).unwrap().count();
    let output = run_in(folder, args);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
    for word in words {
        assert!(said.contains(word), "{args:?} does not say {word:?}: {said}");
    }
    assert!(!said.contains("internal error"), "{said}");
    assert_eq!(fs::read_dir(folder).unwrap().count(), before, "{args:?} wrote something");
}

/// The scene with one change must fail to export, and say `words`.
fn bad(from: &str, to: &str, words: &[&str]) {
    assert!(TWIG.contains(from), "{from}");
    let folder = folder_with("twig.toml", &TWIG.replace(from, to));
    fails(folder.path(), &["export", "twig", "--to", "pov"], 2, words);
}

#[test]
fn bad_scenes_get_one_clear_error() {
    bad("space = \"sheet\"", "spcae = \"sheet\"", &["twig.toml:6:1", "did you mean `space`"]);
    bad("space = \"sheet\"", "", &["grow.twig.space", "this way of growing needs a `space`"]);
    bad("nodes.lattice", "nodez.lattice", &["did you mean `nodes`", "the key `nodes` is missing"]);
    bad("spacing = 0.1", "spacing = \"wide\"", &["twig.toml:4", "expected a number", "found text"]);
    bad("spacing = 0.1", "spacing = nan", &["expected a number, found NaN"]);
    bad("spacing = 0.1", "spacing = -1", &["above 0", "found -1"]);
    bad("spacing = 0.1", "spacing = 1e-300", &["too large"]);
    bad("spacing = 0.1", "spacing = 50.0", &["of 5 endpoints could be placed"]);
    bad("neighbours = 8", "neighbours = 5", &["expected one of 4, 8, 6, 18, 26, found 5"]);
    bad("count = 5", "count = 0", &["from 1 to 1000000"]);
    bad("count = 5", "apart = 5.0", &["exactly one of `count`"]);
    bad("to.tips = { count = 5 }", "to = {}", &["at least one set of endpoints"]);
    bad("count = 5", "count = 900", &["only", "of 900 endpoints could be placed"]);
    bad("count = 5", "count = 9, apart = 3.0", &["grow.twig.to.tips", "apart"]);
    bad("count = 5", "at = [[7, 7]]", &["outside the space"]);
    bad("from.at = [[0, 0]]", "from.at = [[9, 9]]", &["grow.twig.from", "outside the space"]);
    bad("from.at = [[0, 0]]", "from.at = []", &["at least 1 items"]);
    bad("[grow.twig]", "weights = { max = 10, alpha = 1000 }\n[grow.twig]", &["twig.toml:5", "lower alpha"]);
    bad("[grow.twig]", "weights = { max = 1e6, alpha = 1.1 }\n[grow.twig]", &["lower alpha"]);
    bad("width.constant", "width.constent", &["did you mean `constant`"]);
    bad("grow = [\"twig\"]", "grow = [\"twgi\"]", &["did you mean `twig`"]);
    bad("grow = [\"twig\"]", "grow = []", &["either steps (`grow`) or a `mesh`"]);
    bad("grow = [\"twig\"]", "mesh = \"none.obj\"", &["cannot read `none.obj`"]);
    bad("[grow.twig]", "[sky]\nhorizon = [1, 1, 1]\n[grow.twig]", &["both `horizon` and `zenith`"]);
    bad("[grow.twig]", "[sky]\ncolour = [1, 1, 1]\nfile = \"a.exr\"\n[grow.twig]", &["exactly one of `colour`"]);
    let night = "[sky]\ndaylight = { latitude = 50, day = 172, hour = 23 }\n[grow.twig]";
    bad("[grow.twig]", night, &["sky.daylight: at this hour the sun is", "below the horizon"]);
    bad(
        "[grow.twig]",
        "[sky]\ncolour = [1, 1, 1]\nstrength = 2\n[grow.twig]",
        &["sky.strength", "for a picture of the sky"],
    );
    bad("[grow.twig]", "[sky]\nfile = \"a.exr\"\n[grow.twig]", &["sky.file", "cannot read `a.exr`"]);
    bad("[object.twig]", "[object.\"a\\nb\"]", &["is no name"]);
    bad("[object.twig]", "[object.\"../x\"]", &["is no name"]);
    bad("title = \"Twig\"", "title = Twig", &["twig.toml:1"]);
    bad("title = \"Twig\"", "title = \"Twig\"\nseed = -3", &["twig.toml:2"]);
    bad(
        "[grow.twig]",
        "forbid = { box = { min = [-9, 0.45], max = [9, 0.55] } }\n[grow.twig]",
        &["no path reaches", "unreached = \"drop\""],
    );
    bad("[grow.twig]", "like = \"sheet\"\n[grow.twig]", &["like itself"]);
    bad("[grow.twig]", "field.map.of.map.file = \"gone.png\"\n[grow.twig]", &["cannot read `gone.png`"]);
    bad("[grow.twig]", "field.map.of.map.file = \"twig.toml\"\n[grow.twig]", &["not a PNG or JPEG"]);
    bad("[grow.twig]", "field.s.of.sketch.file = \"twig.toml\"\n[grow.twig]", &["not an SVG"]);
    bad("width.constant = 0.02", "width.taper = { from = { thick = 1 }, to = 0 }", &["class `main`"]);
    bad("[object.twig]", "[camera]\nat = [0, 0, 0]\n[object.twig]", &["needs `look_at`"]);
    bad("max = [1, 2]", "max = [1e5, 1e5]", &["too large"]);
    bad("max = [1, 2]", "max = [-1, 2]", &["outside the space"]);
}

#[test]
fn unreached_endpoints_can_be_dropped() {
    let wall = "forbid = { box = { min = [-9, 0.45], max = [9, 0.55] } }\n[grow.twig]\nunreached = \"drop\"";
    let some = TWIG.replace("[grow.twig]", wall).replace("count = 5", "at = [[0, 0.3], [0, 1], [1, 2]]");
    let folder = folder_with("twig.toml", &some);
    let output = run_in(folder.path(), &["export", "twig", "--to", "svg"]);
    let said = text(&output.stderr);
    assert!(output.status.success() && said.contains("dropped 2 endpoints"), "{said}");
}

#[test]
fn every_mistake_is_reported() {
    let text = TWIG
        .replace("spacing = 0.1", "spacing = -1")
        .replace("count = 5", "cuont = 5")
        .replace("width.constant = 0.02", "width.constant = \"x\"");
    let folder = folder_with("twig.toml", &text);
    fails(folder.path(), &["check", "twig"], 2, &["found -1", "did you mean `count`", "found text"]);
    let output = run_in(folder.path(), &["check", "twig", "--json"]);
    let json: serde_json::Value = serde_json::from_str(text_of(&output.stdout).trim()).unwrap();
    let lines: Vec<_> = json["errors"].as_array().unwrap().iter().map(|e| e["line"].as_u64().unwrap()).collect();
    assert_eq!(lines, [4, 8, 9]);
}

fn text_of(bytes: &[u8]) -> String {
    text(bytes)
}

#[test]
fn bad_pictures_are_named() {
    let with_map = TWIG.replace("[grow.twig]", "field.map.of.map.file = \"map.png\"\n[grow.twig]");
    let folder = folder_with("twig.toml", &with_map);
    let good = fs::read(crate::support::root().join("scenes/assets/painted-leaf.png")).unwrap();
    let mut huge = good.clone();
    huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    for bytes in [&good[..good.len() / 2], &huge[..], b"\x89PNG\r\n\x1a\n", b""] {
        fs::write(folder.path().join("map.png"), bytes).unwrap();
        fails(
            folder.path(),
            &["export", "twig", "--to", "svg"],
            2,
            &["cannot read `map.png`", "space.sheet.field.map"],
        );
    }
    fs::write(folder.path().join("map.png"), good).unwrap();
    succeed_in(folder.path(), &["export", "twig", "--to", "svg"]);
    let sketch = with_map.replace("map.file = \"map.png\"", "sketch.file = \"s.svg\"").replace("of.map", "of");
    fs::write(folder.path().join("twig.toml"), sketch).unwrap();
    fs::write(folder.path().join("s.svg"), "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'/>").unwrap();
    fails(folder.path(), &["check", "twig"], 2, &["it has no paths"]);
}

#[test]
fn bad_calls_get_one_clear_error() {
    let folder = folder_with("twig.toml", TWIG);
    let at = folder.path();
    fails(at, &["export", "twgi", "--to", "pov"], 2, &["no scene file or embedded scene"]);
    fails(at, &["render", "twig", "--crop", "0,0,9000,2"], 2, &["does not lie within", "640 by 480"]);
    fails(at, &["render", "twig", "--crop", "1,2,3"], 2, &["left, top, width, height"]);
    fails(
        at,
        &["render", "twig", "--size", "9000x9000", "--max-memory", "200M", "-o", "a.exr"],
        2,
        &["--crop", "--max-memory"],
    );
    fails(at, &["render", "twig", "--samples", "0"], 2, &["1..=4096"]);
    fails(at, &["render", "twig", "--show", "contours"], 2, &["--schematic"]);
    fails(at, &["render", "twig", "--with", "povray", "-o", "a.exr"], 2, &["must end in .png"]);
    fails(at, &["render", "twig", "-o", "a.jpg"], 2, &["must end in .png or .exr"]);
    fails(at, &["render", "elm", "--watch"], 2, &["a scene file"]);
    fails(at, &["render", "twig", "--schematic", "--look", "exact"], 2, &["cannot be used with"]);
    for name in ["../x", "a\"b", "a\nb", "", "povray", ".x"] {
        fails(at, &["export", "twig", "--to", "pov", "--name", name], 2, &["is no name for files"]);
    }
    fails(at, &["export", "twig", "--to", "pov", "--max-memory", "1k"], 2, &["MB of memory", "--max-memory"]);
    fails(at, &["render", "twig", "--schematic", "-o", "x.jpg"], 2, &["must end in .png"]);
    fails(at, &["render", "twig", "--schematic", "--seeds", "1-3", "-o", "x.png"], 2, &["written twice", "{seed}"]);
    fails(at, &["render", "twig", "--schematic", "-o", "{sede}.png"], 2, &["did you mean"]);
    fails(at, &["export", "twig", "--to", "svg", "--set", "grow.twig.to.tips.cuont=3"], 2, &["did you mean `count`"]);
    fails(at, &["export", "twig", "--to", "svg", "--set", "grow..x=3"], 2, &["path of keys"]);
    fails(at, &["check", "papers/amin-fig4", "--set", "grow.sun.from.at.0=7"], 2, &["grow.sun.from.at"]);
    fails(at, &["check", "papers/amin-fig4", "--set", "grow.sun.from.at.1=[0, 0, 0]"], 2, &["the first of a list"]);
    fails(at, &["export", "twig", "--to", "svg", "--size", "1x1"], 2, &["640x480"]);
    fails(at, &["new", "twig"], 2, &["there already"]);
    fails(at, &["new", "../twig"], 2, &["is no name"]);
    fails(at, &["export", "twig", "--to", "pov", "-o", "twig.toml"], 2, &["cannot write"]);
    fails(at, &["export", "twig", "--to", "pov", "--templates", "."], 2, &["none of the templates"]);
    fails(at, &["check", "elm", "--set", "space.air.nodes.lattice.spacing=0.00001"], 2, &["too large"]);
}

/// A disk that is full: the error is the system's, and nothing is left.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_nothing() {
    let folder = folder_with("twig.toml", TWIG);
    // A limit on file size stands for the full disk; the shell ignores its signal, so that writing fails.
    let script =
        format!("trap '' XFSZ; ulimit -f 8; exec {} export elm --to pov -o out", env!("CARGO_BIN_EXE_lichtenberg"));
    let output = Command::new("bash").current_dir(folder.path()).args(["-c", &script]).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("cannot write"));
    assert_eq!(fs::read_dir(folder.path().join("out")).unwrap().count(), 0);
}

#[test]
fn an_edited_scene_is_kept() {
    let folder = folder_with("twig.toml", TWIG);
    let at = folder.path();
    let export = ["export", "twig", "--to", "pov"];
    succeed_in(at, &export);
    let (inc, pov) = (at.join("twig.inc"), at.join("twig.pov"));
    let first = fs::read_to_string(&inc).unwrap();
    succeed_in(at, &[&export[..], &["--seed", "2"]].concat());
    assert_ne!(fs::read_to_string(&inc).unwrap(), first, "the include file is always rewritten");
    let edited = fs::read_to_string(&pov).unwrap() + "// mine\n";
    fs::write(&pov, &edited).unwrap();
    let output = run_in(at, &export);
    assert!(output.status.success() && text(&output.stderr).contains("kept"));
    assert_eq!(fs::read_to_string(&pov).unwrap(), edited);
    assert_eq!(fs::read_to_string(&inc).unwrap(), first);
    succeed_in(at, &[&export[..], &["--force"]].concat());
    assert_ne!(fs::read_to_string(&pov).unwrap(), edited);
}

#[test]
fn scene_text_stays_in_its_comment() {
    let evil = TWIG.replace("title = \"Twig\"", "title = \"a\\n*/ #error \\\"x\\\" \\u0001 0\\u0001\"");
    let folder = folder_with("twig.toml", &evil);
    succeed_in(folder.path(), &["export", "twig", "--to", "pov"]);
    for file in ["twig.inc", "twig.pov"] {
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(text.lines().filter(|l| l.contains("#error")).all(|l| l.starts_with("//")), "{file}");
        assert!(!text.contains('\u{1}'));
    }
}

#[test]
fn many_at_once() {
    let folder = folder_with("twig.toml", TWIG);
    let at = folder.path();
    let made = succeed_in(
        at,
        &["render", "twig", "--schematic", "--seeds", "1-3", "--size", "64x64", "-o", "out/{scene}_{seed}.png"],
    );
    assert_eq!(made.lines().collect::<Vec<_>>(), ["out/twig_1.png", "out/twig_2.png", "out/twig_3.png"]);
    fs::copy(at.join("out/twig_1.png"), at.join("out/twig_2.png")).unwrap();
    let again = succeed_in(
        at,
        &[
            "render",
            "twig",
            "--schematic",
            "--seeds",
            "1-4",
            "--size",
            "64x64",
            "-o",
            "out/{scene}_{seed}.png",
            "--skip-existing",
        ],
    );
    assert_eq!(again.trim(), "out/twig_4.png");
    assert!(fs::read(at.join("out/twig_2.png")).unwrap() == fs::read(at.join("out/twig_1.png")).unwrap());
    // The sweep of Fig. 2 on a contact sheet, in one call.
    let sheet = succeed_in(
        at,
        &[
            "render",
            "twig",
            "--schematic",
            "--sweep",
            "space.sheet.weights.alpha=0.3,1,3",
            "--sheet",
            "sheet.png",
            "--size",
            "64x64",
        ],
    );
    assert_eq!(sheet.trim(), "sheet.png");
    let picture = lichtenberg::files::decode_png(&fs::read(at.join("sheet.png")).unwrap()).unwrap();
    assert!(picture.width > 500, "three pictures: {}", picture.width);
    assert_eq!(fs::read_dir(at).unwrap().count(), 3, "the sheet is all that is written");
}

#[test]
fn a_file_goes_before_an_embedded_scene() {
    let folder = folder_with("elm.toml", TWIG);
    let output = run_in(folder.path(), &["export", "elm", "--to", "svg"]);
    assert!(output.status.success() && text(&output.stderr).contains("taking the file elm.toml"));
    assert!(fs::read_to_string(folder.path().join("elm.svg")).unwrap().contains("<title>Twig</title>"));
}

#[test]
fn new_scenes_stand_on_their_own() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["mine", "vine", "painted-leaf"] {
        succeed_in(folder.path(), &["new", name]);
        succeed_in(folder.path(), &["check", &format!("{name}.toml")]);
    }
    succeed_in(folder.path(), &["new", "copy", "--like", "cactus"]);
}

#[test]
fn the_rest_of_the_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let listed = succeed_in(at, &["list"]);
    for name in scene_names() {
        assert!(listed.contains(&name));
    }
    let schema: serde_json::Value = serde_json::from_str(&succeed_in(at, &["schema"])).unwrap();
    assert_eq!(schema["title"], "Lichtenberg scene");
    assert!(succeed_in(at, &["completions", "bash"]).contains("lichtenberg"));
    assert!(succeed_in(at, &["man"]).contains(".TH"));
    let info: serde_json::Value = serde_json::from_str(&succeed_in(at, &["info", "elm", "--json"])).unwrap();
    assert_eq!(info["nodes"], 512_000);
    for key in ["edges", "endpoints", "primitives"] {
        assert!(info[key].as_u64().unwrap() > 1000, "{key}");
    }
    assert!(info["seconds"]["grow"].as_f64().unwrap() > 0.0 && info["bytes"]["needed"].as_u64().unwrap() > 1_000_000);
    let exported = succeed_in(at, &["export", "cactus", "--to", "pov", "--json", "-o", "x"]);
    assert_eq!(exported.lines().count(), 5);
    assert!(exported.lines().all(|l| serde_json::from_str::<serde_json::Value>(l).is_ok()));
    let output = run_in(at, &["check", "papers/2008-fig02", "--claims", "--set", "space.straight.weights.alpha=3"]);
    assert_eq!(output.status.code(), Some(1));
}

/// Where a scene does not grow, `--claims` tells every mistake, not the first alone; a camera that sees nothing among them.
#[test]
fn claims_tell_the_mistakes_that_check_tells() {
    let folder = tempfile::tempdir().unwrap();
    let outside = ["grow.plain.from.at=[[98, 99]]", "grow.erratic.from.at=[[99, 99]]"];
    for (scene, wrong) in [("papers/2008-fig02", &outside[..]), ("elm", &["camera.at=[1, 1, 1]"])] {
        let set: Vec<&str> = wrong.iter().flat_map(|&change| ["--set", change]).collect();
        let [checked, claimed] = [&[][..], &["--claims"]].map(|more| {
            let output = run_in(folder.path(), &[&["check", scene], more, &set].concat());
            assert_eq!(output.status.code(), Some(2), "{scene}");
            text(&output.stderr).to_owned()
        });
        assert_eq!(checked.matches(" x ").count(), wrong.len(), "{checked}");
        assert_eq!(checked, claimed);
    }
}

/// Over several seeds every claim is summed up: how often it held, and where it came nearest to failing.
#[test]
fn claims_are_summed_up_over_seeds() {
    let folder = tempfile::tempdir().unwrap();
    let check = ["check", "cactus", "--claims", "--seeds", "1-3"];
    let said = succeed_in(folder.path(), &check);
    assert!(said.lines().count() >= 3 && said.lines().all(|line| line.contains("holds in 3 of 3 runs")), "{said}");
    // The worst of the three is the least of what single runs measure.
    let spread = |seed: &str| {
        let told = succeed_in(folder.path(), &["check", "cactus", "--claims", "--json", "--seed", seed]);
        let findings = told.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
        let own = findings.map(|line| line["finding"].clone()).find(|finding| finding["claim"] == "upright");
        own.unwrap()["measured"].as_f64().unwrap()
    };
    let most = ["1", "2", "3"].map(spread).into_iter().fold(0.0, f64::max);
    let line = said.lines().find(|line| line.contains("upright")).unwrap();
    assert!(line.contains(&format!("at worst {most:.4}")), "{line} {most}");
    let narrow = format!("claim.upright.at_most={}", most * 0.999);
    let output = run_in(folder.path(), &[&check[..], &["--set", &narrow]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("upright DOES NOT HOLD in"), "{}", text(&output.stdout));
}

#[test]
fn info_measures_what_a_scene_claims() {
    let folder = tempfile::tempdir().unwrap();
    let said = succeed_in(folder.path(), &["info", "papers/2008-fig09", "--json"]);
    let info: serde_json::Value = serde_json::from_str(&said).unwrap();
    let claims = info["claims"].as_array().unwrap();
    assert!(claims.len() >= 6 && claims.iter().all(|claim| claim["holds"] == true), "{claims:?}");
    let dimension = info["steps"][0]["skeleton"]["dimension"].as_f64().unwrap();
    assert!((0.9..1.6).contains(&dimension), "{dimension}");
}

/// A scene with `show` is drawn without a flag, and traced where a look is asked for; options of tracing are refused until then.
#[test]
fn what_shows_its_construction_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let small = ["render", "papers/2012-fig03", "--size", "80x70", "--quiet", "-o"];
    let picture = |more: &[&str]| {
        succeed_in(at, &[&small[..], more].concat());
        fs::read(at.join(more[0])).unwrap()
    };
    let drawn = picture(&["drawn.png"]);
    assert_eq!(drawn, picture(&["schematic.png", "--schematic"]));
    assert_ne!(drawn, picture(&["traced.png", "--look", "exact"]));
    assert_ne!(drawn, picture(&["nodes.png", "--show", "nodes"]));
    fails(at, &[&small[..], &["x.png", "--samples", "4"]].concat(), 2, &["--samples", "--look"]);
    fails(at, &[&small[..], &["x.exr"]].concat(), 2, &["EXR", "--look"]);
    // Also where a file is watched, which its next change may mend: what is traced has no marks.
    succeed_in(at, &["new", "mine", "--like", "cactus"]);
    let mut child = lichtenberg()
        .current_dir(at)
        .args(["render", "mine.toml", "--watch", "--show", "nodes"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let told = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    assert!(told.into_iter().any(|line| line.contains("--schematic")), "it ends without a word");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!at.join("mine.png").exists());
    // What the marks are.
    let svg = |scene: &str, marks: &str| {
        succeed_in(at, &["export", scene, "--to", "svg", "--name", "marks", "--show", marks, "--quiet"]);
        fs::read_to_string(at.join("marks.svg")).unwrap()
    };
    assert_eq!(svg("papers/2012-fig03", "sectors").matches("stroke-dasharray").count(), 1);
    let costs = svg("papers/2012-fig02", "costs");
    let tones = (0..8)
        .filter(|step| costs.contains(&format!("stroke=\"#{0:02x}{0:02x}{0:02x}\"", 70 + 160 * step / 7)))
        .count();
    assert_eq!(tones, 8, "edges have eight tones");
    // Fig. 5 shows its 7 first endpoints with two of its objects, those of 7 subgraphs with one.
    let ends = |options: &[&str]| {
        let common = ["export", "papers/2012-fig05", "--to", "svg", "--name", "ends", "--show", "endpoints", "--quiet"];
        succeed_in(at, &[&common[..], options].concat());
        fs::read_to_string(at.join("ends.svg")).unwrap().matches("<circle").count()
    };
    let shown = ends(&[]);
    assert_eq!(ends(&["--set", "object.graph.marks=false"]), shown - 7);
    assert_eq!(ends(&["--set", "object.subgraphs.marks=false"]), shown - 7 * 7);
    fails(at, &["export", "papers/2008-fig01", "--to", "svg", "--show", "sectors"], 2, &["Yao graphs in the plane"]);
}

/// A sketch in JSON is strokes that paths follow, or points; what is wrong with it is told at its place.
#[test]
fn sketches_are_strokes_or_points() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    succeed_in(at, &["new", "drawn", "--like", "sketched-tree"]);
    succeed_in(at, &["check", "drawn"]);
    let both = "grow.limbs.to.strokes.sketch=\"assets/sketched-tree.json\"";
    fails(at, &["check", "drawn", "--set", both], 2, &["exactly one of", "`strokes`"]);
    let json = at.join("assets/sketched-tree.json");
    fs::write(&json, r#"{ "size": [4, 4], "points": [[2, 1]] }"#).unwrap();
    fails(at, &["check", "drawn"], 2, &["grow.limbs.to.strokes.strokes", "no strokes"]);
    fs::write(&json, r#"{ "size": [4, 4], "strokes": [[[2, 1], [3]]] }"#).unwrap();
    fails(at, &["check", "drawn"], 2, &["no sketch in JSON", "line 1 column"]);
}
