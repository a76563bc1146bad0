//! What strangers bring: names that are no text, texts that steer terminals, scenes that look around.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::command::TWIG;
use crate::support::{lichtenberg, openimageio, require_povray, run_in, succeed_in, text};

const SMALL: [&str; 4] = ["--size", "32x32", "--samples", "1"];

fn run_with(folder: &Path, args: &[&OsStr]) -> Output {
    lichtenberg().current_dir(folder).args(args).output().unwrap()
}

#[test]
fn names_need_not_be_utf8() {
    let folder = tempfile::tempdir().unwrap();
    let name = |bytes: &[u8]| PathBuf::from(OsStr::from_bytes(bytes));
    let (scene, sub) = (name(b"tw\xffig.toml"), folder.path().join(name(b"d\xfe")));
    fs::create_dir(&sub).unwrap();
    fs::write(folder.path().join(&scene), TWIG).unwrap();
    let call = |args: &[&str], names: &[&Path], code: i32| {
        let args: Vec<&OsStr> = args.iter().map(OsStr::new).chain(names.iter().map(|path| path.as_os_str())).collect();
        let output = run_with(folder.path(), &args);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {}", text(&output.stderr));
        output.stdout
    };
    let picture = name(b"d\xfe/{seed}\xfd.png");
    let made = name(b"d\xfe/7\xfd.png");
    call(&["check"], &[&scene], 0);
    call(&["info", "--json"], &[&scene], 0);
    let said = call(&["render", "--size", "32x32", "--samples", "1", "--seed", "7", "-o"], &[&picture, &scene], 0);
    assert_eq!(said, [made.as_os_str().as_bytes(), b"\n"].concat());
    call(&["render", "--json", "--skip-existing", "--seed", "7", "-o"], &[&picture, &scene], 0);
    call(&["export", "--to", "svg", "--name", "x", "-o"], &[&sub, &scene], 0);
    call(&["export", "--json", "--to", "pov", "--name", "x", "-o"], &[&sub, &scene], 0);
    assert!(sub.join("x.svg").is_file() && sub.join("x.inc").is_file() && folder.path().join(&made).is_file());
    call(&["strike", "--json", "--to", "0.5,0.6", "-o"], &[&name(b"s\xfc.png"), &made], 0);
    // By name in both folders, and as files.
    fs::create_dir(folder.path().join("other")).unwrap();
    fs::copy(folder.path().join(&made), folder.path().join("other").join(name(b"7\xfd.png"))).unwrap();
    call(&["compare", "other", "--html", "r.html", "--junit"], &[&name(b"r\xfb.xml"), &sub], 0);
    call(&["compare", "--json"], &[&made, &made], 0);
    // What is wrong is told all the same.
    fs::write(folder.path().join(&scene), TWIG.replace("count", "cuont")).unwrap();
    let refused = run_with(folder.path(), &[OsStr::new("check"), scene.as_os_str()]);
    assert!(refused.status.code() == Some(2) && text(&refused.stderr).contains("tw\u{fffd}ig.toml:"));
}

/// No control character but line ends and tabs.
fn is_tame(bytes: &[u8]) -> bool {
    String::from_utf8_lossy(bytes).chars().all(|c| !c.is_control() || c == '\n' || c == '\t')
}

#[test]
fn nothing_steers_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let wild = "x\u{1b}[2J\r\u{9b}31m.toml";
    let scene = TWIG.replacen("title = \"", "title = \"\\u001b[31m\\u009b\\r::error::\\n", 1);
    fs::write(folder.path().join(wild), &scene).unwrap();
    fs::write(folder.path().join("wrong.toml"), format!("# \u{1b}[2J\u{9b}\nb\u{7f} = 1\n{TWIG}")).unwrap();
    fs::write(folder.path().join("named.toml"), TWIG.replace("[grow.twig]", "[grow.\"\\u001b[2J\"]")).unwrap();
    for args in [
        &["check", wild][..],
        &["check", wild, "--json"],
        &["info", wild],
        &["info", wild, "--json"],
        &["check", "wrong.toml"],
        &["check", "named.toml"],
        &["check", "named.toml", "--json"],
        &["render", "no\u{1b}[2J"],
        &["render", wild, "-o", "\u{1b}"],
        &["compare", "no\u{1b}", "\u{9b}"],
        &["strike", "\u{1b}.png", "--to", "0.5,0.5", "-o", "x.png"],
        &["info", wild, "--set", "\u{1b}=1"],
    ] {
        let output = run_in(folder.path(), args);
        assert!(
            is_tame(&output.stderr) && is_tame(&output.stdout),
            "{args:?}: {:?} {:?}",
            text(&output.stdout),
            text(&output.stderr)
        );
        assert_ne!(output.status.code(), Some(70), "{args:?}");
    }
}

