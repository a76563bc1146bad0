//! Closest-hit and any-hit queries for primitives of one kind.

use std::marker::PhantomData;

use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x8};
use rayon::prelude::*;

use super::build::{self, EMPTY};
use super::collapse::Wide;
use super::tree::{Aabb, Beam, Leaf, Tree, WIDTH};
use super::{Hit, Ray};
use crate::geom::Bounds;
use crate::math::{DVec3, prefetch};

/// Padding of boxes, as a share of the size of the whole: above the rounding error of the slab test (Ize 2013, "Robust BVH ray
/// traversal").
const PAD: f32 = 1e-6;

/// Primitives of a block, about.
const FULL: usize = 6;

/// Eight primitives of `N` numbers each, as structure of arrays; unused lanes are NaN, which no ray hits.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Block<const N: usize> {
    lanes: [[f32; WIDTH]; N],
}

impl<const N: usize> Block<N> {
    /// Number `i` of each primitive.
    #[inline(always)]
    pub(super) fn lane<S: Simd>(&self, simd: S, i: usize) -> f32x8<S> {
        f32x8::from_slice(simd, &self.lanes[i])
    }

    /// Numbers `i` to `i + 2` of each primitive.
    #[inline(always)]
    pub(super) fn point<S: Simd>(&self, simd: S, i: usize) -> [f32x8<S>; 3] {
        [self.lane(simd, i), self.lane(simd, i + 1), self.lane(simd, i + 2)]
    }
}

/// A kind of primitive, packed as `N` numbers.
pub trait Primitive<const N: usize>: Sync {
    /// The packed primitive; `None` if it is degenerate.
    fn pack(&self) -> Option<[f32; N]>;

    /// Least and greatest corner of its bounding box.
    fn bounds(packed: &[f32; N]) -> [[f32; 3]; 2];

    /// The distance at which the ray enters each of eight primitives, beyond its near end; infinity or NaN on a miss.
    #[doc(hidden)]
    fn enter<S: Simd>(beam: &Beam<S>, block: &Block<N>) -> f32x8<S>;
}

/// A bounding volume hierarchy of primitives.
#[derive(Clone, Debug)]
pub struct Queries<P, const N: usize> {
    level: Level,
    tree: Tree,
    blocks: Vec<Block<N>>,
    /// The ids of each block's primitives.
    ids: Vec<[u32; WIDTH]>,
    bounds: Aabb,
    count: usize,
    kind: PhantomData<P>,
}

impl<P: Primitive<N>, const N: usize> Queries<P, N> {
    /// The hierarchy of `count` primitives, given by index; a hit's id is that index.
    #[must_use]
    pub fn new(count: usize, primitive: impl Fn(usize) -> P + Sync) -> Self {
        Self::with_level(Level::new(), count, primitive)
    }

    /// [`Queries::new`] for a chosen instruction set; all give the same hits.
    #[must_use]
    pub fn with_level(level: Level, count: usize, primitive: impl Fn(usize) -> P + Sync) -> Self {
        // Packed again at each use: cheaper than the memory.
        let pack = |i: u32| primitive(i as usize).pack();
        let mut ids: Vec<u32> = (0..count as u32).into_par_iter().filter(|&i| pack(i).is_some()).collect();
        let of = |i: u32| pack(i).unwrap_or([f32::NAN; N]);
        let bounds = |i: &u32| {
            let [min, max] = P::bounds(&of(*i));
            Aabb { min, max }
        };
        let mut boxes: Vec<Aabb> = ids.par_iter().map(bounds).collect();
        if !build::is_spread(boxes.iter()) {
            // Of identical ones only the first is kept.
            let mut keyed: Vec<_> = ids.par_iter().map(|&i| (of(i).map(f32::to_bits), i)).collect();
            keyed.par_sort_unstable();
            keyed.dedup_by_key(|(bits, _)| *bits);
            ids = keyed.into_iter().map(|(_, i)| i).collect();
            boxes = ids.par_iter().map(bounds).collect();
        }
        let whole = boxes.iter().fold(Aabb::EMPTY, Aabb::union);
        let Wide { tree, blocks: mut order, .. } = build::build(&boxes, whole.size() * PAD);
        drop(boxes);
        let block = |slots: &mut [u32; WIDTH]| {
            let mut block = Block { lanes: [[f32::NAN; WIDTH]; N] };
            for (lane, slot) in slots.iter_mut().enumerate().filter(|(_, slot)| **slot != EMPTY) {
                *slot = ids[*slot as usize];
                for (lanes, x) in block.lanes.iter_mut().zip(of(*slot)) {
                    lanes[lane] = x;
                }
            }
            block
        };
        let blocks = order.par_iter_mut().map(block).collect();
        Self { level, tree, blocks, ids: order, bounds: whole, count: ids.len(), kind: PhantomData }
    }

