//! Decoding of meshes: Wavefront OBJ and PLY.

use std::io::Cursor;

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use crate::math::DVec3;
use crate::model::Mesh;

/// Why a mesh cannot be decoded.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// It is not PLY.
    #[error("it is no PLY: {0}")]
    Ply(String),
    /// Coordinates of a vertex are missing.
    #[error("a vertex has no x, y, z")]
    NoCoordinates,
    /// Indices of a face are missing.
    #[error("a face has no list of corners")]
    NoCorners,
    /// A face has an index out of range.
    #[error("a face names a corner that is not among the {0}")]
    Corner(usize),
    /// A text file is not UTF-8.
    #[error("it is not text")]
    NotText,
    /// It is not OBJ.
    #[error(transparent)]
    Obj(#[from] tobj::LoadError),
    /// A face has an index that is malformed or out of range.
    #[error("line {line}: a face has the index {index:?}, where {count} are given so far")]
    Index {
        /// The line, from 1.
        line: usize,
        /// The index.
        index: String,
        /// The number of such elements before.
        count: i64,
    },
    /// It has no faces.
    #[error("it has no faces")]
    NoFaces,
    /// A coordinate is infinite or not a number.
    #[error("it has coordinates that are not numbers")]
    NotFinite,
}

/// Decodes the triangles of the file called `name`: PLY by its extension, otherwise OBJ.
///
/// # Errors
/// [`MeshError`].
pub fn decode_mesh(name: &str, bytes: &[u8]) -> Result<Mesh, MeshError> {
    if name.to_ascii_lowercase().ends_with(".ply") { decode_ply(bytes) } else { decode_obj(bytes) }
}

/// The number in a PLY property.
fn number(property: Option<&Property>) -> Option<f64> {
    Some(match *property? {
        Property::Char(x) => f64::from(x),
        Property::UChar(x) => f64::from(x),
        Property::Short(x) => f64::from(x),
        Property::UShort(x) => f64::from(x),
        Property::Int(x) => f64::from(x),
        Property::UInt(x) => f64::from(x),
        Property::Float(x) => f64::from(x),
        Property::Double(x) => x,
        _ => return None,
    })
}

/// The indices in a PLY property.
fn indices(property: &Property) -> Option<Vec<i64>> {
    Some(match property {
        Property::ListChar(list) => list.iter().map(|&i| i64::from(i)).collect(),
        Property::ListUChar(list) => list.iter().map(|&i| i64::from(i)).collect(),
        Property::ListShort(list) => list.iter().map(|&i| i64::from(i)).collect(),
        Property::ListUShort(list) => list.iter().map(|&i| i64::from(i)).collect(),
        Property::ListInt(list) => list.iter().map(|&i| i64::from(i)).collect(),
        Property::ListUInt(list) => list.iter().map(|&i| i64::from(i)).collect(),
        _ => return None,
    })
}

/// Decodes the triangles of a PLY file (text or binary), with coordinates unchanged: z up. Polygons become fans.
///
/// # Errors
/// [`MeshError`].
pub fn decode_ply(bytes: &[u8]) -> Result<Mesh, MeshError> {
    // Rows are read one by one, so that a header with excessive counts runs out of bytes instead of memory.
    let ply = Parser::<DefaultElement>::new().read_ply(&mut Cursor::new(bytes));
    let ply = ply.map_err(|error| MeshError::Ply(error.to_string()))?;
    let mut mesh = Mesh::default();
    for row in ply.payload.get("vertex").into_iter().flatten() {
        let [x, y, z] = ["x", "y", "z"].map(|axis| number(row.get(axis)));
        let (Some(x), Some(y), Some(z)) = (x, y, z) else { return Err(MeshError::NoCoordinates) };
        mesh.points.push(DVec3::new(x, y, z));
    }
    for row in ply.payload.get("face").into_iter().flatten() {
        let list = ["vertex_indices", "vertex_index"].iter().find_map(|name| row.get(*name)).and_then(indices);
        let list = list.ok_or(MeshError::NoCorners)?;
        if list.iter().any(|&i| i < 0 || i >= mesh.points.len() as i64) {
            return Err(MeshError::Corner(mesh.points.len()));
        }
        let list: Vec<u32> = list.into_iter().map(|i| i as u32).collect();
        let fan = (1..list.len().saturating_sub(1)).map(|i| [list[0], list[i], list[i + 1]]);
        mesh.triangles.extend(fan.filter(is_proper));
    }
    checked(mesh)
}

