//! Denoising by what is seen without noise: surfaces' colours and normals.

use rayon::prelude::*;

use super::film::Sample;

/// Radius of the filter, in pixels.
const REACH: i64 = 5;
/// Margin that the filter and its means need, in pixels.
pub(super) const MARGIN: u32 = REACH as u32 + 1;
/// Differences of mean normals and colours from which on pixels do not show the same.
const NORMAL: f32 = 0.35;
const COLOUR: f32 = 0.08;
/// Differences of light count from so many standard errors on.
const ERRORS: f32 = 1.5;
/// No colour is so dark that the light on it could not be told.
const DARKEST: f32 = 0.02;

/// What a pixel shows besides its light, which is hardly noisy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Guide {
    /// The mean colour of surfaces, and of the sky.
    pub colour: [f32; 3],
    /// The mean normal; zero for the sky.
    pub normal: [f32; 3],
    /// Variance of the mean of its samples' light.
    pub variance: f32,
}

/// Filters the light on surfaces over pixels that show alike ones: a joint bilateral filter (Petschnigg et al. 2004) guided by colours
/// and normals, and by 3 x 3 means of the light with their errors (after Rousselle et al. 2013, section 4), so that noise does not
/// preserve itself. Light is what a pixel shows over the colour of its surfaces, so that patterns and leaves stay sharp.
pub(super) fn denoise(width: u32, pixels: &[[f32; 4]], guides: &[Guide]) -> Vec<[f32; 4]> {
    let film = Film { width: i64::from(width), height: pixels.len() as i64 / i64::from(width), guides };
    let lights: Vec<[f32; 3]> = pixels.iter().zip(guides).map(|(p, guide)| guide.light(p)).collect();
    let means: Vec<[f32; 2]> = (0..pixels.len()).into_par_iter().map(|i| film.mean(i, &lights)).collect();
    let filtered = |i: usize| {
        let own = &guides[i];
        // One whose samples are alike by chance, as where hardly any meets a light, is as noisy as those about it.
        if own.is_sky() || means[i][1] == 0.0 {
            return pixels[i];
        }
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for (j, distance2) in film.around(i, REACH) {
            let weight = own.alike(&guides[j]) * same(means[i], means[j]) / (1.0 + distance2 * 0.05);
            (0..3).for_each(|c| sum[c] += lights[j][c] * weight);
            total += weight;
        }
        let [r, g, b] = [0, 1, 2].map(|c| sum[c] / total * own.colour[c].max(DARKEST));
        [r, g, b, pixels[i][3]]
    };
    (0..pixels.len()).into_par_iter().map(filtered).collect()
}

/// The pixels of a picture, by index.
struct Film<'a> {
    width: i64,
    height: i64,
    guides: &'a [Guide],
}

impl Film<'_> {
    /// Pixels around one, with the squares of their distances.
    fn around(&self, i: usize, reach: i64) -> impl Iterator<Item = (usize, f32)> {
        let (w, h) = (self.width, self.height);
        let (x, y) = (i as i64 % w, i as i64 / w);
        let rows = (y - reach).max(0)..=(y + reach).min(h - 1);
        let places = rows.flat_map(move |v| ((x - reach).max(0)..=(x + reach).min(w - 1)).map(move |u| (u, v)));
        places.map(move |(u, v)| ((v * w + u) as usize, ((u - x) * (u - x) + (v - y) * (v - y)) as f32))
    }

    /// The luminance of the mean light of the pixels about one that are like it, and the variance of that mean.
    fn mean(&self, i: usize, lights: &[[f32; 3]]) -> [f32; 2] {
        let (mut light, mut variance, mut total) = (0.0, 0.0, 0.0);
        for (j, _) in self.around(i, 1) {
            let weight = self.guides[i].alike(&self.guides[j]);
            light += weight * luminance(lights[j]);
            variance += weight * weight * self.guides[j].variance;
            total += weight;
        }
        [light / total, variance / (total * total)]
    }
}

impl Guide {
    /// Of the samples of a pixel.
    pub fn of(samples: &[Sample]) -> Self {
        let n = samples.len() as f32;
        let mean = |part: &dyn Fn(&Sample) -> [f64; 3]| {
            let sum = samples.iter().map(part).fold([0.0; 3], |sum, x| [0, 1, 2].map(|c| sum[c] + x[c]));
            sum.map(|x| x as f32 / n)
        };
        let light = |s: &Sample| {
            let [shown, pigment] = [s.colour, s.pigment].map(|c| luminance(c.map(|x| x as f32)));
            shown / pigment.max(DARKEST)
        };
        let all = samples.iter().map(light).sum::<f32>() / n;
        let squares = samples.iter().map(|s| (light(s) - all) * (light(s) - all)).sum::<f32>();
        Self {
            colour: mean(&|s| s.pigment),
            normal: mean(&|s| s.normal.to_array()),
            variance: squares / (n * (n - 1.0).max(1.0)),
        }
    }