/// Every output is what its format says, whatever a name or a text holds.
#[test]
fn outputs_stay_in_their_formats() {
    let folder = tempfile::tempdir().unwrap();
    let (good, bad) = (folder.path().join("good"), folder.path().join("bad"));
    [&good, &bad].iter().for_each(|path| fs::create_dir(path).unwrap());
    let name = "a\u{1}\"<b>&'|`]]>\n::error::%,\u{1b}.png";
    succeed_in(folder.path(), &[&["render", "elm", "-o", "a.png"], &SMALL[..]].concat());
    fs::copy(folder.path().join("a.png"), good.join(name)).unwrap();
    fs::write(bad.join(name), "no picture").unwrap();
    let output = lichtenberg()
        .current_dir(folder.path())
        .args(["compare", "good", "bad", "--junit", "r.xml", "--html", "r.html"])
        .env("GITHUB_ACTIONS", "true")
        .env("GITHUB_STEP_SUMMARY", "summary.md")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert_eq!(said.lines().filter(|line| line.starts_with("::")).count(), 1, "{said}");
    assert!(is_tame(&output.stdout));
    // Read by Python's parsers.
    let script = r#"
import html.parser, sys, xml.etree.ElementTree as tree
case = tree.parse("r.xml").getroot().find(".//testcase")
print(case.get("classname"), len(list(case)))
class Page(html.parser.HTMLParser):
    found = []
    def handle_starttag(self, tag, attrs): self.found.append(tag)
page = Page()
page.feed(open("r.html", encoding="utf-8").read())
print("b" in page.found)
table = [line for line in open("summary.md", encoding="utf-8").read().split("\n") if line.startswith("|")]
print(len(table))
"#;
    assert_eq!(openimageio(folder.path(), script, &[]), "pictures 1\nFalse\n3\n");
}

/// Every text and name of a scene stays what it is, as POV-Ray and parsers of other projects read it.
#[test]
fn texts_stay_in_their_places() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    let title = r#"title = "a\n*/ #error \"x\" <script>alert(1)</script> ]]> \u0001 &amp; %PNG\nWorldEnd\n\\""#;
    let evil = TWIG.replace("title = \"Twig\"", title).replace("twig", "x-_9");
    fs::write(folder.path().join("evil.toml"), evil).unwrap();
    for format in ["pov", "svg", "rib"] {
        succeed_in(folder.path(), &["export", "evil", "--to", format]);
    }
    let info = succeed_in(folder.path(), &["info", "evil", "--json"]);
    fs::write(folder.path().join("info.json"), info).unwrap();
    succeed_in(folder.path(), &["render", "evil", "--size", "32x32", "-o", "evil.png"]);
    let povray = Command::new("povray")
        .current_dir(folder.path())
        .args(["+Ievil.pov", "-D", "-GR", "-GS", "-GD", "+W16", "+H12", "+Oout.png"])
        .output()
        .unwrap();
    assert!(povray.status.success(), "{}", text(&povray.stderr));
    let rib = fs::read_to_string(folder.path().join("evil.rib")).unwrap();
    assert_eq!(rib.lines().filter(|line| line.trim() == "WorldEnd").count(), 1, "{rib}");
    let script = r#"
import json, xml.etree.ElementTree as tree
import OpenImageIO as oiio
print(json.load(open("info.json"))["title"].startswith("a\n*/"))
print([e.tag for e in tree.parse("evil.svg").getroot().iter() if "script" in e.tag])
print(oiio.ImageInput.open("evil.png").spec().getattribute("ImageDescription") is not False)
"#;
    assert_eq!(openimageio(folder.path(), script, &[]), "True\n[]\nTrue\n");
}

