//! Maximal Poisson-disc sampling: no two nodes nearer than the spacing, and no room for another.
//!
//! A grid has cells so small that each contains at most one node (Bridson 2007). Cells are visited once, in random order: a
//! dart is thrown into the cell; on a miss it is subdivided until a free point is found or every piece is covered by discs or
//! outside the region (after Ebeida et al. 2012). A visited cell has no room left.

use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x8};
use rand::RngExt;
use rayon::prelude::*;

use super::scatter_size::{MOST_NODES, ScatterError, scatter_estimate};
use crate::math::{DVec3, Stream, mix};

/// Cells along the side of a block, the unit of parallel work: blocks that do not touch are filled concurrently.
const BLOCK: i32 = 16;
/// Cells around a block whose nodes affect it: the side of a cell is 1 / sqrt 3 (in the plane 1 / sqrt 2) of the spacing.
const HALO: i32 = 2;
/// Pieces of a cell up to this depth are tested in single precision, with this relative tolerance.
const COARSE: (u32, f64) = (6, 1e-5);
/// Greatest depth of subdivision: such a piece is a millionth of a spacing wide.
const DEEPEST: u32 = 20;
/// Most pieces visited in a cell; only degenerate regions might need more.
const MOST_PIECES: u32 = 20_000;

/// The region that is sampled.
pub trait Region: Sync {
    /// A conservative signed distance bound: negative inside, its magnitude at most the true distance.
    fn margin(&self, p: DVec3) -> f64;

    /// The least and the greatest corner of a bounding box.
    fn bounds(&self) -> [DVec3; 2];
}

/// The grid over the bounding box of a region.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellGrid {
    origin: DVec3,
    /// Side of a cell.
    side: f64,
    size: [i32; 3],
    is_plane: bool,
}

impl CellGrid {
    pub fn new(bounds: [DVec3; 2], spacing: f64, is_plane: bool) -> Self {
        // Slightly less, so that rounding cannot put two nodes into one cell.
        let side = spacing * (1.0 - 1e-9) / libm::sqrt(if is_plane { 2.0 } else { 3.0 });
        let extent = (bounds[1] - bounds[0]) / side;
        let mut size = extent.to_array().map(|e| (libm::floor(e) as i32).saturating_add(1).max(1));
        if is_plane {
            size[2] = 1;
        }
        let origin = if is_plane { bounds[0].with_z(0.0) } else { bounds[0] };
        Self { origin, side, size, is_plane }
    }

    /// The number of cells.
    pub fn count(&self) -> u64 {
        self.size.iter().map(|&s| s as u64).product()
    }

    fn of(&self, p: DVec3) -> Option<[i32; 3]> {
        let at = ((p - self.origin) / self.side).to_array().map(|c| libm::floor(c) as i32);
        let at = if self.is_plane { [at[0], at[1], 0] } else { at };
        (0..3).all(|axis| (0..self.size[axis]).contains(&at[axis])).then_some(at)
    }

    fn index(&self, [x, y, z]: [i32; 3]) -> usize {
        x as usize + self.size[0] as usize * (y as usize + self.size[1] as usize * z as usize)
    }
}

/// A maximal Poisson-disc sample of `region`: first those of `fixed` (anywhere in the bounding box) that are no nearer than
/// the spacing to an earlier one, then random points from `stream`.
pub(super) fn poisson(
    region: &dyn Region,
    cells: &CellGrid,
    spacing: f64,
    fixed: &[DVec3],
    stream: &Stream,
) -> Vec<DVec3> {
    // The number of the node in each cell plus 1, 0 for none.
    let mut held = vec![0_u32; cells.count() as usize];
    let mut nodes: Vec<DVec3> = Vec::new();
    for &p in fixed {
        let Some(at) = cells.of(p) else { continue };
        let range = |axis: usize| (at[axis] - HALO).max(0)..(at[axis] + HALO + 1).min(cells.size[axis]);
        let mut near = range(2).flat_map(|z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])));
        let is_free = near.all(|cell| match held[cells.index(cell)] {
            0 => true,
            node => nodes[node as usize - 1].distance(p) >= spacing,
        });
        if is_free {
            nodes.push(p);
            held[cells.index(at)] = nodes.len() as u32;
        }
    }
    let level = Level::new();
    let blocks = cells.size.map(|s| (s + BLOCK - 1) / BLOCK);
    // Blocks of equal parity do not touch, so there are eight parallel phases.
    for phase in 0..8 {
        let every = |axis: usize| (0..blocks[axis]).filter(move |b| b & 1 == phase >> axis & 1);
        let places: Vec<[i32; 3]> =
            every(2).flat_map(|z| every(1).flat_map(move |y| every(0).map(move |x| [x, y, z]))).collect();
        let fill = |&place: &[i32; 3]| {
            let block = CellBlock::new(cells, spacing, place, &held, &nodes);
            dispatch!(level, simd => block.fill(simd, region, stream))
        };
        let found: Vec<Vec<DVec3>> =
            if places.len() > 1 { places.par_iter().map(fill).collect() } else { places.iter().map(fill).collect() };
        for p in found.into_iter().flatten() {
            nodes.push(p);
            if let Some(at) = cells.of(p) {
                held[cells.index(at)] = nodes.len() as u32;
            }
        }
    }
    nodes
}

