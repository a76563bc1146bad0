//! Limits of a call: time, bytes, memory.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use lichtenberg::files::{encode_exr, encode_png16};
use lichtenberg::math::Stream;
use lichtenberg::raster::{Channel, Layers};
use rand::RngExt;

use crate::support::sample::tests_all;
use crate::support::{lichtenberg, run_in, succeed_in, text};

#[test]
fn time_runs_out() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["render", "elm", "--size", "4000x3000", "--samples", "4096", "-o", "a.png"];
    let ended = run_in(folder.path(), &[&args[..], &["--max-seconds", "1"]].concat());
    assert_eq!(ended.status.code(), Some(124), "{}", text(&ended.stderr));
    assert!(text(&ended.stderr).contains("--max-seconds"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    succeed_in(folder.path(), &["list", "--max-seconds", "1000"]);
}

#[test]
fn files_stay_small() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["export", "elm", "--to", "pov", "-o", "out"];
    let refused = run_in(folder.path(), &[&args[..], &["--max-bytes", "10k"]].concat());
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    assert!(text(&refused.stderr).contains("--max-bytes"), "{}", text(&refused.stderr));
    assert_eq!(fs::read_dir(folder.path().join("out")).unwrap().count(), 0);
    succeed_in(folder.path(), &[&args[..], &["--max-bytes", "1G"]].concat());
}

#[test]
fn comparisons_fit_into_memory() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    succeed_in(folder.path(), &["render", "night-bolt", "--size", "700x500", "-o", "a/1.png"]);
    fs::create_dir(at("b")).unwrap();
    for name in ["a/2.png", "b/1.png", "b/2.png"] {
        fs::copy(at("a/1.png"), at(name)).unwrap();
    }
    let refused = run_in(folder.path(), &["compare", "a", "b", "--max-memory", "20M"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stdout).contains("more than the 20 MB allowed"), "{}", text(&refused.stdout));
    // One after the other.
    succeed_in(folder.path(), &["compare", "a", "b", "--max-memory", "60M"]);
}

/// Two pictures of six million pixels of noise, of 16 bits a sample, in 40 bytes a pixel: asked for and taken.
#[test]
fn a_pixel_is_compared_in_40_bytes() {
    if !tests_all() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (width, height) = (3000_u32, 2000_u32);
    let pixels = width as usize * height as usize;
    for (i, name) in ["a", "b"].into_iter().enumerate() {
        let mut random = Stream::new(i as u64, "noise");
        let values: Vec<u16> = (0..4 * pixels).map(|_| random.random()).collect();
        let mut png = Vec::new();
        encode_png16([width, height], &values, &[], &mut png).unwrap();
        fs::write(folder.path().join(format!("{name}.png")), png).unwrap();
        let channel = |(c, channel): (usize, &str)| Channel {
            name: channel.to_owned(),
            values: values.iter().skip(c).step_by(4).map(|&v| f32::from(v) / 65535.0).collect(),
            is_half: true,
        };
        let channels = ["A", "B", "G", "R"].into_iter().enumerate().map(channel).collect();
        let exr = encode_exr(&Layers { width, height, channels, ..Layers::default() }).unwrap();
        fs::write(folder.path().join(format!("{name}.exr")), exr).unwrap();
    }
    let limit = (40 * pixels).to_string();
    for [a, b] in [["a.png", "b.png"], ["a.exr", "b.exr"]] {
        let differ = run_in(folder.path(), &["compare", a, b, "--max-memory", &limit]);
        assert_eq!(differ.status.code(), Some(1), "{}{}", text(&differ.stdout), text(&differ.stderr));
    }
}

/// What no estimate knows - how much a file becomes that is read - ends when it takes too much.
#[cfg(target_os = "linux")]
#[test]
fn memory_is_held() {
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["new", "broken-vase"]);
    let faces = "f 1 2 3\n".repeat(6_000_000);
    fs::write(folder.path().join("assets/vase.obj"), format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}")).unwrap();
    let mut child = lichtenberg()
        .current_dir(folder.path())
        .args(["export", "broken-vase.toml", "--to", "pov", "--max-memory", "50M"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0_u64;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        peak = peak.max(kilobytes.unwrap_or(0));
        sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("more than the 52 MB of memory allowed"), "{}", text(&output.stderr));
    // What a scene takes within the time between two looks, at the pace of memory that is filled by two threads.
    assert!(peak > 50 << 10 && peak < 450 << 10, "{peak} kB");
}