    /// Bytes that so many primitives take at the peak of construction: their boxes and order, and blocks and
    /// nodes as full as they are on average; and what clusters a piece on each thread.
    #[must_use]
    pub fn bytes_needed(count: usize) -> usize {
        let boxes = count * (size_of::<Aabb>() + size_of::<u32>());
        let block = size_of::<Block<N>>() + size_of::<[u32; WIDTH]>() + Tree::NODE_BYTES;
        boxes + count * block / FULL + build::bytes_of_pieces(count)
    }

    /// The number of primitives, without degenerate ones and, among thousands, without duplicates.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Are there no primitives?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The bounding box of all primitives.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds.into()
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
            + self.blocks.capacity() * size_of::<Block<N>>()
            + self.ids.capacity() * size_of::<[u32; WIDTH]>()
    }

    /// The closest hit: the nearest primitive that the ray enters. Primitives that contain its origin are ignored.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        dispatch!(self.level, simd => {
            let beam = Beam::new(simd, ray, self.bounds.middle());
            // Finite: infinity marks a miss.
            let far = ((ray.far - beam.shift) as f32).min(f32::MAX);
            let mut leaf = Closest::<P, N> { blocks: &self.blocks, ids: &self.ids, t: far, id: EMPTY, kind: PhantomData };
            self.tree.walk::<_, _, true>(&beam, far, &mut leaf);
            (leaf.id != EMPTY).then(|| Hit { t: f64::from(leaf.t) + beam.shift, id: leaf.id })
        })
    }

    /// Any hit: does the ray enter a primitive?
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray) -> bool {
        dispatch!(self.level, simd => {
            let beam = Beam::new(simd, ray, self.bounds.middle());
            let far = (ray.far - beam.shift) as f32;
            let mut leaf = Any::<P, N> { blocks: &self.blocks, is_met: false, kind: PhantomData };
            self.tree.walk::<_, _, false>(&beam, far, &mut leaf);
            leaf.is_met
        })
    }
}

struct Closest<'a, P, const N: usize> {
    blocks: &'a [Block<N>],
    ids: &'a [[u32; WIDTH]],
    t: f32,
    id: u32,
    kind: PhantomData<P>,
}

impl<P: Primitive<N>, const N: usize> Leaf for Closest<'_, P, N> {
    #[inline(always)]
    fn test<S: Simd>(&mut self, beam: &Beam<S>, block: usize, far: f32) -> f32 {
        let t = P::enter(beam, &self.blocks[block]);
        let mut met = t.simd_le(f32x8::splat(beam.simd, far)).to_bitmask() as u32;
        if met == 0 {
            return far;
        }
        let t: [f32; WIDTH] = t.into();
        let ids = &self.ids[block];
        while met != 0 {
            let lane = met.trailing_zeros() as usize;
            met &= met - 1;
            if t[lane] < self.t || (t[lane] == self.t && ids[lane] < self.id) {
                (self.t, self.id) = (t[lane], ids[lane]);
            }
        }
        self.t
    }

    #[inline(always)]
    fn fetch(&self, block: usize) {
        prefetch(self.blocks, block);
    }
}

