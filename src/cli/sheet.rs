//! Contact sheets: many pictures on one, each with its label.

use std::path::Path;

use super::error::Failure;
use super::{output, shown};
use crate::files::{Rgba, draw_svg, encode_png, resize};

/// A picture and what tells it from the others.
pub struct Tile {
    pub picture: Rgba,
    pub label: String,
}

/// Longest side of a picture on a sheet, in pixels.
const SIDE: u32 = 320;
/// Height of a label, in pixels.
const LABEL: u32 = 26;
/// Space between pictures, in pixels.
const GAP: u32 = 8;

/// Writes the sheet of `tiles`, about as wide as high.
pub fn write_sheet(path: &Path, tiles: &[Tile]) -> Result<(), Failure> {
    let cell = tiles.iter().fold([1, 1], |[w, h], tile| [w.max(tile.picture.width), h.max(tile.picture.height)]);
    let scale = f64::from(SIDE) / f64::from(cell[0].max(cell[1]));
    let [width, height] = cell.map(|side| ((f64::from(side) * scale).round() as u32).clamp(1, SIDE));
    let count = tiles.len() as u32;
    let columns = (1..=count)
        .min_by_key(|&columns| (columns * (width + GAP)).max(count.div_ceil(columns) * (height + LABEL + GAP)))
        .unwrap_or(1);
    let rows = count.div_ceil(columns);
    let mut sheet = Rgba::white(columns * (width + GAP) + GAP, rows * (height + LABEL + GAP) + GAP);
    for (i, tile) in (0..).zip(tiles) {
        let x = GAP + i % columns * (width + GAP);
        let y = GAP + i / columns * (height + LABEL + GAP);
        let small = resize(&tile.picture, width, height);
        sheet.paste(&small, x + (width - small.width.min(width)) / 2, y);
        sheet.paste(&label(&tile.label, width)?, x, y + height);
    }
    let texts = [("Software", concat!("lichtenberg ", env!("CARGO_PKG_VERSION")))];
    output::write(path, |out| encode_png(&sheet, &texts, out))
}

/// A line of text, centred and made to fit.
fn label(text: &str, width: u32) -> Result<Rgba, Failure> {
    let letters = text.chars().count().max(1) as f64;
    // A letter is about half as wide as high.
    let size = (f64::from(width) / letters * 1.9).min(15.0);
    let text = shown::line(text).replace('&', "&amp;").replace('<', "&lt;");
    let svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{LABEL}"><text x="{}" y="17" font-family="Ubuntu" font-weight="300" font-size="{size:.1}" text-anchor="middle" fill="#222">{text}</text></svg>"##,
        width / 2
    );
    draw_svg(&svg, &[epaint_default_fonts::UBUNTU_LIGHT]).map_err(|e| Failure::Usage(e.to_string()))
}
