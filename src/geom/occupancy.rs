//! A sparse set of voxels, a tree of two levels as in VDB (Museth 2013): a space of a billion voxels takes the memory of those
//! that are occupied.

use rayon::prelude::*;

use super::{Bounds, Shape};
use crate::math::DVec3;

/// log2 of the voxels along the side of a leaf, and of the leaves along the side of a tile.
const BITS: u32 = 3;
/// Voxels of a leaf, and leaves of a tile.
const CELLS: usize = 1 << (3 * BITS);
/// Depth to which a solid is filled, in voxels: more than a ray that starts beside it can step over.
const DEPTH: f64 = 3.0;
/// Advance of a ray past each cell's border, in voxels.
const STEP: f64 = 1e-6;
/// Smaller components of a direction count as 0.
const LEAST: f64 = 1e-12;

/// 8 x 8 x 8 voxels, a bit each.
type LeafBits = [u64; CELLS / 64];

/// A set of voxels: cubes of one size in a box.
#[derive(Clone, Debug)]
pub struct Occupancy {
    low: DVec3,
    side: f64,
    /// Voxels along each axis.
    size: [i32; 3],
    /// Tiles along each axis.
    tiling: [i32; 3],
    /// The index of each tile in `tiles`, or [`NONE`].
    root: Vec<u32>,
    /// For each tile the indices of its leaves in `leaves`, or [`NONE`].
    tiles: Vec<[u32; CELLS]>,
    leaves: Vec<LeafBits>,
    count: u64,
}

/// Stands for an empty tile or leaf.
const NONE: u32 = u32::MAX;

/// The index of a voxel within its leaf, or of a leaf within its tile.
fn within([x, y, z]: [i32; 3]) -> usize {
    let low = |c: i32| (c & ((1 << BITS) - 1)) as usize;
    low(x) | low(y) << BITS | low(z) << (2 * BITS)
}

impl Occupancy {
    /// An empty set of voxels with this side in `bounds`.
    #[must_use]
    pub fn new(bounds: Bounds, side: f64) -> Self {
        let size = Self::size(bounds, side).map(|n| n as i32);
        let tiling = size.map(|n| ((n - 1) >> (2 * BITS)) + 1);
        let root = vec![NONE; tiling.iter().map(|&n| n as usize).product()];
        Self { low: bounds.min, side, size, tiling, root, tiles: Vec::new(), leaves: Vec::new(), count: 0 }
    }

    /// The number of voxels with this side along each axis of `bounds`.
    #[must_use]
    pub fn size(bounds: Bounds, side: f64) -> [f64; 3] {
        (bounds.size() / side).to_array().map(|n| libm::ceil(n - 1e-9).max(1.0))
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.root.len() * 4 + self.tiles.len() * CELLS * 4 + self.leaves.len() * size_of::<LeafBits>()
    }

    /// Side of a voxel, in scene units.
    #[must_use]
    pub fn side(&self) -> f64 {
        self.side
    }

    /// The number of occupied voxels.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The coordinates of the voxel that contains `p`.
    fn cell(&self, p: DVec3) -> [i32; 3] {
        ((p - self.low) / self.side).to_array().map(|c| libm::floor(c) as i32)
    }

    fn is_within(&self, [x, y, z]: [i32; 3]) -> bool {
        let [nx, ny, nz] = self.size;
        x >= 0 && x < nx && y >= 0 && y < ny && z >= 0 && z < nz
    }

    /// The index in `root` of the tile that contains the voxel.
    fn tile(&self, [x, y, z]: [i32; 3]) -> usize {
        let tile = |c: i32| c >> (2 * BITS);
        (tile(x) + self.tiling[0] * (tile(y) + self.tiling[1] * tile(z))) as usize
    }