    /// The standard error of what the pixel shows.
    pub fn error(&self) -> f32 {
        self.variance.sqrt() * luminance(self.colour)
    }

    fn is_sky(&self) -> bool {
        self.normal == [0.0; 3]
    }

    /// What `pixel` shows over the colour of its surfaces.
    fn light(&self, pixel: &[f32; 4]) -> [f32; 3] {
        [0, 1, 2].map(|c| pixel[c] / self.colour[c].max(DARKEST))
    }

    /// How much another pixel shows of the same, 1 at most.
    fn alike(&self, other: &Self) -> f32 {
        let between = |a: &[f32; 3], b: &[f32; 3]| (0..3).map(|c| (a[c] - b[c]) * (a[c] - b[c])).sum::<f32>();
        let normals = between(&self.normal, &other.normal) / (NORMAL * NORMAL);
        let colours = between(&self.colour, &other.colour) / (COLOUR * COLOUR);
        falling(normals + colours)
    }
}

/// How far two mean lights may be the same but for noise.
fn same([a, of_a]: [f32; 2], [b, of_b]: [f32; 2]) -> f32 {
    falling((a - b) * (a - b) / (ERRORS * ERRORS * (of_a + of_b) + 1e-6))
}

/// From 1 at 0 downwards.
fn falling(x: f32) -> f32 {
    let y = 1.0 / (1.0 + x);
    y * y
}

fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix;

    /// A picture of two walls that meet in the middle, one in a pattern, whose light is noisy.
    fn walls() -> (Vec<[f32; 4]>, Vec<[f32; 4]>, Vec<Guide>) {
        let noise = |i: u64| (mix(i) >> 40) as f32 / (1 << 24) as f32 - 0.5;
        let mut picture = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..32 * 32_u64 {
            let (x, y) = (i % 32, i / 32);
            let colour = if x >= 16 && (x + y) % 2 == 0 { [0.6; 3] } else { [0.3; 3] };
            let (normal, light) = if x < 16 { ([1.0, 0.0, 0.0], 1.0) } else { ([0.0, 1.0, 0.0], 0.5) };
            let pixel = |light: f32| [colour[0] * light, colour[1] * light, colour[2] * light, 1.0];
            picture.0.push(pixel(light));
            picture.1.push(pixel(light + 0.4 * noise(i)));
            picture.2.push(Guide { colour, normal, variance: 0.4 * 0.4 / 12.0 });
        }
        picture
    }

    #[test]
    fn noise_goes_and_edges_and_patterns_stay() {
        let (clean, noisy, guides) = walls();
        let error = |p: &[[f32; 4]]| {
            p.iter().zip(&clean).map(|(a, b)| (a[0] - b[0]) * (a[0] - b[0])).sum::<f32>() / p.len() as f32
        };
        let filtered = denoise(32, &noisy, &guides);
        assert!(error(&filtered) < error(&noisy) / 10.0, "{} of {}", error(&filtered), error(&noisy));
        // At the corner, and from one square of the pattern to the next.
        for (i, own) in filtered.iter().enumerate() {
            assert!((own[0] - clean[i][0]).abs() < 0.09, "{i}: {} {}", own[0], clean[i][0]);
        }
    }

    /// Where light is seldom met, all samples of a pixel may miss it.
    #[test]
    fn black_by_chance_is_noise() {
        let (clean, mut noisy, mut guides) = walls();
        let at = 10 * 32 + 6;
        noisy[at] = [0.0, 0.0, 0.0, 1.0];
        guides[at].variance = 0.0;
        let filtered = denoise(32, &noisy, &guides);
        assert!((filtered[at][0] - clean[at][0]).abs() < 0.09, "{}", filtered[at][0]);
    }

    #[test]
    fn what_has_no_noise_stays() {
        let (clean, _, mut guides) = walls();
        guides.iter_mut().for_each(|guide| guide.variance = 0.0);
        assert_eq!(denoise(32, &clean, &guides), clean);
        // A shadow's edge on one wall.
        let shadow = |p: &[f32; 4], i: usize| if i / 32 < 12 { p.map(|c| c * 0.3) } else { *p };
        let lit: Vec<[f32; 4]> = clean.iter().enumerate().map(|(i, p)| shadow(p, i)).collect();
        guides.iter_mut().for_each(|guide| guide.variance = 1e-4);
        let filtered = denoise(32, &lit, &guides);
        for i in [11 * 32 + 5, 12 * 32 + 5] {
            assert!((filtered[i][0] / lit[i][0] - 1.0).abs() < 0.1, "{} {}", filtered[i][0], lit[i][0]);
        }
    }
}
