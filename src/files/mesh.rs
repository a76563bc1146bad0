//! Meshes: Wavefront OBJ in.

use std::io::Cursor;

use crate::math::DVec3;
use crate::model::Mesh;

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
