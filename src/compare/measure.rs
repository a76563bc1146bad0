//! Image difference metrics.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::flip::{self, PIXELS_PER_DEGREE, Tile, Tiles, flip_hdr, flip_ldr};
use super::rank::ranked;
use crate::math::to_srgb;
use crate::raster::Layers;

/// Differences above this count in [`Measures::share`]: more than rounding makes.
const NOTICED: f64 = 2.0 / 255.0;

/// Why pictures cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// The sizes differ.
    #[error("sizes differ: {} by {} expected, {} by {} there", expected[0], expected[1], actual[0], actual[1])]
    Size {
        /// Width and height expected.
        expected: [u32; 2],
        /// Width and height found.
        actual: [u32; 2],
    },
    /// The expected picture has no such channel or layer.
    #[error("it has no channel or layer `{name}`; it has {}", known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// The channels that there are.
        known: Vec<String>,
    },
    /// The actual picture has no such channel.
    #[error("channel `{0}` is missing")]
    Missing(String),
}

/// The differences of two pictures of the same size.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Measures {
    /// FLIP: its mean.
    pub flip: f64,
    /// FLIP: what 95 % of the pixels stay below.
    pub flip_95: f64,
    /// FLIP: its largest.
    pub flip_max: f64,
    /// The largest difference of a channel: encoded, from 0 to 1, for screen pictures; in linear light for EXR.
    pub max: f64,
    /// The root of the mean square of these differences.
    pub rms: f64,
    /// The share of pixels with a difference above 2/255.
    pub share: f64,
    /// FLIP a pixel.
    #[serde(skip)]
    pub map: Vec<f32>,
}

/// What decides whether two pictures are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// Mean FLIP.
    Flip,
    /// The FLIP that 95 % of the pixels stay below.
    #[serde(rename = "flip-95")]
    Flip95,
    /// The largest FLIP: a change anywhere counts.
    #[default]
    FlipMax,
    /// The largest difference.
    Max,
    /// Root-mean-square difference.
    Rms,
    /// Share of pixels that differ by more than 2/255.
    Share,
}

impl Metric {
    /// The value above which pictures differ, unless another is given.
    #[must_use]
    pub fn threshold(self) -> f64 {
        match self {
            Self::Flip => 0.01,
            Self::Flip95 => 0.05,
            Self::FlipMax => 0.1,
            Self::Max => NOTICED,
            Self::Rms => 0.002,
            Self::Share => 0.001,
        }
    }

    /// Its name, as it is chosen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Flip => "flip",
            Self::Flip95 => "flip-95",
            Self::FlipMax => "flip-max",
            Self::Max => "max",
            Self::Rms => "rms",
            Self::Share => "share",
        }
    }

    /// Its value among `measures`.
    #[must_use]
    pub fn of(self, measures: &Measures) -> f64 {
        match self {
            Self::Flip => measures.flip,
            Self::Flip95 => measures.flip_95,
            Self::FlipMax => measures.flip_max,
            Self::Max => measures.max,
            Self::Rms => measures.rms,
            Self::Share => measures.share,
        }
    }
}

/// The channels that `chosen` selects, by channel or by layer (`glow`, `N`); by default `R G B A`, or all if there are none of
/// these.
fn chosen_channels(picture: &Layers, chosen: &[String]) -> Result<Vec<String>, CompareError> {
    let names = || picture.channels.iter().map(|c| c.name.clone());
    if chosen.is_empty() {
        let colours: Vec<String> = names().filter(|n| ["R", "G", "B", "A"].contains(&n.as_str())).collect();
        return Ok(if colours.is_empty() { names().collect() } else { colours });
    }
    let mut all = Vec::new();
    for choice in chosen {
        let before = all.len();
        all.extend(names().filter(|n| n == choice || n.rsplit_once('.').is_some_and(|(layer, _)| layer == choice)));
        if all.len() == before {
            return Err(CompareError::Unknown { name: choice.clone(), known: names().collect() });
        }
    }
    Ok(all)
}

/// Bytes that comparing two pictures of so many pixels and channels each takes, from reading them to their [`Measures`].
#[must_use]
pub fn bytes_needed(pixels: [u64; 2], channels: [u64; 2]) -> u64 {
    let samples = [0, 1].map(|i| pixels[i].saturating_mul(channels[i]).saturating_mul(4));
    // A decoder has the picture as it was stored besides its samples.
    let decoded = pixels[1].saturating_mul(8);
    samples[0].saturating_add(samples[1]).saturating_add(decoded.max(flip::bytes_needed(pixels[0])))
}

/// The differences of some pixels.
#[derive(Clone, Copy, Default)]
struct Differences {
    /// The sum of their squares.
    squares: f64,
    /// The largest.
    max: f64,
    /// Pixels with one above [`NOTICED`].
    noticed: usize,
}

impl Differences {
    /// Adds a pixel with the differences of its channels.
    fn add(&mut self, channels: impl Iterator<Item = f64>) {
        let mut worst = 0.0_f64;
        for d in channels {
            self.squares += d * d;
            worst = worst.max(d);
        }
        self.max = self.max.max(worst);
        self.noticed += usize::from(worst > NOTICED);
    }

    fn and(self, other: &Self) -> Self {
        Self {
            squares: self.squares + other.squares,
            max: self.max.max(other.max),
            noticed: self.noticed + other.noticed,
        }
    }
}

