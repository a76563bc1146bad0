//! `strike` from outside: photographs made and pictures read by OpenImageIO, bad plates, sequences, and a real storm.

use std::fs;
use std::path::Path;

use crate::support::{embedded, openimageio, run_in, succeed_in, text};
use lichtenberg::math::{Memory, Progress};
use lichtenberg::scene::grow;
use lichtenberg::skeleton::apart;

/// Leaves out what takes three quarters of the time on a small plate.
const QUICK: &str = "object.bolt.glow.near.strength=0";
/// Where Debian's `colord-data` has the profile.
const ADOBE_RGB: &str = "/usr/share/color/icc/colord/AdobeRGB1998.icc";
/// Where Debian's `mate-backgrounds` has a photograph of a storm.
const STORM: &str = "/usr/share/backgrounds/mate/nature/Storm.jpg";

/// Runs a script with OpenImageIO at hand; returns what it printed.
fn oiio(folder: &Path, script: &str) -> String {
    openimageio(folder, &format!("import OpenImageIO as oiio, numpy as np, sys\n{script}"), &[])
}

/// Writes a photograph: a gradient of `width` by `height`, brighter to the right and greener downwards.
fn plate(folder: &Path, name: &str, width: u32, height: u32, kind: &str, attributes: &str) {
    oiio(
        folder,
        &format!(
            r#"
w, h = {width}, {height}
y, x = np.mgrid[0:h, 0:w]
p = np.stack([0.1 + 0.3 * x / w, 0.1 + 0.2 * y / h, 0.2 + 0 * x], -1).astype(np.float32)
spec = oiio.ImageSpec(w, h, 3, oiio.{kind})
{attributes}
out = oiio.ImageOutput.create("{name}")
out.open("{name}", spec)
out.write_image(p)
out.close()
"#
        ),
    );
}

/// Values of a script's line of numbers.
fn numbers(said: &str) -> Vec<f64> {
    said.split_whitespace().map(|word| word.parse().unwrap_or_else(|_| panic!("{said}"))).collect()
}

#[test]
fn passes_add_up() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    plate(at, "p.exr", 120, 80, "FLOAT", "");
    succeed_in(at, &["strike", "p.exr", "--to", "40%,70%", "-o", "s.exr"]);
    succeed_in(at, &["strike", "p.exr", "--to", "40%,70%", "--split", "-o", "t.exr"]);
    let said = oiio(
        at,
        r#"
image = oiio.ImageBuf("s.exr"); plate = oiio.ImageBuf("p.exr").get_pixels(oiio.FLOAT)
names = image.spec().channelnames; p = image.get_pixels(oiio.FLOAT)
rgb = lambda prefix: np.stack([p[:, :, names.index(prefix + c)] for c in "RGB"], -1)
passes = ["core", "branches", "glow", "halo", "cloud"]
total = plate + sum(rgb(n + ".") for n in passes)
worst = (abs(total - rgb("")) / np.maximum(rgb(""), 1e-3)).max()
alphas = max(p[:, :, names.index(n + ".A")].max() for n in passes)
split = max(abs(oiio.ImageBuf("t." + n + ".exr").get_pixels(oiio.FLOAT)[:, :, :3] - rgb(n + ".")).max() for n in passes)
light = [rgb(n + ".").max() for n in passes]
print(worst, p[:, :, names.index("A")].min(), alphas, split, *light)
"#,
    );
    let found = numbers(&said);
    // Five passes of 11 bits each.
    assert!(found[0] < 0.004, "{said}");
    assert_eq!((found[1], found[2], found[3]), (1.0, 0.0, 0.0), "{said}");
    assert!(found[4] > 1.0 && found[5] > 0.3 && found[6..].iter().all(|&x| x > 0.001), "{said}");
}

