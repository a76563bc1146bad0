//! Bad geometry through the tracer: nothing panics, hangs or takes all memory, and what can be seen is seen.

use std::time::{Duration, Instant};

use lichtenberg::bvh::{Cones, Ray, RoundCone, Triangle, Triangles};
use lichtenberg::math::{Colour, DVec3, Progress, Stream};
use lichtenberg::model::{Ball, Body, Camera, Digits, Ground, Light, Limbs, Material, Model, Object, Projection, Sky};
use lichtenberg::trace::{Look, RenderSettings, World, render};
use proptest::prelude::*;
use rand::RngExt;

fn ball(centre: [f64; 3], radius: f64) -> Ball {
    Ball { centre: DVec3::from_array(centre), radius, cost: 0.0, branch: 0, level: 0 }
}

/// A model of one object, seen from 10 units in front of the origin.
fn model(balls: Vec<Ball>, segments: Vec<[u32; 2]>) -> Model {
    Model {
        title: "bad".to_owned(),
        is_flat: false,
        objects: vec![Object::new(
            "it",
            Body::Limbs(Limbs { balls, segments, ..Limbs::default() }),
            DVec3::ZERO,
            Digits(5),
            0,
        )],
        materials: vec![("white".to_owned(), Material::matt(Colour([1.0; 3])))],
        camera: Camera {
            at: DVec3::new(0.0, -10.0, 0.0),
            look_at: DVec3::ZERO,
            projection: Projection::Perspective { angle: 0.8 },
            aspect: 1.0,
            ..Camera::FRONT
        },
        lights: vec![Light::Sun {
            towards: DVec3::new(0.0, -0.6, 0.8),
            colour: Colour([1.0; 3]),
            size: 0.05,
            shadow: true,
        }],
        ground: None,
        sky: Sky::plain(Colour([0.0; 3])),
        air: None,
        look: Look::Studio,
        marks: Vec::new(),
        strokes: Vec::new(),
    }
}

/// The share of a small picture that something covers, in both looks.
fn cover(model: &Model) -> f64 {
    let world = World::new(model);
    let shares = [Look::Exact, Look::Studio].map(|look| {
        let view = RenderSettings { transparent: true, data: true, ..RenderSettings::new([48, 48], look, 4) };
        let picture = render(&world, &view, &Progress::default()).unwrap();
        assert!(picture.pixels.iter().flatten().all(|x| x.is_finite()), "every pixel is a number");
        picture.pixels.iter().map(|p| f64::from(p[3])).sum::<f64>() / picture.pixels.len() as f64
    });
    assert!((shares[0] - shares[1]).abs() < 0.03, "{shares:?}");
    shares[0]
}

#[test]
fn an_empty_scene_is_sky() {
    assert_eq!(cover(&model(vec![], vec![])), 0.0);
    let mut none = model(vec![], vec![]);
    none.objects.clear();
    assert_eq!(cover(&none), 0.0);
    none.ground =
        Some(Ground { material: Material::matt(Colour([0.5; 3])), height: -1.0, reach: 100.0, radius: Some(5.0) });
    assert!(cover(&none) > 0.05);
}

#[test]
fn one_primitive_is_seen() {
    let share = cover(&model(vec![ball([0.0; 3], 1.0)], vec![]));
    // A sphere of radius 1 from 10: its outline's share of the view.
    let expected = std::f64::consts::PI * (1.0 / 99.0) / (4.0 * libm::tan(0.4) * libm::tan(0.4));
    assert!((share - expected).abs() < 0.01, "{share}, not {expected}");
}

