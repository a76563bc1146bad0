//! A signed distance field on a grid: a grown solid, as a shape for other steps.

use rayon::prelude::*;

use super::Bounds;
use crate::math::DVec3;

/// A signed distance field on a grid, negative inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Voxels {
    size: [usize; 3],
    spacing: f64,
    low: DVec3,
    distances: Vec<f32>,
}

impl Voxels {
    /// The distance field of the samples where `is_inside`, indexed by `x + size.x (y + size.y z)`; the first sample is at
    /// `low`. The surface is half a step from the samples inside; distances between samples are exact.
    #[must_use]
    pub fn new(size: [u32; 3], spacing: f64, low: DVec3, is_inside: &[bool]) -> Self {
        let size = size.map(|s| s as usize);
        let [out, within] =
            rayon::join(|| squared_distances(size, |i| is_inside[i]), || squared_distances(size, |i| !is_inside[i]))
                .into();
        let distances = out
            .into_par_iter()
            .zip(within)
            .map(|(out, within)| {
                let d = if within == 0.0 { f64::from(out).sqrt() - 0.5 } else { 0.5 - f64::from(within).sqrt() };
                (d * spacing) as f32
            })
            .collect();
        Self { size, spacing, low, distances }
    }

    /// Bytes that a sample takes at the peak of [`Voxels::new`]: what is inside and outside, transformed, along z once more, and
    /// the result.
    pub const SAMPLE_BYTES: usize = 5 * size_of::<f32>();

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.distances[..])
    }

    fn at(&self, x: usize, y: usize, z: usize) -> f64 {
        f64::from(self.distances[x + self.size[0] * (y + self.size[1] * z)])
    }

    /// Signed distance of `p`, trilinearly interpolated; beyond the grid its distance from the grid is added.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        let last = DVec3::from_array(self.size.map(|s| s as f64 - 1.0));
        let at = (p - self.low) / self.spacing;
        let inside = at.clamp(DVec3::ZERO, last);
        let low = inside.to_array().map(|c| c as usize);
        let share = inside - DVec3::from_array(low.map(|c| c as f64));
        if share == DVec3::ZERO && inside == at {
            return self.at(low[0], low[1], low[2]);
        }
        let high: [usize; 3] = std::array::from_fn(|axis| (low[axis] + 1).min(self.size[axis] - 1));
        let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let line = |y: usize, z: usize| lerp(self.at(low[0], y, z), self.at(high[0], y, z), share.x);
        let face = |z: usize| lerp(line(low[1], z), line(high[1], z), share.y);
        lerp(face(low[2]), face(high[2]), share.z) + (at - inside).length() * self.spacing
    }

    /// A bounding box.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let last = DVec3::from_array(self.size.map(|s| s as f64 - 1.0));
        Bounds { min: self.low - self.spacing, max: self.low + (last + 1.0) * self.spacing }
    }
}

/// Stands for infinity: above the square of any grid's diagonal.
const FAR: f32 = 1e12;

/// The squared Euclidean distance transform: for each sample the distance, in grid steps, from the nearest that is `set`;
/// exact, an axis at a time (Felzenszwalb and Huttenlocher 2012).
fn squared_distances(size: [usize; 3], set: impl Fn(usize) -> bool + Sync) -> Vec<f32> {
    let [nx, ny, nz] = size;
    let mut all: Vec<f32> = (0..nx * ny * nz).into_par_iter().map(|i| if set(i) { 0.0 } else { FAR }).collect();
    all.par_chunks_mut(nx).for_each(sweep);
    all.par_chunks_mut(nx * ny).for_each_init(
        || (Envelope::default(), vec![0.0; ny]),
        |(envelope, line), layer| {
            for x in 0..nx {
                (0..ny).for_each(|y| line[y] = layer[x + nx * y]);
                envelope.lower(line);
                (0..ny).for_each(|y| layer[x + nx * y] = line[y]);
            }
        },
    );
    if nz > 1 {
        // Along z: slices of x and z, gathered for each y.
        let mut layers = vec![0.0; all.len()];
        layers.par_chunks_mut(nx * nz).enumerate().for_each_init(
            || (Envelope::default(), vec![0.0; nz]),
            |(envelope, line), (y, layer)| {
                for x in 0..nx {
                    (0..nz).for_each(|z| line[z] = all[x + nx * (y + ny * z)]);
                    envelope.lower(line);
                    (0..nz).for_each(|z| layer[x + nx * z] = line[z]);
                }
            },
        );
        all.par_chunks_mut(nx).enumerate().for_each(|(row, to)| {
            let from = nx * (row / ny + nz * (row % ny));
            to.copy_from_slice(&layers[from..from + nx]);
        });
    }
    all
}

