//! Meshes for other programs: Wavefront OBJ and PLY, of models that are all triangles.

use std::io::{self, Write};

use super::decimal::plain_number;
use super::identifier::plain;
use crate::math::DVec3;
use crate::model::{Digits, Mesh, Model, Object};

/// Why a model is no mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoMesh {
    /// Something is made of spheres and cones.
    #[error("object `{0}` is made of spheres and cones: give it `skin = \"mesh\"`")]
    Cones(String),
    /// Copies are written out.
    #[error("{0} triangles, every copy counted, are more than {MOST_FACES}: export fewer copies")]
    TooMany(usize),
}

/// More triangles than this are refused: each takes about 200 bytes on its way.
const MOST_FACES: usize = 20_000_000;

/// A triangle's corners in the world, and their places in a texture, if there are any.
type Face = ([DVec3; 3], Option<[[f64; 2]; 3]>);

/// An object's name, the digits of its numbers, and its faces.
type Named<'a> = (&'a str, Digits, Vec<Face>);

/// All faces of each object, wherever it stands.
fn objects(model: &Model) -> Result<Vec<Named<'_>>, NoMesh> {
    let mut meshes = Vec::new();
    for object in &model.objects {
        let (mesh, poses) = object.body.mesh().ok_or_else(|| NoMesh::Cones(object.name.clone()))?;
        meshes.push((object, mesh, poses));
    }
    let faces =
        |(object, mesh, poses): &(&Object, &Mesh, Vec<_>)| mesh.triangles.len() * poses.len() * object.instances.len();
    let count: usize = meshes.iter().map(faces).sum();
    if count > MOST_FACES {
        return Err(NoMesh::TooMany(count));
    }
    let mut all = Vec::new();
    for (object, mesh, poses) in meshes {
        let mut faces: Vec<Face> = Vec::new();
        for place in &object.instances {
            for pose in &poses {
                for (i, triangle) in mesh.triangles.iter().enumerate() {
                    let corners = triangle.map(|corner| {
                        let p = mesh.points[corner as usize];
                        place.to_world(pose.map_or(p, |pose| pose.to_object(p)))
                    });
                    faces.push((corners, mesh.uvs.get(i).copied()));
                }
            }
        }
        all.push((object.name.as_str(), object.digits, faces));
    }
    Ok(all)
}

/// Writes a Wavefront OBJ: y up, as usual there, an object each, with texture coordinates where limbs have them. Corners in
/// one place are one, so that programs can smooth.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] around a [`NoMesh`], or what `out` says.
pub fn write_obj(model: &Model, mut out: impl Write) -> io::Result<()> {
    let objects = objects(model).map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
    writeln!(out, "# {}", plain(&model.title))?;
    let (mut corners, mut places) = (0, 0);
    for (name, digits, faces) in objects {
        writeln!(out, "o {name}")?;
        let mut known = std::collections::HashMap::new();
        let mut lines = Vec::new();
        for (points, uvs) in faces {
            let mut line = String::from("f");
            for (i, p) in points.into_iter().enumerate() {
                let p = digits.round_point(p);
                let index = match known.get(&p.to_array().map(f64::to_bits)) {
                    Some(&index) => index,
                    None => {
                        corners += 1;
                        let [x, y, z] = [p.x, p.z, -p.y].map(|c| plain_number(c, digits));
                        writeln!(out, "v {x} {y} {z}")?;
                        known.insert(p.to_array().map(f64::to_bits), corners);
                        corners
                    }
                };
                line.push_str(&format!(" {index}"));
                if let Some(uvs) = uvs {
                    places += 1;
                    let [u, v] = uvs[i].map(|x| plain_number(x, Digits(5)));
                    writeln!(out, "vt {u} {v}")?;
                    line.push_str(&format!("/{places}"));
                }
            }
            lines.push(line);
        }
        for line in lines {
            writeln!(out, "{line}")?;
        }
    }
    Ok(())
}

/// Writes a PLY in text: z up, all objects as one mesh, corners in one place joined.
///
/// # Errors
/// As [`write_obj`].
pub fn write_ply(model: &Model, mut out: impl Write) -> io::Result<()> {
    let objects = objects(model).map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
    let mut known = std::collections::HashMap::new();
    let mut points: Vec<(DVec3, Digits)> = Vec::new();
    let mut triangles: Vec<[usize; 3]> = Vec::new();
    for (_, digits, faces) in objects {
        for (corners, _) in faces {
            triangles.push(corners.map(|p| {
                let p = digits.round_point(p);
                *known.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
                    points.push((p, digits));
                    points.len() - 1
                })
            }));
        }
    }
    writeln!(out, "ply\nformat ascii 1.0\ncomment {}", plain(&model.title))?;
    writeln!(out, "element vertex {}", points.len())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    writeln!(out, "element face {}\nproperty list uchar int vertex_indices\nend_header", triangles.len())?;
    for (p, digits) in points {
        let [x, y, z] = p.to_array().map(|c| plain_number(c, digits));
        writeln!(out, "{x} {y} {z}")?;
    }
    for [a, b, c] in triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}