/// A maximal Poisson-disc sample of `region`, in the plane or in space.
///
/// # Errors
/// [`ScatterError::TooMany`].
pub fn poisson_points(
    region: &dyn Region,
    spacing: f64,
    is_plane: bool,
    stream: &Stream,
) -> Result<Vec<DVec3>, ScatterError> {
    let estimate = scatter_estimate(region.bounds(), spacing, is_plane);
    if estimate.is_nan() || estimate > MOST_NODES {
        return Err(ScatterError::TooMany(estimate));
    }
    Ok(poisson(region, &CellGrid::new(region.bounds(), spacing, is_plane), spacing, &[], stream))
}

/// A block of cells with its halo.
struct CellBlock<'a> {
    cells: &'a CellGrid,
    /// The spacing squared.
    apart: f64,
    /// The lowest cell, halo excluded.
    low: [i32; 3],
    /// Cells along each axis, halo excluded.
    size: [i32; 3],
    /// Cells in a row and in a layer, halo included.
    strides: [usize; 2],
    /// The number of the node in each cell plus 1, 0 for none.
    held: Vec<u32>,
    /// For each row of cells, bits of those that contain a node, and of those known to have no room.
    rows: Vec<[u32; 2]>,
    nodes: Vec<DVec3>,
    /// The index of the first new node.
    first: usize,
    /// The stack of the search.
    stack: Vec<CellPiece>,
}

/// The nodes whose discs overlap a cell, in order of distance from its centre.
#[derive(Default)]
struct NearDiscs {
    /// Their positions.
    nodes: Vec<DVec3>,
    /// Positions relative to the cell's centre, eight at a time; unused lanes are far away.
    lanes: Vec<[[f32; 8]; 3]>,
    /// The cell's centre.
    middle: DVec3,
}

/// A piece of a subdivided cell.
#[derive(Clone, Copy)]
struct CellPiece {
    low: DVec3,
    side: f64,
    depth: u32,
    /// Is all of it inside the region?
    is_inside: bool,
}

impl<'a> CellBlock<'a> {
    fn new(cells: &'a CellGrid, spacing: f64, place: [i32; 3], held: &[u32], nodes: &[DVec3]) -> Self {
        let low = place.map(|b| b * BLOCK);
        let size = [0, 1, 2].map(|axis| BLOCK.min(cells.size[axis] - low[axis]));
        let width = size.map(|s| (s + 2 * HALO) as usize);
        let mut own = Self {
            cells,
            apart: spacing * spacing,
            low,
            size,
            strides: [width[0], width[0] * width[1]],
            held: vec![0; width[0] * width[1] * width[2]],
            rows: vec![[0; 2]; width[1] * width[2]],
            nodes: Vec::new(),
            first: 0,
            stack: Vec::new(),
        };
        let range = |axis: usize| (low[axis] - HALO).max(0)..(low[axis] + size[axis] + HALO).min(cells.size[axis]);
        for z in range(2) {
            for y in range(1) {
                let row = cells.index([0, y, z]);
                for x in range(0) {
                    let node = held[row + x as usize];
                    if node != 0 {
                        own.put([x - low[0], y - low[1], z - low[2]], nodes[node as usize - 1]);
                    }
                }
            }
        }
        own.first = own.nodes.len();
        own
    }

    /// Puts a node into the cell `at`, and marks the cells that its disc covers.
    fn put(&mut self, at: [i32; 3], p: DVec3) {
        self.nodes.push(p);
        let index = self.index(at);
        self.held[index] = self.nodes.len() as u32;
        let row = index / self.strides[0];
        self.rows[row][0] |= 1 << (at[0] + HALO);
        let side = self.cells.side;
        let own = self.low_corner([0, 1, 2].map(|axis| at[axis] + self.low[axis]));
        // Squared distance, along each axis, of the far side of the previous, this and the next cell.
        let far = [0, 1, 2].map(|axis| {
            let d = p[axis] - own[axis];
            [d + side, d.max(side - d), 2.0 * side - d].map(|far| far * far)
        });
        let deep = if self.cells.is_plane { 0..1 } else { -1..2 };
        for dz in deep {
            let z = if self.cells.is_plane { 0.0 } else { far[2][(dz + 1) as usize] };
            for dy in -1..2_i32 {
                let (y, z_at) = (at[1] + dy, at[2] + dz);
                if !(-HALO..self.size[1] + HALO).contains(&y) || !(-HALO..self.size[2] + HALO).contains(&z_at) {
                    continue;
                }
                let row = self.index([0, y, z_at]) / self.strides[0];
                for dx in -1..2_i32 {
                    let across = far[0][(dx + 1) as usize] + far[1][(dy + 1) as usize] + z;
                    if across < self.apart && (-HALO..self.size[0] + HALO).contains(&(at[0] + dx)) {
                        self.rows[row][1] |= 1 << (at[0] + dx + HALO);
                    }
                }
            }
        }
    }

