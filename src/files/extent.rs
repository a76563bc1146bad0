//! How much memory a picture takes, by its header alone.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::meta::MetaData;
use image::ImageReader;

/// What decoding a picture makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Pixels.
    pub pixels: u64,
    /// Channels, of four bytes a sample.
    pub channels: u64,
}

/// What [`super::decode_exr`], where `is_exr`, or [`super::decode_linear`] make of the file at `path`; `None` where its header
/// cannot be read.
#[must_use]
pub fn picture_extent(path: &Path, is_exr: bool) -> Option<Extent> {
    let file = BufReader::new(File::open(path).ok()?);
    if !is_exr {
        let (width, height) = ImageReader::new(file).with_guessed_format().ok()?.into_dimensions().ok()?;
        return Some(Extent { pixels: u64::from(width) * u64::from(height), channels: 4 });
    }
    let meta = MetaData::read_from_buffered(file, false).ok()?;
    let header = meta.headers.first()?;
    let [width, height] = [header.layer_size.width(), header.layer_size.height()].map(|side| side as u64);
    Some(Extent { pixels: width.saturating_mul(height), channels: header.channels.list.len() as u64 })
}

#[cfg(test)]
mod tests {
    use super::super::{Rgba, encode_exr, encode_png, write_bytes};
    use super::*;
    use crate::raster::{Channel, Layers};

    #[test]
    fn headers_tell() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mut png = Vec::new();
        encode_png(&Rgba::white(7, 5), &[], &mut png).unwrap();
        write_bytes(&at("a.png"), &png).unwrap();
        assert_eq!(picture_extent(&at("a.png"), false), Some(Extent { pixels: 35, channels: 4 }));
        let channel = |name: &str| Channel { name: name.to_owned(), values: vec![0.0; 6], is_half: true };
        let layers = Layers { width: 3, height: 2, channels: vec![channel("R"), channel("Z")], ..Layers::default() };
        write_bytes(&at("a.exr"), &encode_exr(&layers).unwrap()).unwrap();
        assert_eq!(picture_extent(&at("a.exr"), true), Some(Extent { pixels: 6, channels: 2 }));
        assert_eq!(picture_extent(&at("a.png"), true), None);
        assert_eq!(picture_extent(&at("none.png"), false), None);
    }
}
