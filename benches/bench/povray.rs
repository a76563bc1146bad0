//! The preview beside the real povray: the same trees, the same rays (exact look, 1280 x 720, one sample a
//! pixel and the ten of the default), whole processes, the fastest of three runs each.
//!
//! `cargo bench -- povray`; needs povray. With numbers it renders the tree of so many segments with so many
//! samples itself, as one process: `cargo bench -- povray 100000 1`.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::trees::tree;
use lichtenberg::export::{Origin, Pov, Templates};
use lichtenberg::files::{Rgba, encode_png};
use lichtenberg::math::{Colour, DVec3, Progress, srgb_byte};
use lichtenberg::model::{Ball, Body, Camera, Digits, Light, Limbs, Look, Material, Model, Object, Projection, Sky};
use lichtenberg::trace::{RenderSettings, World, render};
use rayon::prelude::*;

const SIZE: [u32; 2] = [1280, 720];

fn model(count: usize) -> Model {
    let digits = Digits(5);
    let cones = tree(count);
    let ball = |centre: DVec3, radius: f64| Ball {
        centre: digits.round_point(centre),
        radius: digits.round(radius),
        cost: 0.0,
        branch: 0,
        level: 0,
    };
    let limbs = Limbs {
        balls: cones.iter().flat_map(|c| [ball(c.a, c.ra), ball(c.b, c.rb)]).collect(),
        segments: (0..count as u32).map(|i| [2 * i, 2 * i + 1]).collect(),
        ..Limbs::default()
    };
    Model {
        title: "Bench".to_owned(),
        is_flat: false,
        objects: vec![Object::new("tree", Body::Limbs(limbs), DVec3::ZERO, digits, 0)],
        materials: vec![("bark".to_owned(), Material::matt(Colour([0.5, 0.4, 0.3])))],
        camera: Camera {
            at: DVec3::new(0.0, -20.0, 6.0),
            look_at: DVec3::new(0.0, 0.0, 6.0),
            projection: Projection::Perspective { angle: 1.0 },
            aspect: f64::from(SIZE[0]) / f64::from(SIZE[1]),
            ..Camera::FRONT
        },
        lights: vec![Light::Sun {
            towards: DVec3::new(0.4, -0.5, 0.7).normalize(),
            colour: Colour([1.0; 3]),
            size: 0.0,
            shadow: true,
        }],
        ground: None,
        sky: Sky::plain(Colour([0.7, 0.8, 0.9])),
        air: None,
        look: Look::Studio,
        marks: Vec::new(),
        strokes: Vec::new(),
    }
}

/// What `render --look exact --samples 1` does, from the tree to the PNG.
fn ours(count: usize, samples: u32) {
    let model = model(count);
    let world = World::new(&model);
    let picture =
        render(&world, &RenderSettings::new(SIZE, Look::Exact, samples), &Progress::default()).expect("not cancelled");
    let pixel = |p: &[f32; 4]| [p[0], p[1], p[2], 1.0].map(|c| srgb_byte(f64::from(c)));
    let bytes = picture.pixels.par_iter().map(pixel).collect::<Vec<_>>().into_flattened();
    let picture = Rgba { width: SIZE[0], height: SIZE[1], bytes };
    encode_png(&picture, &[], fs::File::create("ours.png").expect("a file")).expect("written");
}

fn fastest(mut run: impl FnMut() -> Command) -> f64 {
    let times = (0..3).map(|_| {
        let mut command = run();
        let begun = Instant::now();
        let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status().expect("it starts");
        assert!(status.success());
        begun.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

pub fn run() {
    let numbers: Vec<u32> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    if let [count, samples] = numbers[..] {
        return ours(count as usize, samples);
    }
    let folder = tempfile::tempdir().expect("a folder");
    for count in [10_000, 100_000, 1_000_000] {
        let model = model(count);
        let templates = Templates::default();
        let pov = Pov::new(&model, &templates, "bench", SIZE, &Origin::default());
        pov.write_inc(fs::File::create(folder.path().join("bench.inc")).expect("a file")).expect("written");
        fs::write(folder.path().join("bench.pov"), pov.scene().expect("filled in")).expect("written");
        for samples in [1, 9] {
            let theirs = fastest(|| {
                let mut povray = Command::new("povray");
                povray.current_dir(folder.path()).args(["+Ibench.pov", "+Otheirs.png", "-D", "Declare=Bench_Exact=1"]);
                povray.args([format!("+W{}", SIZE[0]), format!("+H{}", SIZE[1])]);
                povray.args(if samples == 1 { &["-A"][..] } else { &["+A0.0", "+AM1", "+R3", "-J"] });
                povray
            });
            let own = fastest(|| {
                let mut program = Command::new(std::env::current_exe().expect("our own path"));
                program.current_dir(folder.path()).args(["povray".to_owned(), count.to_string(), samples.to_string()]);
                program
            });
            let ratio = theirs / own;
            println!("{count:>8} segments, {samples} samples: ours {own:.2} s, povray {theirs:.2} s, ratio {ratio:.1}");
        }
    }
}