struct Any<'a, P, const N: usize> {
    blocks: &'a [Block<N>],
    is_met: bool,
    kind: PhantomData<P>,
}

impl<P: Primitive<N>, const N: usize> Leaf for Any<'_, P, N> {
    #[inline(always)]
    fn test<S: Simd>(&mut self, beam: &Beam<S>, block: usize, far: f32) -> f32 {
        let t = P::enter(beam, &self.blocks[block]);
        self.is_met = t.simd_lt(f32x8::splat(beam.simd, far)).to_bitmask() != 0;
        if self.is_met { f32::NEG_INFINITY } else { far }
    }

    #[inline(always)]
    fn fetch(&self, block: usize) {
        prefetch(self.blocks, block);
    }
}

impl From<Aabb> for Bounds {
    fn from(b: Aabb) -> Self {
        let corner = |c: [f32; 3]| DVec3::from_array(c.map(f64::from));
        Self { min: corner(b.min), max: corner(b.max) }
    }
}

/// A bounding volume hierarchy of boxes whose contents the caller tests.
#[derive(Clone, Debug)]
pub struct Boxes {
    level: Level,
    tree: Tree,
    blocks: Vec<[u32; WIDTH]>,
    middle: DVec3,
}

impl Boxes {
    /// Bytes that so many boxes take at the peak of construction, as [`Queries::bytes_needed`] has it.
    #[must_use]
    pub fn bytes_needed(count: usize) -> usize {
        let boxes = count * (size_of::<Bounds>() + size_of::<Aabb>());
        boxes + count * (size_of::<[u32; WIDTH]>() + Tree::NODE_BYTES) / FULL + build::bytes_of_pieces(count)
    }

    /// The hierarchy of `boxes`.
    #[must_use]
    pub fn new(boxes: &[Bounds]) -> Self {
        let corner = |p: DVec3| p.to_array().map(|x| x as f32);
        let boxes: Vec<Aabb> = boxes.iter().map(|b| Aabb { min: corner(b.min), max: corner(b.max) }).collect();
        let whole = boxes.iter().fold(Aabb::EMPTY, Aabb::union);
        let Wide { tree, blocks, .. } = build::build(&boxes, whole.size() * PAD);
        Self { level: Level::new(), tree, blocks, middle: whole.middle() }
    }

    /// Calls `test` with the index of each box that the ray hits, roughly nearest first, and the ray's far end; `test` returns the new
    /// far end, negative to end the traversal.
    pub fn meet(&self, ray: &Ray, test: &mut dyn FnMut(u32, f64) -> f64) {
        dispatch!(self.level, simd => {
            let beam = Beam::new(simd, ray, self.middle);
            let shift = beam.shift;
            let mut leaf = Each { blocks: &self.blocks, far: ray.far, shift, test };
            self.tree.walk::<_, _, true>(&beam, (ray.far - shift) as f32, &mut leaf);
        });
    }
}

struct Each<'a, 'b> {
    blocks: &'a [[u32; WIDTH]],
    far: f64,
    shift: f64,
    test: &'b mut dyn FnMut(u32, f64) -> f64,
}

impl Leaf for Each<'_, '_> {
    #[inline(always)]
    fn test<S: Simd>(&mut self, _: &Beam<S>, block: usize, _: f32) -> f32 {
        for &id in self.blocks[block].iter().filter(|&&id| id != EMPTY) {
            self.far = (self.test)(id, self.far);
            if self.far < 0.0 {
                return f32::NEG_INFINITY;
            }
        }
        // Rounded up, so that no hit is lost.
        ((self.far - self.shift) as f32).next_up()
    }

    #[inline(always)]
    fn fetch(&self, block: usize) {
        prefetch(self.blocks, block);
    }
}
