//! The bodies of RIB objects: spheres, hyperboloids and polygon meshes, streamed.

use std::io::{self, Write};

use super::buffer::{BUFFER, flush_at};
use super::decimal::{plain_number as number, push_plain as push_number};
use super::identifier::plain;
use super::rib_options::{RibOptions, RibShadows};
use super::rib_text::{MATRIX, triple};
use crate::geom::frustum;
use crate::math::DVec3;
use crate::model::{Body, Digits, Instance, Limbs, Mesh, Object, Pose};

/// Triangles of one `PointsPolygons`: renderers take a mesh whole.
const MOST_TRIANGLES: usize = 200_000;

/// Writes `object` with its surface, wherever it stands; where that is in several places or it has poses, as a retained object
/// named by `handle`.
pub(super) fn write_object(
    object: &Object,
    surface: &str,
    handle: u32,
    options: RibOptions,
    out: &mut impl Write,
) -> io::Result<()> {
    writeln!(out, "AttributeBegin\nAttribute \"identifier\" \"string name\" [\"{}\"]", plain(&object.name))?;
    writeln!(out, "{surface}")?;
    if !object.shadow && options.shadows == RibShadows::Rays {
        writeln!(out, "Attribute \"visibility\" \"int transmission\" [0]")?;
    }
    if let Some(thorns) = object.body.limbs().and_then(|limbs| limbs.thorns).filter(|_| options.displace) {
        let [height, radius, apart] = [thorns.length, thorns.radius, thorns.apart].map(|x| number(x, object.digits));
        writeln!(
            out,
            "Attribute \"displacementbound\" \"float sphere\" [{height}] \"string coordinatesystem\" [\"shader\"]"
        )?;
        writeln!(
            out,
            "Displacement \"thorns\" \"float height\" [{height}] \"float radius\" [{radius}] \"float apart\" [{apart}]"
        )?;
    }
    let poses: &[Pose] = if let Body::Posed(_, poses) = &object.body { poses } else { &[] };
    if object.instances.len() == 1 && poses.is_empty() {
        write_primitives(object, object.instances[0].at, out)?;
        return writeln!(out, "AttributeEnd");
    }
    writeln!(out, "ObjectBegin {handle}")?;
    write_primitives(object, DVec3::ZERO, out)?;
    writeln!(out, "ObjectEnd")?;
    let posed: Vec<Option<&Pose>> = if poses.is_empty() { vec![None] } else { poses.iter().map(Some).collect() };
    for place in &object.instances {
        for pose in &posed {
            writeln!(out, "TransformBegin\nConcatTransform [{}]", placed(place, *pose, object.digits))?;
            writeln!(out, "ObjectInstance {handle}\nTransformEnd")?;
        }
    }
    writeln!(out, "AttributeEnd")
}

/// The matrix of a place, and of a pose within it: row vectors.
fn placed(place: &Instance, pose: Option<&Pose>, digits: Digits) -> String {
    let put = |d: DVec3| place.turned(pose.map_or(d, |pose| pose.axes * d) * place.scale);
    let at = place.to_world(pose.map_or(DVec3::ZERO, |pose| pose.at));
    let rows = DVec3::AXES.map(|axis| format!("{} 0", triple(put(axis), MATRIX)));
    format!("{} {} 1", rows.join(" "), triple(at, digits))
}

/// Writes what an object is made of, moved by `offset`.
fn write_primitives(object: &Object, offset: DVec3, out: &mut impl Write) -> io::Result<()> {
    match &object.body {
        Body::Limbs(limbs) => write_limbs(limbs, offset, object.digits, out),
        Body::Mesh(mesh) | Body::Posed(mesh, _) => {
            let mut pieces = mesh.triangles.chunks(MOST_TRIANGLES);
            pieces.try_for_each(|triangles| write_mesh(mesh, triangles, offset, object.digits, out))
        }
    }
}

