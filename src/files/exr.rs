//! OpenEXR decoding and encoding; decoding of skies (OpenEXR or Radiance HDR).

use std::io::{self, Cursor, Read, Seek};

use exr::block::BlockIndex;
use exr::image::write::channels::{ChannelsWriter, WritableChannels};
use exr::math::RoundingMode;
use exr::meta::attribute::{AttributeValue, ChannelDescription, ChannelList, Chromaticities, LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::{
    Blocks, Compression, Encoding, FlatSamples, Image, IntegerBounds, Layer, LayerAttributes, LineOrder, ReadChannels,
    ReadLayers, Text, Vec2, WritableImage, f16, read,
};

use super::PictureError;
use super::exr_header::sort_attributes;
use super::picture::{MOST_BYTES, MOST_SIDE};
use crate::raster::{Channel, DataWindow, Layers, Panorama};

/// Why an OpenEXR picture cannot be decoded.
#[derive(Debug, thiserror::Error)]
pub enum ExrError {
    /// It exceeds the limits.
    #[error("it is {width} by {height} with {channels} channels, too large to read")]
    TooLarge {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// The number of channels.
        channels: usize,
    },
    /// Not OpenEXR, truncated, damaged, or deep data.
    #[error("it is no OpenEXR picture that can be read: {0}")]
    Decode(#[from] exr::error::Error),
    /// It has no layer.
    #[error("it has no layer")]
    Empty,
    /// Channels have fewer samples than pixels.
    #[error("it has subsampled channels, which are not read")]
    Subsampled,
}

/// Why a picture is no sky.
#[derive(Debug, thiserror::Error)]
pub enum PanoramaError {
    /// It is no OpenEXR picture.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// It is no other picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Colours are missing.
    #[error("it has no channels R, G and B")]
    NoColours,
    /// It is not equirectangular.
    #[error("a sky is twice as wide as high, this is {0} by {1}")]
    Aspect(u32, u32),
    /// A side is 0.
    #[error("it has no pixels")]
    Empty,
}

/// Checks the limits before anything is allocated.
fn check_size(width: usize, height: usize, channels: usize) -> Result<(), ExrError> {
    let most = MOST_SIDE as usize;
    let bytes = (width as u64).saturating_mul(height as u64).saturating_mul(channels as u64 * 4);
    if width > most || height > most || bytes > MOST_BYTES {
        return Err(ExrError::TooLarge { width, height, channels });
    }
    Ok(())
}

/// Checks the limits by the header alone, and goes back to the start.
fn check_header(source: &mut (impl Read + Seek)) -> Result<(), ExrError> {
    let meta = exr::meta::MetaData::read_from_buffered(&mut *source, false)?;
    let header = meta.headers.first().ok_or(ExrError::Empty)?;
    check_size(header.layer_size.width(), header.layer_size.height(), header.channels.list.len())?;
    source.rewind().map_err(exr::error::Error::from)?;
    Ok(())
}

/// Decodes the first layer of an OpenEXR picture with all channels and texts.
///
/// # Errors
/// [`ExrError`].
pub fn decode_exr(mut source: impl Read + Seek) -> Result<Layers, ExrError> {
    check_header(&mut source)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(source)?;
    let layer = image.layer_data;
    let pixels = layer.size.width() * layer.size.height();
    let channels: Vec<Channel> = layer
        .channel_data
        .list
        .into_iter()
        .map(|channel| Channel {
            name: channel.name.to_string(),
            is_half: matches!(channel.sample_data, FlatSamples::F16(_)),
            // Not twice in memory.
            values: match channel.sample_data {
                FlatSamples::F32(values) => values,
                other => other.values_as_f32().collect(),
            },
        })
        .collect();
    if channels.iter().any(|c| c.values.len() != pixels) {
        return Err(ExrError::Subsampled);
    }
    let mut texts = Vec::new();
    if let Some(text) = &layer.attributes.software_name {
        texts.push(("software".to_owned(), text.to_string()));
    }
    if let Some(text) = &layer.attributes.comments {
        texts.push(("comments".to_owned(), text.to_string()));
    }
    for (name, value) in sorted(layer.attributes.other.iter().chain(&image.attributes.other)) {
        if let AttributeValue::Text(text) = value {
            texts.push((name, text.to_string()));
        }
    }
    let size = [layer.size.width() as u32, layer.size.height() as u32];
    let (at, display) = (layer.attributes.layer_position, image.attributes.display_window);
    let mut window = DataWindow {
        at: [at.x(), at.y()],
        origin: [display.position.x(), display.position.y()],
        display: [display.size.width() as u32, display.size.height() as u32],
    };
    if (window.at, window.display) == (window.origin, size) && window.at == [0, 0] {
        window = DataWindow::default();
    }
    let xy = |c: Chromaticities| [c.red, c.green, c.blue, c.white].map(|v| [v.0, v.1]);
    let chromaticities = image.attributes.chromaticities.map(|c| {
        let flat = xy(c);
        [0, 1, 2, 3, 4, 5, 6, 7].map(|i: usize| flat[i / 2][i % 2])
    });
    Ok(Layers { width: size[0], height: size[1], channels, texts, window, chromaticities })
}

/// Attributes by name: their order in the file is arbitrary.
fn sorted<'a>(
    attributes: impl Iterator<Item = (&'a Text, &'a AttributeValue)>,
) -> std::collections::BTreeMap<String, &'a AttributeValue> {
    attributes.map(|(name, value)| (name.to_string(), value)).collect()
}

