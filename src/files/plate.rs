//! Photographs in, with everything that says what their numbers mean: JPEG, PNG, TIFF, WebP and OpenEXR.

use std::io::Cursor;

use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::imageops::{self, FilterType};
use image::{DynamicImage, ExtendedColorType, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Limits, Luma, Rgb};
use moxcms::{ColorProfile, DataColorSpace, ToneReprCurve};

use super::exr::{decode_exr, is_exr};
use super::picture::{MOST_BYTES, MOST_SIDE};
use crate::math::{DMat3, from_srgb};
use crate::raster::{Grey, Plate, Samples};

/// CIE xy of red, green, blue and white of ITU-R BT.709.
pub const REC709: [f32; 8] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];
/// CIE xy of red, green, blue and white of ACEScg (AP1).
pub const ACESCG: [f32; 8] = [0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767];
/// A matrix by its rows.
type Matrix = [[f64; 3]; 3];
/// Nothing to convert.
const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Values a picture's alpha may have and still count as none.
const OPAQUE: f32 = 0.999;

/// The photograph in `bytes`, turned as its EXIF data says.
///
/// # Errors
/// A sentence: no such picture, truncated, too large, with transparency, animated, in inks, or with a colour profile that
/// cannot be inverted.
pub fn decode_plate(bytes: &[u8]) -> Result<Plate, String> {
    if is_exr(bytes) {
        return linear(bytes);
    }
    let wrong = |error: image::ImageError| format!("it cannot be decoded: {error}");
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let format = reader.format().ok_or("it is not a JPEG, PNG, TIFF, WebP or OpenEXR picture")?;
    let is_animated = match format {
        ImageFormat::Png => PngDecoder::new(Cursor::new(bytes)).and_then(|d| d.is_apng()).map_err(wrong)?,
        ImageFormat::WebP => WebPDecoder::new(Cursor::new(bytes)).map_err(wrong)?.has_animation(),
        ImageFormat::Jpeg | ImageFormat::Tiff => false,
        other => return Err(format!("it is {other:?}, not a JPEG, PNG, TIFF, WebP or OpenEXR picture")),
    };
    if is_animated {
        return Err("it is animated: give its frames one by one".to_owned());
    }
    if format == ImageFormat::Jpeg && inks(bytes) == Some(4) {
        return Err("it is in inks (CMYK): convert it to RGB first".to_owned());
    }
    let mut reader = reader;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_SIDE);
    limits.max_image_height = Some(MOST_SIDE);
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(wrong)?;
    if matches!(decoder.original_color_type(), ExtendedColorType::Cmyk8 | ExtendedColorType::Cmyk16) {
        return Err("it is in inks (CMYK): convert it to RGB first".to_owned());
    }
    let profile = decoder.icc_profile().map_err(wrong)?;
    let turn = decoder.orientation().map_err(wrong)?;
    let mut picture = DynamicImage::from_decoder(decoder).map_err(wrong)?;
    picture.apply_orientation(turn);
    if picture.color().has_alpha() && !is_opaque(&picture) {
        return Err("it is transparent in places: lay it over something first".to_owned());
    }
    let is_grey = !picture.color().has_color();
    let size = [picture.width(), picture.height()];
    let is_deep = picture.color().bytes_per_pixel() / picture.color().channel_count() > 1;
    let samples = if matches!(picture, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)) {
        Samples::Linear(picture.into_rgb32f().into_raw())
    } else if is_deep {
        Samples::Sixteen(picture.into_rgb16().into_raw())
    } else {
        Samples::Eight(picture.into_rgb8().into_raw())
    };
    let codes = match samples {
        Samples::Eight(_) => 256,
        Samples::Sixteen(_) => 65536,
        Samples::Linear(_) => 0,
    };
    let plain =
        |codes: usize| -> Vec<f32> { (0..codes).map(|i| from_srgb(i as f64 / (codes - 1) as f64) as f32).collect() };
    let (curves, from_rec709) = match &profile {
        Some(bytes) => profile_curves(bytes, codes, is_grey)?,
        None => ([plain(codes), plain(codes), plain(codes)], IDENTITY),
    };
    // A grey profile says nothing of the colours that are written.
    let profile = profile.filter(|_| !is_grey);
    Ok(Plate { size, samples, curves, from_rec709, profile, window: Default::default(), chromaticities: None })
}