/// FLIP a pixel of `expected` and `actual`, of red, green and blue if they are among `names`, otherwise of the first as grey.
fn flip_map(pictures: [&Layers; 2], names: &[String], is_hdr: bool) -> Vec<f32> {
    let [width, height] = [pictures[0].width, pictures[0].height].map(|side| side as usize);
    let of_layer = |c: &str| names.iter().find(|n| *n == c || n.ends_with(&format!(".{c}"))).map(String::as_str);
    let first = names.first().map_or("", String::as_str);
    let rgb = match (of_layer("R"), of_layer("G"), of_layer("B")) {
        (Some(r), Some(g), Some(b)) => [r, g, b],
        _ => [first; 3],
    };
    let colours = pictures.map(|picture| rgb.map(|name| picture.channel(name).unwrap_or(&[])));
    // FLIP is undefined for infinities.
    let finite = |x: f32| if x.is_finite() { x } else { f32::MAX.sqrt() };
    let read = |tile: &Tile| {
        let at = || tile.y.clone().flat_map(|y| tile.x.clone().map(move |x| y * width + x));
        colours.map(|colours| at().map(|i| colours.map(|c| finite(c[i]))).collect())
    };
    let tiles = Tiles { size: [width, height], read: &read };
    if is_hdr { flip_hdr(&tiles, PIXELS_PER_DEGREE) } else { flip_ldr(&tiles, PIXELS_PER_DEGREE) }
}

/// The differences between `actual` and `expected` in the channels that `chosen` selects. FLIP compares red, green and blue if
/// they are among them, otherwise the first channel as grey. `is_hdr` compares linear light, otherwise values are
/// sRGB-encoded.
///
/// # Errors
/// [`CompareError`].
pub fn measure(expected: &Layers, actual: &Layers, chosen: &[String], is_hdr: bool) -> Result<Measures, CompareError> {
    if (expected.width, expected.height) != (actual.width, actual.height) {
        let size = |picture: &Layers| [picture.width, picture.height];
        return Err(CompareError::Size { expected: size(expected), actual: size(actual) });
    }
    let names = chosen_channels(expected, chosen)?;
    let mut pairs = Vec::new();
    for name in &names {
        let there = actual.channel(name).ok_or_else(|| CompareError::Missing(name.clone()))?;
        pairs.push((expected.channel(name).unwrap_or(&[]), there));
    }
    let show = |x: f32, name: &str| match is_hdr || name == "A" {
        true => f64::from(x),
        false => to_srgb(f64::from(x)),
    };
    let [width, height] = [expected.width, expected.height].map(|side| side as usize);
    let pixels = width * height;
    let difference = |c: usize, i: usize| {
        let (a, b) = (pairs[c].0[i], pairs[c].1[i]);
        // Equal bits, also of infinities, are no difference.
        let d = if a.to_bits() == b.to_bits() { 0.0 } else { (show(a, &names[c]) - show(b, &names[c])).abs() };
        if d.is_nan() { f64::INFINITY } else { d }
    };
    let of_row = |y: usize| {
        let mut row = Differences::default();
        (y * width..(y + 1) * width).for_each(|i| row.add((0..pairs.len()).map(|c| difference(c, i))));
        row
    };
    // Row by row, so that the sum is the same on any number of threads.
    let rows: Vec<Differences> = (0..height).into_par_iter().map(of_row).collect();
    let all = rows.iter().fold(Differences::default(), Differences::and);
    let map = flip_map([expected, actual], &names, is_hdr);
    let values = |visit: &mut dyn FnMut(f64)| map.iter().map(|&x| f64::from(x)).for_each(visit);
    Ok(Measures {
        flip: map.iter().map(|&x| f64::from(x)).sum::<f64>() / pixels as f64,
        flip_95: ranked(&values, |count| (count * 95).div_ceil(100).max(1) - 1).unwrap_or(0.0),
        flip_max: map.iter().copied().fold(0.0, f32::max).into(),
        max: all.max,
        rms: libm::sqrt(all.squares / (pixels * names.len().max(1)) as f64),
        share: all.noticed as f64 / pixels as f64,
        map,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Channel;

    fn picture(values: &[(&str, [f32; 4])]) -> Layers {
        let channel =
            |(name, v): &(&str, [f32; 4])| Channel { name: (*name).to_owned(), values: v.to_vec(), is_half: false };
        Layers { width: 2, height: 2, channels: values.iter().map(channel).collect(), ..Layers::default() }
    }

    #[test]
    fn plain_errors_are_plain() {
        let a = picture(&[("R", [0.0; 4]), ("G", [0.0; 4]), ("B", [0.0; 4]), ("Z", [f32::INFINITY; 4])]);
        let b = picture(&[
            ("R", [0.0, 0.0, 1.0, 0.0]),
            ("G", [0.0; 4]),
            ("B", [0.0; 4]),
            ("Z", [f32::INFINITY, 1.0, 2.0, f32::NAN]),
        ]);
        let m = measure(&a, &b, &[], false).unwrap();
        assert!((m.max - 1.0).abs() < 1e-12 && m.share == 0.25);
        assert!((m.rms - libm::sqrt(1.0 / 12.0)).abs() < 1e-12);
        assert!(m.flip_max > 0.0 && m.flip < m.flip_max);
        let z = measure(&a, &b, &["Z".to_owned()], true).unwrap();
        assert_eq!((z.max, z.share), (f64::INFINITY, 0.75));
        let error = measure(&a, &b, &["N".to_owned()], true).unwrap_err();
        assert_eq!(error.to_string(), "it has no channel or layer `N`; it has R, G, B, Z");
    }
}
