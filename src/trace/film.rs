//! The film: colours, and arbitrary output variables for compositing.

use crate::math::DVec3;
use crate::raster::{Channel, Layers};

/// ID mattes of a pixel: those with the largest coverage (Cryptomatte 1.2).
pub const RANKS: usize = 6;

/// IDs and their coverage of a pixel, in descending order; 0 is none.
pub type Ranks = [(u32, f32); RANKS];

/// The output variables of a pixel besides its colour: those of its nearest sample, but for the mattes.
#[derive(Clone, Copy, Debug)]
pub struct Data {
    /// Distance along the camera's axis, in scene units; infinite for the background.
    pub depth: f32,
    /// Unit normal in world space; zero for the background.
    pub normal: [f32; 3],
    /// Position in world space.
    pub point: [f32; 3],
    /// Path cost.
    pub cost: f32,
    /// The round of growth.
    pub level: f32,
    /// Objects by index plus 1; the ground follows the last.
    pub objects: Ranks,
    /// Limbs by number plus 1, counted through all objects.
    pub branches: Ranks,
}

/// A traced picture, in linear light; a crop of one has the size of the crop.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue times alpha, and alpha, row by row from the top.
    pub pixels: Vec<[f32; 4]>,
    /// Output variables a pixel; empty if they were not requested.
    pub data: Vec<Data>,
}

/// A sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub colour: [f64; 3],
    /// The colour of the surface, or of the sky.
    pub pigment: [f64; 3],
    pub alpha: f64,
    pub depth: f64,
    pub normal: DVec3,
    pub point: DVec3,
    pub cost: f64,
    pub level: u16,
    /// Index plus 1; 0 for the background.
    pub object: u32,
    /// Number plus 1; 0 for none.
    pub branch: u32,
}

/// The mean colour and alpha of samples (a box filter).
pub(super) fn mean(samples: &[Sample]) -> [f32; 4] {
    let share = 1.0 / samples.len() as f64;
    let sum = samples
        .iter()
        .fold([0.0; 4], |sum, s| [sum[0] + s.colour[0], sum[1] + s.colour[1], sum[2] + s.colour[2], sum[3] + s.alpha]);
    sum.map(|x| (x * share) as f32)
}

/// The output variables of samples.
pub(super) fn data(samples: &[Sample]) -> Data {
    let nearest = samples.iter().reduce(|a, b| if b.depth < a.depth { b } else { a });
    let single = |p: DVec3| p.to_array().map(|x| x as f32);
    Data {
        depth: nearest.map_or(f32::INFINITY, |s| s.depth as f32),
        normal: nearest.map_or([0.0; 3], |s| single(s.normal)),
        point: nearest.map_or([0.0; 3], |s| single(s.point)),
        cost: nearest.map_or(0.0, |s| s.cost as f32),
        level: nearest.map_or(0.0, |s| f32::from(s.level)),
        objects: ranks(samples.iter().map(|s| s.object)),
        branches: ranks(samples.iter().map(|s| s.branch)),
    }
}

/// The coverage of IDs in descending order, equal ones by ID; 0 is none.
fn ranks(ids: impl ExactSizeIterator<Item = u32>) -> Ranks {
    let count = ids.len() as f32;
    let mut ids: Vec<u32> = ids.filter(|&id| id != 0).collect();
    ids.sort_unstable();
    let mut groups: Vec<(u32, usize)> = ids.chunk_by(|a, b| a == b).map(|g| (g[0], g.len())).collect();
    groups.sort_by_key(|&(id, n)| (std::cmp::Reverse(n), id));
    let mut ranks = [(0, 0.0); RANKS];
    for (rank, (id, n)) in ranks.iter_mut().zip(groups) {
        *rank = (id, n as f32 / count);
    }
    ranks
}

impl Picture {
    /// The crop `[left, top, width, height]`, which must be within it.
    #[must_use]
    pub(super) fn cut(&self, [left, top, width, height]: [u32; 4]) -> Self {
        fn part<T: Copy>(values: &[T], row: u32, [left, top, width, height]: [u32; 4]) -> Vec<T> {
            if values.is_empty() {
                return Vec::new();
            }
            let from = |y: u32| y as usize * row as usize + left as usize;
            (top..top + height).flat_map(|y| values[from(y)..from(y) + width as usize].iter().copied()).collect()
        }
        let rect = [left, top, width, height];
        Self { width, height, pixels: part(&self.pixels, self.width, rect), data: part(&self.data, self.width, rect) }
    }

    /// Its channels by their EXR names: `R G B A`, and with output variables `Z`, `N`, `P`, `cost` and `level`.
    #[must_use]
    pub fn layers(&self) -> Layers {
        let mut layers = Layers { width: self.width, height: self.height, ..Layers::default() };
        let mut add = |name: &str, is_half, values: Vec<f32>| {
            layers.channels.push(Channel { name: name.to_owned(), values, is_half });
        };
        for (i, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            add(name, true, self.pixels.iter().map(|p| p[i]).collect());
        }
        if self.data.is_empty() {
            return layers;
        }
        let data = &self.data;
        add("Z", false, data.iter().map(|d| d.depth).collect());
        for (i, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
            add(&format!("N.{axis}"), false, data.iter().map(|d| d.normal[i]).collect());
            add(&format!("P.{axis}"), false, data.iter().map(|d| d.point[i]).collect());
        }
        add("cost", false, data.iter().map(|d| d.cost).collect());
        add("level", false, data.iter().map(|d| d.level).collect());
        layers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mattes_are_ranked_by_cover() {
        let ranks = ranks([3, 0, 7, 7, 3, 7, 9, 0].into_iter());
        assert_eq!(ranks[..4], [(7, 0.375), (3, 0.25), (9, 0.125), (0, 0.0)]);
    }
}
