//! RIB by an independent reading: what a renderer would rebuild from the files is what the model says.

use crate::support::rib::{Primitive, World, point, read};
use crate::support::{embedded, run_in, succeed_in, text};
use lichtenberg::export::{Origin, Rib, RibOptions, RibPart, RibShadows, Templates};
use lichtenberg::math::{DVec3, Memory, Progress};
use lichtenberg::model::{Body, Camera, Model, Object, Projection};
use lichtenberg::scene::{grow, model};

fn modelled(name: &str) -> Model {
    let scene = embedded(name, &[]);
    let grown = grow(&scene, &[], &Memory::new(8 << 30), &Progress::default()).unwrap();
    model(&scene, &grown, [160, 120], &Memory::default(), &Progress::default()).unwrap()
}

fn exported(model: &Model, options: RibOptions) -> (String, String) {
    let templates = Templates::default();
    let rib = Rib::new(model, &templates, "scene", [160, 120], &Origin::default(), options);
    let mut archive = Vec::new();
    rib.write_part(RibPart::Archive, &mut archive).unwrap();
    if rib.has_stage() {
        rib.write_part(RibPart::Stage, &mut archive).unwrap();
    }
    // The reader takes all archives as one.
    let scene = rib.scene().unwrap().replace("ReadArchive \"scene.stage.rib\"\n", "");
    (scene, String::from_utf8(archive).unwrap())
}

fn near(found: [f64; 3], expected: DVec3, size: f64) -> bool {
    (DVec3::from_array(found) - expected).abs().max_element() <= 1e-4 * size
}

/// The frustum tangent to two spheres, from the formula of the design.
fn tangent(a: DVec3, ra: f64, b: DVec3, rb: f64) -> Option<(DVec3, f64, DVec3, f64)> {
    let long = (b - a).length();
    let sin = (ra - rb) / long;
    if long == 0.0 || sin.abs() >= 1.0 {
        return None;
    }
    let (u, cos) = ((b - a) / long, (1.0 - sin * sin).sqrt());
    Some((a + u * ra * sin, ra * cos, b + u * rb * sin, rb * cos))
}

/// Everything of `object`, place by place, is what was read.
fn check_object(object: &Object, found: &[Primitive], scene: &str) {
    let name = format!("{scene}: {}", object.name);
    let bounds = object.bounds();
    let size = bounds.size().max_element().max(bounds.max.abs().max_element());
    let smallest = 1.0 / object.digits.scale();
    let mut found = found.iter().peekable();
    for place in &object.instances {
        let limbs = object.body.limbs().cloned().unwrap_or_default();
        for ball in &limbs.balls {
            // No renderer takes a radius that is 0 as written.
            if ball.radius < smallest * 0.5 {
                continue;
            }
            let (centre, radius) = (place.to_world(ball.centre), ball.radius * place.scale);
            let Some(Primitive::Sphere { centre: c, radius: r }) = found.next() else { panic!("{name}: no sphere") };
            assert!(near(*c, centre, size) && (r - radius).abs() <= 1e-4 * size, "{name}: {c:?} {r} {centre} {radius}");
        }
        for &[a, b] in &limbs.segments {
            let (a, b) = (&limbs.balls[a as usize], &limbs.balls[b as usize]);
            let Some((fa, ra, fb, rb)) = tangent(a.centre, a.radius, b.centre, b.radius) else { continue };
            // What is shorter or thinner than a digit may be left out.
            let is_tiny = (fb - fa).length() < smallest || ra.max(rb) < smallest;
            if is_tiny && !matches!(found.peek(), Some(Primitive::Frustum { .. })) {
                continue;
            }
            let Some(Primitive::Frustum { a: pa, ra: qa, b: pb, rb: qb }) = found.peek() else {
                panic!("{name}: no frustum")
            };
            let (fa, fb) = (place.to_world(fa), place.to_world(fb));
            let matches = |pa: &[f64; 3], qa: f64, pb: &[f64; 3], qb: f64| {
                near(*pa, fa, size)
                    && near(*pb, fb, size)
                    && (qa - ra * place.scale).abs() <= 1e-4 * size
                    && (qb - rb * place.scale).abs() <= 1e-4 * size
            };
            // A cone begins at its wide end.
            let is_it = matches(pa, *qa, pb, *qb) || (*qb == 0.0 && matches(pb, *qb, pa, *qa));
            if is_tiny && !is_it {
                continue;
            }
            assert!(is_it, "{name}: {pa:?} {qa} {pb:?} {qb}, not {fa} {ra} {fb} {rb}");
            found.next();
        }
        let Some((mesh, poses)) = object.body.mesh() else { continue };
        for pose in poses {
            let put = |p: DVec3| place.to_world(pose.map_or(p, |pose| pose.at + pose.axes * p));
            let mut triangles = mesh.triangles.iter();
            while triangles.len() > 0 {
                let Some(Primitive::Polygons { points, normals, faces }) = found.next() else {
                    panic!("{name}: no mesh")
                };
                for face in faces {
                    let [a, b, c] =
                        triangles.next().unwrap_or_else(|| panic!("{name}: too many triangles")).map(|i| i as usize);
                    let wanted = [a, c, b];
                    assert_eq!(face.len(), 3);
                    for (&i, &corner) in face.iter().zip(&wanted) {
                        assert!(near(points[i], put(mesh.points[corner]), size), "{name}: corner {corner}");
                        if !normals.is_empty() && pose.is_none() && place.turn == 0.0 && place.scale == 1.0 {
                            assert!(near(normals[i], mesh.normals[corner], 1.0), "{name}: normal {corner}");
                        }
                    }
                    // Clockwise from outside, where normals tell it.
                }
            }
        }
    }
    assert!(found.next().is_none(), "{name}: more than the model has");
}