/// What is known before it is made is refused before.
#[test]
fn what_is_too_large_is_not_begun() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let isosurface =
        ["export", "cactus", "--to", "obj", "--set", "object.cactus.skin={ isosurface = { spacing = 0.006 } }"];
    let thorns = [
        "export",
        "cactus",
        "--to",
        "pov",
        "--set",
        "object.cactus.thorns={ length = 0.1, radius = 0.01, apart = 0.003 }",
    ];
    let triangles = ["export", "forest", "--to", "ply"];
    let layers = ["render", "elm", "--size", "2000x2000", "--samples", "1", "-o", "a.exr"];
    for (call, limit) in [(&isosurface[..], "200M"), (&thorns, "200M"), (&triangles, "500M"), (&layers, "1G")] {
        let refused = run_in(at, &[call, &["--max-memory", limit]].concat());
        let said = text(&refused.stderr);
        assert!(refused.status.code() == Some(2) && said.contains("MB of memory, more than the"), "{call:?}: {said}");
        assert_eq!(fs::read_dir(at).unwrap().count(), 0);
    }
}

/// Others may leave half of a file: it is not taken for one that is done.
#[test]
fn half_a_file_is_not_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let render = ["render", "cactus", "--size", "64x48", "--samples", "1", "--skip-existing", "-o"];
    for (name, args) in [
        ("a.png", [&render[..], &["a.png"]].concat()),
        ("a.exr", [&render[..], &["a.exr"]].concat()),
        ("cactus.inc", vec!["export", "cactus", "--to", "pov", "--skip-existing"]),
        ("storm.svg", vec!["export", "storm", "--to", "svg", "--skip-existing"]),
    ] {
        assert!(!succeed_in(folder.path(), &args).is_empty());
        let whole = fs::read(at(name)).unwrap();
        assert!(succeed_in(folder.path(), &args).is_empty(), "{name} is there");
        for length in [0, whole.len() / 2, whole.len() - 1] {
            fs::write(at(name), &whole[..length]).unwrap();
            assert!(!succeed_in(folder.path(), &args).is_empty(), "{length} bytes of {name}");
            assert!(fs::read(at(name)).unwrap() == whole);
        }
    }
    // Nor is a folder one that was edited.
    fs::remove_file(at("cactus.pov")).unwrap();
    fs::create_dir(at("cactus.pov")).unwrap();
    let refused = run_in(folder.path(), &["export", "cactus", "--to", "pov"]);
    assert!(
        refused.status.code() == Some(2) && text(&refused.stderr).contains("cactus.pov"),
        "{}",
        text(&refused.stderr)
    );
}

/// A real disk without room, in a mount namespace of its own; `ulimit` stands for it on pushes.
#[test]
fn a_full_disk_keeps_the_old_file() {
    if !tests_all() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    succeed_in(folder.path(), &["render", "night-bolt", "--size", "640x480", "-o", "plate.png"]);
    let verbs = [
        ("x.png", "render night-bolt --size 640x480 -o disk/x.png"),
        ("x.exr", "render cactus --samples 1 -o disk/x.exr"),
        ("x.inc", "export elm --to pov -o disk --name x"),
        ("x.archive.rib", "export elm --to rib -o disk --name x"),
        ("x.png", "strike plate.png --to 0.5,0.6 -o disk/x.png"),
        ("x.html", "compare plate.png plate.png --html disk/x.html"),
    ];
    for (name, verb) in verbs {
        let program = env!("CARGO_BIN_EXE_lichtenberg");
        let script = format!(
            "mkdir -p disk && mount -t tmpfs -o size=64k none disk && echo old > disk/{name} && \
             {{ {program} {verb}; echo code $?; ls -A disk; cat disk/{name}; }}"
        );
        let output = Command::new("unshare").args(["-rm", "sh", "-c", &script]).current_dir(folder.path()).output();
        let output = output.expect("unshare (util-linux)");
        let said = text(&output.stdout);
        assert!(output.status.success(), "a namespace for a small disk is needed: {}", text(&output.stderr));
        assert!(said.ends_with(&format!("code 2\n{name}\nold\n")), "{verb}: {said} {}", text(&output.stderr));
        assert!(text(&output.stderr).contains("No space left"), "{verb}: {}", text(&output.stderr));
    }
}
