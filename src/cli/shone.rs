//! Pictures of strokes: light over a photograph or over black, on its way to files.

use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::Failure;
use super::preview::is_exr;
use crate::files::{ExrHead, PngHead, REC709, Rgba, encode_exr_rows, encode_png_rows, write_whole};
use crate::glow::{Canvas, Composite, Layer, Pass, ShineError, shine};
use crate::math::Progress;
use crate::model::Stroke;
use crate::raster::{DataWindow, Grey, Plate, Samples};
use crate::scene::{Resolved, View};

/// Rows that are coloured at a time.
const STRIP: usize = 64;
/// Bytes that a pixel takes at the peak: layers, the photograph, and what is being written.
const PIXEL_BYTES: u64 = 48;

/// A picture of strokes.
pub struct Shone {
    canvas: Canvas,
    plate: Option<Arc<Plate>>,
    matte: Option<Arc<Grey>>,
    layers: Vec<Layer>,
}

/// How a picture of strokes is written.
#[derive(Clone, Copy, Debug, Default)]
pub struct Writing {
    /// 16 bits a channel of a PNG where no photograph says otherwise.
    pub is_deep: bool,
    /// A file a pass, in place of one with all of them (OpenEXR).
    pub split: bool,
}

impl Shone {
    /// The light of `strokes` in the view of `scene`.
    pub fn new(
        scene: &Resolved,
        view: &View,
        strokes: &[Stroke],
        max_memory: u64,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let mut canvas = Canvas::new(view.frame, scene.size);
        if let Some(plate) = &view.plate {
            (canvas.size, canvas.offset) = (plate.size, plate.offset());
        }
        let needed = canvas.pixels() as u64 * PIXEL_BYTES;
        if needed > max_memory {
            return Err(Failure::Usage(format!(
                "a picture of {} by {} pixels needs about {} MB of memory, more than the {} MB allowed: raise --max-memory",
                canvas.size[0],
                canvas.size[1],
                needed.div_ceil(1_000_000),
                max_memory / 1_000_000
            )));
        }
        let layers = shine(strokes, &canvas, view.plate.is_some(), scene.seed, max_memory, progress).map_err(
            |error| match error {
                ShineError::Cancelled(_) => Failure::Stopped,
                ShineError::Scene { object, message } => {
                    Failure::Scene(scene.error(&format!("object.{object}.glow.near.grain"), message))
                }
            },
        )?;
        Ok(Self { canvas, plate: view.plate.clone(), matte: view.matte.clone(), layers })
    }

    fn composite<'a>(&'a self, plate: Option<&'a Plate>) -> Composite<'a> {
        Composite { canvas: self.canvas, plate, matte: self.matte.as_deref(), layers: &self.layers }
    }

    /// The photograph in linear light, Rec. 709 unless it is linear already and told in its own colours.
    fn linear_plate(&self, keeps_colours: bool) -> Option<Plate> {
        let plate = self.plate.as_deref()?;
        let is_linear = matches!(plate.samples, Samples::Linear(_));
        if is_linear && keeps_colours {
            return Some(plate.clone());
        }
        Some(plate.to_rec709())
    }

    /// The picture as a screen shows it, in 8 bits.
    pub fn to_screen(&self) -> Rgba {
        let [width, height] = self.canvas.size;
        let linear = self.display_plate();
        let composite = self.composite(linear.as_ref().or(self.plate.as_deref()));
        let codes = composite.display(0..height as usize, false);
        let by = composite.plate.map_or(255, Plate::most).max(255) / 255;
        let pixel = |rgb: &[u16]| [rgb[0], rgb[1], rgb[2]].map(|c| (u32::from(c) / by) as u8);
        let bytes = codes.chunks_exact(3).flat_map(|rgb| {
            let [r, g, b] = pixel(rgb);
            [r, g, b, 255]
        });
        Rgba { width, height, bytes: bytes.collect() }
    }

    /// What a PNG of a linear photograph is made from, which is of no curve and perhaps of other colours.
    fn display_plate(&self) -> Option<Plate> {
        let is_linear = self.plate.as_ref().is_some_and(|plate| matches!(plate.samples, Samples::Linear(_)));
        if is_linear { self.linear_plate(false) } else { None }
    }

