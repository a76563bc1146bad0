//! Pictures: PNG and JPEG decoding, PNG encoding.

use std::io::{self, BufRead, Cursor, Seek, Write};

use image::{DynamicImage, ImageBuffer, ImageReader, Limits};

use crate::math::{from_srgb, to_srgb};
use crate::raster::{Channel, Grey, Layers};

/// Most pixels along a side of a picture that is decoded.
pub(super) const MOST_SIDE: u32 = 32_768;
/// Memory limit of decoding a picture, in bytes.
pub(super) const MOST_BYTES: u64 = 2 << 30;

/// Why a picture cannot be decoded.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The format is unknown.
    #[error("it is not a PNG or JPEG picture")]
    Format,
    /// Reading failed.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// It is truncated, damaged or too large.
    #[error("it cannot be decoded: {0}")]
    Decode(#[from] image::ImageError),
    /// A side is 0.
    #[error("it has no pixels")]
    Empty,
}

/// A picture of 8 bits a channel, not premultiplied, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgba {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Four bytes a pixel.
    pub bytes: Vec<u8>,
}

impl Rgba {
    /// A white picture.
    #[must_use]
    pub fn white(width: u32, height: u32) -> Self {
        Self { width, height, bytes: vec![255; width as usize * height as usize * 4] }
    }

    /// Composites `other` over it with its corner at `(x, y)`, clipped.
    pub fn paste(&mut self, other: &Self, x: u32, y: u32) {
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            for column in 0..other.width.min(self.width.saturating_sub(x)) {
                let from = (row as usize * other.width as usize + column as usize) * 4;
                let to = ((y + row) as usize * self.width as usize + (x + column) as usize) * 4;
                let alpha = u32::from(other.bytes[from + 3]);
                for channel in 0..3 {
                    let over = u32::from(other.bytes[from + channel]) * alpha;
                    let under = u32::from(self.bytes[to + channel]) * (255 - alpha);
                    self.bytes[to + channel] = ((over + under + 127) / 255) as u8;
                }
            }
        }
    }
}

/// Decodes a picture in any known format, within the limits.
pub(super) fn decode(source: impl BufRead + Seek) -> Result<DynamicImage, PictureError> {
    let mut reader = ImageReader::new(source).with_guessed_format()?;
    if reader.format().is_none() {
        return Err(PictureError::Format);
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_SIDE);
    limits.max_image_height = Some(MOST_SIDE);
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    Ok(reader.decode()?)
}

/// Decodes a PNG or JPEG picture to greyscale: the luma of colours, values as encoded.
///
/// # Errors
/// [`PictureError`].
pub fn decode_grey(bytes: &[u8]) -> Result<Grey, PictureError> {
    let picture = decode(Cursor::new(bytes))?.into_luma16();
    let (width, height) = picture.dimensions();
    let values = picture.into_raw().into_iter().map(|v| f32::from(v) / 65535.0).collect();
    Grey::new(width, height, values).ok_or(PictureError::Empty)
}

/// Decodes a PNG picture.
///
/// # Errors
/// [`PictureError`].
pub fn decode_png(bytes: &[u8]) -> Result<Rgba, PictureError> {
    let picture = decode(Cursor::new(bytes))?.into_rgba8();
    let (width, height) = picture.dimensions();
    Ok(Rgba { width, height, bytes: picture.into_raw() })
}

/// Decodes a picture of linear light, of 16 bits a channel, to one for the screen; alpha is as it was.
///
/// # Errors
/// [`PictureError`].
pub fn decode_light(bytes: &[u8]) -> Result<Rgba, PictureError> {
    let picture = decode(Cursor::new(bytes))?.into_rgba16();
    let (width, height) = picture.dimensions();
    let byte = |x: f64| libm::round(x * 255.0) as u8;
    let pixel = |p: &image::Rgba<u16>| {
        let [r, g, b, a] = p.0.map(|x| f64::from(x) / 65535.0);
        [byte(to_srgb(r)), byte(to_srgb(g)), byte(to_srgb(b)), byte(a)]
    };
    Ok(Rgba { width, height, bytes: picture.pixels().flat_map(pixel).collect() })
}

/// Decodes a PNG or JPEG picture to channels `R G B A` in linear light, premultiplied, with its texts.
///
/// # Errors
/// [`PictureError`].
pub fn decode_linear(mut source: impl BufRead + Seek) -> Result<Layers, PictureError> {
    if let Some(([width, height], channels, texts)) = png_channels(&mut source) {
        return Ok(Layers { width, height, channels, texts, ..Layers::default() });
    }
    source.rewind()?;
    decode_whole(source)
}

/// Keyword and text.
type Texts = Vec<(String, String)>;