#[test]
fn what_no_light_reaches_is_copied() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, kind) in [("a.png", "UINT8"), ("b.tif", "UINT16")] {
        plate(at, name, 90, 60, kind, "");
        fs::write(at.join("flat.py"), "").unwrap();
        oiio(
            at,
            "b = oiio.ImageBuf(oiio.ImageSpec(90, 60, 1, oiio.UINT8)); oiio.ImageBufAlgo.fill(b, (1.0,)); b.write('white.png')",
        );
        // No light, light that is held out everywhere, and light.
        succeed_in(at, &["strike", "--set", QUICK, name, "--to", "40%,70%", "--exposure", "-20", "-o", "dark.png"]);
        succeed_in(
            at,
            &["strike", "--set", QUICK, name, "--to", "40%,70%", "--matte", "white.png", "-o", "behind.png"],
        );
        succeed_in(at, &["strike", "--set", QUICK, name, "--to", "40%,70%", "-o", "lit.png"]);
        succeed_in(at, &["--threads", "1", "strike", "--set", QUICK, name, "--to", "40%,70%", "-o", "alone.png"]);
        let said = oiio(
            at,
            &format!(
                r#"
kind = oiio.{kind}
read = lambda n: oiio.ImageBuf(n).get_pixels(kind).astype(int)
p = read("{name}")
lit = read("lit.png")
print((read("dark.png") != p).sum(), (read("behind.png") != p).sum(), (lit != p).any(-1).sum(), (lit < p - 1).sum(), oiio.ImageBuf("lit.png").spec().format == kind)
"#
            ),
        );
        let words: Vec<&str> = said.split_whitespace().collect();
        assert_eq!((words[0], words[1], words[3], words[4]), ("0", "0", "0", "True"), "{said}");
        assert!(words[2].parse::<u32>().unwrap() > 100, "{said}");
        assert_eq!(fs::read(at.join("lit.png")).unwrap(), fs::read(at.join("alone.png")).unwrap());
    }
}

/// Every format, made by others, is struck.
#[test]
fn formats_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, kind) in [("a.jpg", "UINT8"), ("b.webp", "UINT8"), ("c.tif", "UINT8"), ("d.png", "UINT16")] {
        plate(at, name, 64, 48, kind, "");
        succeed_in(at, &["strike", "--set", QUICK, name, "--to", "50%,60%", "-o", "o.png"]);
        let said =
            oiio(at, "o = oiio.ImageBuf('o.png').get_pixels(oiio.FLOAT); print(o.shape[1], o.shape[0], o[0, 0, 2])");
        let found = numbers(&said);
        assert_eq!((found[0], found[1]), (64.0, 48.0), "{name}");
        assert!(found[2] > 0.18, "{name}: {said}");
    }
}

#[test]
fn photographs_are_turned_as_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // Lies on its left side: its top row is the right-hand column of what is meant.
    plate(
        at,
        "turned.jpg",
        80,
        120,
        "UINT8",
        "spec.attribute('Orientation', 6); spec.attribute('CompressionQuality', 100)",
    );
    succeed_in(at, &["strike", "--set", QUICK, "turned.jpg", "--to", "50%,60%", "--exposure", "-20", "-o", "o.png"]);
    let said = oiio(
        at,
        r#"
o = oiio.ImageBuf("o.png").get_pixels(oiio.FLOAT); p = oiio.ImageBuf("turned.jpg").get_pixels(oiio.FLOAT)
print(o.shape[1], o.shape[0], abs(o - np.rot90(p, -1)).max())
"#,
    );
    let found = numbers(&said);
    assert_eq!((found[0], found[1]), (120.0, 80.0));
    assert!(found[2] < 0.02, "{said}");
}

/// What a profile says of colours, against its definition computed here.
#[test]
fn profiles_are_kept_and_understood() {
    assert!(Path::new(ADOBE_RGB).exists(), "these tests need Debian's colord-data: run ./run-tests");
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let attribute = format!(
        "spec.attribute('ICCProfile', oiio.TypeDesc('uint8[%d]' % len(open('{ADOBE_RGB}','rb').read())), np.frombuffer(open('{ADOBE_RGB}','rb').read(), np.uint8))"
    );
    plate(at, "adobe.png", 64, 48, "UINT16", &attribute);
    succeed_in(
        at,
        &[
            "strike",
            "--set",
            QUICK,
            "adobe.png",
            "--to",
            "50%,60%",
            "--exposure",
            "-20",
            "-o",
            "dark.png",
            "-o",
            "dark.exr",
        ],
    );
    let said = oiio(
        at,
        &format!(
            r#"
p = oiio.ImageBuf("adobe.png").get_pixels(oiio.FLOAT).astype(float)
linear = p ** (563 / 256)
# Adobe RGB (1998) and Rec. 709 share red, blue and white: only green differs.
def matrix(xy):
    m = np.array([[x / y, 1, (1 - x - y) / y] for x, y in xy]).T
    white = np.array([0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290])
    return m * np.linalg.solve(m, white)
adobe = matrix([(0.64, 0.33), (0.21, 0.71), (0.15, 0.06)])
rec709 = matrix([(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)])
expected = linear @ (np.linalg.inv(rec709) @ adobe).T
found = oiio.ImageBuf("dark.exr").get_pixels(oiio.FLOAT)
names = oiio.ImageBuf("dark.exr").spec().channelnames
found = np.stack([found[:, :, names.index(c)] for c in "RGB"], -1)
kept = oiio.ImageBuf("dark.png").spec().getattribute("ICCProfile")
kept = len(np.asarray(kept)) if kept is not None else 0
print(abs(found - expected).max(), kept == len(open("{ADOBE_RGB}", "rb").read()))
"#
        ),
    );
    let words: Vec<&str> = said.split_whitespace().collect();
    assert!(words[0].parse::<f64>().unwrap() < 2e-3 && words[1] == "True", "{said}");
}