#[test]
fn degenerate_cones_are_spheres_or_nothing() {
    // No length; one end within the other; both at once.
    let one = cover(&model(vec![ball([0.0; 3], 1.0)], vec![]));
    for (a, b) in [
        (ball([0.0; 3], 1.0), ball([0.0; 3], 1.0)),
        (ball([0.0; 3], 1.0), ball([0.2, 0.1, 0.0], 0.3)),
        (ball([0.0, 0.0, 1e-12], 1.0), ball([0.0; 3], 1.0)),
    ] {
        let share = cover(&model(vec![a, b], vec![[0, 1]]));
        assert!((share - one).abs() < 1e-3, "{share}, not {one}");
    }
    // What is no solid is left out.
    let bad = [(f64::NAN, 1.0), (0.0, 0.0), (0.0, -1.0), (f64::INFINITY, 1.0), (0.0, f64::NAN)];
    let cones = Cones::new(bad.len(), |i| {
        let (x, r) = bad[i];
        RoundCone { a: DVec3::new(x, 0.0, 0.0), ra: r, b: DVec3::X, rb: r }
    });
    assert!(cones.is_empty());
    assert!(cones.closest(&Ray::new(DVec3::new(0.0, -5.0, 0.0), DVec3::Y)).is_none());
    let flat = Triangles::new(1, |_| Triangle([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]));
    assert!(flat.is_empty());
}

#[test]
fn nested_spheres_show_the_outermost() {
    let n = 20_000;
    let nested: Vec<Ball> = (0..n).map(|i| ball([0.0; 3], 1e-4 + f64::from(i) / f64::from(n))).collect();
    let begun = Instant::now();
    let share = cover(&model(nested, vec![]));
    assert!(share > 0.02);
    assert!(begun.elapsed() < Duration::from_secs(60), "nested spheres take {:?}", begun.elapsed());
}

/// obvhs' clustering is quadratic there: 100,000 took minutes.
#[test]
fn identical_primitives_are_one() {
    let n = 300_000;
    let one = RoundCone { a: DVec3::ZERO, ra: 0.5, b: DVec3::Z, rb: 0.4 };
    let begun = Instant::now();
    let cones = Cones::new(n, |_| one);
    assert_eq!(cones.len(), 1);
    let hit = cones.closest(&Ray::new(DVec3::new(0.0, -5.0, 0.5), DVec3::Y)).unwrap();
    assert_eq!(hit.id, 0, "the first of them");
    // Equal boxes of different solids cannot be thinned out, but are built in time.
    let tilted = |i: usize| {
        let end = [DVec3::new(1.0, 1.0, 1.0), DVec3::new(-1.0, 1.0, 1.0)][i % 2];
        RoundCone { a: -end, ra: 0.01 + i as f64 * 1e-9, b: end, rb: 0.01 + i as f64 * 1e-9 }
    };
    assert!(Cones::new(n, tilted).closest(&Ray::new(DVec3::new(0.0, -5.0, 0.0), DVec3::Y)).is_some());
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
}

#[test]
fn a_camera_in_a_trunk_sees_its_inside() {
    let mut inside = model(vec![ball([0.0, -10.0, -2.0], 1.0), ball([0.0, -10.0, 2.0], 1.0)], vec![[0, 1]]);
    assert_eq!(cover(&inside), 1.0);
    let Body::Limbs(limbs) = &mut inside.objects[0].body else { unreachable!("it has limbs") };
    limbs.balls.push(ball([0.0; 3], 1.0));
    assert_eq!(cover(&inside), 1.0);
}

#[test]
fn tiny_and_huge_scenes_look_alike() {
    let shares = [1e-3, 1.0, 1e4].map(|scale| {
        let balls = vec![ball([0.0, 0.0, -scale], 0.5 * scale), ball([0.3 * scale, 0.0, scale], 0.3 * scale)];
        let mut model = model(balls, vec![[0, 1]]);
        model.camera.at *= scale;
        cover(&model)
    });
    assert!((shares[0] - shares[1]).abs() < 2e-3 && (shares[2] - shares[1]).abs() < 2e-3, "{shares:?}");
}

