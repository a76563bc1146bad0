//! FLIP: the perceived difference, 0 to 1 a pixel, when one flips between two pictures (Andersson et al. 2020; for high dynamic
//! range 2021). Locals carry the papers' letters.

use std::f64::consts::PI;
use std::ops::Range;

use rayon::prelude::*;

use super::rank::ranked;
use crate::math::power;

/// Pixels per degree of visual angle of a 0.7 m wide screen of 3840 pixels at a distance of 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.020_645;

/// Exponent of the colour difference.
const Q_C: f64 = 0.7;
/// The knee of the map of colour differences, as a share of the largest.
const P_C: f64 = 0.4;
/// The value at the knee.
const P_T: f64 = 0.95;
/// Exponent of the feature difference.
const Q_F: f64 = 0.5;
/// Width of the feature detectors, in degrees.
const W: f64 = 0.082;

type Pixel = [f64; 3];

/// The white point: linear RGB (1, 1, 1).
const WHITE: Pixel = [0.950_428_545_377, 1.0, 1.088_900_370_798];

/// CIE XYZ of linear sRGB, by the fractions that NVIDIA's implementation uses.
fn xyz([r, g, b]: Pixel) -> Pixel {
    [
        0.412_386_563_253 * r + 0.357_591_490_921 * g + 0.180_450_491_204 * b,
        0.212_636_821_677 * r + 0.715_182_981_841 * g + 0.072_180_196_481 * b,
        0.019_330_620_152 * r + 0.119_197_163_640 * g + 0.950_372_587_005 * b,
    ]
}

/// The inverse of [`xyz`].
fn rgb([x, y, z]: Pixel) -> Pixel {
    [
        3.241_003_232_976 * x - 1.537_398_969_489 * y - 0.498_615_881_996 * z,
        -0.969_224_252_203 * x + 1.875_929_983_695 * y + 0.041_554_226_340 * z,
        0.055_639_419_852 * x - 0.204_011_206_124 * y + 1.057_148_977_188 * z,
    ]
}

/// The opponent space YyCxCz.
fn opponent(linear: Pixel) -> Pixel {
    let [x, y, z] = xyz(linear);
    let (x, y, z) = (x / WHITE[0], y / WHITE[1], z / WHITE[2]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([y, c_x, c_z]: Pixel) -> Pixel {
    let y = (y + 16.0) / 116.0;
    rgb([(y + c_x / 500.0) * WHITE[0], y * WHITE[1], (y - c_z / 200.0) * WHITE[2]])
}

/// CIELAB adjusted for the Hunt effect: chroma in proportion to lightness.
fn hunt(linear: Pixel) -> Pixel {
    let delta: f64 = 6.0 / 29.0;
    let f = |t: f64| {
        if t > delta * delta * delta { libm::cbrt(t) } else { t / (3.0 * delta * delta) + 4.0 / 29.0 }
    };
    let [x, y, z] = xyz(linear);
    let (x, y, z) = (f(x / WHITE[0]), f(y / WHITE[1]), f(z / WHITE[2]));
    let l = 116.0 * y - 16.0;
    [l, 500.0 * (x - y) * 0.01 * l, 200.0 * (y - z) * 0.01 * l]
}

/// The HyAB distance: city-block in lightness, Euclidean in chroma.
fn hyab(a: Pixel, b: Pixel) -> f64 {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    d[0].abs() + libm::sqrt(d[1] * d[1] + d[2] * d[2])
}

/// A picture of one channel.
struct GreyPlane {
    width: usize,
    values: Vec<f64>,
}

impl GreyPlane {
    /// Separable convolution with `across` along rows and `down` along columns, both centred; clamped to the edge.
    fn convolve(&self, across: &[f64], down: &[f64]) -> Self {
        let (width, height) = (self.width, self.values.len() / self.width);
        let near = |at: usize, half: usize, most: usize| at.saturating_sub(half).min(most - 1);
        let mut rows = vec![0.0; self.values.len()];
        rows.par_chunks_mut(width).zip(self.values.par_chunks(width)).for_each(|(row, values)| {
            let half = across.len() / 2;
            let padded: Vec<f64> = (0..width + across.len() - 1).map(|x| values[near(x, half, width)]).collect();
            weighted_sum(across, |i| &padded[i..], row);
        });
        let mut values = vec![0.0; rows.len()];
        values.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            weighted_sum(down, |i| &rows[near(y + i, down.len() / 2, height) * width..], row);
        });
        Self { width, values }
    }
}

