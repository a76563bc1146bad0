//! Traced pictures.

use std::io::{self, Write};

use rayon::prelude::*;

use crate::files::{Rgba, add_mattes, encode_exr, encode_png16};
use crate::math::{Cancelled, Progress, srgb_byte, to_srgb};
use crate::model::Model;
use crate::raster::{Layers, filmic};
use crate::trace::{self, Look, Picture, RenderSettings, World};

/// A traced picture, in linear light, with the names of its objects and limbs.
pub struct Traced {
    picture: Picture,
    is_filmic: bool,
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
    // A drawing's white is white.
    let is_filmic = view.look != Look::Exact && !model.is_flat;
    Ok(Traced { picture, is_filmic, objects, branches: world.branch_names() })
}

impl Traced {
    /// The picture as a screen shows it.
    #[must_use]
    pub fn to_screen(&self) -> Rgba {
        Rgba {
            width: self.picture.width,
            height: self.picture.height,
            bytes: self.encoded(srgb_byte, |alpha| libm::floor(alpha * 255.0 + 0.5) as u8),
        }
    }

    /// Writes it as a PNG with 16 bits a channel and these texts.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write_png16(&self, texts: &[(&str, &str)], out: &mut dyn Write) -> io::Result<()> {
        let round = |x: f64| libm::floor(x * 65535.0 + 0.5) as u16;
        let values = self.encoded(|linear| round(to_srgb(linear)), round);
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

    /// Red, green, blue by `encode` and alpha by `round`, not premultiplied.
    fn encoded<T: Copy + Send>(&self, encode: impl Fn(f64) -> T + Sync, round: impl Fn(f64) -> T + Sync) -> Vec<T> {
        let pixel = |p: &[f32; 4]| {
            let alpha = f64::from(p[3]);
            let show = |c: f32| {
                let linear = if alpha > 0.0 { f64::from(c) / alpha } else { 0.0 };
                encode(if self.is_filmic { filmic(linear) } else { linear })
            };
            [show(p[0]), show(p[1]), show(p[2]), round(alpha)]
        };
        let pixels: Vec<[T; 4]> = self.picture.pixels.par_iter().map(pixel).collect();
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
