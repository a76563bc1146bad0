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
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..tobj::LoadOptions::default() };
    // Materials are the scene's.
    let no_materials = |_: &std::path::Path| tobj::load_mtl_buf(&mut Cursor::new(&[][..]));
    let (models, _) =
        tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials).map_err(|error| error.to_string())?;
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
        mesh.triangles.extend(part.indices.chunks_exact(3).map(|t| [first + t[0], first + t[1], first + t[2]]));
    }
    if mesh.triangles.is_empty() {
        return Err("it has no faces".to_owned());
    }
    if !mesh.points.iter().all(|p| p.is_finite()) {
        return Err("it has coordinates that are not numbers".to_owned());
    }
    Ok(mesh)
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
    }
}