/// Adds `row(i)` to `sum` for each weight i.
fn weighted_sum<'a>(weights: &[f64], row: impl Fn(usize) -> &'a [f64], sum: &mut [f64]) {
    for (i, weight) in weights.iter().enumerate() {
        sum.iter_mut().zip(row(i)).for_each(|(sum, value)| *sum += weight * value);
    }
}

/// A Gaussian of the contrast sensitivity function: `exp(-pi^2 x^2 / b)`, x in degrees, up to `radius` pixels.
fn sensitivity(b: f64, radius: i64, ppd: f64) -> Vec<f64> {
    (-radius..=radius).map(|i| i as f64 / ppd).map(|x| libm::exp(-PI * PI * x * x / b)).collect()
}

/// An opponent channel filtered by the contrast sensitivity function: a sum of Gaussians (a, b), normalised.
fn seen(plane: &GreyPlane, gaussians: &[(f64, f64)], radius: i64, ppd: f64) -> GreyPlane {
    let parts: Vec<(f64, Vec<f64>)> =
        gaussians.iter().map(|&(a, b)| (a * libm::sqrt(PI / b), sensitivity(b, radius, ppd))).collect();
    let total: f64 = parts
        .iter()
        .map(|(scale, kernel)| {
            let sum: f64 = kernel.iter().sum();
            scale * sum * sum
        })
        .sum();
    let mut values = vec![0.0; plane.values.len()];
    for (scale, kernel) in &parts {
        let part = plane.convolve(kernel, kernel);
        values.iter_mut().zip(&part.values).for_each(|(sum, x)| *sum += x * scale / total);
    }
    GreyPlane { width: plane.width, values }
}

/// The radius of all filters of colours: that of the widest Gaussian (section 4.1.1).
fn colour_radius(ppd: f64) -> i64 {
    libm::ceil(3.0 * libm::sqrt(0.04 / (2.0 * PI * PI)) * ppd) as i64
}

/// The standard deviation of the feature detectors, and their radius.
fn feature_size(ppd: f64) -> (f64, i64) {
    let sd = 0.5 * W * ppd;
    (sd, libm::ceil(3.0 * sd) as i64)
}

/// Pixels around one that its FLIP depends on.
fn reach(ppd: f64) -> usize {
    colour_radius(ppd).max(feature_size(ppd).1) as usize
}

/// The perceived colours: filtered, clamped to the gamut, in Hunt-adjusted CIELAB (section 4.1).
fn perceived(width: usize, pixels: &[Pixel], ppd: f64) -> Vec<Pixel> {
    let radius = colour_radius(ppd);
    let plane = |i: usize| GreyPlane { width, values: pixels.iter().map(|p| p[i]).collect() };
    let y = seen(&plane(0), &[(1.0, 0.0047)], radius, ppd);
    let c_x = seen(&plane(1), &[(1.0, 0.0053)], radius, ppd);
    let c_z = seen(&plane(2), &[(34.1, 0.04), (13.5, 0.025)], radius, ppd);
    (0..pixels.len())
        .into_par_iter()
        .map(|i| hunt(from_opponent([y.values[i], c_x.values[i], c_z.values[i]]).map(|x| x.clamp(0.0, 1.0))))
        .collect()
}

/// The responses of the edge and the point detector at each pixel (section 4.2).
fn features(width: usize, pixels: &[Pixel], ppd: f64) -> Vec<[f64; 2]> {
    let grey = GreyPlane { width, values: pixels.iter().map(|p| (p[0] + 16.0) / 116.0).collect() };
    let (sd, radius) = feature_size(ppd);
    let gauss: Vec<f64> = (-radius..=radius).map(|x| libm::exp(-(x * x) as f64 / (2.0 * sd * sd))).collect();
    // Positive and negative weights each sum to 1.
    let balanced = |weights: Vec<f64>| -> Vec<f64> {
        let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
        let negative: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
        weights.into_iter().map(|w| if w > 0.0 { w / positive } else { w / negative.max(f64::MIN_POSITIVE) }).collect()
    };
    let along = |weight: &dyn Fn(f64) -> f64| {
        balanced((-radius..=radius).zip(&gauss).map(|(x, g)| weight(x as f64) * g).collect())
    };
    let first = along(&|x| -x);
    let second = along(&|x| x * x / (sd * sd) - 1.0);
    let blur = balanced(gauss.clone());
    let (ex, ey) = (grey.convolve(&first, &blur), grey.convolve(&blur, &first));
    let (px, py) = (grey.convolve(&second, &blur), grey.convolve(&blur, &second));
    let length = |a: f64, b: f64| libm::sqrt(a * a + b * b);
    (0..pixels.len()).map(|i| [length(ex.values[i], ey.values[i]), length(px.values[i], py.values[i])]).collect()
}