/// The header of an OpenEXR file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExrHead {
    /// Pixels in a row, and rows, of what is stored.
    pub size: [u32; 2],
    /// Data window and display window.
    pub window: DataWindow,
    /// Names of the channels, and whether they are stored in 16 bits.
    pub channels: Vec<(String, bool)>,
    /// Keyword and text: `software` and `comments` become standard attributes, others custom ones.
    pub texts: Vec<(String, String)>,
    /// CIE xy of red, green, blue and white; `None` leaves the attribute out.
    pub chromaticities: Option<[f32; 8]>,
}

/// Channels whose rows are computed as they are written.
struct Rows<'a, F> {
    /// Sorted by name, as the format requires.
    channels: Vec<(&'a str, bool, usize)>,
    fill: &'a F,
}

impl<'a, F: Fn(usize, usize, &mut [f32]) + Sync> WritableChannels<'a> for Rows<'a, F> {
    type Writer = &'a Self;

    fn infer_channel_list(&self) -> ChannelList {
        let channel = |&(name, is_half, _): &(&str, bool, usize)| {
            let kind = if is_half { SampleType::F16 } else { SampleType::F32 };
            ChannelDescription::named(name, kind)
        };
        ChannelList::new(self.channels.iter().map(channel).collect())
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_writer(&'a self, _: &Header) -> &'a Self {
        self
    }
}

impl<F: Fn(usize, usize, &mut [f32]) + Sync> ChannelsWriter for &Rows<'_, F> {
    fn extract_uncompressed_block(&self, _: &Header, block: BlockIndex) -> Vec<u8> {
        let (width, left) = (block.pixel_size.width(), block.pixel_position.x());
        let mut bytes = Vec::with_capacity(block.pixel_size.area() * self.channels.len() * 4);
        let mut values = vec![0.0_f32; left + width];
        for y in block.pixel_position.y()..block.pixel_position.y() + block.pixel_size.height() {
            for &(_, is_half, channel) in &self.channels {
                (self.fill)(channel, y, &mut values);
                for &x in &values[left..] {
                    if is_half {
                        // Finite values stay finite.
                        let x = if x.is_finite() { x.clamp(-65504.0, 65504.0) } else { x };
                        bytes.extend(f16::from_f32(x).to_ne_bytes());
                    } else {
                        bytes.extend(x.to_ne_bytes());
                    }
                }
            }
        }
        bytes
    }
}

/// Encodes a picture as one ZIP-compressed part, which every reader accepts. `fill` computes the values of a channel's row from
/// the channel's index and the row's number. The same picture has the same bytes.
///
/// # Errors
/// What cannot be encoded, as a size of 0.
pub fn encode_exr_rows(head: &ExrHead, fill: &(impl Fn(usize, usize, &mut [f32]) + Sync)) -> io::Result<Vec<u8>> {
    let mut attributes = LayerAttributes::default();
    for (keyword, text) in &head.texts {
        let value = Text::new_or_none(ascii(text)).unwrap_or_default();
        match keyword.as_str() {
            "software" => attributes.software_name = Some(value),
            "comments" => attributes.comments = Some(value),
            _ => {
                attributes.other.insert(Text::from(keyword.as_str()), AttributeValue::Text(value));
            }
        }
    }
    attributes.layer_position = Vec2(head.window.at[0], head.window.at[1]);
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let [width, height] = head.size.map(|s| s as usize);
    let mut channels: Vec<_> =
        head.channels.iter().enumerate().map(|(i, (name, is_half))| (name.as_str(), *is_half, i)).collect();
    channels.sort_unstable();
    let mut image = Image::from_layer(Layer::new((width, height), attributes, encoding, Rows { channels, fill }));
    if head.window.display != [0, 0] {
        let [w, h] = head.window.display.map(|s| s as usize);
        let origin = Vec2(head.window.origin[0], head.window.origin[1]);
        image.attributes.display_window = IntegerBounds::new(origin, Vec2(w, h));
    }
    if let Some([rx, ry, gx, gy, bx, by, wx, wy]) = head.chromaticities {
        image.attributes.chromaticities =
            Some(Chromaticities { red: Vec2(rx, ry), green: Vec2(gx, gy), blue: Vec2(bx, by), white: Vec2(wx, wy) });
    }
    let mut file = Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).map_err(|error| match error {
        exr::error::Error::Io(error) => error,
        error => io::Error::other(error.to_string()),
    })?;
    let mut file = file.into_inner();
    sort_attributes(&mut file);
    Ok(file)
}