    /// log2 of the side, in voxels, of the largest empty cell of the tree around the voxel `at`, which must be within the box;
    /// `None` if it is occupied.
    fn empty_level(&self, at: [i32; 3]) -> Option<u32> {
        let tile = self.root[self.tile(at)];
        if tile == NONE {
            return Some(2 * BITS);
        }
        let [x, y, z] = at;
        let leaf = self.tiles[tile as usize][within([x >> BITS, y >> BITS, z >> BITS])];
        if leaf == NONE {
            return Some(BITS);
        }
        let bit = within(at);
        (self.leaves[leaf as usize][bit / 64] >> (bit % 64) & 1 == 0).then_some(0)
    }

    /// Is the voxel that contains `p` occupied?
    #[must_use]
    pub fn contains(&self, p: DVec3) -> bool {
        let at = self.cell(p);
        self.is_within(at) && self.empty_level(at).is_none()
    }

    /// The leaf of the voxel `at`, which must be within the box; added if it is missing.
    fn leaf(&mut self, at: [i32; 3]) -> &mut LeafBits {
        let tile = self.tile(at);
        if self.root[tile] == NONE {
            self.root[tile] = self.tiles.len() as u32;
            self.tiles.push([NONE; CELLS]);
        }
        let slot = &mut self.tiles[self.root[tile] as usize][within(at.map(|c| c >> BITS))];
        if *slot == NONE {
            *slot = self.leaves.len() as u32;
            self.leaves.push(LeafBits::default());
        }
        &mut self.leaves[*slot as usize]
    }

    fn insert(&mut self, at: [i32; 3]) {
        if self.is_within(at) {
            let bit = within(at);
            let word = &mut self.leaf(at)[bit / 64];
            let is_new = *word >> (bit % 64) & 1 == 0;
            *word |= 1 << (bit % 64);
            self.count += u64::from(is_new);
        }
    }

    /// Occupies the voxels along a line segment.
    pub fn insert_line(&mut self, from: DVec3, to: DVec3) {
        let steps = libm::ceil((to - from).length() / self.side * 2.0).max(1.0) as u32;
        for i in 0..=steps {
            self.insert(self.cell(from + (to - from) * (f64::from(i) / f64::from(steps))));
        }
    }

