//! Decoding of photographs with their colour spaces: JPEG, PNG, TIFF, WebP and OpenEXR.

use std::io::Cursor;

use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::imageops::{self, FilterType};
use image::{DynamicImage, ExtendedColorType, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Limits, Luma, Rgb};
use moxcms::{ColorProfile, DataColorSpace, ToneReprCurve};

use super::exr::{ExrError, decode_exr, is_exr};
use super::picture::{MOST_BYTES, MOST_SIDE};
use crate::math::{DMat3, from_srgb};
use crate::raster::{Grey, Plate, Samples};

/// CIE xy of red, green, blue and white of ITU-R BT.709.
pub const REC709: [f32; 8] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];
/// CIE xy of red, green, blue and white of ACEScg (AP1).
pub const ACESCG: [f32; 8] = [0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767];
/// A row-major matrix.
type Matrix = [[f64; 3]; 3];
/// The identity matrix.
const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Least alpha that counts as opaque.
const OPAQUE: f32 = 0.999;

/// Why a photograph cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PlateError {
    /// The format is unknown.
    #[error("it is not a JPEG, PNG, TIFF, WebP or OpenEXR picture")]
    Unknown,
    /// The format is not supported.
    #[error("it is {0:?}, not a JPEG, PNG, TIFF, WebP or OpenEXR picture")]
    Format(ImageFormat),
    /// Reading failed.
    #[error(transparent)]
    Read(#[from] std::io::Error),
    /// It is truncated, damaged or too large.
    #[error("it cannot be decoded: {0}")]
    Decode(#[from] image::ImageError),
    /// It is no OpenEXR picture.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// It has several frames.
    #[error("it is animated: give its frames one by one")]
    Animated,
    /// It is CMYK.
    #[error("it is in inks (CMYK): convert it to RGB first")]
    Cmyk,
    /// It is not opaque.
    #[error("it is transparent in places: lay it over something first")]
    Transparent,
    /// Colours are missing.
    #[error("it has no channels R, G and B")]
    NoColours,
    /// The chromaticities span no colour space.
    #[error("its chromaticities are no colours")]
    Chromaticities,
    /// The ICC profile is damaged.
    #[error("its colour profile cannot be read: {0}")]
    UnreadableProfile(String),
    /// The ICC profile is of another kind, or not invertible.
    #[error("its colour profile is not one of tone curves and primaries: convert it to sRGB first")]
    Profile,
    /// The data window is not the display window.
    #[error("a photograph with a data window of its own keeps its size")]
    Window,
    /// Its samples do not fit its size.
    #[error("the photograph cannot be scaled")]
    Scale,
}

/// Decodes a photograph, oriented by its EXIF data.
///
/// # Errors
/// [`PlateError`].
pub fn decode_plate(bytes: &[u8]) -> Result<Plate, PlateError> {
    if is_exr(bytes) {
        return linear(bytes);
    }
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    check_format(reader.format().ok_or(PlateError::Unknown)?, bytes)?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_SIDE);
    limits.max_image_height = Some(MOST_SIDE);
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let mut decoder = reader.into_decoder()?;
    if matches!(decoder.original_color_type(), ExtendedColorType::Cmyk8 | ExtendedColorType::Cmyk16) {
        return Err(PlateError::Cmyk);
    }
    let profile = decoder.icc_profile()?;
    let orientation = decoder.orientation()?;
    let mut picture = DynamicImage::from_decoder(decoder)?;
    picture.apply_orientation(orientation);
    if picture.color().has_alpha() && !is_opaque(&picture) {
        return Err(PlateError::Transparent);
    }
    let is_grey = !picture.color().has_color();
    let size = [picture.width(), picture.height()];
    let samples = samples(picture);
    let codes = match samples {
        Samples::Eight(_) => 256,
        Samples::Sixteen(_) => 65536,
        Samples::Linear(_) => 0,
    };
    let srgb = || -> Vec<f32> { (0..codes).map(|i| from_srgb(i as f64 / (codes - 1) as f64) as f32).collect() };
    let (curves, from_rec709) = match &profile {
        Some(bytes) => profile_curves(bytes, codes, is_grey)?,
        None => ([srgb(), srgb(), srgb()], IDENTITY),
    };
    // A grey profile does not apply to the colours that are written.
    let profile = profile.filter(|_| !is_grey);
    Ok(Plate { size, samples, curves, from_rec709, profile, window: Default::default(), chromaticities: None })
}