/// [`encode_exr_rows`] of a picture in memory.
///
/// # Errors
/// As [`encode_exr_rows`].
pub fn encode_exr(picture: &Layers) -> io::Result<Vec<u8>> {
    let head = ExrHead {
        size: [picture.width, picture.height],
        window: picture.window,
        channels: picture.channels.iter().map(|c| (c.name.clone(), c.is_half)).collect(),
        texts: picture.texts.clone(),
        chromaticities: picture.chromaticities,
    };
    let width = picture.width as usize;
    let fill = |channel: usize, y: usize, row: &mut [f32]| {
        row.copy_from_slice(&picture.channels[channel].values[y * width..(y + 1) * width]);
    };
    encode_exr_rows(&head, &fill)
}

/// Do `bytes` start with OpenEXR's magic number?
pub(super) fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01])
}

/// `text` with all but ASCII escaped as in JSON, `\\u6728`: readers preserve only ASCII attributes.
fn ascii(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_ascii() {
            out.push(c);
        } else {
            c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| out.push_str(&format!("\\u{unit:04x}")));
        }
    }
    out
}

/// Decodes an equirectangular sky from an OpenEXR or Radiance HDR picture.
///
/// # Errors
/// [`PanoramaError`].
pub fn decode_panorama(bytes: &[u8]) -> Result<Panorama, PanoramaError> {
    let (width, height, pixels) = if is_exr(bytes) {
        let layers = decode_exr(Cursor::new(bytes))?;
        (layers.width, layers.height, layers.pixels(["R", "G", "B"]).ok_or(PanoramaError::NoColours)?)
    } else {
        let picture = super::picture::decode(Cursor::new(bytes))?.into_rgb32f();
        let (width, height) = picture.dimensions();
        (width, height, picture.pixels().map(|p| p.0).collect())
    };
    if width != height * 2 {
        return Err(PanoramaError::Aspect(width, height));
    }
    // The range of 16-bit floats: suns may be brighter.
    let light = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, 65504.0) };
    let pixels = pixels.into_iter().map(|p| p.map(light)).collect();
    Panorama::new(width, height, pixels).ok_or(PanoramaError::Empty)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exr_round_trip() {
        let channel =
            |name: &str, values: [f32; 6], is_half| Channel { name: name.to_owned(), values: values.into(), is_half };
        let picture = Layers {
            width: 3,
            height: 2,
            channels: vec![
                channel("CryptoObject00.R", [1e-38, f32::from_bits(0x1234_5678), 0.0, 1.0, 2.0, 3.0], false),
                channel("R", [0.5, 1.0, 2.0, 4.0, 0.25, 1000.0], true),
            ],
            texts: vec![
                ("comments".to_owned(), "{\"a\":1}".to_owned()),
                ("cryptomatte/1/name".to_owned(), "x".to_owned()),
            ],
            window: DataWindow { at: [-1, 4], origin: [0, 0], display: [12, 8] },
            chromaticities: Some([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]),
        };
        let bytes = encode_exr(&picture).unwrap();
        assert_eq!(decode_exr(Cursor::new(&bytes)).unwrap(), picture);
        assert!(decode_exr(Cursor::new(&bytes[..bytes.len() - 9])).is_err());
        assert!(decode_exr(Cursor::new(b"no picture")).is_err());
        assert_eq!(
            serde_json::from_str::<String>(&format!("\"{}\"", ascii("\u{6728} elm \u{1f333}"))).unwrap(),
            "\u{6728} elm \u{1f333}"
        );
        assert!(decode_panorama(&bytes).is_err());
    }
}
