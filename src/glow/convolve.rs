//! Convolution with wide kernels by the fast Fourier transform.

use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{FftDirection, FftPlannerScalar};

/// A picture of one channel.
#[derive(Clone, Debug)]
pub(super) struct LightPlane {
    pub size: [usize; 2],
    pub values: Vec<f32>,
}

/// The convolutions of `light` with two even kernels, functions of the offset in pixels.
pub(super) fn convolve(light: &LightPlane, kernels: impl Fn(i64, i64) -> [f32; 2] + Sync) -> [LightPlane; 2] {
    let [width, height] = light.size;
    // Zero-padded to twice the size, so that nothing wraps around.
    let [w, h] = light.size.map(|s| smooth_size(2 * s));
    let mut image = vec![Complex::new(0.0_f32, 0.0); w * h];
    for y in 0..height {
        for x in 0..width {
            image[y * w + x].re = light.values[y * width + x];
        }
    }
    let around = |i: usize, size: usize| if i < size.div_ceil(2) { i as i64 } else { i as i64 - size as i64 };
    let mut kernel = vec![Complex::new(0.0_f32, 0.0); w * h];
    kernel.par_chunks_mut(w).enumerate().for_each(|(y, row)| {
        for (x, value) in row.iter_mut().enumerate() {
            let [a, b] = kernels(around(x, w), around(y, h));
            *value = Complex::new(a, b);
        }
    });
    let image = transform(image, [w, h], FftDirection::Forward);
    let mut product = transform(kernel, [w, h], FftDirection::Forward);
    // Light and kernels are real: the results are the real and the imaginary part of one complex convolution.
    product.par_iter_mut().zip(&image).for_each(|(k, i)| *k *= i);
    let spread = transform(product, [h, w], FftDirection::Inverse);
    let scale = 1.0 / (w * h) as f32;
    let part = |of: fn(&Complex<f32>) -> f32| {
        let values =
            (0..height).flat_map(|y| spread[y * w..y * w + width].iter().map(|c| (of(c) * scale).max(0.0))).collect();
        LightPlane { size: light.size, values }
    };
    [part(|c| c.re), part(|c| c.im)]
}

/// The 2D transform of an array of `w` by `h`, transposed.
fn transform(mut data: Vec<Complex<f32>>, [w, h]: [usize; 2], direction: FftDirection) -> Vec<Complex<f32>> {
    // The scalar one: the same bits on every instruction set, and far less to compile.
    let mut planner = FftPlannerScalar::new();
    let rows = planner.plan_fft(w, direction);
    data.par_chunks_mut(w).for_each(|row| rows.process(row));
    let mut turned = vec![Complex::new(0.0_f32, 0.0); w * h];
    turned.par_chunks_mut(h).enumerate().for_each(|(x, column)| {
        column.iter_mut().enumerate().for_each(|(y, value)| *value = data[y * w + x]);
    });
    let columns = planner.plan_fft(h, direction);
    turned.par_chunks_mut(h).for_each(|column| columns.process(column));
    turned
}

/// The least 5-smooth number, with prime factors 2, 3 and 5, that is at least `least`: such sizes transform fast.
fn smooth_size(least: usize) -> usize {
    (least.max(1)..)
        .find(|&size| {
            let mut rest = size;
            for factor in [2, 3, 5] {
                while rest.is_multiple_of(factor) {
                    rest /= factor;
                }
            }
            rest == 1
        })
        .unwrap_or(least)
}

impl LightPlane {
    /// The value at pixel coordinates, pixel centres at halves, by bicubic Catmull-Rom interpolation, clamped to 0 and above.
    pub fn at(&self, x: f64, y: f64) -> f32 {
        let [width, height] = self.size;
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (libm::floor(x), libm::floor(y));
        let (wx, wy) = (weights((x - x0) as f32), weights((y - y0) as f32));
        let clamp = |i: i64, size: usize| i.clamp(0, size as i64 - 1) as usize;
        let mut sum = 0.0;
        for (j, wy) in (-1..).zip(wy) {
            let row = &self.values[clamp(y0 as i64 + j, height) * width..][..width];
            sum += wy * (-1..).zip(wx).map(|(i, wx)| wx * row[clamp(x0 as i64 + i, width)]).sum::<f32>();
        }
        sum.max(0.0)
    }
}

/// Catmull-Rom weights of four neighbours at the fraction `t` between the middle two (Catmull and Rom 1974).
fn weights(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_sum_over_all_sources() {
        let size = [23, 14];
        let mut light = LightPlane { size, values: vec![0.0; size[0] * size[1]] };
        let sources = [(3, 2, 1.0), (22, 13, 2.5), (0, 7, 0.5)];
        sources.iter().for_each(|&(x, y, v)| light.values[y * size[0] + x] = v);
        let kernel = |dx: i64, dy: i64| {
            let r2 = (dx * dx + dy * dy) as f32;
            [1.0 / (1.0 + r2), 1.0 / (1.0 + 0.01 * r2 * r2)]
        };
        let spread = convolve(&light, kernel);
        for (which, plane) in spread.iter().enumerate() {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let expected: f32 = sources
                        .iter()
                        .map(|&(sx, sy, v)| v * kernel(x as i64 - sx as i64, y as i64 - sy as i64)[which])
                        .sum();
                    let found = plane.values[y * size[0] + x];
                    assert!((found - expected).abs() < 1e-4, "{x} {y}: {found} {expected}");
                }
            }
        }
    }
}
