//! The files that shapes name: sketches, meshes, fonts and pictures.

use super::{Folder, ReadError, decode_grey, decode_mesh, decode_sketch, letter_outlines};
use crate::geom::{MeshParts, Rings, ShapeError, ShapeFiles, SketchLines, simplified};
use crate::math::DVec2;
use crate::raster::contours;

/// The font that comes with the program.
const FONT: &str = "fonts/DejaVuSans-Bold.ttf";
/// Outlines of pictures are within this many pixels of where the brightness crosses the threshold.
const SLACK: f64 = 0.1;

impl From<ReadError> for ShapeError {
    fn from(ReadError { name, reason }: ReadError) -> Self {
        Self::file(&name, reason)
    }
}

impl ShapeFiles for Folder {
    fn sketch_lines(&self, file: &str) -> Result<SketchLines, ShapeError> {
        let page = decode_sketch(&self.read(file)?).map_err(|error| ShapeError::file(file, error))?;
        let square = |p: DVec2| DVec2::new(p.x * page.aspect, p.y);
        Ok(page.lines.iter().map(|(line, _)| line.iter().map(|&p| square(p)).collect()).collect())
    }

    fn letters(&self, text: &str, file: Option<&str>) -> Result<Rings, ShapeError> {
        let bytes = match file {
            Some(file) => self.read(file)?,
            None => Self::Embedded("".into()).read(FONT)?,
        };
        letter_outlines(text, &bytes).map_err(|error| ShapeError::file(file.unwrap_or(FONT), error))
    }

    fn picture_outlines(&self, file: &str, threshold: f64, bright: bool) -> Result<Rings, ShapeError> {
        let grey = decode_grey(&self.read(file)?).map_err(|error| ShapeError::file(file, error))?;
        let [width, height] = grey.size();
        let sign = if bright { -1.0 } else { 1.0 };
        // All beyond the picture is outside, and a value just at the threshold is not on the line.
        let value = |x: u32, y: u32| {
            if x == 0 || y == 0 || x > width || y > height {
                return 1.0;
            }
            let d = sign * (f64::from(grey.pixel(x - 1, y - 1)) - threshold);
            if d == 0.0 { 1e-9 } else { d }
        };
        let unit = 1.0 / f64::from(height);
        let rings: Rings = contours([width + 2, height + 2], value)
            .iter()
            .map(|line| simplified(line, SLACK))
            .map(|line| line.iter().map(|p| DVec2::new((p.x - 0.5) * unit, 1.0 - (p.y - 0.5) * unit)).collect())
            .collect();
        if rings.is_empty() {
            let what = if bright { "brighter" } else { "darker" };
            return Err(ShapeError::file(file, format!("nothing in it is {what} than {threshold}")));
        }
        Ok(rings)
    }

    fn mesh_parts(&self, file: &str) -> Result<MeshParts, ShapeError> {
        let mesh = decode_mesh(file, &self.read(file)?).map_err(|error| ShapeError::file(file, error))?;
        Ok((mesh.points, mesh.triangles))
    }
}