/// LDR-FLIP of pixels in linear light from 0 to 1.
fn ldr(width: usize, pictures: [&[[f32; 3]]; 2], ppd: f64) -> Vec<f32> {
    let [(colour_r, feature_r), (colour_t, feature_t)] = pictures.map(|pixels| {
        let shown: Vec<Pixel> = pixels.par_iter().map(|p| opponent(p.map(|x| f64::from(x).clamp(0.0, 1.0)))).collect();
        (perceived(width, &shown, ppd), features(width, &shown, ppd))
    });
    let c_max = power(hyab(hunt([0.0, 1.0, 0.0]), hunt([0.0, 0.0, 1.0])), Q_C);
    (0..colour_r.len())
        .into_par_iter()
        .map(|i| {
            let c = power(hyab(colour_r[i], colour_t[i]), Q_C);
            let bend = P_C * c_max;
            let e_c = if c < bend { c * P_T / bend } else { P_T + (c - bend) / (c_max - bend) * (1.0 - P_T) };
            let d = |k: usize| (feature_r[i][k] - feature_t[i][k]).abs();
            let e_f = power(std::f64::consts::FRAC_1_SQRT_2 * if d(0) > d(1) { d(0) } else { d(1) }, Q_F);
            power(e_c, 1.0 - e_f) as f32
        })
        .collect()
}

/// A part of a picture.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Columns.
    pub x: Range<usize>,
    /// Rows.
    pub y: Range<usize>,
}

/// Two pictures of one size, read tile by tile.
pub struct Tiles<'a> {
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// The pixels of a tile in linear light, row by row, expected and actual.
    pub read: &'a (dyn Fn(&Tile) -> [Vec<[f32; 3]>; 2] + Sync),
}

/// Pixels along a side of what is worked on at once.
const SIDE: usize = 256;
/// Bytes that a pixel of a tile takes meanwhile: both pictures (24), and in HDR-FLIP their exposures and the maximum (28); colours
/// and features of the one that is done (40); the opponent colours of the other (24) and six planes of its filters (48).
const PIXEL_BYTES: u64 = 164;

/// Bytes that FLIP of so many pixels takes at its peak besides the pictures: its map, and a tile on its way.
pub(super) fn bytes_needed(pixels: u64) -> u64 {
    let side = (SIDE + 2 * reach(PIXELS_PER_DEGREE)) as u64;
    pixels.saturating_mul(4).saturating_add(pixels.min(side * side) * PIXEL_BYTES)
}

impl Tiles<'_> {
    /// The tiles of so many pixels a side.
    fn tiles(&self, side: usize) -> impl Iterator<Item = Tile> + use<> {
        let [width, height] = self.size;
        let part = move |i: usize, most: usize| i * side..((i + 1) * side).min(most);
        let rows = (0..height.div_ceil(side)).map(move |i| part(i, height));
        rows.flat_map(move |y| (0..width.div_ceil(side)).map(move |i| Tile { x: part(i, width), y: y.clone() }))
    }

    /// What `flip` makes of all tiles of so many pixels a `side`; it is given each with what filters reach around it, and the
    /// pixels in a row of that.
    fn map(&self, side: usize, ppd: f64, flip: impl Fn(usize, [&[[f32; 3]]; 2]) -> Vec<f32>) -> Vec<f32> {
        let [width, height] = self.size;
        let reach = reach(ppd);
        let grown = |part: &Range<usize>, most: usize| part.start.saturating_sub(reach)..(part.end + reach).min(most);
        let mut map = vec![0.0; width * height];
        for tile in self.tiles(side) {
            let around = Tile { x: grown(&tile.x, width), y: grown(&tile.y, height) };
            let [expected, actual] = (self.read)(&around);
            let values = flip(around.x.len(), [&expected, &actual]);
            for y in tile.y {
                let from = (y - around.y.start) * around.x.len() + tile.x.start - around.x.start;
                let row = &values[from..from + tile.x.len()];
                map[y * width..][tile.x.clone()].copy_from_slice(row);
            }
        }
        map
    }
}