/// Has the triangle three distinct corners?
fn is_proper([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// `mesh` if it has faces and finite coordinates.
fn checked(mesh: Mesh) -> Result<Mesh, MeshError> {
    if mesh.triangles.is_empty() {
        return Err(MeshError::NoFaces);
    }
    if !mesh.points.iter().all(|p| p.is_finite()) {
        return Err(MeshError::NotFinite);
    }
    Ok(mesh)
}

/// Decodes the triangles of an OBJ file, rotated from y up to z up. Polygons are triangulated; the mesh is smooth where every
/// corner has a normal.
///
/// # Errors
/// [`MeshError`].
pub fn decode_obj(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let text = std::str::from_utf8(bytes).map_err(|_| MeshError::NotText)?;
    let text = faces_only(text)?;
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..tobj::LoadOptions::default() };
    // Materials are the scene's.
    let no_materials = |_: &std::path::Path| tobj::load_mtl_buf(&mut Cursor::new(&[][..]));
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(text.as_bytes()), &options, no_materials)?;
    let points = |numbers: &[f32]| -> Vec<DVec3> {
        let turned = |p: &[f32]| DVec3::new(f64::from(p[0]), -f64::from(p[2]), f64::from(p[1]));
        numbers.chunks_exact(3).map(turned).collect()
    };
    let is_smooth = models.iter().all(|m| m.mesh.normals.len() == m.mesh.positions.len());
    let mut mesh = Mesh::default();
    for part in models.iter().map(|m| &m.mesh) {
        let first = mesh.points.len() as u32;
        mesh.points.extend(points(&part.positions));
        if is_smooth {
            mesh.normals.extend(points(&part.normals).into_iter().map(|n| n.normalize_or(DVec3::Z)));
        }
        let triangles = part.indices.chunks_exact(3).map(|t| [first + t[0], first + t[1], first + t[2]]);
        mesh.triangles.extend(triangles.filter(is_proper));
    }
    checked(mesh)
}

/// The lines of an OBJ file that concern faces, with validated indices: `tobj` would take lines and points for faces, and does
/// not check indices.
fn faces_only(text: &str) -> Result<String, MeshError> {
    let mut kept = String::with_capacity(text.len());
    let mut counts = [0_i64; 3];
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => counts[0] += 1,
            Some("vt") => counts[1] += 1,
            Some("vn") => counts[2] += 1,
            Some("f") => {
                for index in words.flat_map(|corner| corner.split('/').zip(counts)) {
                    let (text, count) = index;
                    let is_there = text.parse::<i64>().is_ok_and(|i| i != 0 && (-count..=count).contains(&i));
                    if !text.is_empty() && !is_there {
                        return Err(MeshError::Index { line: number, index: text.to_owned(), count });
                    }
                }
            }
            _ => continue,
        }
        kept.push_str(line);
        kept.push('\n');
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_ply() {
        let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
        let square = format!("{head}0 0 0\n1 0 0\n1 2 0\n0 2 0\n4 0 1 2 3\n");
        let mesh = decode_ply(square.as_bytes()).unwrap();
        assert_eq!((mesh.points.len(), mesh.triangles.len()), (4, 2));
        assert_eq!(mesh.points[2], DVec3::new(1.0, 2.0, 0.0));
        for bad in [
            square.replace("2 3\n", "2 9\n"),
            square.replace("ply", "plx"),
            head.replace("vertex 4", "vertex 4000000000"),
        ] {
            assert!(decode_ply(bad.as_bytes()).is_err(), "{bad}");
        }
    }

    #[test]
    fn reads_polygons_upright() {
        let square = b"v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4\n";
        let mesh = decode_obj(square).unwrap();
        assert_eq!(mesh.triangles.len(), 2);
        assert_eq!(mesh.points[2], DVec3::new(1.0, 0.0, 2.0));
        assert!(mesh.normals.is_empty());
        assert!(matches!(decode_obj(b"v 0 0 0\n"), Err(MeshError::NoFaces)));
        assert!(decode_obj(b"f 1 2 3\n").is_err());
        assert!(decode_obj(b"\xff\xfe").is_err());
        let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\n";
        for bad in ["f 1//6148914691236517206 2//1 3//1", "f 1/-5 2/1 3/1", "f 1 2 0", "f 1 2 x", "l 1 2 3", "f 1 1 1"]
        {
            assert!(decode_obj(format!("{three}{bad}\n").as_bytes()).is_err(), "{bad}");
        }
        assert_eq!(decode_obj(format!("{three}f -3 -2 -1\n").as_bytes()).unwrap().triangles.len(), 1);
    }
}
