//! Denoising where the colour is uniform, so that variation is noise or shadow.

use rayon::prelude::*;

use crate::math::DVec3;

/// Radius of the filter, in pixels.
const REACH: i64 = 3;
/// Margin that the filter and its guide need, in pixels.
pub(super) const MARGIN: u32 = REACH as u32 + 1;
/// Scale of the range kernel: differences of 3 x 3 means of luminance below it count as noise.
const NOISE: f32 = 0.025;

/// Quantisation of a normal's components, to one byte each.
const UNIT: f64 = 127.0;
/// Least scalar product of quantised normals of one face: a cosine of 0.98.
const ALIKE: i32 = 15_807;

/// The object and the normal that a pixel shows, if there is only one of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FaceKey {
    object: u32,
    normal: [i8; 3],
}

impl FaceKey {
    pub fn new(object: u32, normal: DVec3) -> Self {
        Self { object, normal: (normal * UNIT).to_array().map(|c| libm::round(c) as i8) }
    }

    fn is_like(&self, other: &Self) -> bool {
        let cosine: i32 = (0..3).map(|c| i32::from(self.normal[c]) * i32::from(other.normal[c])).sum();
        self.object == other.object && cosine >= ALIKE
    }

    /// The face that all of these have in common, if there is one; the background, without a normal, is none.
    pub fn of_all(mut faces: impl Iterator<Item = Self> + Clone) -> Option<Self> {
        let first = faces.clone().next()?;
        faces.all(|face| face.is_like(&first)).then_some(first)
    }
}

/// Filters the pixels that show one face over pixels of the same face: a bilateral filter (Tomasi and Manduchi 1998) guided by
/// 3 x 3 means, so that noise does not preserve itself.
pub(super) fn smooth(width: u32, pixels: &[[f32; 4]], faces: &[Option<FaceKey>]) -> Vec<[f32; 4]> {
    let (w, h) = (i64::from(width), pixels.len() as i64 / i64::from(width));
    let around = |i: usize, own: FaceKey, reach: i64| {
        let (x, y) = (i as i64 % w, i as i64 / w);
        let rows = (y - reach).max(0)..=(y + reach).min(h - 1);
        rows.flat_map(move |v| ((x - reach).max(0)..=(x + reach).min(w - 1)).map(move |u| (u, v)))
            .filter(move |&(u, v)| faces[(v * w + u) as usize].is_some_and(|face| face.is_like(&own)))
            .map(move |(u, v)| ((v * w + u) as usize, ((u - x) * (u - x) + (v - y) * (v - y)) as f32))
    };
    let light = |p: &[f32; 4]| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    let means: Vec<f32> = (0..pixels.len())
        .into_par_iter()
        .map(|i| {
            let Some(own) = faces[i] else { return 0.0 };
            let (sum, n) = around(i, own, 1).fold((0.0, 0.0), |(sum, n), (j, _)| (sum + light(&pixels[j]), n + 1.0));
            sum / n
        })
        .collect();
    let smoothed = |i: usize| {
        let Some(own) = faces[i] else { return pixels[i] };
        let mut sum = [0.0; 4];
        let mut total = 0.0;
        for (j, distance2) in around(i, own, REACH) {
            let difference = (means[j] - means[i]) / NOISE;
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
    fn faces_are_like_themselves() {
        for i in 0..1000_u64 {
            let c = [0, 1, 2].map(|k| (crate::math::mix(3 * i + k) % 2001) as f64 / 1000.0 - 1.0);
            let normal = DVec3::from_array(c).normalize_or(DVec3::Z);
            let face = FaceKey::new(1, normal);
            assert_eq!(FaceKey::of_all([face; 3].into_iter()), Some(face));
            let turned = normal.any_orthonormal_vector() * 0.35 + normal;
            assert!(!face.is_like(&FaceKey::new(1, turned.normalize())), "{normal}");
        }
        assert_eq!(FaceKey::of_all([FaceKey::new(1, DVec3::ZERO)].into_iter()), None);
    }

    #[test]
    fn grain_goes_and_edges_stay() {
        let (width, height) = (32, 16);
        let noise = |i: u32| (crate::math::mix(u64::from(i)) % 1000) as f32 / 1000.0 - 0.5;
        let pixels: Vec<[f32; 4]> = (0..width * height)
            .map(|i| [if i % width < 16 { 0.2 } else { 0.6 } + noise(i) * 0.04, 0.4, 0.4, 1.0])
            .collect();
        let ground = FaceKey::new(1, DVec3::Z);
        let mut faces = vec![Some(ground); pixels.len()];
        faces[5] = None;
        // Other faces are separate from the ground.
        faces[40] = Some(FaceKey::new(2, DVec3::Z));
        faces[42] = Some(FaceKey::new(1, DVec3::X));
        let smoothed = smooth(width, &pixels, &faces);
        assert!([5, 40, 42].iter().all(|&i| smoothed[i] == pixels[i]));
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