/// Checks that a picture is of a supported format, not animated, and not CMYK.
fn check_format(format: ImageFormat, bytes: &[u8]) -> Result<(), PlateError> {
    let is_animated = match format {
        ImageFormat::Png => PngDecoder::new(Cursor::new(bytes)).and_then(|d| d.is_apng())?,
        ImageFormat::WebP => WebPDecoder::new(Cursor::new(bytes))?.has_animation(),
        ImageFormat::Jpeg | ImageFormat::Tiff => false,
        other => return Err(PlateError::Format(other)),
    };
    if is_animated {
        return Err(PlateError::Animated);
    }
    if format == ImageFormat::Jpeg && jpeg_components(bytes) == Some(4) {
        return Err(PlateError::Cmyk);
    }
    Ok(())
}

/// The samples of a picture at its own depth.
fn samples(picture: DynamicImage) -> Samples {
    let is_deep = picture.color().bytes_per_pixel() / picture.color().channel_count() > 1;
    if matches!(picture, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)) {
        Samples::Linear(picture.into_rgb32f().into_raw())
    } else if is_deep {
        Samples::Sixteen(picture.into_rgb16().into_raw())
    } else {
        Samples::Eight(picture.into_rgb8().into_raw())
    }
}

/// Decodes an OpenEXR picture; its colour space is that of its chromaticities, by default Rec. 709.
fn linear(bytes: &[u8]) -> Result<Plate, PlateError> {
    let layers = decode_exr(Cursor::new(bytes))?;
    let pixels = layers.pixels(["R", "G", "B"]).ok_or(PlateError::NoColours)?;
    if layers.channel("A").is_some_and(|alpha| alpha.iter().any(|&a| a < OPAQUE)) {
        return Err(PlateError::Transparent);
    }
    let mut plate = Plate {
        size: [layers.width, layers.height],
        samples: Samples::Linear(pixels.into_flattened()),
        curves: Default::default(),
        from_rec709: IDENTITY,
        profile: None,
        window: layers.window,
        chromaticities: None,
    };
    if let Some(chromaticities) = layers.chromaticities {
        set_chromaticities(&mut plate, chromaticities)?;
    }
    Ok(plate)
}

/// Sets the colour space of a linear plate by CIE xy of red, green, blue and white.
///
/// # Errors
/// [`PlateError::Chromaticities`].
pub fn set_chromaticities(plate: &mut Plate, chromaticities: [f32; 8]) -> Result<(), PlateError> {
    let to_xyz = |xy: [f32; 8]| {
        let [r, g, b, w] = [0, 2, 4, 6].map(|i| {
            let [x, y] = [f64::from(xy[i]), f64::from(xy[i + 1])];
            [x / y, 1.0, (1.0 - x - y) / y]
        });
        // The primaries are scaled to sum to white (SMPTE RP 177).
        let columns = [0, 1, 2].map(|i| [r[i], g[i], b[i]]);
        let scale = apply(&invert(&columns)?, w);
        Some(columns.map(|row| [0, 1, 2].map(|i| row[i] * scale[i])))
    };
    let wrong = || PlateError::Chromaticities;
    let own = to_xyz(chromaticities).ok_or_else(wrong)?;
    let rec709 = to_xyz(REC709).ok_or_else(wrong)?;
    let white = |xy: [f32; 8]| {
        let [x, y] = [f64::from(xy[6]), f64::from(xy[7])];
        [x / y, 1.0, (1.0 - x - y) / y]
    };
    let adapt = bradford(white(REC709), white(chromaticities)).ok_or_else(wrong)?;
    let inverse = invert(&own).ok_or_else(wrong)?;
    plate.from_rec709 = multiply(&inverse, &multiply(&adapt, &rec709));
    if plate.from_rec709.iter().flatten().any(|x| !x.is_finite()) {
        return Err(wrong());
    }
    plate.chromaticities = Some(chromaticities);
    Ok(())
}

/// The chromatic adaptation from one white point to another (Bradford; Lam 1985).
fn bradford(from: [f64; 3], to: [f64; 3]) -> Option<Matrix> {
    const CONES: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    let (a, b) = (apply(&CONES, from), apply(&CONES, to));
    let scaled = [0, 1, 2].map(|i| CONES[i].map(|x| x * b[i] / a[i]));
    Some(multiply(&invert(&CONES)?, &scaled))
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = [0, 1, 2].map(|j| apply(a, [b[0][j], b[1][j], b[2][j]]));
    [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]])
}

