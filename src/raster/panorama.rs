//! Environment maps.

use std::sync::{Mutex, PoisonError};
use std::thread;

use super::{Channel, Layers};
use crate::math::DVec3;

/// Parts of a picture that each thread paints, about: those above the horizon take longer.
const PARTS: usize = 8;

/// An equirectangular environment map in linear light, z up: the top row is +z, the middle column +x, the left and right edges -x,
/// the column a quarter from the left -y.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
    /// The mean light of the row above the horizon.
    horizon: [f64; 3],
}

impl Panorama {
    /// A picture of `width` by `height` pixels, or `None` if `pixels` has another length or is empty.
    #[must_use]
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Option<Self> {
        let fits = u64::from(width) * u64::from(height) == pixels.len() as u64;
        (fits && !pixels.is_empty()).then(|| Self::of(width, height, pixels))
    }

    fn of(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Self {
        let row = (height / 2).saturating_sub(1) as usize * width as usize;
        let row = &pixels[row..row + width as usize];
        let horizon = [0, 1, 2].map(|c| row.iter().map(|p| f64::from(p[c])).sum::<f64>() / row.len() as f64);
        Self { width, height, pixels, horizon }
    }

    /// A picture of `rows` rows, at least one, and twice as many columns: the light from where each pixel's middle is, by its angle
    /// from +x about the vertical and by its elevation, in radians.
    #[must_use]
    pub fn painted(rows: u32, light: impl Fn(f64, f64) -> [f32; 3] + Sync) -> Self {
        let (width, height) = (2 * rows.max(1), rows.max(1));
        let pixel = |i: u32| light(turn(i % width, width), rise(i / width, height));
        let mut pixels = vec![[0.0; 3]; (width * height) as usize];
        // On threads of its own: a thread of the pool that waits for it could take up work that waits for it too.
        let share = pixels.len().div_ceil(rayon::current_num_threads() * PARTS).max(1);
        let parts = Mutex::new((0_u32..).step_by(share).zip(pixels.chunks_mut(share)));
        let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
        let paint = || {
            while let Some((first, part)) = next() {
                (first..).zip(part).for_each(|(i, to)| *to = pixel(i));
            }
        };
        thread::scope(|scope| (0..rayon::current_num_threads()).for_each(|_| drop(scope.spawn(paint))));
        Self::of(width, height, pixels)
    }

    /// Bytes of one of `rows` rows and twice as many columns.
    #[must_use]
    pub fn bytes_of(rows: u32) -> usize {
        2 * rows as usize * rows as usize * size_of::<[f32; 3]>()
    }

    /// Pixels in a row, and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Its pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// Its channels `R G B`, times `strength`.
    #[must_use]
    pub fn layers(&self, strength: f64) -> Layers {
        let channel = |(i, name): (usize, &str)| Channel {
            name: name.to_owned(),
            values: self.pixels.iter().map(|p| (f64::from(p[i]) * strength) as f32).collect(),
            is_half: true,
        };
        let channels = ["R", "G", "B"].into_iter().enumerate().map(channel).collect();
        Layers { width: self.width, height: self.height, channels, ..Layers::default() }
    }

    /// The bilinearly interpolated light from the unit vector `d`; rows wrap around, columns are clamped at the poles.
    #[must_use]
    pub fn at(&self, d: DVec3) -> [f64; 3] {
        let u = 0.5 + libm::atan2(d.y, d.x) / std::f64::consts::TAU;
        let v = 0.5 - libm::asin(d.z.clamp(-1.0, 1.0)) / std::f64::consts::PI;
        let (w, h) = (i64::from(self.width), i64::from(self.height));
        let (x, y) = (u * w as f64 - 0.5, (v * h as f64 - 0.5).clamp(0.0, (h - 1) as f64));
        let (x0, y0) = (libm::floor(x), libm::floor(y));
        let (fx, fy) = (x - x0, y - y0);
        let pixel = |x: i64, y: i64| self.pixels[(y.min(h - 1) * w + x.rem_euclid(w)) as usize].map(f64::from);
        let (x0, y0) = (x0 as i64, y0 as i64);
        let corners = [pixel(x0, y0), pixel(x0 + 1, y0), pixel(x0, y0 + 1), pixel(x0 + 1, y0 + 1)];
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        [0, 1, 2].map(|c| (0..4).map(|i| corners[i][c] * weights[i]).sum())
    }

    /// The mean light of the row above the horizon.
    #[must_use]
    pub fn horizon(&self) -> [f64; 3] {
        self.horizon
    }

    /// The mean light over the spherical cap about the unit vector `about`, with `cos` the cosine of its half-angle; pixels are
    /// clamped to `most`.
    #[must_use]
    pub fn mean(&self, about: DVec3, cos: f64, most: f64) -> [f64; 3] {
        let columns: Vec<[f64; 2]> =
            (0..self.width).map(|x| turn(x, self.width)).map(|turn| [libm::cos(turn), libm::sin(turn)]).collect();
        let mut sum = [0.0; 3];
        let mut weight = 0.0;
        for y in 0..self.height {
            let rise = rise(y, self.height);
            let (z, r) = (libm::sin(rise), libm::cos(rise));
            // The row does not intersect the cap.
            let flat = libm::sqrt((1.0 - about.z * about.z).max(0.0));
            if z * about.z + r * flat < cos {
                continue;
            }
            for (x, [cos_turn, sin_turn]) in (0..).zip(&columns) {
                let d = DVec3::new(r * cos_turn, r * sin_turn, z);
                if d.dot(about) >= cos {
                    let pixel = self.pixels[y as usize * self.width as usize + x];
                    (0..3).for_each(|c| sum[c] += f64::from(pixel[c]).min(most) * r);
                    weight += r;
                }
            }
        }
        if weight > 0.0 { sum.map(|x| x / weight) } else { self.at(about) }
    }
}

/// The angle from +x about the vertical of column `x` of `width`.
fn turn(x: u32, width: u32) -> f64 {
    std::f64::consts::TAU * ((f64::from(x) + 0.5) / f64::from(width) - 0.5)
}

/// The elevation of row `y` of `height`.
fn rise(y: u32, height: u32) -> f64 {
    std::f64::consts::PI * (0.5 - (f64::from(y) + 0.5) / f64::from(height))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_painted_is_seen_where_it_was() {
        let way = |turn: f64, rise: f64| crate::math::from_height(libm::sin(rise), turn);
        let panorama = Panorama::painted(64, |turn, rise| way(turn, rise).to_array().map(|x| x as f32));
        for (turn, rise) in [(0.0, 0.0), (1.0, 0.5), (-2.5, -0.8), (3.0, 1.2)] {
            let seen = DVec3::from_array(panorama.at(way(turn, rise)));
            assert!((seen - way(turn, rise)).length() < 2e-3, "{turn} {rise}: {seen}");
        }
    }

    #[test]
    fn directions_find_their_pixels() {
        let mut pixels = vec![[0.0; 3]; 8];
        pixels[1] = [1.0, 2.0, 3.0];
        let panorama = Panorama::new(4, 2, pixels).unwrap();
        // Column 1 of 4 is centred three eighths from the left: 45 degrees from -y towards +x... and up.
        let turn = std::f64::consts::TAU * (0.375 - 0.5);
        let (up, r) = (libm::sqrt(0.5), libm::sqrt(0.5));
        let d = DVec3::new(r * libm::cos(turn), r * libm::sin(turn), up);
        assert!((panorama.at(d)[2] - 3.0).abs() < 1e-9);
        assert_eq!(panorama.horizon(), [0.25, 0.5, 0.75]);
        assert!(Panorama::new(2, 2, vec![]).is_none());
    }
}