/// A random bush.
fn bush(n: usize, seed: u64) -> Vec<RoundCone> {
    let mut random = Stream::new(seed, "bush");
    let mut point = |size: f64| {
        DVec3::new(random.random_range(-size..size), random.random_range(-size..size), random.random_range(-size..size))
    };
    let mut cones = Vec::new();
    for i in 0..n {
        let (a, way) = (point(1.0), point(0.2));
        let r = 0.002 + 0.02 * ((i % 7) as f64 / 7.0);
        cones.push(RoundCone { a, ra: r, b: a + way, rb: r * 0.6 });
    }
    cones
}

#[test]
fn a_million_primitives_are_built_and_met() {
    let n = 1_000_000;
    let few = bush(1000, 1);
    // A thousand bushes.
    let cones = Cones::new(n, |i| {
        let offset = DVec3::new((i / 1000 % 10) as f64, (i / 10_000 % 10) as f64, (i / 100_000) as f64) * 3.0;
        let cone = few[i % 1000];
        RoundCone { a: cone.a + offset, b: cone.b + offset, ..cone }
    });
    assert_eq!(cones.len(), n);
    assert!(cones.bytes() < 100 << 20, "{} bytes", cones.bytes());
    let met = (0..1000).filter(|i| {
        let x = f64::from(i % 100) * 0.3;
        cones.closest(&Ray::new(DVec3::new(x, -5.0, f64::from(i / 100) * 3.0), DVec3::Y)).is_some()
    });
    assert!(met.count() > 100);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The tree finds what testing every primitive in double precision finds; the portable code finds the very same hits.
    #[test]
    fn the_tree_finds_what_there_is(n in 1_usize..400, seed in 0_u64..1000) {
        let all = bush(n, seed);
        let cones = Cones::new(n, |i| all[i]);
        let portable = Cones::with_level(fearless_simd::Level::baseline(), n, |i| all[i]);
        let mut random = Stream::new(seed, "rays");
        let mut wrong = 0;
        for _ in 0..200 {
            let z = random.random_range(-1.0..1.0_f64);
            let turn = random.random_range(0.0..std::f64::consts::TAU);
            let r = (1.0 - z * z).sqrt();
            let from = DVec3::new(r * libm::cos(turn), r * libm::sin(turn), z) * 4.0;
            let to = DVec3::new(random.random_range(-0.8..0.8), random.random_range(-0.8..0.8), random.random_range(-0.8..0.8));
            let ray = Ray::new(from, (to - from).normalize());
            let hit = cones.closest(&ray);
            prop_assert_eq!(hit, portable.closest(&ray));
            prop_assert_eq!(hit.is_some(), cones.is_blocked(&ray));
            prop_assert_eq!(cones.is_blocked(&ray), portable.is_blocked(&ray));
            let nearest = all.iter().filter_map(|c| c.enter(&ray)).map(|e| e.t).fold(f64::INFINITY, f64::min);
            let there = hit.map_or(f64::INFINITY, |h| h.t);
            // At silhouettes single precision may decide otherwise.
            wrong += u32::from(nearest != there && (nearest - there).abs() > 1e-4);
        }
        prop_assert!(wrong <= 1, "{wrong} of 200 rays");
    }

    /// A closed mesh lets no ray through, also not through its edges and corners.
    #[test]
    fn meshes_are_tight(seed in 0_u64..1000) {
        let mut random = Stream::new(seed, "mesh");
        let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) * 2.0 - 1.0;
        let faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]];
        let mesh = Triangles::new(12, |i| Triangle(faces[i].map(corner)));
        for k in 0..200 {
            let from = DVec3::new(random.random_range(-6.0..6.0), -7.0, random.random_range(-6.0..6.0));
            // At corners, along diagonals, and anywhere within.
            let to = match k % 3 {
                0 => corner(k % 8) * 0.999_999,
                1 => corner(0).lerp(corner(3), random.random_range(0.0..1.0)) * 0.999_999,
                _ => DVec3::new(random.random_range(-0.9..0.9), random.random_range(-0.9..0.9), random.random_range(-0.9..0.9)),
            };
            prop_assert!(mesh.closest(&Ray::new(from, (to - from).normalize())).is_some(), "{from} {to}");
        }
    }
}