/// Where the camera of the file puts a point, as fractions of the picture from the top left.
fn projected(world: &World, p: DVec3) -> [f64; 2] {
    let [x, y, z] = point(&world.camera, p.to_array());
    let [width, height] = world.format;
    if world.projection == "orthographic" {
        let w = &world.window;
        return [(x - w[0]) / (w[1] - w[0]), 1.0 - (y - w[2]) / (w[3] - w[2])];
    }
    // The angle is that across the shorter side.
    let tan = libm::tan(world.fov.to_radians() * 0.5);
    let shorter = width.min(height);
    [0.5 + x / (z * tan) * 0.5 * shorter / width, 0.5 - y / (z * tan) * 0.5 * shorter / height]
}

fn check_camera(model: &Model, world: &World, scene: &str) {
    let camera: &Camera = &model.camera;
    let mut seen = 0;
    for p in model.bounds().corners() {
        let Some(expected) = camera.project(p).filter(|at| at.depth > 0.0) else { continue };
        let [x, y] = projected(world, p);
        assert!((x - expected.x).abs() < 1e-4 && (y - expected.y).abs() < 1e-4, "{scene}: {x} {y}, not {expected:?}");
        let depth = point(&world.camera, p.to_array())[2];
        if matches!(camera.projection, Projection::Perspective { .. }) {
            assert!((depth - expected.depth).abs() < 1e-4 * expected.depth.max(1.0), "{scene}");
        }
        assert!(depth < world.clipping[1], "{scene}: {p} is beyond the far plane");
        seen += 1;
    }
    assert!(seen > 0, "{scene}: the camera sees nothing");
    // Nothing of sky or ground reaches behind the camera.
    for (name, .., primitives) in world.objects.iter().filter(|(name, ..)| SHEETS.contains(&name.as_str())) {
        for primitive in primitives {
            let Primitive::Polygons { points, .. } = primitive else { panic!("{name} is no sheet") };
            let is_front = |p: &[f64; 3]| {
                let z = point(&world.camera, *p)[2];
                z > world.clipping[0] && z < world.clipping[1]
            };
            assert!(points.iter().all(is_front), "{scene}: {name}");
        }
    }
}

/// What stands around the objects.
const SHEETS: [&str; 3] = ["sky", "haze", "ground"];

