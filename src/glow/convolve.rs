//! Convolution with broad kernels, by the fast Fourier transform.

use rayon::prelude::*;

use super::fourier::{Complex, Fourier, times};

/// A picture of one number a pixel.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub size: [usize; 2],
    pub values: Vec<f32>,
}

/// `light` spread by two kernels that are even about their middle, each told by the offset in pixels.
pub(super) fn convolve(light: &Plane, kernels: impl Fn(i64, i64) -> [f32; 2] + Sync) -> [Plane; 2] {
    let [width, height] = light.size;
    // Twice as large, so that nothing comes in from the other side.
    let [w, h] = light.size.map(|s| smooth_size(2 * s));
    let mut image = vec![[0.0; 2]; w * h];
    for y in 0..height {
        for x in 0..width {
            image[y * w + x][0] = light.values[y * width + x];
        }
    }
    let around = |i: usize, size: usize| if i < size.div_ceil(2) { i as i64 } else { i as i64 - size as i64 };
    let mut kernel = vec![[0.0; 2]; w * h];
    kernel.par_chunks_mut(w).enumerate().for_each(|(y, row)| {
        for (x, value) in row.iter_mut().enumerate() {
            *value = kernels(around(x, w), around(y, h));
        }
    });
    let image = transform(image, [w, h], false);
    let mut product = transform(kernel, [w, h], false);
    // Light is real and both kernels are: the one's result is the real part, the other's the imaginary.
    product.par_iter_mut().zip(&image).for_each(|(k, i)| *k = times(*k, *i));
    let spread = transform(product, [h, w], true);
    let scale = 1.0 / (w * h) as f32;
    let part = |of: fn(&Complex) -> f32| {
        let values =
            (0..height).flat_map(|y| spread[y * w..y * w + width].iter().map(|c| (of(c) * scale).max(0.0))).collect();
        Plane { size: light.size, values }
    };
    [part(|c| c[0]), part(|c| c[1])]
}

/// The transform of an array of `w` by `h`, as one of `h` by `w`.
fn transform(mut data: Vec<Complex>, [w, h]: [usize; 2], is_inverse: bool) -> Vec<Complex> {
    let all_rows = |data: &mut [Complex], length: usize| {
        let rows = Fourier::new(length, is_inverse);
        data.par_chunks_mut(length).for_each_init(|| vec![[0.0; 2]; length], |room, row| rows.transform(row, room));
    };
    all_rows(&mut data, w);
    let mut turned = vec![[0.0; 2]; w * h];
    turned.par_chunks_mut(h).enumerate().for_each(|(x, column)| {
        column.iter_mut().enumerate().for_each(|(y, value)| *value = data[y * w + x]);
    });
    all_rows(&mut turned, h);
    turned
}

/// The least size from `least` on whose factors are 2, 3 and 5, which transform fast.
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

impl Plane {
    /// The value at (x, y) in pixels of it, pixel centres at halves, by a Catmull-Rom spline; never negative.
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

/// Weights of the four neighbours at fraction `t` between the middle two (Catmull and Rom 1974).
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
        let mut light = Plane { size, values: vec![0.0; size[0] * size[1]] };
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