    /// Writes it to `path`, as its ending says; returns the files.
    pub fn write(&self, path: &Path, how: Writing, texts: &[(&str, &str)]) -> Result<Vec<PathBuf>, Failure> {
        if is_exr(path) { self.write_exr(path, how, texts) } else { self.write_png(path, how, texts) }
    }

    fn write_png(&self, path: &Path, how: Writing, texts: &[(&str, &str)]) -> Result<Vec<PathBuf>, Failure> {
        if how.split {
            return Err(Failure::Usage("--split writes OpenEXR: end the picture in .exr".to_owned()));
        }
        let linear = self.display_plate();
        let composite = self.composite(linear.as_ref().or(self.plate.as_deref()));
        let is_deep = match composite.plate.map(|plate| &plate.samples) {
            Some(Samples::Eight(_)) => false,
            Some(Samples::Sixteen(_)) => true,
            Some(Samples::Linear(_)) | None => how.is_deep,
        };
        let profile = composite.plate.and_then(|plate| plate.profile.as_deref());
        let head = PngHead { size: self.canvas.size, is_deep, has_alpha: false, profile, texts };
        let height = self.canvas.size[1] as usize;
        let strips = (0..height).step_by(STRIP).map(|top| {
            let codes = composite.display(top..(top + STRIP).min(height), is_deep);
            if is_deep {
                codes.iter().flat_map(|code| code.to_be_bytes()).collect::<Vec<u8>>()
            } else {
                codes.iter().map(|&code| code as u8).collect()
            }
        });
        write_whole(path, |out| encode_png_rows(&head, strips, out)).map_err(|e| Failure::file("write", path, &e))?;
        Ok(vec![path.to_owned()])
    }

    fn write_exr(&self, path: &Path, how: Writing, texts: &[(&str, &str)]) -> Result<Vec<PathBuf>, Failure> {
        let plate = self.linear_plate(true);
        let composite = self.composite(plate.as_ref());
        let alpha = if plate.is_some() { 1.0 } else { 0.0 };
        let texts: Vec<(String, String)> = texts
            .iter()
            .map(|(k, t)| (if *k == "Software" { "software" } else { k }.to_owned(), (*t).to_owned()))
            .collect();
        let window = plate.as_ref().map_or_else(DataWindow::default, |plate| plate.window);
        let told = plate.as_ref().and_then(|plate| plate.chromaticities).unwrap_or(REC709);
        let head = |channels| ExrHead {
            size: self.canvas.size,
            window,
            channels,
            texts: texts.clone(),
            chromaticities: Some(told),
        };
        let write = |path: &Path, head: &ExrHead, fill: &(dyn Fn(usize, usize, &mut [f32]) + Sync)| {
            write_whole(path, |out| {
                let mut bytes = Cursor::new(Vec::new());
                encode_exr_rows(head, &fill, &mut bytes)?;
                out.write_all(bytes.get_ref())
            })
            .map_err(|e: io::Error| Failure::file("write", path, &e))
        };
        let colours = ["R", "G", "B", "A"];
        if how.split {
            let mut files = Vec::new();
            for pass in self.passes() {
                let file = path.with_extension(format!("{}.exr", pass.name()));
                let channels = colours.map(|c| (c.to_owned(), true)).to_vec();
                write(&file, &head(channels), &|channel, y, row| {
                    if channel == 3 { row.fill(0.0) } else { composite.pass(pass, channel, y, row) }
                })?;
                files.push(file);
            }
            return Ok(files);
        }
        let mut channels: Vec<(String, bool)> = colours.map(|c| (c.to_owned(), true)).to_vec();
        let passes = self.passes();
        for pass in &passes {
            channels.extend(colours.map(|c| (format!("{}.{c}", pass.name()), true)));
        }
        if self.matte.is_some() {
            channels.push(("matte".to_owned(), true));
        }
        write(path, &head(channels), &|channel, y, row| match (channel / 4, channel % 4) {
            (0, 3) => row.fill(alpha),
            (0, c) => composite.linear(c, y, row),
            (layer, _) if layer > passes.len() => composite.matte_row(y, row),
            (_, 3) => row.fill(0.0),
            (layer, c) => composite.pass(passes[layer - 1], c, y, row),
        })?;
        Ok(vec![path.to_owned()])
    }

    /// The passes that a file has: those that add to a photograph only where there is one.
    fn passes(&self) -> Vec<Pass> {
        Pass::ALL.into_iter().filter(|&pass| pass != Pass::Cloud || self.plate.is_some()).collect()
    }
}