/// A stroke ends where it is told, and in the same way at any size.
#[test]
fn strokes_do_not_depend_on_the_size() {
    let bolt = |size: &str| {
        let scene = embedded("storm", &[("size", size)]);
        let grown = grow(&scene, &[], &Memory::new(1 << 30), &Progress::default()).unwrap();
        grown.into_iter().find(|step| step.name == "bolt").unwrap().skeleton
    };
    let (small, large) = (bolt("[960, 640]"), bolt("[3840, 2560]"));
    assert!(large.nodes.len() > small.nodes.len() * 2);
    // In heights of the picture.
    for distance in [apart(&small, &large), apart(&large, &small)] {
        assert!(distance < 0.005, "{distance}");
    }
    for skeleton in [small, large] {
        let end = skeleton.nodes[skeleton.paths[0].end as usize].position;
        assert_eq!((end.x, end.y), (0.7, 0.1));
    }
}

#[test]
fn windows_of_openexr_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let window = "spec.x, spec.y = -8, 4; spec.full_x, spec.full_y, spec.full_width, spec.full_height = 0, 0, 64, 48\n\
         spec.attribute('chromaticities', oiio.TypeDesc('float[8]'), [0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767])";
    plate(at, "w.exr", 80, 40, "HALF", window);
    succeed_in(at, &["strike", "--set", QUICK, "w.exr", "--to", "32,40px", "-o", "o.exr"]);
    let said = oiio(
        at,
        r#"
s = oiio.ImageBuf("o.exr").spec()
print(s.x, s.y, s.width, s.height, s.full_x, s.full_y, s.full_width, s.full_height, *s.getattribute("chromaticities"))
image = oiio.ImageBuf("o.exr"); p = image.get_pixels(oiio.FLOAT)
core = p[:, :, s.channelnames.index("core.R")]
print(*[int(v.max()) for v in np.nonzero(core > 0.3)], *[int(v.min()) for v in np.nonzero(core > 0.3)])
"#,
    );
    let lines: Vec<&str> = said.lines().collect();
    let head = numbers(lines[0]);
    assert_eq!(&head[..8], [-8.0, 4.0, 80.0, 40.0, 0.0, 0.0, 64.0, 48.0]);
    assert!((head[8] - 0.713).abs() < 1e-6, "{said}");
    // It ends at row 40 of the whole picture, which is 36 of what is stored, in column 32 + 8.
    let found = numbers(lines[1]);
    assert!((34.0..=38.0).contains(&found[0]) && found[1] >= 39.0 && found[3] <= 41.0, "{said}");
    // Photographs may come with the program.
    succeed_in(
        at,
        &[
            "strike",
            "skies/dusk-launch-pad.jpg",
            "--to",
            "447,125px",
            "--matte",
            "skies/dusk-launch-pad-matte.png",
            "-o",
            "m.exr",
        ],
    );
    let said = oiio(
        at,
        "i = oiio.ImageBuf('m.exr'); n = i.spec().channelnames; p = i.get_pixels(oiio.FLOAT); m = p[:, :, n.index('matte')]; print(m[300, 320], m[20, 400], round(float(p[:, :, n.index('core.R')][m > 0.9999].max()), 4))",
    );
    assert_eq!(numbers(&said), [1.0, 0.0, 0.0]);
    // Told otherwise, it is.
    succeed_in(at, &["strike", "--set", QUICK, "w.exr", "--to", "32,40px", "--plate-space", "rec709", "-o", "r.exr"]);
    let said = oiio(at, "print(*oiio.ImageBuf('r.exr').spec().getattribute('chromaticities'))");
    assert!(said.starts_with("0.63"), "{said}");
}

