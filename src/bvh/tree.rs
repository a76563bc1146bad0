//! An 8-wide tree over blocks of eight primitives, and its traversal.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8};

use super::Ray;
use crate::math::{DVec3, prefetch};

/// Children of a node, and primitives of a block.
pub(super) const WIDTH: usize = 8;
/// Size of the traversal stack; the builder bounds the depth accordingly.
pub(super) const STACK: usize = 128;
/// The flag of a child that is a block.
const BLOCK: u32 = 1 << 31;

/// An axis-aligned bounding box in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

/// The boxes of eight children, as structure of arrays, and the children. Missing ones have empty boxes.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Node {
    /// Least x, y, z, greatest x, y, z of each child.
    bounds: [[f32; WIDTH]; 6],
    /// Index of a node, or of a block with [`BLOCK`].
    children: [u32; WIDTH],
}

/// A child of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    Node(u32),
    Block(u32),
}

/// The nodes; the first is the root. Empty where there are no primitives.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

/// A ray prepared for traversal: in single precision, with its origin moved near to the primitives.
#[derive(Clone, Copy)]
pub struct Beam<S: Simd> {
    pub simd: S,
    pub origin: [f32x8<S>; 3],
    pub direction: [f32x8<S>; 3],
    inverse: [f32x8<S>; 3],
    /// The near plane of a box along each axis.
    first: [usize; 3],
    pub near: f32,
    /// Distance of `origin` along the ray.
    pub shift: f64,
}

/// The visitor of a traversal.
pub(super) trait Leaf {
    /// Tests a block; returns the new far end of the ray, negative to end the traversal.
    fn test<S: Simd>(&mut self, beam: &Beam<S>, block: usize, far: f32) -> f32;

    /// Prefetches a block.
    fn fetch(&self, block: usize);
}

impl Aabb {
    /// The empty box.
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest box that contains both.
    pub fn union(self, other: &Self) -> Self {
        let axes = [0, 1, 2];
        Self { min: axes.map(|i| self.min[i].min(other.min[i])), max: axes.map(|i| self.max[i].max(other.max[i])) }
    }

    /// Its centre; the origin for the empty box.
    pub fn middle(&self) -> DVec3 {
        if self.min[0] > self.max[0] {
            return DVec3::ZERO;
        }
        DVec3::from_array([0, 1, 2].map(|i| (f64::from(self.min[i]) + f64::from(self.max[i])) * 0.5))
    }

    /// Enlarged by `by` on every side.
    pub fn pad(&self, by: f32) -> Self {
        Self { min: self.min.map(|x| x - by), max: self.max.map(|x| x + by) }
    }

    /// Its longest side.
    pub fn size(&self) -> f32 {
        (0..3).map(|i| self.max[i] - self.min[i]).fold(0.0, f32::max)
    }
}

impl<S: Simd> Beam<S> {
    /// `middle` is a point among the primitives, near which the origin is moved to keep coordinates small and precise.
    #[inline(always)]
    pub fn new(simd: S, ray: &Ray, middle: DVec3) -> Self {
        let shift = (middle - ray.origin).dot(ray.direction).max(0.0);
        let o = ray.at(shift).to_array().map(|x| x as f32);
        let d = ray.direction.to_array().map(|x| x as f32);
        // No division by 0: a component of 0 is replaced by one far below the rounding error.
        let inverse = d.map(|x| 1.0 / if x.abs() < 1e-18 { 1e-18_f32.copysign(x) } else { x });
        let splat = |v: [f32; 3]| v.map(|x| f32x8::splat(simd, x));
        Self {
            simd,
            origin: splat(o),
            direction: splat(d),
            first: [0, 1, 2].map(|i| if inverse[i] < 0.0 { i + 3 } else { i }),
            inverse: splat(inverse),
            near: (ray.near - shift) as f32,
            shift,
        }
    }
}