/// LDR-FLIP: the difference of each pixel in linear light, clamped to 0 to 1. `ppd` is the pixels per degree, by default
/// [`PIXELS_PER_DEGREE`].
#[must_use]
pub fn flip_ldr(tiles: &Tiles<'_>, ppd: f64) -> Vec<f32> {
    tiles.map(SIDE, ppd, |width, pixels| ldr(width, pixels, ppd))
}

/// The ACES tone mapping of HDR-FLIP, as a rational function (Narkowicz 2015).
fn aces(x: f64) -> f64 {
    let x = x * 0.6;
    ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
}

/// HDR-FLIP: the maximum of LDR-FLIP over exposures, from that at which the brightest pixel of `expected` is mapped to 0.85 to that
/// at which its median is (Andersson et al. 2021, section 3).
#[must_use]
pub fn flip_hdr(tiles: &Tiles<'_>, ppd: f64) -> Vec<f32> {
    let luminance = |visit: &mut dyn FnMut(f64)| {
        for [expected, _] in tiles.tiles(SIDE).map(|tile| (tiles.read)(&tile)) {
            expected.iter().map(|p| xyz(p.map(f64::from))[1]).filter(|y| y.is_finite()).for_each(&mut *visit);
        }
    };
    // The input that tone mapping maps to 0.85.
    let t = 0.85;
    let (a, b, c) = (0.36 * (2.51 - t * 2.43), 0.6 * (0.03 - t * 0.59), -t * 0.14);
    let x_max = (-b + libm::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
    let median = ranked(&luminance, |count| count / 2).unwrap_or(1.0).max(f64::from(f32::EPSILON));
    let most = ranked(&luminance, |count| count.saturating_sub(1)).unwrap_or(1.0).max(median);
    let (start, stop) = (libm::log2(x_max / most), libm::log2(x_max / median));
    let count = libm::ceil(stop - start).clamp(2.0, 64.0);
    tiles.map(SIDE, ppd, |width, pixels| {
        let mut flip = vec![0.0_f32; pixels[0].len()];
        for i in 0..count as u32 {
            let scale = libm::exp2(start + (stop - start) * f64::from(i) / (count - 1.0));
            let [expected, actual] = pixels.map(|pixels| -> Vec<[f32; 3]> {
                pixels.par_iter().map(|p| p.map(|x| aces(f64::from(x).max(0.0) * scale) as f32)).collect()
            });
            for (most, x) in flip.iter_mut().zip(ldr(width, [&expected, &actual], ppd)) {
                if x > *most {
                    *most = x;
                }
            }
        }
        flip
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Colour, Stream};
    use rand::RngExt;

    /// Two pictures of shapes, gradients and noise, as bytes.
    fn pair(width: u32, height: u32, seed: u64) -> [Vec<[u8; 3]>; 2] {
        let mut random = Stream::new(seed, "pictures");
        let mut expected = Vec::new();
        let mut actual = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let disc = (f64::from(x) - 20.0).square() + (f64::from(y) - 15.0).square() < 90.0;
                let base = if disc { [200, 40, 30] } else { [(x * 255 / width) as u8, (y * 255 / height) as u8, 90] };
                expected.push(base.map(|c: u8| c.saturating_add(random.random_range(0..20))));
                let moved = (f64::from(x) - 23.0).square() + (f64::from(y) - 15.0).square() < 80.0;
                let base = if moved { [190, 60, 30] } else { [(x * 250 / width) as u8, (y * 255 / height) as u8, 80] };
                actual.push(base.map(|c: u8| c.saturating_add(random.random_range(0..20))));
            }
        }
        [expected, actual]
    }

    trait Square {
        fn square(self) -> f64;
    }

    impl Square for f64 {
        fn square(self) -> f64 {
            self * self
        }
    }

    type Flip = fn(&Tiles<'_>, f64) -> Vec<f32>;

    fn flip(flip: Flip, width: usize, pictures: [&[[f32; 3]]; 2]) -> Vec<f32> {
        with_tiles(width, pictures, |tiles| flip(tiles, PIXELS_PER_DEGREE))
    }

    fn with_tiles<T>(width: usize, [expected, actual]: [&[[f32; 3]]; 2], of: impl FnOnce(&Tiles<'_>) -> T) -> T {
        let read = |tile: &Tile| {
            [expected, actual]
                .map(|pixels| tile.y.clone().flat_map(|y| &pixels[y * width..][tile.x.clone()]).copied().collect())
        };
        of(&Tiles { size: [width, expected.len() / width], read: &read })
    }

    fn linear(pixels: &[[u8; 3]]) -> Vec<[f32; 3]> {
        pixels.iter().map(|&p| Colour::from_srgb(p).0.map(|x| x as f32)).collect()
    }

    /// Against NVIDIA's implementation.
    #[test]
    fn agrees_with_nvidia() {
        for (width, height, seed) in [(64, 48, 1), (33, 70, 2), (5, 3, 3)] {
            let [expected, actual] = pair(width, height, seed);
            let ours = flip(flip_ldr, width as usize, [&linear(&expected), &linear(&actual)]);
            let picture = |p: &[[u8; 3]]| nv_flip::FlipImageRgb8::with_data(width, height, p.as_flattened());
            let theirs = nv_flip::flip(picture(&expected), picture(&actual), PIXELS_PER_DEGREE as f32);
            let worst = ours.iter().zip(theirs.to_vec()).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
            assert!(worst < 1e-4, "{width}x{height}: {worst}");
        }
    }

    /// Against NVIDIA's `flip-evaluator` 1.7: the mean, 0.043_700, and two pixels.
    #[test]
    fn high_dynamic_range_agrees_with_nvidia() {
        let (width, height) = (48_u32, 32_u32);
        let [mut expected, mut actual] = [Vec::new(), Vec::new()];
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let (u, y0) = (x as f32 / width as f32, y as f32);
            let v = u * u * u * 20.0 + 0.01 * y0;
            let brighter = if x > 20 && x < 30 && y > 10 && y < 20 { 1.5 } else { 1.0 };
            let blue = 0.3 * y0 / height as f32;
            expected.push([v, v * 0.5 + 0.02, blue]);
            actual.push([v * brighter, v * 0.5 + 0.02, blue * brighter + 0.001]);
        }
        let flip = flip(flip_hdr, width as usize, [&expected, &actual]);
        let mean = flip.iter().sum::<f32>() / flip.len() as f32;
        assert!((mean - 0.043_700).abs() < 1e-4, "{mean}");
        assert!((flip[15 * 48 + 25] - 0.332_805).abs() < 1e-4 && (flip[3 * 48 + 3] - 0.017_351).abs() < 1e-4);
    }

    /// Tiles give what the whole picture gives, to the bit.
    #[test]
    fn tiles_do_not_show() {
        let (width, height) = (320, 150);
        let [expected, actual] = pair(width, height, 5).map(|pixels| linear(&pixels));
        let width = width as usize;
        let whole = ldr(width, [&expected, &actual], PIXELS_PER_DEGREE);
        let tiles = with_tiles(width, [&expected, &actual], |tiles| {
            assert_eq!(tiles.tiles(48).count(), 7 * 4);
            tiles.map(48, PIXELS_PER_DEGREE, |width, pixels| ldr(width, pixels, PIXELS_PER_DEGREE))
        });
        assert!(tiles == whole);
    }

    #[test]
    fn the_same_is_no_difference() {
        let [expected, _] = pair(20, 20, 4);
        let pixels = linear(&expected);
        assert!(flip(flip_ldr, 20, [&pixels, &pixels]).iter().all(|&x| x == 0.0));
        let bright: Vec<[f32; 3]> = pixels.iter().map(|p| p.map(|x| x * 40.0)).collect();
        assert!(flip(flip_hdr, 20, [&bright, &bright]).iter().all(|&x| x == 0.0));
        assert!(flip(flip_hdr, 20, [&bright, &pixels]).iter().all(|&x| x > 0.0));
        let black = vec![[0.0; 3]; 4];
        assert!(flip(flip_hdr, 2, [&black, &black]).iter().all(|&x| x == 0.0));
    }
}