#[test]
fn results_go_to_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let render = [&["render", "elm", "-o"], &SMALL[..], &["-"]].concat();
    // Options have their values before what is written where.
    let render: Vec<&str> =
        render.iter().copied().filter(|arg| *arg != "-o" && *arg != "-").chain(["-o", "-"]).collect();
    let picture = run_in(folder.path(), &render);
    assert!(picture.status.success(), "{}", text(&picture.stderr));
    let to_file: Vec<&str> = render[..render.len() - 1].iter().copied().chain(["a.png"]).collect();
    succeed_in(folder.path(), &to_file);
    let file = fs::read(folder.path().join("a.png")).unwrap();
    assert!(picture.stdout == file);
    for (format, start, end) in [("svg", "<", "</svg>\n"), ("ply", "ply\n", "\n")] {
        let scene = if format == "ply" { "broken-vase" } else { "elm" };
        let said = succeed_in(folder.path(), &["export", scene, "--to", format, "-o", "-"]);
        assert!(said.starts_with(start) && said.ends_with(end), "{format}");
    }
    let struck = run_in(folder.path(), &["strike", "a.png", "--to", "0.5,0.6", "-o", "-"]);
    assert!(struck.status.success() && struck.stdout.starts_with(b"\x89PNG"));
    for args in [
        &["render", "elm", "--seeds", "1-2", "-o", "-"][..],
        &["render", "elm", "--json", "-o", "-"],
        &["export", "elm", "--to", "pov", "-o", "-"],
        &["compare", "a.png", "a.png", "--html", "-"],
    ] {
        assert_eq!(run_in(folder.path(), args).status.code(), Some(2), "{args:?}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no file is called -");
}

#[test]
fn confined_scenes_stay_in_their_folder() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("mine")).unwrap();
    fs::create_dir_all(at("shared")).unwrap();
    succeed_in(&at("mine"), &["new", "painted-leaf"]);
    let scene = fs::read_to_string(at("mine/painted-leaf.toml")).unwrap();
    let map = "assets/painted-leaf.png";
    fs::copy(at("mine").join(map), at("shared/map.png")).unwrap();
    symlink(at("shared/map.png"), at("mine/link.png")).unwrap();
    let with = |name: &str, path: &str| fs::write(at("mine").join(name), scene.replace(map, path)).unwrap();
    with("own.toml", map);
    with("up.toml", "../shared/map.png");
    with("link.toml", "link.png");
    with("far.toml", at("shared/map.png").to_str().unwrap());
    fs::write(at("mine/include.toml"), "include = \"/etc/passwd\"\n").unwrap();
    let check = |name: &str, more: &[&str]| {
        let output = run_in(folder.path(), &[&["check", name], more].concat());
        (output.status.code() == Some(0), text(&output.stderr))
    };
    for name in ["own", "up", "link", "far"].map(|name| format!("mine/{name}.toml")) {
        assert!(check(&name, &[]).0, "{name}");
        let (is_good, said) = check(&name, &["--confined"]);
        assert_eq!(is_good, name.contains("own"), "{name}: {said}");
        assert!(is_good || said.contains("outside the folders that this scene may read"), "{said}");
        assert!(check(&name, &["--confined", "--allow", "shared"]).0, "{name}");
    }
    let (_, said) = check("mine/include.toml", &["--confined"]);
    assert!(said.contains("outside the folders") && !said.contains("root:"), "{said}");
    // An embedded scene reads what comes with it.
    assert!(check("painted-leaf", &["--confined"]).0);
    // SVG names files of its own: they are not opened, a device would never end.
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="9" height="9"><image xlink:href="/dev/zero" width="9" height="9"/><path d="M0 0L9 9L0 9Z"/></svg>"#;
    succeed_in(&at("mine"), &["new", "vine"]);
    fs::write(at("mine/assets/vine.svg"), svg).unwrap();
    let _ = check("mine/vine.toml", &["--max-seconds", "20"]);
}

/// A terminal that never answers, by `script` of util-linux.
#[test]
fn silent_terminals_are_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let render = format!("{} render cactus --size 32x32 --samples 1 -o a.png", env!("CARGO_BIN_EXE_lichtenberg"));
    let mut child = Command::new("timeout")
        .args(["60", "script", "-qec", &format!("stty cols 80 rows 24; {render} --show; stty -a"), "/dev/null"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // Nothing is typed, nor is there an end of it.
    let silent = child.stdin.take();
    let output = child.wait_with_output().unwrap();
    drop(silent);
    assert!(output.status.success(), "{:?} {}", output.status, text(&output.stdout));
    assert!(text(&output.stdout).contains('\u{2584}'), "half blocks: {}", text(&output.stdout));
    // The terminal shows what is typed, as before.
    assert!(text(&output.stdout).contains(" icanon") && text(&output.stdout).contains(" echo "));
}
