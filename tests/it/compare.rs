//! `compare` from outside: outcomes, exit codes, reports, and the project's own goldens.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::support::{lichtenberg, root, run_in, succeed_in, text};

/// Scenes whose small pictures are kept in `renders/golden/`, each with what its picture shows.
const GOLDENS: [(&str, &str); 7] = [
    ("bonsai", "a tree with moss, its mesh of a pot on a round table, two lights: soft shadows meet the table"),
    ("cactus", "three thick arms in warm light with a highlight, and their shadow to the right"),
    ("elm", "a bare elm with bark, its crown a fine net, and a soft shadow of it on the ground"),
    ("grove", "eight elms against a photographed sunrise, their shadows towards us"),
    (
        "storm",
        "a white stroke from the top right of the middle to a tenth above the bottom, forks pointing down, on near black",
    ),
    (
        "papers/2008-fig12",
        "a tower at dusk struck by a forked bolt, the sky about it brighter, the rocket before it untouched",
    ),
    (
        "papers/2008-fig05",
        "four clay plants in a row: a spine with limbs, a basin of stems, a tree that forks above, an antler whose stems run low and rise",
    ),
];

fn run_with(folder: &Path, vars: &[(&str, &str)], args: &[&str]) -> Output {
    lichtenberg().current_dir(folder).envs(vars.iter().copied()).args(args).output().unwrap()
}

/// Small pictures: a in both folders, b changed in one parameter, c only expected, d only there, e of another size.
fn folders() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let render = |output: &str, size: &str, set: &str| {
        succeed_in(folder.path(), &["render", "cactus", "--size", size, "--samples", "2", "--set", set, "-o", output]);
    };
    render("x/a.png", "48x48", "seed=3");
    render("x/sub/b.png", "48x48", "seed=3");
    render("y/sub/b.png", "48x48", "grow.cactus.width.taper.from.main=0.6");
    render("x/e.png", "48x48", "seed=3");
    render("y/e.png", "40x48", "seed=3");
    for (from, to) in [("x/a.png", "y/a.png"), ("x/a.png", "x/c.png"), ("x/a.png", "y/d.png")] {
        fs::copy(folder.path().join(from), folder.path().join(to)).unwrap();
    }
    folder
}

