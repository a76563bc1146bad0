//! Writing POV-Ray: bytes a second for a million primitives.

use std::hint::black_box;
use std::io;

use crate::clock::median;
use lichtenberg::export::{Origin, Pov, Templates};
use lichtenberg::math::{Colour, DVec3, Stream};
use lichtenberg::model::{Ball, Body, Camera, CameraSpec, Digits, Limbs, Look, Material, Model, Object, Sky};
use rand::RngExt;

/// A chain of half a million balls that wanders through a box of 12 units, with a cone between each two.
fn million() -> Model {
    let digits = Digits::for_size(12.0);
    let mut stream = Stream::new(1, "million");
    let mut at = DVec3::ZERO;
    let balls: Vec<Ball> = (0..500_000)
        .map(|_| {
            let [x, y, z]: [f64; 3] = std::array::from_fn(|_| stream.random_range(-0.05..0.05));
            at = (at + DVec3::new(x, y, z)).clamp(DVec3::splat(-6.0), DVec3::splat(6.0));
            let radius = digits.round(stream.random_range(0.005..0.02));
            Ball { centre: digits.round_point(at), radius, cost: 0.0, branch: 0, level: 0 }
        })
        .collect();
    let segments = (1..balls.len() as u32).map(|i| [i - 1, i]).collect();
    let object =
        Object::new("chain", Body::Limbs(Limbs { balls, segments, ..Limbs::default() }), DVec3::ZERO, digits, 0);
    let grey = Colour([0.5; 3]);
    Model {
        title: "A million primitives".to_owned(),
        is_flat: false,
        objects: vec![object],
        materials: vec![("plain".to_owned(), Material::matt(grey))],
        camera: Camera::new(&CameraSpec::default(), 1.0, [(DVec3::ZERO, 6.0)].into_iter()).expect("a view"),
        lights: Vec::new(),
        ground: None,
        sky: Sky::plain(grey),
        air: None,
        look: Look::Studio,
        marks: Vec::new(),
        strokes: Vec::new(),
    }
}

pub fn run() {
    let model = million();
    let templates = Templates::default();
    let pov = Pov::new(&model, &templates, "million", [640, 480], &Origin::default());
    let mut text = Vec::new();
    pov.write_inc(&mut text).expect("nothing can fail");
    let seconds = median(|| black_box(&pov).write_inc(io::sink()).expect("nothing can fail"), 11);
    let rate = text.len() as f64 / seconds * 1e-6;
    println!("a million primitives to POV-Ray: {seconds:.3} s, {rate:.0} MB/s");
}
