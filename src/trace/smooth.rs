//! Less grain on the ground: its colour is even, so that what varies from pixel to pixel is chance or shadow.

use rayon::prelude::*;

/// Pixels on each side that a smoothed pixel may take from.
const REACH: i64 = 3;
/// Pixels on each side that must be known, to smooth a pixel.
pub(super) const MARGIN: u32 = REACH as u32 + 1;
/// Differences of light, after a first mean over neighbours, that count as chance; shadows' edges are stronger.
const CHANCE: f32 = 0.025;

/// Smooths the pixels that show nothing but ground, over such pixels alone (a bilateral filter, Tomasi and Manduchi
/// 1998, told apart by means of three by three so that grain does not keep itself).
pub(super) fn smooth(width: u32, pixels: &[[f32; 4]], is_ground: &[bool]) -> Vec<[f32; 4]> {
    let (w, h) = (i64::from(width), pixels.len() as i64 / i64::from(width));
    let around = |i: usize, reach: i64| {
        let (x, y) = (i as i64 % w, i as i64 / w);
        let rows = (y - reach).max(0)..=(y + reach).min(h - 1);
        rows.flat_map(move |v| ((x - reach).max(0)..=(x + reach).min(w - 1)).map(move |u| (u, v)))
            .filter(|&(u, v)| is_ground[(v * w + u) as usize])
            .map(move |(u, v)| ((v * w + u) as usize, ((u - x) * (u - x) + (v - y) * (v - y)) as f32))
    };
    let light = |p: &[f32; 4]| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    let means: Vec<f32> = (0..pixels.len())
        .into_par_iter()
        .map(|i| {
            if !is_ground[i] {
                return 0.0;
            }
            let (sum, n) = around(i, 1).fold((0.0, 0.0), |(sum, n), (j, _)| (sum + light(&pixels[j]), n + 1.0));
            sum / n
        })
        .collect();
    let smoothed = |i: usize| {
        if !is_ground[i] {
            return pixels[i];
        }
        let mut sum = [0.0; 4];
        let mut total = 0.0;
        for (j, distance2) in around(i, REACH) {
            let difference = (means[j] - means[i]) / CHANCE;
            let alike = 1.0 / (1.0 + difference * difference);
            let weight = alike * alike / (1.0 + distance2 * 0.15);
            (0..4).for_each(|c| sum[c] += pixels[j][c] * weight);
            total += weight;
        }
        sum.map(|x| x / total)
    };
    (0..pixels.len()).into_par_iter().map(smoothed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grain_goes_and_edges_stay() {
        let (width, height) = (32, 16);
        let noise = |i: u32| (crate::math::mix(u64::from(i)) % 1000) as f32 / 1000.0 - 0.5;
        let pixels: Vec<[f32; 4]> = (0..width * height)
            .map(|i| [if i % width < 16 { 0.2 } else { 0.6 } + noise(i) * 0.04, 0.4, 0.4, 1.0])
            .collect();
        let mut is_ground = vec![true; pixels.len()];
        is_ground[5] = false;
        let smoothed = smooth(width, &pixels, &is_ground);
        assert_eq!(smoothed[5], pixels[5]);
        let spread = |p: &[[f32; 4]]| {
            let part: Vec<f32> = (0..p.len()).filter(|i| i % 32 < 12).map(|i| p[i][0]).collect();
            let mean = part.iter().sum::<f32>() / part.len() as f32;
            part.iter().map(|x| (x - mean) * (x - mean)).sum::<f32>()
        };
        assert!(spread(&smoothed) < spread(&pixels) * 0.15);
        assert!(
            smoothed[15][0] < 0.25 && smoothed[16][0] > 0.5,
            "the edge stays: {} {}",
            smoothed[15][0],
            smoothed[16][0]
        );
    }
}