/// The size of a PNG, its channels in linear light, premultiplied, row by row, and its texts: nothing else of it is kept, since
/// pictures are large. `None` where it is interlaced, or is to be refused.
fn png_channels(source: impl BufRead + Seek) -> Option<([u32; 2], Vec<Channel>, Texts)> {
    let limits = png::Limits { bytes: MOST_BYTES as usize };
    let mut decoder = png::Decoder::new_with_limits(source, limits);
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().ok()?;
    let info = reader.info();
    let (size, is_interlaced, texts) = ([info.width, info.height], info.interlaced, texts(info));
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    if is_interlaced || size.iter().any(|&side| side > MOST_SIDE) || pixels.saturating_mul(8) > MOST_BYTES {
        return None;
    }
    let (colour, depth) = reader.output_color_type();
    let (samples, is_wide) = (colour.samples(), depth == png::BitDepth::Sixteen);
    // Which samples of a pixel are red, green, blue and alpha.
    let (rgb, alpha) = match colour {
        png::ColorType::Grayscale => ([0; 3], None),
        png::ColorType::GrayscaleAlpha => ([0; 3], Some(1)),
        png::ColorType::Rgb => ([0, 1, 2], None),
        png::ColorType::Rgba => ([0, 1, 2], Some(3)),
        png::ColorType::Indexed => return None,
    };
    let most = if is_wide { 65535.0 } else { 255.0 };
    let light: Vec<f64> = (0..=most as u32).map(|sample| from_srgb(f64::from(sample) / most)).collect();
    let mut values: [Vec<f32>; 4] = Default::default();
    values.iter_mut().try_for_each(|channel| channel.try_reserve_exact(pixels as usize)).ok()?;
    while let Some(row) = reader.next_row().ok()? {
        for pixel in row.data().chunks_exact(if is_wide { 2 * samples } else { samples }) {
            let sample = |i: usize| match is_wide {
                true => u16::from_be_bytes([pixel[2 * i], pixel[2 * i + 1]]),
                false => pixel[i].into(),
            };
            let a = alpha.map_or(1.0, |i| f64::from(sample(i)) / most);
            for (channel, i) in values.iter_mut().zip(rgb) {
                channel.push((light[usize::from(sample(i))] * a) as f32);
            }
            values[3].push(a as f32);
        }
    }
    let channel = |(values, name): (Vec<f32>, &str)| Channel { name: name.to_owned(), values, is_half: false };
    let is_whole = values[3].len() as u64 == pixels;
    is_whole.then(|| (size, values.into_iter().zip(["R", "G", "B", "A"]).map(channel).collect(), texts))
}

/// Decodes a picture of any format as [`decode_linear`] does, all at once.
fn decode_whole(mut source: impl BufRead + Seek) -> Result<Layers, PictureError> {
    let texts = png::Decoder::new(&mut source).read_info().map_or_else(|_| Texts::new(), |reader| texts(reader.info()));
    source.rewind()?;
    let picture = decode(source)?;
    let (width, height) = (picture.width(), picture.height());
    // Pixels of a byte a channel are not blown up: pictures are large.
    let channels = match picture.color().bytes_per_pixel() / picture.color().channel_count() {
        1 => linear_channels(&picture.into_rgba8(), |v| f64::from(v) / 255.0),
        _ => linear_channels(&picture.into_rgba16(), |v| f64::from(v) / 65535.0),
    };
    Ok(Layers { width, height, channels, texts, ..Layers::default() })
}

/// The channels of an sRGB picture with alpha, whose samples `value` brings to 0 to 1.
fn linear_channels<T>(picture: &ImageBuffer<image::Rgba<T>, Vec<T>>, value: impl Fn(T) -> f64) -> Vec<Channel>
where
    image::Rgba<T>: image::Pixel<Subpixel = T>,
    T: image::Primitive,
{
    let channel = |(i, name): (usize, &str)| Channel {
        name: name.to_owned(),
        values: picture
            .pixels()
            .map(|p| if i == 3 { value(p.0[3]) } else { from_srgb(value(p.0[i])) * value(p.0[3]) } as f32)
            .collect(),
        is_half: false,
    };
    (0..4).zip(["R", "G", "B", "A"]).map(channel).collect()
}

/// The texts before a PNG's pixels.
fn texts(info: &png::Info<'_>) -> Texts {
    info.utf8_text.iter().filter_map(|chunk| Some((chunk.keyword.clone(), chunk.get_text().ok()?))).collect()
}

/// `picture` scaled to fit `width` by `height`, its aspect kept.
#[must_use]
pub fn resize(picture: &Rgba, width: u32, height: u32) -> Rgba {
    let Some(buffer) = image::RgbaImage::from_raw(picture.width, picture.height, picture.bytes.clone()) else {
        return picture.clone();
    };
    let scaled = DynamicImage::from(buffer).resize(width, height, image::imageops::FilterType::CatmullRom).into_rgba8();
    let (width, height) = scaled.dimensions();
    Rgba { width, height, bytes: scaled.into_raw() }
}