#[test]
fn sequences_flash_and_follow() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for frame in 1001..=1005 {
        plate(at, &format!("p.{frame}.exr"), 96, 64, "FLOAT", "");
    }
    fs::write(at.join("track.csv"), "frame,x,y\n1001,30%,70%\n1005,50%,70%\n").unwrap();
    fs::write(at.join("light.csv"), "1001,1\n1004,1\n1005,0\n").unwrap();
    let call = ["strike", "--set", QUICK, "p.####.exr", "--frames", "1001-1005", "--strike-at", "1002"];
    let more = ["--track", "track.csv", "--intensity", "light.csv", "-o", "o.####.exr"];
    let said = succeed_in(at, &[&call[..], &more].concat());
    assert_eq!(said.lines().count(), 5);
    let said = oiio(
        at,
        r#"
def core(frame):
    image = oiio.ImageBuf("o.%d.exr" % frame)
    names = image.spec().channelnames
    p = image.get_pixels(oiio.FLOAT)
    return p[:, :, names.index("core.R")]
for frame in range(1001, 1006):
    c = core(frame)
    column = (c[40] * np.arange(96)).sum() / max(c[40].sum(), 1e-9)
    print(c.max(), column)
"#,
    );
    let rows: Vec<Vec<f64>> = said.lines().map(numbers).collect();
    assert_eq!((rows[0][0], rows[4][0]), (0.0, 0.0), "before the strike, and put out: {said}");
    assert!(rows[1][0] > 4.0 * rows[3][0] * 0.9 && rows[3][0] > 0.0, "it flickers: {said}");
    // A twentieth of the width a frame: the stroke moves as a whole.
    assert!((rows[2][1] - rows[1][1] - 4.8).abs() < 0.1 && (rows[3][1] - rows[2][1] - 4.8).abs() < 0.1, "{said}");

    fs::remove_file(at.join("p.1003.exr")).unwrap();
    let output = run_in(at, &[&call[..], &["--to", "30%,70%", "-o", "gap.####.exr"]].concat());
    assert!(text(&output.stderr).contains("p.1003.exr is missing"));
    assert!(!at.join("gap.1001.exr").exists());
}