fn write_limbs(limbs: &Limbs, offset: DVec3, digits: Digits, out: &mut impl Write) -> io::Result<()> {
    let scale = digits.scale();
    let mut text: Vec<u8> = Vec::with_capacity(BUFFER + 512);
    let length = |text: &mut Vec<u8>, x: f64| {
        push_number(text, x, digits, scale);
        text.push(b' ');
    };
    for ball in &limbs.balls {
        if digits.round(ball.radius) <= 0.0 {
            continue;
        }
        text.extend_from_slice(b"TransformBegin Translate ");
        (ball.centre + offset).to_array().iter().for_each(|&c| length(&mut text, c));
        text.extend_from_slice(b"Sphere ");
        [ball.radius, -ball.radius, ball.radius].iter().for_each(|&c| length(&mut text, c));
        text.extend_from_slice(b"360 TransformEnd\n");
        flush_at(&mut text, out, BUFFER)?;
    }
    for &[a, b] in &limbs.segments {
        let (a, b) = (&limbs.balls[a as usize], &limbs.balls[b as usize]);
        let Some(f) = frustum(a.centre, a.radius, b.centre, b.radius) else { continue };
        let (ra, rb, long) = (digits.round(f.ra), digits.round(f.rb), digits.round((f.b - f.a).length()));
        if long <= 0.0 || (ra <= 0.0 && rb <= 0.0) {
            continue;
        }
        let Some(w) = (f.b - f.a).try_normalize() else { continue };
        // A whole cone has its apex at its far end.
        let (foot, w, ra, rb) = if ra <= 0.0 { (f.b, -w, rb, ra) } else { (f.a, w, ra, rb) };
        let u = w.any_orthonormal_vector();
        text.extend_from_slice(b"TransformBegin ConcatTransform [");
        for axis in [u, w.cross(u), w] {
            for c in axis.to_array() {
                push_number(&mut text, c, MATRIX, MATRIX.scale());
                text.push(b' ');
            }
            text.extend_from_slice(b"0 ");
        }
        (foot + offset).to_array().iter().for_each(|&c| length(&mut text, c));
        if rb > 0.0 {
            text.extend_from_slice(b"1] Hyperboloid ");
            [ra, 0.0, 0.0, rb, 0.0, long].iter().for_each(|&c| length(&mut text, c));
        } else {
            text.extend_from_slice(b"1] Cone ");
            [long, ra].iter().for_each(|&c| length(&mut text, c));
        }
        text.extend_from_slice(b"360 TransformEnd\n");
        flush_at(&mut text, out, BUFFER)?;
    }
    flush_at(&mut text, out, 1)
}

/// Writes some triangles of a mesh with the corners that they have.
fn write_mesh(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    offset: DVec3,
    digits: Digits,
    out: &mut impl Write,
) -> io::Result<()> {
    let mut renamed = vec![u32::MAX; mesh.points.len()];
    let mut used = Vec::new();
    for &corner in triangles.iter().flatten() {
        if renamed[corner as usize] == u32::MAX {
            renamed[corner as usize] = used.len() as u32;
            used.push(corner as usize);
        }
    }
    let mut text: Vec<u8> = Vec::with_capacity(BUFFER + 512);
    let mut list =
        |out: &mut dyn Write, head: &str, count: usize, item: &dyn Fn(&mut Vec<u8>, usize)| -> io::Result<()> {
            text.extend_from_slice(head.as_bytes());
            text.extend_from_slice(b" [");
            for i in 0..count {
                text.push(if i % 8 == 0 { b'\n' } else { b' ' });
                item(&mut text, i);
                if text.len() >= BUFFER {
                    out.write_all(&text)?;
                    text.clear();
                }
            }
            text.extend_from_slice(b"]\n");
            out.write_all(&text)?;
            text.clear();
            Ok(())
        };
    let vector = |text: &mut Vec<u8>, p: DVec3, digits: Digits| {
        for (i, c) in p.to_array().into_iter().enumerate() {
            if i > 0 {
                text.push(b' ');
            }
            push_number(text, c, digits, digits.scale());
        }
    };
    list(out, "PointsPolygons", triangles.len(), &|text, _| text.push(b'3'))?;
    list(out, "", triangles.len(), &|text, i| {
        // Clockwise faces the viewer.
        let [a, b, c] = triangles[i].map(|corner| renamed[corner as usize]);
        text.extend_from_slice(format!("{a} {c} {b}").as_bytes());
    })?;
    // Posed meshes are of unit size.
    let digits = if digits.0 < Pose::DIGITS && mesh.points.iter().all(|p| p.abs().max_element() <= 2.0) {
        Digits(Pose::DIGITS)
    } else {
        digits
    };
    list(out, "\"P\"", used.len(), &|text, i| vector(text, mesh.points[used[i]] + offset, digits))?;
    if !mesh.normals.is_empty() {
        list(out, "\"N\"", used.len(), &|text, i| vector(text, mesh.normals[used[i]], Digits(6)))?;
    }
    Ok(())
}
