//! Lenses: what is not in focus blurs by as much as optics say, here and in POV-Ray.

use std::fs;

use lichtenberg::files::decode_png;
use lichtenberg::math::from_srgb;

use crate::support::{require_povray, succeed_in};

/// A bright upright bar of 0.2 at 2.5 before a camera that is focused at 6 with a lens 0.5 wide.
const BAR: &str = r#"
title = "A bar"
look = "studio"
size = [240, 120]
camera = { at = [0, -6, 1], look_at = [0, 0, 1], angle = 40, aperture = 0.5 }
sky.colour = [0, 0, 0]
[light.sun]
sun = { from = [0, -1, 0], colour = [0, 0, 0] }
[material.lamp]
colour = [0.5, 0.5, 0.5]
ambient = 0
diffuse = 0
emission = 1
[space.air]
shape.box = { min = [-1, -1, -3], max = [1, 1, 3] }
nodes.lattice = { spacing = 0.5, neighbours = 6 }
[grow.bar]
space = "air"
from.at = [[0, 0, -3]]
to.tip = { at = [[0, 0, 3]] }
width.constant = 0.1
[object.bar]
grow = ["bar"]
at = [0, -3.5, 1]
material = "lamp"
"#;

/// The standard deviation across the picture of what shines in its middle row, in pixels.
fn spread(png: &[u8]) -> f64 {
    let picture = decode_png(png).unwrap();
    let row = picture.height as usize / 2 * picture.width as usize * 4;
    let light = |x: usize| from_srgb(f64::from(picture.bytes[row + x * 4]) / 255.0);
    let row: Vec<f64> = (0..picture.width as usize).map(light).collect();
    let total: f64 = row.iter().sum();
    let mean = row.iter().enumerate().map(|(x, light)| x as f64 * light).sum::<f64>() / total;
    libm::sqrt(
        row.iter().enumerate().map(|(x, light)| (x as f64 - mean) * (x as f64 - mean) * light).sum::<f64>() / total,
    )
}

/// A disc of diameter `d` has a standard deviation of `d / 4` along a line, a strip of width `w` one of `w / sqrt 12`; variances add.
#[test]
fn lenses_blur_as_in_optics() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bar.toml"), BAR).unwrap();
    let common = ["render", "bar.toml", "--look", "studio"];
    succeed_in(folder.path(), &[&common[..], &["--samples", "256", "-o", "ours.png"]].concat());
    succeed_in(folder.path(), &[&common[..], &["--samples", "9", "--with", "povray", "-o", "theirs.png"]].concat());
    succeed_in(
        folder.path(),
        &[&common[..], &["--samples", "64", "--set", "camera.aperture=0", "-o", "sharp.png"]].concat(),
    );
    // Pixels to a scene unit at the bar, and the circle of confusion of a thin lens focused at f: aperture |z - f| / f.
    let unit = 240.0 / (2.0 * 2.5 * libm::tan(20.0_f64.to_radians()));
    let (strip, circle) = (0.2 * unit, 0.5 * 3.5 / 6.0 * unit);
    let expected = libm::sqrt(strip * strip / 12.0 + circle * circle / 16.0);
    let [ours, theirs, sharp] =
        ["ours.png", "theirs.png", "sharp.png"].map(|name| spread(&fs::read(folder.path().join(name)).unwrap()));
    assert!((sharp / (strip / libm::sqrt(12.0)) - 1.0).abs() < 0.05, "sharp: {sharp}");
    assert!((ours / expected - 1.0).abs() < 0.05, "{ours} of {expected}");
    // Its samples end where it deems them enough.
    assert!((theirs / expected - 1.0).abs() < 0.08, "{theirs} of {expected}");
}

/// A stop doubles the light, in the preview and in POV-Ray, up to the rounding of 8 bits.
#[test]
fn a_stop_doubles_the_light() {
    require_povray();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bar.toml"), BAR).unwrap();
    let common =
        ["render", "bar.toml", "--look", "exact", "--samples", "1", "--set", "material.lamp.colour=[0.2,0.2,0.2]"];
    let light = |name: &str, extra: &[&str]| {
        succeed_in(folder.path(), &[&common[..], extra, &["-o", name]].concat());
        let picture = decode_png(&fs::read(folder.path().join(name)).unwrap()).unwrap();
        let row = &picture.bytes[60 * 240 * 4..61 * 240 * 4];
        from_srgb(f64::from(row.chunks(4).map(|p| p[0]).max().unwrap()) / 255.0)
    };
    for with in [&[][..], &["--with", "povray"]] {
        let plain = light("plain.png", with);
        let longer = light("longer.png", &[with, &["--set", "camera.exposure=1"]].concat());
        assert!((plain - 0.2).abs() < 4e-3 && (longer / plain - 2.0).abs() < 0.03, "{with:?}: {plain} {longer}");
    }
}
