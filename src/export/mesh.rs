//! Meshes for other programs: Wavefront OBJ and PLY, of models that are all triangles.

use std::io::{self, Write};

use rustc_hash::FxHashMap;

use super::decimal::plain_number;
use super::identifier::plain;
use crate::math::DVec3;
use crate::model::{Digits, Mesh, Model, Object, Pose};

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

/// More triangles than this are refused.
const MOST_FACES: usize = 20_000_000;
/// Bytes of a corner in the table of those that are known, which is half empty at worst while it grows.
const KNOWN_BYTES: u64 = 3 * (size_of::<[u64; 3]>() + size_of::<u32>()) as u64;

/// An object as triangles, wherever it stands.
struct Faces<'a> {
    object: &'a Object,
    mesh: &'a Mesh,
    poses: Vec<Option<&'a Pose>>,
}

/// The places in a texture of a triangle's corners.
type Places = [[f64; 2]; 3];

impl<'a> Faces<'a> {
    /// Every triangle: its corners in the world, rounded, and their places in a texture, if there are any.
    fn each(&self) -> impl Iterator<Item = ([DVec3; 3], Option<&'a Places>)> {
        let Self { object, mesh, poses } = self;
        let stands = object.instances.iter().flat_map(move |place| poses.iter().map(move |pose| (place, pose)));
        stands.flat_map(move |(place, pose)| {
            (0..).zip(&mesh.triangles).map(move |(i, triangle)| {
                let corner = |corner: u32| {
                    let p = mesh.points[corner as usize];
                    object.digits.round_point(place.to_world(pose.map_or(p, |pose| pose.to_object(p))))
                };
                (triangle.map(corner), mesh.uvs.get(i))
            })
        })
    }

    /// How many times it stands.
    fn places(&self) -> usize {
        self.poses.len() * self.object.instances.len()
    }
}

/// Every object as triangles, but scenery.
fn objects(model: &Model) -> Result<Vec<Faces<'_>>, NoMesh> {
    let mut all = Vec::new();
    for object in model.objects.iter().filter(|object| !object.is_scenery) {
        let (mesh, poses) = object.body.mesh().ok_or_else(|| NoMesh::Cones(object.name.clone()))?;
        all.push(Faces { object, mesh, poses });
    }
    let count = all.iter().map(|faces| faces.mesh.triangles.len() * faces.places()).sum();
    if count > MOST_FACES { Err(NoMesh::TooMany(count)) } else { Ok(all) }
}

/// Bytes that [`write_obj`] takes for each object of `model` at its peak; none where that is no mesh.
fn bytes_of_objects(model: &Model) -> impl Iterator<Item = u64> {
    let of = |faces: &Faces<'_>| {
        let (corners, triangles) = (faces.mesh.points.len() as u64, faces.mesh.triangles.len() as u64);
        (corners * KNOWN_BYTES + triangles * size_of::<[u32; 3]>() as u64) * faces.places() as u64
    };
    objects(model).unwrap_or_default().into_iter().map(move |faces| of(&faces))
}

/// Bytes that [`write_obj`] takes for `model` at its peak.
#[must_use]
pub fn obj_bytes_needed(model: &Model) -> u64 {
    bytes_of_objects(model).max().unwrap_or(0)
}

/// Bytes that [`write_ply`] takes for `model` at its peak.
#[must_use]
pub fn ply_bytes_needed(model: &Model) -> u64 {
    // It keeps the corners of all, in order too.
    let list = 1.0 + (size_of::<(DVec3, Digits)>() as f64) / KNOWN_BYTES as f64;
    (bytes_of_objects(model).sum::<u64>() as f64 * list) as u64
}

/// Corners by place, numbered from 0 on.
#[derive(Default)]
struct Corners(FxHashMap<[u64; 3], u32>);

impl Corners {
    /// The number of the corner at `p`, and whether it is a new one.
    fn number(&mut self, p: DVec3) -> (u32, bool) {
        let next = self.0.len() as u32;
        let number = *self.0.entry(p.to_array().map(f64::to_bits)).or_insert(next);
        (number, number == next)
    }
}

/// Writes a Wavefront OBJ: y up, as usual there, an object each, with texture coordinates where limbs have them. Corners in
/// one place are one, so that programs can smooth.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] around a [`NoMesh`], or what `out` says.
pub fn write_obj(model: &Model, mut out: impl Write) -> io::Result<()> {
    let objects = objects(model).map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
    writeln!(out, "# {}", plain(&model.title))?;
    // What came before: corners, and places in textures.
    let (mut first, mut placed) = (1, 0);
    for faces in objects {
        let digits = faces.object.digits;
        writeln!(out, "o {}", faces.object.name)?;
        let mut known = Corners::default();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for (corners, uvs) in faces.each() {
            let mut triangle = [0; 3];
            for (i, p) in corners.into_iter().enumerate() {
                let (number, is_new) = known.number(p);
                if is_new {
                    let [x, y, z] = [p.x, p.z, -p.y].map(|c| plain_number(c, digits));
                    writeln!(out, "v {x} {y} {z}")?;
                }
                triangle[i] = first + number;
                if let Some(uvs) = uvs {
                    let [u, v] = uvs[i].map(|x| plain_number(x, Digits(5)));
                    writeln!(out, "vt {u} {v}")?;
                }
            }
            triangles.push(triangle);
        }
        first += known.0.len() as u32;
        for ([a, b, c], i) in triangles.into_iter().zip((0..faces.mesh.triangles.len()).cycle()) {
            if i < faces.mesh.uvs.len() {
                writeln!(out, "f {a}/{} {b}/{} {c}/{}", placed + 1, placed + 2, placed + 3)?;
                placed += 3;
            } else {
                writeln!(out, "f {a} {b} {c}")?;
            }
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
    let mut known = Corners::default();
    let mut points: Vec<(DVec3, Digits)> = Vec::new();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for faces in objects {
        for (corners, _) in faces.each() {
            triangles.push(corners.map(|p| {
                let (number, is_new) = known.number(p);
                if is_new {
                    points.push((p, faces.object.digits));
                }
                number
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