    /// Occupies the voxels whose centres lie in a ball.
    pub fn insert_ball(&mut self, centre: DVec3, radius: f64) {
        let (low, high) = (self.cell(centre - radius), self.cell(centre + radius));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    if (self.centre([x, y, z], 0) - centre).length_squared() <= radius * radius {
                        self.insert([x, y, z]);
                    }
                }
            }
        }
    }

    /// The centre of the cell with side 2^`level` voxels whose first voxel is `at`.
    fn centre(&self, at: [i32; 3], level: u32) -> DVec3 {
        let half = f64::from(1 << level) * 0.5;
        self.low + DVec3::from_array(at.map(|c| f64::from(c) + half)) * self.side
    }

    /// Occupies the voxels whose centres lie in `shape`, to a depth of a few voxels below its surface.
    pub fn insert_shape(&mut self, shape: &Shape) {
        // Every voxel is evaluated once: a cache would be useless.
        let shape = &shape.unsampled();
        let [nx, ny, nz] = self.tiling;
        let tiles: Vec<[i32; 3]> = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / (nx * ny)]).collect();
        let found: Vec<Vec<([i32; 3], LeafBits)>> =
            tiles.into_par_iter().map(|tile| self.leaves_of(shape, tile)).collect();
        for (at, bits) in found.into_iter().flatten() {
            let mut more = 0;
            for (word, more_bits) in self.leaf(at).iter_mut().zip(bits) {
                more += u64::from((more_bits & !*word).count_ones());
                *word |= more_bits;
            }
            self.count += more;
        }
    }

    /// The leaves of a tile that a shape occupies near its surface, by their first voxel.
    fn leaves_of(&self, shape: &Shape, tile: [i32; 3]) -> Vec<([i32; 3], LeafBits)> {
        let depth = DEPTH * self.side;
        let half_diagonal = |level: u32| f64::from(1 << level) * self.side * 0.5 * libm::sqrt(3.0);
        // May the cell contain voxels to be occupied?
        let is_near = |at: [i32; 3], level: u32| {
            let margin = shape.margin(self.centre(at, level));
            margin <= half_diagonal(level) && margin >= -half_diagonal(level) - depth
        };
        let first = tile.map(|c| c << (2 * BITS));
        if !is_near(first, 2 * BITS) {
            return Vec::new();
        }
        let mut found = Vec::new();
        let mut near_pairs = [false; CELLS];
        for leaf in 0..CELLS as i32 {
            let at = first_voxel(leaf, first, BITS);
            if !is_near(at, BITS) {
                continue;
            }
            let mut bits = LeafBits::default();
            for voxel in 0..CELLS as i32 {
                let cell = first_voxel(voxel, at, 0);
                // Most of a leaf is not near: cells of 2 x 2 x 2 voxels are tested first.
                let pair = cell.map(|c| c & !1);
                if cell == pair {
                    near_pairs[voxel as usize] = is_near(pair, 1);
                }
                if !near_pairs[within(pair)] {
                    continue;
                }
                let d = shape.distance(self.centre(cell, 0));
                let is_set = d <= 0.0 && d >= -depth && self.is_within(cell);
                bits[voxel as usize / 64] |= u64::from(is_set) << (voxel % 64);
            }
            if bits != LeafBits::default() {
                found.push((at, bits));
            }
        }
        found
    }

    /// Does the ray from `origin` along the unit vector `direction` meet an occupied voxel beyond the distance `near`?
    #[must_use]
    pub fn is_blocked(&self, origin: DVec3, direction: DVec3, near: f64) -> bool {
        let from = (origin - self.low) / self.side;
        // A smaller component crosses no border, but rounding would stop the ray at each.
        let direction = direction.map(|c| if c.abs() < LEAST { 0.0 } else { c });
        let inverse = DVec3::new(inverse(direction.x), inverse(direction.y), inverse(direction.z));
        // A ray upwards along an axis leaves a cell at its upper side.
        let far = DVec3::new(exit_side(direction.x), exit_side(direction.y), exit_side(direction.z));
        // The parameter at which the ray leaves a cell.
        let out_of = |low: DVec3, size: DVec3| {
            let out = (low + far * size - from) * inverse;
            let xy = if out.x < out.y { out.x } else { out.y };
            if out.z < xy { out.z } else { xy }
        };
        let end =
            out_of(DVec3::ZERO, DVec3::new(f64::from(self.size[0]), f64::from(self.size[1]), f64::from(self.size[2])));
        let mut t = near / self.side;
        while t < end {
            let p = from + direction * t;
            // Truncation is floor here: negative coordinates are outside.
            let at = [p.x as i32, p.y as i32, p.z as i32];
            if p.x < 0.0 || p.y < 0.0 || p.z < 0.0 || !self.is_within(at) {
                t += 1.0;
                continue;
            }
            let Some(level) = self.empty_level(at) else { return true };
            let low = |c: i32| f64::from(c >> level << level);
            let out = out_of(DVec3::new(low(at[0]), low(at[1]), low(at[2])), DVec3::splat(f64::from(1 << level)));
            t = if out > t { out } else { t } + STEP;
        }
        false
    }
}

/// The reciprocal of a component of a direction; infinite where it is 0, since no border is met.
fn inverse(component: f64) -> f64 {
    if component == 0.0 { f64::INFINITY } else { 1.0 / component }
}

/// The side by which a ray with this component leaves a cell: 1 the upper one, 0 the lower one.
fn exit_side(component: f64) -> f64 {
    if component >= 0.0 { 1.0 } else { 0.0 }
}