impl Tree {
    /// Bytes of a node.
    pub const NODE_BYTES: usize = size_of::<Node>();

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }

    /// Adds a node without children ([`Tree::set`]).
    pub fn add(&mut self) -> u32 {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        let bounds = [low, low, low, high, high, high];
        self.nodes.push(Node { bounds, children: [BLOCK; WIDTH] });
        (self.nodes.len() - 1) as u32
    }

    /// Sets a child of a node.
    pub fn set(&mut self, node: u32, slot: usize, bounds: &Aabb, child: Child) {
        let node = &mut self.nodes[node as usize];
        for i in 0..3 {
            node.bounds[i][slot] = bounds.min[i];
            node.bounds[i + 3][slot] = bounds.max[i];
        }
        node.children[slot] = match child {
            Child::Node(i) => i,
            Child::Block(i) => i | BLOCK,
        };
    }

    /// Appends another tree, whose blocks are renumbered from `blocks` on; returns its root.
    pub fn graft(&mut self, other: Self, blocks: u32) -> u32 {
        let root = self.nodes.len() as u32;
        self.nodes.extend(other.nodes.into_iter().map(|mut node| {
            for child in &mut node.children {
                *child += if *child & BLOCK == 0 { root } else { blocks };
            }
            node
        }));
        root
    }

    /// Visits the blocks whose boxes the ray hits: nearest first if `SORTED`, otherwise in any order.
    #[inline(always)]
    pub fn walk<S: Simd, L: Leaf, const SORTED: bool>(&self, beam: &Beam<S>, mut far: f32, leaf: &mut L) {
        if self.nodes.is_empty() {
            return;
        }
        let simd = beam.simd;
        let [ox, oy, oz] = beam.origin;
        let [ix, iy, iz] = beam.inverse;
        let [fx, fy, fz] = beam.first;
        let near = f32x8::splat(simd, beam.near);
        let mut stack = [(0.0_f32, 0_u32); STACK];
        let mut waiting = 0;
        let mut next = 0_u32;
        loop {
            if next & BLOCK != 0 {
                far = leaf.test(beam, (next ^ BLOCK) as usize, far);
                if far < beam.near {
                    return;
                }
            } else {
                let node = &self.nodes[next as usize];
                let plane = |i: usize| f32x8::from_slice(simd, &node.bounds[i]);
                let t0 = (plane(fx) - ox) * ix;
                let t1 = (plane(fy) - oy) * iy;
                let t2 = (plane(fz) - oz) * iz;
                let u0 = (plane((fx + 3) % 6) - ox) * ix;
                let u1 = (plane((fy + 3) % 6) - oy) * iy;
                let u2 = (plane((fz + 3) % 6) - oz) * iz;
                let enter = t0.max(t1).max(t2.max(near));
                let leave = u0.min(u1).min(u2.min(f32x8::splat(simd, far)));
                let mut met = enter.simd_le(leave).to_bitmask() as u32;
                if met != 0 {
                    let enter: [f32; WIDTH] = enter.into();
                    let mut nearest = met.trailing_zeros() as usize;
                    met &= met - 1;
                    if met == 0 {
                        next = node.children[nearest];
                        continue;
                    }
                    let bottom = waiting;
                    while met != 0 {
                        let mut other = met.trailing_zeros() as usize;
                        met &= met - 1;
                        if enter[other] < enter[nearest] {
                            std::mem::swap(&mut other, &mut nearest);
                        }
                        let item = (enter[other], node.children[other]);
                        let mut place = waiting;
                        if SORTED {
                            while place > bottom && stack[(place - 1) % STACK].0 < item.0 {
                                stack[place % STACK] = stack[(place - 1) % STACK];
                                place -= 1;
                            }
                        }
                        // Pushed children are prefetched while the nearest is tested.
                        match item.1 & BLOCK {
                            0 => prefetch(&self.nodes, item.1 as usize),
                            _ => leaf.fetch((item.1 ^ BLOCK) as usize),
                        }
                        stack[place % STACK] = item;
                        waiting += 1;
                    }
                    next = node.children[nearest];
                    continue;
                }
            }
            loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                let (enter, child) = stack[waiting % STACK];
                if enter <= far {
                    next = child;
                    break;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    fn cube(x: f32) -> Aabb {
        Aabb { min: [x, -1.0, -1.0], max: [x + 1.0, 1.0, 1.0] }
    }

    /// Notes the blocks in the order in which they come.
    struct Seen(Vec<usize>);

    impl Leaf for Seen {
        fn test<S: Simd>(&mut self, _: &Beam<S>, block: usize, far: f32) -> f32 {
            self.0.push(block);
            far
        }

        fn fetch(&self, _: usize) {}
    }

    fn walked(tree: &Tree, ray: &Ray) -> Vec<usize> {
        let mut seen = Seen(Vec::new());
        dispatch!(Level::new(), simd => {
            let beam = Beam::new(simd, ray, DVec3::ZERO);
            tree.walk::<_, _, true>(&beam, f32::INFINITY, &mut seen);
        });
        seen.0
    }

    #[test]
    fn an_empty_tree_is_walked() {
        assert!(walked(&Tree::default(), &Ray::new(DVec3::ZERO, DVec3::X)).is_empty());
    }

    /// Nearest first from either side, through a grafted tree too; what the ray passes by is not shown.
    #[test]
    fn blocks_come_nearest_first() {
        let mut inner = Tree::default();
        let root = inner.add();
        for (slot, x) in [(0, 6.0), (1, 4.0)] {
            inner.set(root, slot, &cube(x), Child::Block(slot as u32));
        }
        let mut tree = Tree::default();
        let root = tree.add();
        tree.set(root, 3, &cube(2.0), Child::Block(0));
        tree.set(root, 5, &cube(0.0), Child::Block(1));
        let aside = Aabb { min: [0.0, 5.0, 0.0], max: [9.0, 6.0, 1.0] };
        tree.set(root, 1, &aside, Child::Block(2));
        let grafted = tree.graft(inner, 3);
        tree.set(root, 0, &cube(4.0).union(&cube(6.0)), Child::Node(grafted));
        assert_eq!(walked(&tree, &Ray::new(DVec3::new(-9.0, 0.0, 0.0), DVec3::X)), [1, 0, 4, 3]);
        assert_eq!(walked(&tree, &Ray::new(DVec3::new(19.0, 0.0, 0.0), -DVec3::X)), [3, 4, 0, 1]);
        assert!(walked(&tree, &Ray::new(DVec3::new(19.0, 0.0, 0.0), DVec3::X)).is_empty());
    }

    #[test]
    fn the_empty_box_is_neutral() {
        let b = cube(3.0);
        assert_eq!(Aabb::EMPTY.union(&b), b);
        assert_eq!(Aabb::EMPTY.middle(), DVec3::ZERO);
        assert_eq!((b.middle(), b.size()), (DVec3::new(3.5, 0.0, 0.0), 2.0));
        assert_eq!(b.pad(1.0).size(), 4.0);
    }
}