    /// The index of a cell with coordinates relative to the block's lowest.
    fn index(&self, [x, y, z]: [i32; 3]) -> usize {
        (x + HALO) as usize + self.strides[0] * (y + HALO) as usize + self.strides[1] * (z + HALO) as usize
    }

    /// Visits every cell in random order, and returns the new nodes.
    #[inline(always)]
    fn fill<S: Simd>(mut self, simd: S, region: &dyn Region, stream: &Stream) -> Vec<DVec3> {
        let half = self.half_diagonal(self.cells.side);
        let mut order: Vec<(u64, [i16; 3], bool)> = Vec::new();
        // 2 x 2 (x 2) cells at a time: most are inside or outside together.
        let deep = if self.cells.is_plane { 1 } else { 2 };
        for z in (0..self.size[2]).step_by(deep) {
            for y in (0..self.size[1]).step_by(2) {
                for x in (0..self.size[0]).step_by(2) {
                    let low = self.low_corner([0, 1, 2].map(|axis| [x, y, z][axis] + self.low[axis]));
                    let whole = region.margin(self.middle_of(low, self.cells.side * 2.0));
                    if whole > 2.0 * half {
                        continue;
                    }
                    for (dx, dy, dz) in (0..8).map(|i| (i & 1, i >> 1 & 1, i >> 2)) {
                        let own = [x + dx, y + dy, z + dz];
                        if (0..3).any(|axis| own[axis] >= self.size[axis]) || !self.has_room(own) {
                            continue;
                        }
                        let at = [0, 1, 2].map(|axis| own[axis] + self.low[axis]);
                        let margin = if whole <= -2.0 * half { whole } else { region.margin(self.middle(at)) };
                        if margin <= half {
                            let name = self.cells.index(at) as u64;
                            order.push((mix(stream.key() ^ mix(name)), own.map(|c| c as i16), margin <= -half));
                        }
                    }
                }
            }
        }
        order.sort_unstable_by_key(|&(key, at, _)| (key, at));
        let mut near = NearDiscs::default();
        for (key, at, is_inside) in order {
            let at = at.map(i32::from);
            if !self.has_room(at) {
                continue;
            }
            self.gather(at, &mut near);
            let low = self.low_corner([at[0] + self.low[0], at[1] + self.low[1], at[2] + self.low[2]]);
            let piece = CellPiece { low, side: self.cells.side, depth: 0, is_inside };
            if let Some(p) = self.search(simd, region, &near, piece, stream.nth(key)) {
                self.put(at, p);
            }
        }
        self.nodes.split_off(self.first)
    }

    /// Half the diagonal of a cube (in the plane, a square) of this side, rounded up.
    fn half_diagonal(&self, side: f64) -> f64 {
        let diagonal = libm::sqrt(if self.cells.is_plane { 2.0 } else { 3.0 });
        side * diagonal * (0.5 + 1e-6)
    }

    /// May there be room in the cell?
    fn has_room(&self, at: [i32; 3]) -> bool {
        self.rows[self.index(at) / self.strides[0]][1] >> (at[0] + HALO) & 1 == 0
    }

    fn low_corner(&self, at: [i32; 3]) -> DVec3 {
        let [x, y, z] = at.map(f64::from);
        self.cells.origin + DVec3::new(x, y, z) * self.cells.side
    }

    fn middle(&self, at: [i32; 3]) -> DVec3 {
        self.middle_of(self.low_corner(at), self.cells.side)
    }

    fn middle_of(&self, low: DVec3, side: f64) -> DVec3 {
        let middle = low + side * 0.5;
        if self.cells.is_plane { middle.with_z(0.0) } else { middle }
    }