#[test]
fn every_outcome_is_named() {
    let folder = folders();
    let at = folder.path();
    let output = run_with(at, &[], &["compare", "x", "y", "--junit", "r.xml", "--diff", "diff"]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let line = |start: &str| {
        said.lines().find(|l| l.starts_with(start)).unwrap_or_else(|| panic!("{start}: {said}")).to_owned()
    };
    assert!(line("same      a.png").contains("FLIP 0.0000 mean, 0.0000 95 %, 0.0000 max"));
    assert!(line("different sub/b.png").contains("(flip-max at most 0.1)"));
    assert!(said.contains("grow.cactus.width.taper.from.main: 0.42 -> 0.6"), "{said}");
    assert!(line("missing   c.png").contains("no actual picture"));
    assert!(line("new       d.png").contains("no expected picture"));
    assert!(line("different e.png").contains("48 by 48 expected, 40 by 48 there"));
    assert!(said.contains("1 of 5 pictures are as expected"));
    let xml = fs::read_to_string(at.join("r.xml")).unwrap();
    assert!(xml.contains(r#"tests="5" failures="4" errors="0""#), "{xml}");
    assert_eq!(fs::read_dir(at.join("diff/sub")).unwrap().count(), 1);
    // The same folder is the same, and two files are compared as such.
    assert_eq!(run_with(at, &[], &["compare", "x", "x"]).status.code(), Some(0));
    assert_eq!(run_with(at, &[], &["compare", "x/a.png", "y/a.png"]).status.code(), Some(0));
    assert_eq!(run_with(at, &[], &["compare", "x/sub/b.png", "y/sub/b.png"]).status.code(), Some(1));
    // JSON tells the same.
    let output = run_with(at, &[], &["compare", "x", "y", "--json"]);
    let pairs: Vec<serde_json::Value> =
        text(&output.stdout).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let b = pairs.iter().find(|p| p["name"] == "sub/b.png").unwrap();
    assert!(b["flip_max"].as_f64().unwrap() > 0.1 && b["outcome"] == "different", "{b}");
}

#[test]
fn metrics_thresholds_and_their_file() {
    let folder = folders();
    let at = folder.path();
    let code =
        |args: &[&str]| run_with(at, &[], &[&["compare", "x/sub/b.png", "y/sub/b.png"], args].concat()).status.code();
    for metric in ["flip", "flip-95", "flip-max", "max", "rms", "share"] {
        assert_eq!(code(&["--metric", metric]), Some(1), "{metric}");
        assert_eq!(code(&["--metric", metric, "--threshold", "1"]), Some(0), "{metric}");
    }
    assert_eq!(code(&["--threshold", "-1"]), Some(2));
    fs::write(at.join("x/compare.toml"), "[file.\"sub/b.png\"]\nmetric = \"max\"\nthreshold = 1\n").unwrap();
    let output = run_with(at, &[], &["compare", "x", "y"]);
    assert!(text(&output.stdout).contains("same      sub/b.png"), "{}", text(&output.stdout));
    fs::write(at.join("x/compare.toml"), "treshold = 1\n").unwrap();
    let output = run_with(at, &[], &["compare", "x", "y"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("compare.toml") && text(&output.stderr).contains("treshold"));
}

#[test]
fn what_cannot_be_compared_is_exit_2() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir_all(at.join("empty")).unwrap();
    fs::write(at.join("a.png"), b"no picture").unwrap();
    fs::write(at.join("b.exr"), b"no picture").unwrap();
    for args in [["a.png", "a.png"], ["b.exr", "b.exr"], ["no.png", "none.png"], ["empty", "empty"], ["empty", "a.png"]]
    {
        let output = run_with(at, &[], &["compare", args[0], args[1]]);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", text(&output.stdout));
        assert!(!text(&output.stderr).contains("internal error"));
    }
}

#[test]
fn goldens_are_accepted_by_people() {
    let folder = folders();
    let at = folder.path();
    let refused = run_with(at, &[("CI", "true")], &["compare", "x", "y", "--update"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("--force"));
    // c is missing: it has to be deleted by hand.
    assert_eq!(run_with(at, &[], &["compare", "x", "y", "--update"]).status.code(), Some(2));
    fs::remove_file(at.join("x/c.png")).unwrap();
    assert_eq!(run_with(at, &[("CI", "true")], &["compare", "x", "y", "--update", "--force"]).status.code(), Some(0));
    assert_eq!(run_with(at, &[], &["compare", "x", "y"]).status.code(), Some(0));
}

#[test]
fn github_is_told() {
    let folder = folders();
    let at = folder.path();
    let summary = at.join("summary.md");
    let vars = [("GITHUB_ACTIONS", "true"), ("GITHUB_STEP_SUMMARY", summary.to_str().unwrap())];
    let said = text(&run_with(at, &vars, &["compare", "x", "y"]).stdout);
    assert!(said.contains("::error file=x/sub/b.png::different"), "{said}");
    assert!(said.contains("%0A"), "lines are escaped: {said}");
    let table = fs::read_to_string(summary).unwrap();
    assert!(table.contains("| c.png | missing |") && !table.contains("a.png"), "{table}");
}

#[test]
fn exr_is_compared_by_channel() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let render = |output: &str, set: &str| {
        succeed_in(at, &["render", "cactus", "--size", "32x32", "--samples", "2", "--set", set, "-o", output]);
    };
    render("a.exr", "seed=3");
    render("b.exr", "material.skin.colour=\"#604030\"");
    let code = |args: &[&str]| run_with(at, &[], &[&["compare", "a.exr", "b.exr"], args].concat()).status.code();
    assert_eq!(code(&[]), Some(1), "colours differ");
    assert_eq!(code(&["--channels", "Z,N", "--metric", "max"]), Some(0), "geometry does not");
    assert_eq!(code(&["--channels", "CryptoObject00"]), Some(0));
    assert_eq!(code(&["--channels", "nothing"]), Some(2));
}

/// The page works in a real browser, without a network: the slider moves the edge between the pictures, the box hides
/// what is as expected.
#[test]
fn the_page_works_in_a_browser() {
    let folder = folders();
    let at = folder.path();
    run_with(at, &[], &["compare", "x", "y", "--html", "page.html"]);
    let page = fs::read_to_string(at.join("page.html")).unwrap();
    // What a hand would do, done at the end of the page; the browser then prints what has become of it.
    let hand = r#"<script>
      const range = document.querySelector(".slider input"), over = document.querySelector(".slider .over");
      range.value = 20; range.dispatchEvent(new Event("input"));
      const box = document.getElementById("only"); box.click();
      const shown = [...document.querySelectorAll("section")].filter((s) => getComputedStyle(s).display !== "none").length;
      const loaded = [...document.images].every((i) => i.complete && i.naturalWidth > 0);
      document.body.dataset.told = `clip ${over.style.clipPath} shown ${shown} loaded ${loaded}`;
    </script></body>"#;
    fs::write(at.join("test.html"), page.replace("</body>", hand)).unwrap();
    let output = Command::new("chromium")
        .current_dir(at)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .arg(format!("--user-data-dir={}", at.join("profile").display()))
        .args(["--virtual-time-budget=5000", "--dump-dom", "test.html"])
        .output()
        .expect("this test needs Chromium: run ./run-tests, or apt-get install chromium");
    let dom = text(&output.stdout);
    let told = dom.split("data-told=\"").nth(1).and_then(|t| t.split('"').next()).unwrap_or("nothing");
    assert_eq!(told, "clip inset(0px 0px 0px 20%) shown 4 loaded true", "{}", text(&output.stderr));
}

/// The goldens, by this very command. `UPDATE=1` accepts new ones: look at them, and say in [`GOLDENS`] what they show.
#[test]
fn goldens_are_as_expected() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, _) in GOLDENS {
        let output = format!("there/{}.png", name.replace('/', "-"));
        succeed_in(at, &["render", name, "--size", "160x120", "-o", &output]);
    }
    let golden = root().join("renders/golden");
    let golden = golden.to_str().unwrap();
    if std::env::var_os("UPDATE").is_some() {
        fs::create_dir_all(golden).unwrap();
        succeed_in(at, &["compare", golden, "there", "--update"]);
    }
    let output = run_in(at, &["compare", golden, "there"]);
    assert!(output.status.success(), "{}{}{GOLDENS:#?}", text(&output.stdout), text(&output.stderr));
    assert!(text(&output.stdout).contains(&format!("{0} of {0} pictures", GOLDENS.len())));
}