/// The transform along the first axis, whose samples are 0 or [`FAR`]: a forward and a backward pass.
fn sweep(row: &mut [f32]) {
    let pass = |steps: &mut f32, value: &mut f32| {
        *steps = if *value == 0.0 { 0.0 } else { *steps + 1.0 };
        let squared = *steps * *steps;
        *value = if squared < *value { squared } else { *value };
    };
    let mut steps = FAR;
    row.iter_mut().for_each(|value| pass(&mut steps, value));
    let mut steps = FAR;
    row.iter_mut().rev().for_each(|value| pass(&mut steps, value));
}

/// The lower envelope of parabolas over a row.
#[derive(Default)]
struct Envelope {
    /// Vertices of the parabolas of the envelope.
    vertices: Vec<usize>,
    /// Where each becomes the lowest.
    from: Vec<f32>,
    values: Vec<f32>,
}

impl Envelope {
    /// Replaces each `row[x]` by the least of `row[q] + (x - q)^2`.
    fn lower(&mut self, row: &mut [f32]) {
        // Most rows are far from any surface.
        if row.iter().all(|&value| value == 0.0) || row.iter().all(|&value| value >= FAR) {
            return;
        }
        self.values.clear();
        self.values.extend_from_slice(row);
        self.vertices.clear();
        self.from.clear();
        let key = |q: usize| f64::from(row[q]) + (q * q) as f64;
        for q in 0..row.len() {
            loop {
                let Some(&last) = self.vertices.last() else {
                    self.vertices.push(q);
                    self.from.push(f32::NEG_INFINITY);
                    break;
                };
                let cross = ((key(q) - key(last)) / (2 * (q - last)) as f64) as f32;
                if cross > self.from[self.from.len() - 1] {
                    self.vertices.push(q);
                    self.from.push(cross);
                    break;
                }
                self.vertices.pop();
                self.from.pop();
            }
        }
        let mut at = 0;
        for (x, value) in row.iter_mut().enumerate() {
            while at + 1 < self.vertices.len() && self.from[at + 1] < x as f32 {
                at += 1;
            }
            let q = self.vertices[at];
            let d = x.abs_diff(q) as f32;
            *value = self.values[q] + d * d;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Against brute force.
        #[test]
        fn distances_are_exact(seed in any::<u64>(), share in 1..30_u64) {
            let size = [9, 6, 7];
            let inside: Vec<bool> = (0..9 * 6 * 7).map(|i| crate::math::mix(seed ^ i) % 30 < share).collect();
            prop_assume!(inside.iter().any(|&b| b) && inside.iter().any(|&b| !b));
            let voxels = Voxels::new(size, 0.5, DVec3::ZERO, &inside);
            let at = |i: usize| DVec3::new((i % 9) as f64, (i / 9 % 6) as f64, (i / 54) as f64) * 0.5;
            for i in 0..inside.len() {
                let nearest = (0..inside.len()).filter(|&j| inside[j] != inside[i]).map(|j| (at(i) - at(j)).length());
                let nearest = nearest.fold(f64::INFINITY, f64::min) - 0.25;
                let d = voxels.distance(at(i));
                prop_assert!((d.abs() - nearest).abs() < 1e-5 && (d < 0.0) == inside[i], "{} {} {}", i, d, nearest);
            }
        }
    }
}