fn invert(m: &Matrix) -> Option<Matrix> {
    // Transposed on the way in and on the way out.
    let transposed = DMat3::from_cols_array_2d(m);
    let determinant = transposed.determinant();
    (determinant.is_finite() && determinant.abs() > 1e-12).then(|| transposed.inverse().to_cols_array_2d())
}

/// The tone curves of an ICC profile, tabulated for `codes` code values, and the matrix from Rec. 709.
fn profile_curves(bytes: &[u8], codes: usize, is_grey: bool) -> Result<([Vec<f32>; 3], Matrix), PlateError> {
    let wrong = || PlateError::Profile;
    let profile =
        ColorProfile::new_from_slice(bytes).map_err(|error| PlateError::UnreadableProfile(error.to_string()))?;
    let curve = |curve: &Option<ToneReprCurve>| -> Result<Vec<f32>, PlateError> {
        let curve = curve.as_ref().ok_or_else(wrong)?.make_linear_evaluator().map_err(|_| wrong())?;
        let values: Vec<f32> = (0..codes).map(|i| curve.evaluate_value(i as f32 / (codes - 1) as f32)).collect();
        let rises = values.windows(2).all(|pair| pair[1] >= pair[0]) && values.iter().all(|x| x.is_finite());
        if rises { Ok(values) } else { Err(wrong()) }
    };
    if profile.color_space == DataColorSpace::Gray && is_grey {
        let grey = curve(&profile.gray_trc)?;
        return Ok(([grey.clone(), grey.clone(), grey], IDENTITY));
    }
    if profile.color_space != DataColorSpace::Rgb {
        return Err(wrong());
    }
    let curves = [curve(&profile.red_trc)?, curve(&profile.green_trc)?, curve(&profile.blue_trc)?];
    let own = profile.colorant_matrix().v;
    let srgb = ColorProfile::new_srgb().colorant_matrix().v;
    Ok((curves, multiply(&invert(&own).ok_or_else(wrong)?, &srgb)))
}

/// The photograph resampled to another size.
///
/// # Errors
/// [`PlateError::Window`], [`PlateError::Scale`].
pub fn resize_plate(plate: &Plate, [width, height]: [u32; 2]) -> Result<Plate, PlateError> {
    if plate.window != Default::default() {
        return Err(PlateError::Window);
    }
    let [w, h] = plate.size;
    let wrong = || PlateError::Scale;
    let samples = match &plate.samples {
        Samples::Eight(codes) => {
            let picture = image::RgbImage::from_raw(w, h, codes.clone()).ok_or_else(wrong)?;
            Samples::Eight(imageops::resize(&picture, width, height, FilterType::Triangle).into_raw())
        }
        Samples::Sixteen(codes) => {
            let picture = ImageBuffer::<Rgb<u16>, _>::from_raw(w, h, codes.clone()).ok_or_else(wrong)?;
            Samples::Sixteen(imageops::resize(&picture, width, height, FilterType::Triangle).into_raw())
        }
        Samples::Linear(light) => {
            let picture = image::Rgb32FImage::from_raw(w, h, light.clone()).ok_or_else(wrong)?;
            Samples::Linear(imageops::resize(&picture, width, height, FilterType::Triangle).into_raw())
        }
    };
    Ok(Plate { size: [width, height], samples, ..plate.clone() })
}

/// A greyscale picture resampled to another size.
#[must_use]
pub fn resize_grey(grey: &Grey, [width, height]: [u32; 2]) -> Grey {
    let [w, h] = grey.size();
    let picture = ImageBuffer::from_fn(w, h, |x, y| Luma([grey.pixel(x, y)]));
    let scaled = imageops::resize(&picture, width, height, FilterType::Triangle).into_raw();
    Grey::new(width, height, scaled).unwrap_or_else(|| grey.clone())
}

/// Is every pixel opaque?
fn is_opaque(picture: &DynamicImage) -> bool {
    picture.to_rgba32f().pixels().all(|p| p.0[3] >= OPAQUE)
}

/// The number of components of a JPEG picture, from its frame header.
fn jpeg_components(bytes: &[u8]) -> Option<u8> {
    let mut at = 2;
    loop {
        let [0xff, marker] = *bytes.get(at..at + 2)? else { return None };
        let length = usize::from(u16::from_be_bytes([*bytes.get(at + 2)?, *bytes.get(at + 3)?]));
        // SOF markers, without DHT, JPG and DAC.
        if (0xc0..=0xcf).contains(&marker) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
            return bytes.get(at + 9).copied();
        }
        at += 2 + length;
    }
}
