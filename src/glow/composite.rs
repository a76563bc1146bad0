//! Compositing of light over a photograph or black.

use rayon::prelude::*;

use super::{Canvas, Layer, Pass};
use crate::math::{mix, to_srgb};
use crate::raster::{Grey, Plate, Samples};

/// Layers of light to be composited.
pub struct Composite<'a> {
    /// The pixels.
    pub canvas: Canvas,
    /// The photograph; black without one.
    pub plate: Option<&'a Plate>,
    /// White where a foreground hides the light; of the view's size.
    pub matte: Option<&'a Grey>,
    /// The light, in linear Rec. 709.
    pub layers: &'a [Layer],
}

impl Composite<'_> {
    /// Transmittance of the foreground at a pixel, 0 to 1.
    fn open(&self, x: usize, y: usize) -> f32 {
        self.matte.map_or(1.0, |matte| {
            let [w, h] = matte.size();
            let at = |i: usize, offset: i64, size: u32| (i as i64 + offset).clamp(0, i64::from(size) - 1) as u32;
            1.0 - matte.pixel(at(x, self.canvas.offset[0], w), at(y, self.canvas.offset[1], h))
        })
    }

    /// Row `y` of the matte: 1 where the foreground hides the light.
    pub fn matte_row(&self, y: usize, row: &mut [f32]) {
        row.iter_mut().enumerate().for_each(|(x, out)| *out = 1.0 - self.open(x, y));
    }

    /// The colour of a layer in the plate's colour space.
    fn colour(&self, layer: &Layer) -> [f32; 3] {
        let own = self.plate.map_or(layer.colour, |plate| {
            plate.from_rec709.map(|row| (0..3).map(|i| row[i] * layer.colour[i]).sum::<f64>().max(0.0))
        });
        own.map(|c| c as f32)
    }

    /// The light that a pass adds to a channel of row `y`, linear and matted; for [`Pass::Cloud`], times the photograph.
    pub fn pass(&self, pass: Pass, channel: usize, y: usize, row: &mut [f32]) {
        row.fill(0.0);
        let width = self.canvas.size[0] as usize;
        for layer in self.layers.iter().filter(|layer| layer.pass == pass) {
            let colour = self.colour(layer)[channel];
            for (x, out) in row.iter_mut().enumerate() {
                let value = layer.values[y * width + x] * colour * self.open(x, y);
                *out += if pass == Pass::Cloud { value * self.light((y * width + x) * 3 + channel) } else { value };
            }
        }
    }

    /// The photograph's sample `i`, three a pixel, in linear light.
    pub fn light(&self, i: usize) -> f32 {
        self.plate.map_or(0.0, |plate| plate.light(i))
    }

    /// A channel of row `y` of the photograph with all light added, in linear light.
    pub fn linear(&self, channel: usize, y: usize, row: &mut [f32]) {
        let width = self.canvas.size[0] as usize;
        let mut sum: Vec<f32> = (0..width).map(|x| self.light((y * width + x) * 3 + channel)).collect();
        for pass in Pass::ALL {
            self.pass(pass, channel, y, row);
            sum.iter_mut().zip(row.iter()).for_each(|(sum, x)| *sum += x);
        }
        row.copy_from_slice(&sum);
    }

    /// The rows `rows`, display-referred: red, green and blue as code values of the plate's depth and curve; without a plate,
    /// or with a linear one, as sRGB of 8 or (`is_deep`) 16 bits.
    ///
    /// Added light rolls off towards white. Pixels that it changes by less than half a code value are copied; the others
    /// are dithered.
    #[must_use]
    pub fn display(&self, rows: std::ops::Range<usize>, is_deep: bool) -> Vec<u16> {
        let width = self.canvas.size[0] as usize;
        let is_coded = self.plate.is_some_and(|plate| !matches!(plate.samples, Samples::Linear(_)));
        let most = match self.plate {
            Some(plate) if is_coded => plate.most(),
            _ if is_deep => 65535,
            _ => 255,
        };
        let mut out = vec![0_u16; rows.len() * width * 3];
        out.par_chunks_mut(width * 3).zip(rows).for_each(|(line, y)| {
            let mut light = vec![0.0_f32; width];
            let mut added = vec![0.0_f32; width * 3];
            for pass in Pass::ALL {
                for channel in 0..3 {
                    self.pass(pass, channel, y, &mut light);
                    light.iter().enumerate().for_each(|(x, light)| added[x * 3 + channel] += light);
                }
            }
            for x in 0..width {
                let first = (y * width + x) * 3;
                let codes: [f64; 3] = std::array::from_fn(|channel| {
                    let own = f64::from(self.light(first + channel));
                    let sum = roll_off(own, f64::from(added[x * 3 + channel]));
                    match self.plate {
                        Some(plate) if is_coded => plate.encode(channel, sum as f32),
                        _ => to_srgb(sum) * f64::from(most),
                    }
                });
                let own = |channel: usize| match self.plate.map(|plate| &plate.samples) {
                    Some(Samples::Eight(codes)) => f64::from(codes[first + channel]),
                    Some(Samples::Sixteen(codes)) => f64::from(codes[first + channel]),
                    Some(Samples::Linear(light)) => {
                        to_srgb(f64::from(light[first + channel]).clamp(0.0, 1.0)) * f64::from(most)
                    }
                    None => 0.0,
                };
                // Several code values may stand for the same light: the difference of encodings counts.
                let moved = |channel: usize| match self.plate {
                    Some(plate) if is_coded => codes[channel] - plate.encode(channel, self.light(first + channel)),
                    _ => codes[channel] - own(channel),
                };
                let is_touched = (0..3).any(|channel| moved(channel).abs() >= 0.5);
                for channel in 0..3 {
                    let code = if is_touched {
                        own(channel) + moved(channel) + dither((first + channel) as u64)
                    } else {
                        own(channel) + 0.5
                    };
                    line[x * 3 + channel] = libm::floor(code).clamp(0.0, f64::from(most)) as u16;
                }
            }
        });
        out
    }
}

/// Exponential highlight compression `p + (1 - p) (1 - exp(-g / (1 - p)))` of light `g` added to `p`: at most 1, and `p` where
/// g = 0 or p >= 1.
fn roll_off(p: f64, g: f64) -> f64 {
    let room = 1.0 - p;
    if room <= 0.0 { p.min(1.0) } else { p + room * (1.0 - libm::exp(-g / room)) }
}

/// The dither of sample `i`: a uniform number from 0 to 1 to be added before truncation.
fn dither(i: u64) -> f64 {
    (mix(i) >> 40) as f64 / f64::from(1_u32 << 24)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_rolls_off() {
        assert_eq!(roll_off(0.3, 0.0), 0.3);
        assert_eq!(roll_off(1.0, 5.0), 1.0);
        assert!((roll_off(0.3, 1e-6) - 0.300_001).abs() < 1e-9);
        assert!(roll_off(0.3, 0.2) < 0.5 && roll_off(0.3, 100.0) <= 1.0);
    }
}
