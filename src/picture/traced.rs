//! Traced pictures.

use std::io::{self, Write};

use rayon::prelude::*;

use crate::files::{Rgba, add_mattes, encode_exr, encode_png16};
use crate::math::{Cancelled, Progress, srgb_byte, to_srgb};
use crate::model::{Film, Model};
use crate::raster::{Layers, filmic};
use crate::trace::{self, Look, Picture, RenderSettings, World};

/// A traced picture, in linear light, with the names of its objects and limbs.
pub struct Traced {
    picture: Picture,
    is_filmic: bool,
    /// The left upper corner of its crop, where colours are dithered.
    dithered: Option<[u32; 2]>,
    objects: Vec<String>,
    branches: Vec<String>,
}

/// Traces `view` of `model`.
///
/// # Errors
/// [`Cancelled`] by `progress`.
pub fn trace(model: &Model, view: &RenderSettings, progress: &Progress) -> Result<Traced, Cancelled> {
    let world = World::new(model);
    let picture = trace::render(&world, view, progress)?;
    let mut objects: Vec<String> = model.objects.iter().map(|o| o.name.clone()).collect();
    objects.push("ground".to_owned());
    // A drawing's white is white, and its colours are its own.
    let is_photograph = view.look != Look::Exact && !model.is_flat;
    let is_filmic = is_photograph && model.camera.film == Film::Soft;
    let dithered = is_photograph.then_some([view.crop[0], view.crop[1]]);
    Ok(Traced { picture, is_filmic, dithered, objects, branches: world.branch_names() })
}

impl Traced {
    /// The picture as a screen shows it.
    #[must_use]
    pub fn to_screen(&self) -> Rgba {
        Rgba {
            width: self.picture.width,
            height: self.picture.height,
            bytes: self.encoded(
                |linear, [x, y]| match self.dithered {
                    Some([left, top]) => libm::floor(to_srgb(linear) * 255.0 + threshold(left + x, top + y)) as u8,
                    None => srgb_byte(linear),
                },
                |alpha| libm::floor(alpha * 255.0 + 0.5) as u8,
            ),
        }
    }

    /// Writes it as a PNG with 16 bits a channel and these texts.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_png16(&self, texts: &[(&str, &str)], out: &mut dyn Write) -> io::Result<()> {
        let round = |x: f64| libm::floor(x * 65535.0 + 0.5) as u16;
        let values = self.encoded(|linear, _| round(to_srgb(linear)), round);
        encode_png16([self.picture.width, self.picture.height], &values, texts, out)
    }

    /// Writes it as OpenEXR with all its layers and these texts.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_exr(&self, texts: &[(&str, &str)], out: &mut dyn Write) -> io::Result<()> {
        let mut layers = self.layers();
        layers.texts.extend(texts.iter().map(|(keyword, text)| super::shone::attribute(keyword, text)));
        out.write_all(&encode_exr(&layers)?)
    }

    /// Red, green, blue by `encode`, which is told the pixel's place, and alpha by `round`, not premultiplied.
    fn encoded<T: Copy + Send>(
        &self,
        encode: impl Fn(f64, [u32; 2]) -> T + Sync,
        round: impl Fn(f64) -> T + Sync,
    ) -> Vec<T> {
        let pixel = |(i, p): (usize, &[f32; 4])| {
            let place = [i as u32 % self.picture.width, i as u32 / self.picture.width];
            let alpha = f64::from(p[3]);
            let show = |c: f32| {
                let linear = if alpha > 0.0 { f64::from(c) / alpha } else { 0.0 };
                encode(if self.is_filmic { filmic(linear) } else { linear }, place)
            };
            [show(p[0]), show(p[1]), show(p[2]), round(alpha)]
        };
        let pixels: Vec<[T; 4]> = self.picture.pixels.par_iter().enumerate().map(pixel).collect();
        pixels.into_flattened()
    }

    /// Every channel, with mattes of objects and limbs.
    fn layers(&self) -> Layers {
        let mut layers = self.picture.layers();
        if !self.picture.data.is_empty() {
            let objects: Vec<_> = self.picture.data.iter().map(|d| d.objects).collect();
            let branches: Vec<_> = self.picture.data.iter().map(|d| d.branches).collect();
            add_mattes(&mut layers, "CryptoObject", &self.objects, &objects);
            add_mattes(&mut layers, "CryptoBranch", &self.branches, &branches);
        }
        layers
    }
}

/// What is added before a colour of 8 bits is rounded down, so that it is right on the mean of neighbours and smooth skies show no
/// bands: interleaved gradient noise (Jimenez 2014), short of 0 and 1, so that colours that 8 bits can tell stay.
fn threshold(x: u32, y: u32) -> f64 {
    let noise = |a: f64| a - libm::floor(a);
    0.01 + 0.98 * noise(52.982_918_9 * noise(0.067_110_56 * f64::from(x) + 0.005_837_15 * f64::from(y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colours between two of 8 bits are right on the mean, and those of 8 bits stay.
    #[test]
    fn dither_is_right_on_the_mean() {
        let thresholds: Vec<f64> = (0..64 * 64).map(|i| threshold(i % 64, i / 64)).collect();
        for value in [17.0, 17.25, 17.5, 200.9] {
            let bytes = thresholds.iter().map(|threshold| libm::floor(value + threshold));
            let mean = bytes.sum::<f64>() / thresholds.len() as f64;
            assert!((mean - value).abs() < 0.02, "{value}: {mean}");
        }
        assert!(thresholds.iter().all(|threshold| libm::floor(17.005 + threshold) == 17.0));
        assert!(thresholds.iter().all(|threshold| libm::floor(16.995 + threshold) == 17.0));
    }
}