/// What a renderer would rebuild from the model's files is what the model says.
pub fn reads_back(model: &Model, name: &str) {
    let (scene, archive) = exported(model, RibOptions { shadows: RibShadows::None, ..RibOptions::default() });
    let world = read(&scene, &archive);
    check_camera(model, &world, name);
    let objects: Vec<_> = world.objects.iter().filter(|(found, ..)| !SHEETS.contains(&found.as_str())).collect();
    assert_eq!(objects.len(), model.objects.len(), "{name}");
    for (object, (.., surface, colour, primitives)) in model.objects.iter().zip(objects) {
        check_object(&before_camera(object, &scene, &world), primitives, name);
        let (_, material) = &model.materials[object.material];
        let laid = material.pattern.filter(|_| object.body.limbs().is_some());
        let expected = if let Some(pattern) = laid {
            pattern.figure().name()
        } else if material.diffuse == 0.0 && material.ambient == 0.0 {
            "constant"
        } else if material.through > 0.0 {
            "leaf"
        } else if material.specular.max(material.phong) > 0.0 {
            "plastic"
        } else {
            "matte"
        };
        assert_eq!(surface, expected, "{name}");
        if expected != "constant" {
            let shown = if laid.is_some() { material.colour } else { material.mean_colour() };
            assert!(near(*colour, DVec3::from_array(shown.0), 1.0), "{name}");
        }
    }
    // An ambient light of the renderer's own, then the scene's.
    assert_eq!(world.lights.len(), 1 + model.lights.len());
    for (light, found) in model.lights.iter().zip(&world.lights[1..]) {
        let value = |key: &str| DVec3::from_slice(&found.parameters[key]);
        assert!((value("color lightcolor") - DVec3::from_array(light.colour().0)).length() < 1e-5);
        if let lichtenberg::model::Light::Sun { towards, .. } = light {
            assert_eq!(found.shader, "distantlight");
            // As long as shadows reach, should they be traced.
            let ray = value("point from") - value("point to");
            assert!((ray.normalize() - *towards).length() < 1e-4 && ray.length() > model.bounds().size().length());
        }
    }
}

/// An object without what of scenery reaches behind what the camera sees.
fn before_camera(object: &Object, scene: &str, world: &World) -> Object {
    let mut object = object.clone();
    if !object.is_scenery {
        return object;
    }
    let near: f64 = scene.rsplit("Clipping ").next().unwrap().split(' ').next().unwrap().parse().unwrap();
    let is_seen = |p: DVec3, radius: f64| point(&world.camera, p.to_array())[2] - radius > near;
    let Body::Mesh(mesh) = &mut object.body else { panic!("scenery is a mesh") };
    if let [place] = object.instances[..] {
        mesh.triangles.retain(|t| t.iter().all(|&i| is_seen(place.to_world(mesh.points[i as usize]), 0.0)));
    } else {
        let radius = mesh.points.iter().map(|p| p.length()).fold(0.0, f64::max);
        object.instances.retain(|place| is_seen(place.at, radius * place.scale));
    }
    object
}

#[test]
fn shadows_and_displacement_are_told_apart() {
    let model = modelled("papers/2007-fig12");
    let (scene, archive) = exported(&model, RibOptions { displace: true, ..RibOptions::default() });
    assert!(scene.contains("MakeShadow \"scene-light") && scene.contains("\"shadowdistant\""));
    assert!(archive.contains("Displacement \"thorns\"") && archive.contains("\"displacementbound\" \"float sphere\""));
    let world = read(&scene, &archive);
    let thorns = model.objects.iter().filter(|object| object.body.limbs().is_some_and(|limbs| limbs.is_thorns)).count();
    assert!(thorns > 0);
    assert_eq!(world.objects.iter().filter(|o| !SHEETS.contains(&o.0.as_str())).count(), model.objects.len() - thorns);
    let (scene, _) = exported(&model, RibOptions { shadows: RibShadows::Rays, ..RibOptions::default() });
    assert!(scene.contains("\"raydistant\"") && scene.contains("\"int transmission\" [1]"));
}

/// What casts no shadow is not in what shadow maps show.
#[test]
fn shadow_maps_show_casters_alone() {
    let mut model = modelled("papers/2007-fig12");
    let maps = RibOptions::default();
    assert!(exported(&model, maps).0.matches("\"scene.archive.rib\"").count() >= 2);
    model.objects[0].shadow = false;
    let templates = Templates::default();
    let rib = Rib::new(&model, &templates, "scene", [160, 120], &Origin::default(), maps);
    let scene = rib.scene().unwrap();
    assert!(rib.has_casters() && scene.contains("\"scene.casters.rib\""));
    assert_eq!(scene.matches("\"scene.archive.rib\"").count(), 1);
    let mut casters = Vec::new();
    rib.write_part(RibPart::Casters, &mut casters).unwrap();
    let world = read(&scene, &text(&casters));
    assert!(world.objects.iter().all(|(name, ..)| *name != model.objects[0].name));
    assert!(world.objects.iter().any(|(name, ..)| *name == model.objects[1].name));
}

