//! The bodies of RIB objects: limbs and polygon meshes, streamed.

use std::io::{self, Write};

use super::buffer::BUFFER;
use super::decimal::{plain_number as number, push_plain as push_number};
use super::identifier::plain;
use super::rib_limbs::write_limbs;
use super::rib_options::{RibOptions, RibShadows};
use super::rib_surface::surface;
use super::rib_text::{MATRIX, triple};
use crate::math::DVec3;
use crate::model::{Body, Digits, Instance, Material, Mesh, Object, Pose};

/// Triangles of one `PointsPolygons`: renderers take a mesh whole.
const MOST_TRIANGLES: usize = 200_000;

/// Writes `object` with its surface, wherever it stands; where that is in several places or it has poses, as a retained object
/// named by `handle`.
pub(super) fn write_object(
    object: &Object,
    material: &Material,
    handle: u32,
    options: RibOptions,
    out: &mut impl Write,
) -> io::Result<()> {
    writeln!(out, "AttributeBegin\nAttribute \"identifier\" \"string name\" [\"{}\"]", plain(&object.name))?;
    writeln!(out, "{}", surface(object, material))?;
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
    let poses = object.body.poses();
    if object.instances == [Instance::at(object.instances[0].at)] && poses.is_empty() {
        write_primitives(object, material, object.instances[0].at, out)?;
        return writeln!(out, "AttributeEnd");
    }
    writeln!(out, "ObjectBegin {handle}")?;
    write_primitives(object, material, DVec3::ZERO, out)?;
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
fn write_primitives(object: &Object, material: &Material, offset: DVec3, out: &mut impl Write) -> io::Result<()> {
    match &object.body {
        Body::Limbs(limbs) => write_limbs(limbs, offset, object.digits, material, out),
        Body::Mesh(mesh) | Body::Posed(mesh, _) => {
            let mut pieces = mesh.triangles.chunks(MOST_TRIANGLES);
            pieces.try_for_each(|triangles| write_mesh(mesh, triangles, offset, object.digits, out))
        }
    }
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
