//! The files that shapes name: sketches and meshes.

use super::{Folder, decode_mesh, decode_sketch};
use crate::geom::{MeshParts, ShapeFiles, SketchLines};
use crate::math::DVec2;

impl ShapeFiles for Folder {
    fn sketch_lines(&self, file: &str) -> Result<SketchLines, String> {
        let page = decode_sketch(&self.read(file)?).map_err(|error| format!("cannot read `{file}`: {error}"))?;
        let square = |p: DVec2| DVec2::new(p.x * page.aspect, p.y);
        Ok(page.lines.iter().map(|(line, _)| line.iter().map(|&p| square(p)).collect()).collect())
    }

    fn mesh_parts(&self, file: &str) -> Result<MeshParts, String> {
        let mesh = decode_mesh(file, &self.read(file)?).map_err(|error| format!("cannot read `{file}`: {error}"))?;
        Ok((mesh.points, mesh.triangles))
    }
}