#[test]
fn bad_plates_get_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    plate(at, "good.png", 64, 48, "UINT8", "");
    plate(at, "tiny.png", 1, 1, "UINT8", "");
    let good = fs::read(at.join("good.png")).unwrap();
    fs::write(at.join("cut.png"), &good[..good.len() / 2]).unwrap();
    let mut huge = Vec::new();
    drop(png::Encoder::new(&mut huge, 100_000, 100_000).write_header().unwrap());
    fs::write(at.join("huge.png"), huge).unwrap();
    // A baseline JPEG's header with four components.
    let cmyk = [0xff, 0xd8, 0xff, 0xc0, 0, 20, 8, 0, 64, 0, 64, 4, 1, 17, 0, 2, 17, 0, 3, 17, 0, 4, 17, 0, 0xff, 0xd9];
    fs::write(at.join("inks.jpg"), cmyk).unwrap();
    let mut animated = Vec::new();
    let mut encoder = png::Encoder::new(&mut animated, 32, 32);
    encoder.set_animated(2, 0).unwrap();
    let mut writer = encoder.write_header().unwrap();
    (0..2).for_each(|_| writer.write_image_data(&[0; 32 * 32]).unwrap());
    writer.finish().unwrap();
    fs::write(at.join("moves.png"), animated).unwrap();
    let mut clear = Vec::new();
    let mut encoder = png::Encoder::new(&mut clear, 32, 32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(&[100; 32 * 32 * 4]).unwrap();
    fs::write(at.join("clear.png"), clear).unwrap();
    fs::write(at.join("words.jpg"), "no picture").unwrap();
    fs::create_dir(at.join("folder.png")).unwrap();

    let cases: [(&str, &[&str], &str); 19] = [
        ("cut.png", &[], "cannot be decoded"),
        ("tiny.png", &[], "1 by 1 pixels"),
        ("huge.png", &[], "cannot be decoded"),
        ("inks.jpg", &[], "CMYK"),
        ("moves.png", &[], "animated"),
        ("clear.png", &[], "transparent"),
        ("words.jpg", &[], "not a JPEG, PNG, TIFF, WebP or OpenEXR"),
        ("folder.png", &[], "cannot read"),
        ("none.png", &[], "none.png"),
        ("good.png", &["--to", "70,10px"], "outside the picture of 64 by 48"),
        ("good.png", &["--matte", "tiny.png"], "1 by 1 pixels, the photograph 64 by 48"),
        ("good.png", &["--horizon", "30%"], "below the horizon"),
        ("good.png", &["--scene", "elm"], "[view]"),
        ("good.png", &["--scene", "night-bolt", "--set", "grow.bolt.to.target=1"], "target"),
        ("good.png", &["--plate-space", "acescg"], "linear"),
        ("p.####.png", &[], "sequence"),
        ("good.png", &["--to", "30,10"], "did you mean 30,10px?"),
        ("good.png", &["--from", "50%,60%"], "the same place"),
        ("good.png", &["--set", "object.bolt.glow.near.grain=0.00005"], "coarser `grain`"),
    ];
    for (name, more, expected) in cases {
        let to: &[&str] = if more.first() == Some(&"--to") { &[] } else { &["--to", "50%,60%"] };
        let output = run_in(at, &[&["strike", name, "-o", "out.png"], to, more].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {said}");
        assert!(said.contains(expected), "{name}: {said}");
        assert!(said.matches("error:").count() <= 1 && !said.contains("internal error"), "{name}: {said}");
        assert!(!at.join("out.png").exists(), "{name}");
    }
}

/// A photograph as cameras make them, and candidates to choose from.
#[test]
fn a_real_storm_is_struck() {
    assert!(Path::new(STORM).exists(), "these tests need Debian's mate-backgrounds: run ./run-tests");
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    succeed_in(at, &["strike", STORM, "--to", "70%,60%", "--horizon", "63%", "-o", "s.png", "-o", "s.exr"]);
    let said = oiio(
        at,
        &format!(
            r#"
s = oiio.ImageBuf("s.png").get_pixels(oiio.UINT8).astype(int); p = oiio.ImageBuf("{STORM}").get_pixels(oiio.UINT8).astype(int)
image = oiio.ImageBuf("s.exr"); names = image.spec().channelnames; e = image.get_pixels(oiio.FLOAT)
light = e[:, :, names.index("core.G")] + e[:, :, names.index("branches.G")]
rows = np.nonzero(light.max(1) > 0.5)[0]
print(s.shape[1], s.shape[0], (s < p - 3).any(-1).mean(), (s > 250).all(-1).mean(), rows.max() / s.shape[0])
"#
        ),
    );
    let found = numbers(&said);
    assert_eq!((found[0], found[1]), (1920.0, 1280.0));
    // Light only adds; the channel is white; and nothing goes beyond the horizon, but for a pixel's softness.
    assert!(found[2] < 0.001 && found[3] > 0.0005 && found[3] < 0.05 && found[4] < 0.635, "{said}");
    succeed_in(at, &["strike", STORM, "--to", "0.7,0.6", "--seeds", "1-2", "--sheet", "sheet.png"]);
    assert!(at.join("sheet.png").exists() && !at.join("1.png").exists());
}

#[test]
fn animations_have_frames() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let said = succeed_in(at, &["render", "leader", "--size", "64x80", "--frames", "1-3"]);
    assert_eq!(said.lines().collect::<Vec<_>>(), ["leader_0001.png", "leader_0002.png", "leader_0003.png"]);
    // What has grown stays, and more comes.
    let at_frame = |until: &str| {
        let scene = embedded("leader", &[("object.lightning.until", until)]);
        let grown = grow(&scene, &[], &Memory::new(1 << 30), &Progress::default()).unwrap();
        lichtenberg::scene::model(&scene, &grown, scene.recipe.size, &Memory::default(), &Progress::default())
            .unwrap()
            .strokes[0]
            .pieces
            .clone()
    };
    let (young, old) = (at_frame("0.4"), at_frame("0.7"));
    let kept = young.iter().filter(|piece| old.contains(piece)).count();
    assert!(old.len() > young.len() && kept * 50 > young.len() * 49, "{kept} of {} stay", young.len());
    let wrong = run_in(at, &["render", "leader", "--frames", "1-2", "-o", "same.png"]);
    assert!(text(&wrong.stderr).contains("would be written twice"));
}