/// The files of the command: whole, packed or not, and left alone where they were edited.
#[test]
fn the_command_writes_scene_and_archive() {
    let folder = tempfile::tempdir().unwrap();
    let few = ["--set", "grow.elm.to.twigs.count=20"];
    let export = |extra: &[&str]| {
        let args = [&["export", "elm", "--to", "rib"], &few[..], extra].concat();
        succeed_in(folder.path(), &args)
    };
    assert_eq!(export(&[]), "./elm.archive.rib\n./elm.stage.rib\n./bark.sl\n./leaf.sl\n./elm.rib\n");
    let plain = std::fs::read(folder.path().join("elm.archive.rib")).unwrap();
    let scene = std::fs::read_to_string(folder.path().join("elm.rib")).unwrap();
    read(&scene, &text(&plain));
    export(&["--gzip"]);
    let packed = std::fs::read(folder.path().join("elm.archive.rib")).unwrap();
    assert!(packed.starts_with(&[0x1f, 0x8b]) && packed.len() * 2 < plain.len());
    let mut unpacked = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&packed[..]), &mut unpacked).unwrap();
    assert_eq!(unpacked, plain);
    std::fs::write(folder.path().join("elm.rib"), scene.replace("ShadingRate 0.5", "ShadingRate 1")).unwrap();
    assert_eq!(export(&[]), "./elm.archive.rib\n./elm.stage.rib\n./bark.sl\n./leaf.sl\n");
    let output = run_in(folder.path(), &["export", "elm", "--to", "pov", "--gzip"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--gzip is for RIB"));
}

/// Renderers are driven as they are: by a stand-in for what is not packaged, whose exit code lies as theirs do.
#[test]
fn a_renderer_that_speaks_has_failed() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let bin = folder.path().join("bin");
    std::fs::create_dir(&bin).unwrap();
    let run = |script: &str| {
        let path = bin.join("rndr");
        std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        let path = format!("{}:/usr/bin:/bin", bin.display());
        let mut command = crate::support::lichtenberg();
        command.current_dir(folder.path()).env("PATH", path);
        command
            .args(["render", "papers/2007-fig03", "--with", "pixie", "--size", "32x24", "-o", "out.png"])
            .output()
            .unwrap()
    };
    let output = run("echo 'scene.rib:3: unknown shader'; exit 0");
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("unknown shader"), "{}", text(&output.stderr));
    let output = run("exit 0");
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("no picture"));
    assert!(!folder.path().join("out.png").exists());
    // Without it, a hint.
    let output = crate::support::lichtenberg()
        .current_dir(folder.path())
        .env("PATH", "/nowhere")
        .args(["render", "papers/2007-fig03", "--with", "aqsis", "-o", "out.png"])
        .output()
        .unwrap();
    assert!(output.status.code() == Some(3) && text(&output.stderr).contains("export --to rib"));
}

/// With a level of detail fewer limbs are written, and none of those left out strays farther from what is written, in the picture,
/// than was allowed.
#[test]
fn detail_is_below_the_pixel() {
    let model = modelled("elm");
    let count = |archive: &str| archive.matches("TransformBegin").count();
    let whole = exported(&model, RibOptions::default()).1;
    for detail in [0.25, 2.0] {
        let (scene, archive) = exported(&model, RibOptions { detail, ..RibOptions::default() });
        assert!(count(&archive) < count(&whole), "nothing is left out");
        let world = read(&scene, &archive);
        let cones: Vec<_> = world.objects.iter().flat_map(|object| &object.3).filter_map(cone).collect();
        // Pixels of a unit at unit depth: the angle is across the shorter side.
        let pixels = 0.5 * world.format[1] / libm::tan(world.fov.to_radians() * 0.5);
        for ball in
            model.objects.iter().filter_map(|object| object.body.limbs()).flat_map(|limbs| &limbs.balls).step_by(96)
        {
            let depth = point(&world.camera, ball.centre.to_array())[2];
            let strays = cones.iter().map(|&(a, ra, b, rb)| {
                let along = ((ball.centre - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
                let (centre, radius) = (a + (b - a) * along, ra + (rb - ra) * along);
                centre.distance(ball.centre) + ball.radius - radius
            });
            let stray = strays.fold(f64::INFINITY, f64::min) * pixels / depth;
            assert!(stray <= detail + 0.01, "{stray} of {detail} pixels");
        }
    }
}

/// A sphere is a cone without length.
fn cone(primitive: &Primitive) -> Option<(DVec3, f64, DVec3, f64)> {
    match *primitive {
        Primitive::Sphere { centre, radius } => Some((centre.into(), radius, centre.into(), radius)),
        Primitive::Frustum { a, ra, b, rb } => Some((a.into(), ra, b.into(), rb)),
        Primitive::Polygons { .. } => None,
    }
}
