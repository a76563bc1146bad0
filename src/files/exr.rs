//! OpenEXR in and out, and skies (OpenEXR or Radiance HDR) in.

use std::io::{self, Cursor, Seek, Write};

use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder,
    ReadChannels, ReadLayers, Text, WritableImage, f16, read,
};

use super::picture::{MOST_BYTES, MOST_SIDE};
use crate::raster::{Channel, Layers, Panorama};

/// Refuses what would not fit, before anything is allocated.
fn check_size(width: usize, height: usize, channels: usize) -> Result<(), String> {
    let most = MOST_SIDE as usize;
    let bytes = (width as u64).saturating_mul(height as u64).saturating_mul(channels as u64 * 4);
    if width > most || height > most || bytes > MOST_BYTES {
        return Err(format!("it is {width} by {height} with {channels} channels, too large to read"));
    }
    Ok(())
}

/// The first layer of an OpenEXR picture, with every channel and text.
///
/// # Errors
/// A sentence: not OpenEXR, truncated, too large, deep or subsampled.
pub fn decode_exr(bytes: &[u8]) -> Result<Layers, String> {
    let wrong = |error: exr::error::Error| format!("it is no OpenEXR picture that can be read: {error}");
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(wrong)?;
    let header = meta.headers.first().ok_or("it has no layer")?;
    check_size(header.layer_size.width(), header.layer_size.height(), header.channels.list.len())?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(wrong)?;
    let layer = image.layer_data;
    let pixels = layer.size.width() * layer.size.height();
    let channels: Vec<Channel> = layer
        .channel_data
        .list
        .iter()
        .map(|channel| Channel {
            name: channel.name.to_string(),
            values: channel.sample_data.values_as_f32().collect(),
            is_half: matches!(channel.sample_data, FlatSamples::F16(_)),
        })
        .collect();
    if channels.iter().any(|c| c.values.len() != pixels) {
        return Err("it has subsampled channels, which are not read".to_owned());
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
    Ok(Layers { width: layer.size.width() as u32, height: layer.size.height() as u32, channels, texts })
}

fn sorted<'a>(
    attributes: impl Iterator<Item = (&'a Text, &'a AttributeValue)>,
) -> std::collections::BTreeMap<String, &'a AttributeValue> {
    attributes.map(|(name, value)| (name.to_string(), value)).collect()
}

/// Writes `picture` as one part, ZIP-compressed, which every reader accepts. Texts become attributes; `software` and
/// `comments` are standard ones.
///
/// # Errors
/// What `out` says.
pub fn encode_exr(picture: &Layers, out: impl Write + Seek) -> io::Result<()> {
    let channels = picture
        .channels
        .iter()
        .map(|c| {
            let samples = if c.is_half {
                // Nothing becomes infinite by having fewer bits.
                let most = |x: &f32| if x.is_finite() { x.clamp(-65504.0, 65504.0) } else { *x };
                FlatSamples::F16(c.values.iter().map(most).map(f16::from_f32).collect())
            } else {
                FlatSamples::F32(c.values.clone())
            };
            AnyChannel::new(c.name.as_str(), samples)
        })
        .collect();
    let mut attributes = LayerAttributes::default();
    for (keyword, text) in &picture.texts {
        let value = Text::new_or_none(ascii(text)).unwrap_or_default();
        match keyword.as_str() {
            "software" => attributes.software_name = Some(value),
            "comments" => attributes.comments = Some(value),
            _ => {
                attributes.other.insert(Text::from(keyword.as_str()), AttributeValue::Text(value));
            }
        }
    }
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let size = (picture.width as usize, picture.height as usize);
    let image = Image::from_layer(Layer::new(size, attributes, encoding, AnyChannels::sort(channels)));
    image.write().to_buffered(out).map_err(|error| match error {
        exr::error::Error::Io(error) => error,
        error => io::Error::other(error.to_string()),
    })
}

/// Text in ASCII, which is all that attributes are sure to keep: other characters as in JSON, `\\u6728`.
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

/// The sky in an OpenEXR or Radiance HDR picture: its `R`, `G`, `B`, twice as wide as high.
///
/// # Errors
/// A sentence: neither, truncated, too large, without colours, or of another shape.
pub fn decode_panorama(bytes: &[u8]) -> Result<Panorama, String> {
    let (width, height, pixels) = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        let layers = decode_exr(bytes)?;
        (layers.width, layers.height, layers.pixels(["R", "G", "B"]).ok_or("it has no channels R, G and B")?)
    } else {
        let picture = super::picture::decode(bytes)?.into_rgb32f();
        let (width, height) = picture.dimensions();
        (width, height, picture.pixels().map(|p| p.0).collect())
    };
    if width != height * 2 {
        return Err(format!("a sky is twice as wide as high, this is {width} by {height}"));
    }
    // Suns may be brighter than 16 bits can tell.
    let light = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, 65504.0) };
    let pixels = pixels.into_iter().map(|p| p.map(light)).collect();
    Panorama::new(width, height, pixels).ok_or_else(|| "it has no pixels".to_owned())
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
        };
        let mut bytes = Cursor::new(Vec::new());
        encode_exr(&picture, &mut bytes).unwrap();
        let bytes = bytes.into_inner();
        assert_eq!(decode_exr(&bytes).unwrap(), picture);
        assert!(decode_exr(&bytes[..bytes.len() - 9]).is_err());
        assert!(decode_exr(b"no picture").is_err());
        assert_eq!(
            serde_json::from_str::<String>(&format!("\"{}\"", ascii("\u{6728} elm \u{1f333}"))).unwrap(),
            "\u{6728} elm \u{1f333}"
        );
        assert!(decode_panorama(&bytes).is_err());
    }
}
