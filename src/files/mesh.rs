//! Meshes in: Wavefront OBJ, and PLY.

use std::io::Cursor;

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use crate::math::DVec3;
use crate::model::Mesh;

/// The triangles in the file called `name`: PLY by its ending, else OBJ.
///
/// # Errors
/// As [`decode_obj`] and [`decode_ply`].
pub fn decode_mesh(name: &str, bytes: &[u8]) -> Result<Mesh, String> {
    if name.to_ascii_lowercase().ends_with(".ply") { decode_ply(bytes) } else { decode_obj(bytes) }
}

/// The triangles in a PLY file (text or binary), as they are: z up. Polygons are cut into fans.
///
/// # Errors
/// A sentence: no PLY, no faces, or faces that name corners that are not there.
pub fn decode_ply(bytes: &[u8]) -> Result<Mesh, String> {
    // Rows are read one by one, so that a header that promises too many runs out of bytes instead of memory.
    let ply =
        Parser::<DefaultElement>::new().read_ply(&mut Cursor::new(bytes)).map_err(|e| format!("it is no PLY: {e}"))?;
    let number = |property: Option<&Property>| -> Option<f64> {
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
    };
    let corners = |property: &Property| -> Option<Vec<i64>> {
        Some(match property {
            Property::ListChar(list) => list.iter().map(|&i| i64::from(i)).collect(),
            Property::ListUChar(list) => list.iter().map(|&i| i64::from(i)).collect(),
            Property::ListShort(list) => list.iter().map(|&i| i64::from(i)).collect(),
            Property::ListUShort(list) => list.iter().map(|&i| i64::from(i)).collect(),
            Property::ListInt(list) => list.iter().map(|&i| i64::from(i)).collect(),
            Property::ListUInt(list) => list.iter().map(|&i| i64::from(i)).collect(),
            _ => return None,
        })
    };
    let mut mesh = Mesh::default();
    for row in ply.payload.get("vertex").into_iter().flatten() {
        let [x, y, z] = ["x", "y", "z"].map(|axis| number(row.get(axis)));
        let (Some(x), Some(y), Some(z)) = (x, y, z) else { return Err("a vertex has no x, y, z".to_owned()) };
        mesh.points.push(DVec3::new(x, y, z));
    }
    for row in ply.payload.get("face").into_iter().flatten() {
        let list = ["vertex_indices", "vertex_index"].iter().find_map(|name| row.get(*name)).and_then(corners);
        let list = list.ok_or("a face has no list of corners")?;
        if list.iter().any(|&i| i < 0 || i >= mesh.points.len() as i64) {
            return Err(format!("a face names a corner that is not among the {}", mesh.points.len()));
        }
        let list: Vec<u32> = list.into_iter().map(|i| i as u32).collect();
        let fan = (1..list.len().saturating_sub(1)).map(|i| [list[0], list[i], list[i + 1]]);
        mesh.triangles.extend(fan.filter(|[a, b, c]| a != b && b != c && c != a));
    }
    if mesh.triangles.is_empty() {
        return Err("it has no faces".to_owned());
    }
    if !mesh.points.iter().all(|p| p.is_finite()) {
        return Err("it has coordinates that are not numbers".to_owned());
    }
    Ok(mesh)
}

/// The triangles in an OBJ file, turned from its y up to z up. Polygons are cut into triangles; where every corner has
/// a normal the mesh is smooth.
///
/// # Errors
/// A sentence: no OBJ, or no faces.
pub fn decode_obj(bytes: &[u8]) -> Result<Mesh, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not text".to_owned())?;
    let text = faces_only(text)?;
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..tobj::LoadOptions::default() };
    // Materials are the scene's.
    let no_materials = |_: &std::path::Path| tobj::load_mtl_buf(&mut Cursor::new(&[][..]));
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(text.as_bytes()), &options, no_materials)
        .map_err(|error| error.to_string())?;
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
        mesh.triangles.extend(triangles.filter(|[a, b, c]| a != b && b != c && c != a));
    }
    if mesh.triangles.is_empty() {
        return Err("it has no faces".to_owned());
    }
    if !mesh.points.iter().all(|p| p.is_finite()) {
        return Err("it has coordinates that are not numbers".to_owned());
    }
    Ok(mesh)
}

/// The lines of an OBJ file that faces are made of, each index known to be there: `tobj` takes lines and points for
/// faces, and trusts indices.
fn faces_only(text: &str) -> Result<String, String> {
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
                        return Err(format!(
                            "line {number}: a face has the index {text:?}, where {count} are given so far"
                        ));
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
        assert!(decode_obj(b"v 0 0 0\n").unwrap_err().contains("no faces"));
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
