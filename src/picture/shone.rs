//! Pictures of strokes: light over a photograph or over black, on its way to files.

use std::io::{self, Write};
use std::sync::Arc;

use crate::assemble::Backdrop;
use crate::files::{ExrHead, PngHead, REC709, Rgba, encode_exr_rows, encode_png_rows};
use crate::glow::{Canvas, Composite, Layer, Pass, ShineError, shine};
use crate::math::{Memory, OutOfMemory, Progress};
use crate::model::Stroke;
use crate::raster::{DataWindow, Grey, Plate, Samples};

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

/// Bits of a channel of a PNG where no photograph says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 8 bits.
    #[default]
    Eight,
    /// 16 bits.
    Sixteen,
}

/// Why there is no picture of strokes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShoneError {
    /// It would take more memory than allowed.
    #[error("a picture of {} by {} pixels needs {error}: raise --max-memory", size[0], size[1])]
    Memory {
        /// Its pixels.
        size: [u32; 2],
        /// What it needs.
        error: OutOfMemory,
    },
    /// A stroke cannot shine.
    #[error(transparent)]
    Shine(#[from] ShineError),
}

impl Shone {
    /// The light of `strokes` before `backdrop`, in a picture of `size` pixels unless its photograph says otherwise.
    ///
    /// # Errors
    /// [`ShoneError`].
    pub fn new(
        backdrop: &Backdrop,
        size: [u32; 2],
        strokes: &[Stroke],
        seed: u64,
        memory: &Memory,
        progress: &Progress,
    ) -> Result<Self, ShoneError> {
        let mut canvas = Canvas::new(backdrop.frame, size);
        if let Some(plate) = &backdrop.plate {
            (canvas.size, canvas.offset) = (plate.size, plate.offset());
        }
        let needed = canvas.pixels() as u64 * PIXEL_BYTES;
        memory.ask(needed).map_err(|error| ShoneError::Memory { size: canvas.size, error })?;
        let layers = shine(strokes, &canvas, backdrop.plate.is_some(), seed, memory, progress)?;
        Ok(Self { canvas, plate: backdrop.plate.clone(), matte: backdrop.matte.clone(), layers })
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
    #[must_use]
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

    /// Writes it as PNG, in the photograph's own depth and profile where there is one.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_png(&self, depth: Depth, texts: &[(&str, &str)], out: &mut dyn Write) -> io::Result<()> {
        let linear = self.display_plate();
        let composite = self.composite(linear.as_ref().or(self.plate.as_deref()));
        let is_deep = match composite.plate.map(|plate| &plate.samples) {
            Some(Samples::Eight(_)) => false,
            Some(Samples::Sixteen(_)) => true,
            Some(Samples::Linear(_)) | None => depth == Depth::Sixteen,
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
        encode_png_rows(&head, strips, out)
    }

    /// Writes it as OpenEXR with all its passes.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_exr(&self, texts: &[(&str, &str)], out: &mut dyn Write) -> io::Result<()> {
        let plate = self.linear_plate(true);
        let composite = self.composite(plate.as_ref());
        let alpha = if plate.is_some() { 1.0 } else { 0.0 };
        let passes = self.passes();
        let mut channels = rgba("");
        passes.iter().for_each(|pass| channels.extend(rgba(&format!("{}.", pass.name()))));
        if self.matte.is_some() {
            channels.push(("matte".to_owned(), true));
        }
        let head = self.exr_head(plate.as_ref(), channels, texts);
        write_rows(&head, out, &|channel, y, row| match (channel / 4, channel % 4) {
            (0, 3) => row.fill(alpha),
            (0, c) => composite.linear(c, y, row),
            (layer, _) if layer > passes.len() => composite.matte_row(y, row),
            (_, 3) => row.fill(0.0),
            (layer, c) => composite.pass(passes[layer - 1], c, y, row),
        })
    }

    /// Writes one of its passes as OpenEXR.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_pass(&self, pass: Pass, texts: &[(&str, &str)], out: &mut dyn Write) -> io::Result<()> {
        let plate = self.linear_plate(true);
        let composite = self.composite(plate.as_ref());
        let head = self.exr_head(plate.as_ref(), rgba(""), texts);
        write_rows(&head, out, &|channel, y, row| {
            if channel == 3 { row.fill(0.0) } else { composite.pass(pass, channel, y, row) }
        })
    }

    fn exr_head(&self, plate: Option<&Plate>, channels: Vec<(String, bool)>, texts: &[(&str, &str)]) -> ExrHead {
        ExrHead {
            size: self.canvas.size,
            window: plate.map_or_else(DataWindow::default, |plate| plate.window),
            channels,
            texts: texts.iter().map(|(keyword, text)| attribute(keyword, text)).collect(),
            chromaticities: Some(plate.and_then(|plate| plate.chromaticities).unwrap_or(REC709)),
        }
    }

    /// The passes that a file has: those that add to a photograph only where there is one.
    #[must_use]
    pub fn passes(&self) -> Vec<Pass> {
        Pass::ALL.into_iter().filter(|&pass| pass != Pass::Cloud || self.plate.is_some()).collect()
    }
}

/// Four channels, each as long as the picture is wide.
fn rgba(layer: &str) -> Vec<(String, bool)> {
    ["R", "G", "B", "A"].map(|channel| (format!("{layer}{channel}"), true)).to_vec()
}

/// A text as an attribute of OpenEXR: a standard one where there is any.
pub(super) fn attribute(keyword: &str, text: &str) -> (String, String) {
    (if keyword == "Software" { "software" } else { keyword }.to_owned(), text.to_owned())
}

/// Writes OpenEXR whose rows `fill` makes, of a channel and a row.
fn write_rows(head: &ExrHead, out: &mut dyn Write, fill: &(dyn Fn(usize, usize, &mut [f32]) + Sync)) -> io::Result<()> {
    out.write_all(&encode_exr_rows(head, &fill)?)
}