/// A picture in linear light, its own colours told by its chromaticities, Rec. 709 where it has none.
fn linear(bytes: &[u8]) -> Result<Plate, String> {
    let layers = decode_exr(bytes)?;
    let pixels = layers.pixels(["R", "G", "B"]).ok_or("it has no channels R, G and B")?;
    if layers.channel("A").is_some_and(|alpha| alpha.iter().any(|&a| a < OPAQUE)) {
        return Err("it is transparent in places: lay it over something first".to_owned());
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

/// Says what the colours of a linear plate are.
///
/// # Errors
/// A sentence where they are no colours.
pub fn set_chromaticities(plate: &mut Plate, chromaticities: [f32; 8]) -> Result<(), String> {
    let to_xyz = |xy: [f32; 8]| {
        let [r, g, b, w] = [0, 2, 4, 6].map(|i| {
            let [x, y] = [f64::from(xy[i]), f64::from(xy[i + 1])];
            [x / y, 1.0, (1.0 - x - y) / y]
        });
        // The primaries scaled so that they make white (SMPTE RP 177).
        let columns = [0, 1, 2].map(|i| [r[i], g[i], b[i]]);
        let scale = apply(&invert(&columns)?, w);
        Some(columns.map(|row| [0, 1, 2].map(|i| row[i] * scale[i])))
    };
    let wrong = "its chromaticities are no colours";
    let own = to_xyz(chromaticities).ok_or(wrong)?;
    let rec709 = to_xyz(REC709).ok_or(wrong)?;
    let white = |xy: [f32; 8]| {
        let [x, y] = [f64::from(xy[6]), f64::from(xy[7])];
        [x / y, 1.0, (1.0 - x - y) / y]
    };
    let adapt = bradford(white(REC709), white(chromaticities)).ok_or(wrong)?;
    let inverse = invert(&own).ok_or(wrong)?;
    plate.from_rec709 = multiply(&inverse, &multiply(&adapt, &rec709));
    if plate.from_rec709.iter().flatten().any(|x| !x.is_finite()) {
        return Err(wrong.to_owned());
    }
    plate.chromaticities = Some(chromaticities);
    Ok(())
}

/// Chromatic adaptation from one white to another (Bradford; Lam 1985).
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
    // Rows taken for columns both ways.
    let inverse = DMat3::from_cols_array_2d(m);
    let determinant = inverse.determinant();
    (determinant.is_finite() && determinant.abs() > 1e-12).then(|| inverse.inverse().to_cols_array_2d())
}

/// The curves of a profile for so many codes, and the matrix from Rec. 709.
fn profile_curves(bytes: &[u8], codes: usize, is_grey: bool) -> Result<([Vec<f32>; 3], Matrix), String> {
    let wrong = || "its colour profile is not one of tone curves and primaries: convert it to sRGB first".to_owned();
    let profile = ColorProfile::new_from_slice(bytes).map_err(|e| format!("its colour profile cannot be read: {e}"))?;
    let curve = |curve: &Option<ToneReprCurve>| -> Result<Vec<f32>, String> {
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

/// The photograph in another size.
///
/// # Errors
/// A sentence where its data window is not the whole picture.
pub fn resize_plate(plate: &Plate, [width, height]: [u32; 2]) -> Result<Plate, String> {
    if plate.window != Default::default() {
        return Err("a photograph with a data window of its own keeps its size".to_owned());
    }
    let [w, h] = plate.size;
    let wrong = || "the photograph cannot be scaled".to_owned();
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

/// A greyscale picture in another size.
#[must_use]
pub fn resize_grey(grey: &Grey, [width, height]: [u32; 2]) -> Grey {
    let [w, h] = grey.size();
    let picture = ImageBuffer::from_fn(w, h, |x, y| Luma([grey.pixel(x, y)]));
    let scaled = imageops::resize(&picture, width, height, FilterType::Triangle).into_raw();
    Grey::new(width, height, scaled).unwrap_or_else(|| grey.clone())
}

fn is_opaque(picture: &DynamicImage) -> bool {
    picture.to_rgba32f().pixels().all(|p| p.0[3] >= OPAQUE)
}

/// How many components a JPEG picture has, from its frame header.
fn inks(bytes: &[u8]) -> Option<u8> {
    let mut at = 2;
    loop {
        let [0xff, marker] = *bytes.get(at..at + 2)? else { return None };
        let length = usize::from(u16::from_be_bytes([*bytes.get(at + 2)?, *bytes.get(at + 3)?]));
        // Start-of-frame markers but for the tables among them.
        if (0xc0..=0xcf).contains(&marker) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
            return bytes.get(at + 9).copied();
        }
        at += 2 + length;
    }
}