/// The header of a PNG file.
#[derive(Clone, Copy, Debug)]
pub struct PngHead<'a> {
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// 16 bits a channel, big-endian, in place of 8.
    pub is_deep: bool,
    /// With alpha, not premultiplied.
    pub has_alpha: bool,
    /// An ICC profile; without it colours are sRGB.
    pub profile: Option<&'a [u8]>,
    /// Keyword and text.
    pub texts: &'a [(&'a str, &'a str)],
}

/// Encodes `picture` as a PNG of 8 bits a channel with sRGB colours and these texts (keyword, text).
///
/// # Errors
/// Those of `out`.
pub fn encode_png(picture: &Rgba, texts: &[(&str, &str)], out: impl Write) -> io::Result<()> {
    let size = [picture.width, picture.height];
    let head = PngHead { size, is_deep: false, has_alpha: true, profile: None, texts };
    encode_png_rows(&head, std::iter::once(&picture.bytes[..]), out)
}

/// [`encode_png`] of 16 bits a channel: four values a pixel.
///
/// # Errors
/// Those of `out`.
pub fn encode_png16(size: [u32; 2], values: &[u16], texts: &[(&str, &str)], out: impl Write) -> io::Result<()> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    let head = PngHead { size, is_deep: true, has_alpha: true, profile: None, texts };
    encode_png_rows(&head, std::iter::once(&bytes[..]), out)
}

/// Encodes a PNG from consecutive parts of any number of rows.
///
/// # Errors
/// Those of `out`.
pub fn encode_png_rows<T: AsRef<[u8]>>(
    head: &PngHead<'_>,
    parts: impl Iterator<Item = T>,
    out: impl Write,
) -> io::Result<()> {
    let mut info = png::Info::with_size(head.size[0], head.size[1]);
    info.color_type = if head.has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb };
    info.bit_depth = if head.is_deep { png::BitDepth::Sixteen } else { png::BitDepth::Eight };
    match head.profile {
        Some(profile) => info.icc_profile = Some(profile.into()),
        None => info.srgb = Some(png::SrgbRenderingIntent::Perceptual),
    }
    let mut encoder = png::Encoder::with_info(out, info).map_err(io::Error::other)?;
    // A tenth of the time of the default, for a few per cent of size.
    encoder.set_compression(png::Compression::Fast);
    for (keyword, text) in head.texts {
        encoder.add_itxt_chunk((*keyword).to_owned(), (*text).to_owned()).map_err(io::Error::other)?;
    }
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    let mut stream = writer.stream_writer().map_err(io::Error::other)?;
    for part in parts {
        stream.write_all(part.as_ref())?;
    }
    stream.finish().map_err(io::Error::other)?;
    writer.finish().map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn png_round_trip() {
        let mut picture = Rgba::white(3, 2);
        picture.bytes[5] = 7;
        let mut bytes = Vec::new();
        encode_png(&picture, &[("Software", "a test")], &mut bytes).unwrap();
        assert_eq!(decode_png(&bytes).unwrap(), picture);
        assert!(decode_png(&bytes[..40]).is_err());
        assert!(matches!(decode_grey(b"no picture"), Err(PictureError::Format)));
    }

    /// Row by row every kind of PNG gives the same bits as all at once; what is damaged is refused as there.
    #[test]
    fn rows_are_the_picture() {
        let noise = DynamicImage::from(ImageBuffer::from_fn(19, 7, |x, y| {
            image::Rgba(
                [0, 1, 2, 3].map(|i| (x * 7919 + y * 104_729 + i * 1_299_709).wrapping_mul(2_654_435_761) as u16),
            )
        }));
        let kinds = [
            DynamicImage::from(noise.to_luma8()),
            DynamicImage::from(noise.to_luma_alpha8()),
            DynamicImage::from(noise.to_rgb8()),
            DynamicImage::from(noise.to_rgba8()),
            DynamicImage::from(noise.to_luma16()),
            DynamicImage::from(noise.to_luma_alpha16()),
            DynamicImage::from(noise.to_rgb16()),
            noise,
        ];
        for kind in kinds {
            let mut bytes = Cursor::new(Vec::new());
            kind.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
            let bytes = bytes.into_inner();
            let ([width, height], channels, _) = png_channels(Cursor::new(&bytes)).unwrap();
            let whole = decode_whole(Cursor::new(&bytes)).unwrap();
            assert_eq!((width, height, &channels), (whole.width, whole.height, &whole.channels), "{:?}", kind.color());
            let half = &bytes[..bytes.len() / 2];
            assert!(png_channels(Cursor::new(half)).is_none() && decode_linear(Cursor::new(half)).is_err());
        }
    }
}