    /// Collects the nodes whose discs overlap the cell `at`, nearest to its centre first: those most often cover a piece.
    fn gather(&self, at: [i32; 3], near: &mut NearDiscs) {
        near.nodes.clear();
        let half = self.cells.side * 0.5;
        let middle = self.middle([0, 1, 2].map(|axis| at[axis] + self.low[axis]));
        let deep = if self.cells.is_plane { 0 } else { HALO };
        for dz in -deep..=deep {
            for dy in -HALO..=HALO {
                let row = self.index([-HALO, at[1] + dy, at[2] + dz]);
                // Five cells of the row, starting two cells before.
                let mut held = self.rows[row / self.strides[0]][0] >> at[0] & 0b11111;
                while held != 0 {
                    let cell = row + at[0] as usize + held.trailing_zeros() as usize;
                    let p = self.nodes[self.held[cell] as usize - 1];
                    let off = ((p - middle).abs() - half).max(DVec3::ZERO);
                    if off.length_squared() < self.apart {
                        near.nodes.push(p);
                    }
                    held &= held - 1;
                }
            }
        }
        let far = |p: &DVec3| middle.distance_squared(*p);
        near.nodes.sort_unstable_by(|a, b| far(a).total_cmp(&far(b)));
        near.middle = middle;
        near.lanes.clear();
        for eight in near.nodes.chunks(8) {
            let mut lanes = [[1e18_f32; 8]; 3];
            for (i, p) in eight.iter().enumerate() {
                let d = (*p - middle).to_array();
                (0..3).for_each(|axis| lanes[axis][i] = d[axis] as f32);
            }
            near.lanes.push(lanes);
        }
    }

    /// A free point of the region in `whole`, if there is one.
    #[inline(always)]
    fn search<S: Simd>(
        &mut self,
        simd: S,
        region: &dyn Region,
        near: &NearDiscs,
        whole: CellPiece,
        mut random: Stream,
    ) -> Option<DVec3> {
        let (apart, is_plane) = (self.apart, self.cells.is_plane);
        let dart = |piece: &CellPiece, random: &mut Stream| {
            let [u, v, w]: [f64; 3] = std::array::from_fn(|_| random.random());
            let p = piece.low + DVec3::new(u, v, w) * piece.side;
            let p = if is_plane { p.with_z(0.0) } else { p };
            let is_free = near.nodes.iter().all(|q| q.distance_squared(p) >= apart);
            (is_free && (piece.is_inside || region.margin(p) <= 0.0)).then_some(p)
        };
        if self.is_taken(simd, near, &whole) {
            return None;
        }
        if let Some(p) = dart(&whole, &mut random) {
            return Some(p);
        }
        self.stack.clear();
        self.stack.push(whole);
        let mut pieces = 0;
        while let Some(piece) = self.stack.pop() {
            pieces += 1;
            if piece.depth == DEEPEST || pieces > MOST_PIECES {
                continue;
            }
            let side = piece.side * 0.5;
            let half = self.half_diagonal(side);
            let children = if is_plane { 4 } else { 8 };
            let turn = random.random::<u64>() % children;
            for i in 0..children {
                let child = i ^ turn;
                let corner = DVec3::new((child & 1) as f64, (child >> 1 & 1) as f64, (child >> 2) as f64);
                let mut part = CellPiece { low: piece.low + corner * side, side, depth: piece.depth + 1, ..piece };
                if self.is_taken(simd, near, &part) {
                    continue;
                }
                if !part.is_inside {
                    let margin = region.margin(self.middle_of(part.low, side));
                    if margin > half {
                        continue;
                    }
                    part.is_inside = margin <= -half;
                }
                if let Some(p) = dart(&part, &mut random) {
                    return Some(p);
                }
                self.stack.push(part);
            }
        }
        None
    }

    /// Is `piece` covered by the disc of one node?
    #[inline(always)]
    fn is_taken<S: Simd>(&self, simd: S, near: &NearDiscs, piece: &CellPiece) -> bool {
        let half = piece.side * 0.5;
        let middle = self.middle_of(piece.low, piece.side);
        let deep = if self.cells.is_plane { 0.0 } else { half };
        if piece.depth <= COARSE.0 {
            // Loops only: closures would not be compiled for the instruction set.
            let at = middle - near.middle;
            let limit = f32x8::splat(simd, (self.apart * (1.0 - COARSE.1)) as f32);
            for lanes in &near.lanes {
                let x = (f32x8::from_slice(simd, &lanes[0]) - at.x as f32).abs() + half as f32;
                let y = (f32x8::from_slice(simd, &lanes[1]) - at.y as f32).abs() + half as f32;
                let z = (f32x8::from_slice(simd, &lanes[2]) - at.z as f32).abs() + deep as f32;
                if (x * x + y * y + z * z).simd_lt(limit).any_true() {
                    return true;
                }
            }
            return false;
        }
        near.nodes.iter().any(|&q| {
            let far = (q - middle).abs() + DVec3::new(half, half, deep);
            far.length_squared() < self.apart
        })
    }
}