/// The first voxel of child `index` of the cell whose first voxel is `first`; children have 2^`level` voxels a side.
fn first_voxel(index: i32, first: [i32; 3], level: u32) -> [i32; 3] {
    let mask = (1 << BITS) - 1;
    [0, 1, 2].map(|axis| first[axis as usize] + ((index >> (BITS as i32 * axis) & mask) << level))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::Solid;
    use super::*;

    proptest! {
        /// A ray is blocked where small steps along it meet a voxel.
        #[test]
        fn rays_meet_what_steps_meet(
            seed in any::<u64>(), origin in prop::array::uniform3(2.0..98.0), way in prop::array::uniform3(-1.0..1.0)
        ) {
            let bounds = Bounds { min: DVec3::ZERO, max: DVec3::splat(100.0) };
            let mut voxels = Occupancy::new(bounds, 1.0);
            let number = |i: u64| (crate::math::mix(seed ^ i) % 10_000) as f64 / 100.0;
            for i in 0..40 {
                voxels.insert_ball(DVec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)), 3.0);
            }
            let (origin, way) = (DVec3::from_array(origin), DVec3::from_array(way).normalize_or(DVec3::Z));
            let mut met = false;
            // Corners that are cut by less than a step may be missed by these.
            let mut grazes = false;
            for i in 0..40_000 {
                let p = origin + way * (2.0 + f64::from(i) * 0.005);
                met |= voxels.contains(p);
                grazes |= (0..6).any(|k| voxels.contains(p + DVec3::AXES[k / 2] * if k % 2 == 0 { 0.01 } else { -0.01 }));
            }
            let blocked = voxels.is_blocked(origin, way, 2.0);
            prop_assert!(blocked == met || grazes != met, "{} {}", blocked, met);
        }
    }

    #[test]
    fn shapes_are_filled_near_their_surface() {
        let bounds = Bounds { min: DVec3::splat(-50.0), max: DVec3::splat(50.0) };
        let ball = Shape::new(Solid::Sphere { centre: DVec3::new(0.3, 0.1, -0.2), radius: 30.0 });
        let mut voxels = Occupancy::new(bounds, 0.5);
        voxels.insert_shape(&ball);
        let mut count = 0;
        for i in 0..200 * 200 * 200_i32 {
            let p = bounds.min + DVec3::new((i % 200) as f64, (i / 200 % 200) as f64, (i / 40_000) as f64) * 0.5 + 0.25;
            let d = ball.distance(p);
            let is_in = (-1.5..=0.0).contains(&d);
            count += u64::from(is_in);
            assert_eq!(voxels.contains(p), is_in, "{p}");
        }
        assert_eq!(voxels.count(), count);
    }

    /// A ray along a border, but for rounding, advances from cell to cell.
    #[test]
    fn rays_along_borders_go_on() {
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(4096.0, 4.0, 4.0) };
        let mut voxels = Occupancy::new(bounds, 1.0);
        let way = DVec3::new(1.0, -6e-17, 6e-17);
        assert!(!voxels.is_blocked(DVec3::new(0.5, 2.0, 2.0), way, 0.0));
        voxels.insert([4000, 2, 2]);
        assert!(voxels.is_blocked(DVec3::new(0.5, 2.0, 2.0), way, 0.0));
    }

    /// A space of a billion voxels takes the memory of the occupied ones.
    #[test]
    fn empty_space_is_free() {
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::splat(1024.0) };
        let mut voxels = Occupancy::new(bounds, 1.0);
        voxels.insert_line(DVec3::splat(1.0), DVec3::splat(1000.0));
        assert!(voxels.count() > 999 && voxels.bytes() < 2_000_000, "{} {}", voxels.count(), voxels.bytes());
        assert!(voxels.is_blocked(DVec3::new(500.5, 500.5, 0.5), DVec3::Z, 0.0));
        assert!(!voxels.is_blocked(DVec3::new(500.5, 400.5, 0.5), DVec3::Z, 0.0));
    }
}
