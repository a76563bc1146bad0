//! The edges of a lattice: hashed where they are asked for.

use super::lattice::{AXIS_KEYS, length_class};
use super::{Edge, Graph, GraphVisitor, Lattice, Node, WeightRange};
use crate::geom::Neighbours;

/// Least number of nodes, in space, at which threads share a front (`benches/README.md`).
const WIDE: usize = 3_000_000;

/// Layers of a slab ([`Graph::slab`]).
const SLAB: u32 = 32;

/// Stands for a number of neighbours that only the lattice knows.
const ANY: u32 = 0;

/// A lattice with `N` neighbours a node, or with [`ANY`]: a search visits every edge, and is faster where the compiler knows.
#[derive(Clone, Copy)]
pub(super) struct Joined<'a, const N: u32>(&'a Lattice);

impl Lattice {
    #[inline(always)]
    pub(super) fn joined(&self) -> Joined<'_, ANY> {
        Joined(self)
    }
}

impl<const N: u32> Joined<'_, N> {
    #[inline(always)]
    fn neighbours(self) -> Neighbours {
        const { Neighbours::new(N) }.unwrap_or(self.0.neighbours)
    }

    #[inline(always)]
    fn is_plane(self) -> bool {
        self.neighbours().is_plane()
    }

    #[inline(always)]
    pub fn unpack(self, node: Node) -> [u32; 3] {
        let [sx, sy] = self.0.shift;
        if self.is_plane() {
            return [node.0 & ((1 << sx) - 1), (u64::from(node.0) >> sx) as u32, 0];
        }
        let wide = u64::from(node.0);
        [(wide & ((1 << sx) - 1)) as u32, (wide >> sx & ((1 << (sy - sx)) - 1)) as u32, (wide >> sy) as u32]
    }

    #[inline(always)]
    fn cell_at(self, [x, y, z]: [u32; 3]) -> usize {
        let plane = x as usize + y as usize * self.0.strides[1];
        if self.is_plane() { plane } else { plane + z as usize * self.0.strides[2] }
    }

    #[inline(always)]
    fn is_interior(self, at: [u32; 3]) -> bool {
        let size = self.0.window.size;
        let inside = |axis: usize| at[axis].wrapping_sub(1) < size[axis].wrapping_sub(2);
        // The bound wraps where the window is one node wide, so its width is tested as well.
        let wide = |axis: usize| size[axis] > 2;
        inside(0) && inside(1) && wide(0) && wide(1) && (self.is_plane() || (inside(2) && wide(2)))
    }

    #[inline(always)]
    fn is_inside(self, at: [u32; 3], step: [i32; 3]) -> bool {
        (0..3).all(|axis| at[axis].wrapping_add_signed(step[axis]) < self.0.window.size[axis])
    }

    /// The node's part of the keys of its edges.
    #[inline(always)]
    fn node_key(self, [x, y, z]: [u32; 3]) -> u64 {
        let key = self.0.key;
        let key = key.wrapping_add(u64::from(x).wrapping_mul(AXIS_KEYS[0]));
        let key = key.wrapping_add(u64::from(y).wrapping_mul(AXIS_KEYS[1]));
        if self.is_plane() { key } else { key.wrapping_add(u64::from(z).wrapping_mul(AXIS_KEYS[2])) }
    }

    #[inline(always)]
    fn field_at(self, at: [u32; 3]) -> usize {
        self.0.field.as_ref().map_or(0, |f| (0..3).map(|axis| at[axis] as usize * f.strides[axis]).sum())
    }

    #[inline(always)]
    fn random(self, node_key: u64, slot: usize) -> u32 {
        let class = length_class(self.neighbours().steps()[slot]);
        self.0.table.entry(class, scramble(node_key.wrapping_add(self.0.edge_key[slot])))
    }

    #[inline(always)]
    fn weight(self, node_key: u64, field_at: usize, slot: usize) -> u32 {
        let random = self.random(node_key, slot);
        match &self.0.field {
            None => random,
            Some(field) => {
                let other = field_at.wrapping_add(self.0.field_step[slot]);
                field.weight(random, self.0.length[slot], field_at, other)
            }
        }
    }
}

/// A multiplicative hash: its top bits depend on all bits of the key.
#[inline(always)]
fn scramble(key: u64) -> u64 {
    (key ^ (key >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93)
}

impl<const N: u32> Graph for Joined<'_, N> {
    #[inline(always)]
    fn slot_bits(&self) -> u32 {
        match self.neighbours().count() {
            4 | 6 => 3,
            8 => 4,
            _ => 5,
        }
    }

    #[inline(always)]
    fn cells(&self) -> usize {
        self.0.window.nodes() as usize
    }

    #[inline(always)]
    fn cell(&self, node: Node) -> usize {
        self.cell_at(self.unpack(node))
    }

    #[inline(always)]
    fn edges(&self, node: Node, mut visit: impl FnMut(Edge)) {
        let lattice = self.0;
        let at = self.unpack(node);
        let cell = self.cell_at(at);
        let key = self.node_key(at);
        let interior = self.is_interior(at);
        let edge = |slot: usize, weight: u32| Edge {
            node: Node(node.0.wrapping_add(lattice.node_step[slot])),
            cell: cell.wrapping_add(lattice.cell_step[slot]),
            back: slot as u32 ^ 1,
            weight,
        };
        let steps = self.neighbours().steps();
        if interior && lattice.field.is_none() && lattice.mask.is_none() {
            for slot in 0..steps.len() {
                visit(edge(slot, self.random(key, slot)));
            }
        } else {
            let field_at = self.field_at(at);
            for (slot, &step) in steps.iter().enumerate() {
                if interior || self.is_inside(at, step) {
                    let edge = edge(slot, self.weight(key, field_at, slot));
                    if lattice.mask.as_ref().is_none_or(|mask| !mask.is_blocked(edge.cell)) {
                        visit(edge);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn ahead(&self, cell: usize, mut visit: impl FnMut(usize)) {
        // Neighbours along x share the node's cache line, so one visit for each other row suffices.
        for (slot, step) in self.neighbours().steps().iter().enumerate() {
            if step[0] == 0 {
                visit(cell.wrapping_add(self.0.cell_step[slot]));
            }
        }
    }

    #[inline(always)]
    fn follow(&self, node: Node, slot: u32) -> (Node, u32) {
        let at = self.unpack(node);
        let slot = slot as usize;
        let weight = self.weight(self.node_key(at), self.field_at(at), slot);
        (Node(node.0.wrapping_add(self.0.node_step[slot])), weight)
    }

    #[inline(always)]
    fn is_wide(&self) -> bool {
        !self.is_plane() && self.cells() >= WIDE
    }

    #[inline(always)]
    fn slab(&self, node: Node) -> u32 {
        self.unpack(node)[2] / SLAB
    }

    #[inline(always)]
    fn is_inner(&self, node: Node) -> bool {
        // Edges go one layer up or down: those of another slab reach the first and the last layer of this one.
        (2..SLAB - 2).contains(&(self.unpack(node)[2] % SLAB))
    }

    #[inline(always)]
    fn weight_range(&self) -> WeightRange {
        self.0.range
    }
}

impl Graph for Lattice {
    fn slot_bits(&self) -> u32 {
        self.joined().slot_bits()
    }

    fn cells(&self) -> usize {
        self.joined().cells()
    }

    fn cell(&self, node: Node) -> usize {
        self.joined().cell(node)
    }

    fn edges(&self, node: Node, visit: impl FnMut(Edge)) {
        self.joined().edges(node, visit);
    }

    fn ahead(&self, cell: usize, visit: impl FnMut(usize)) {
        self.joined().ahead(cell, visit);
    }

    fn follow(&self, node: Node, slot: u32) -> (Node, u32) {
        self.joined().follow(node, slot)
    }

    fn is_wide(&self) -> bool {
        self.joined().is_wide()
    }

    fn slab(&self, node: Node) -> u32 {
        self.joined().slab(node)
    }

    fn is_inner(&self, node: Node) -> bool {
        self.joined().is_inner(node)
    }

    fn weight_range(&self) -> WeightRange {
        self.range
    }

    fn accept<V: GraphVisitor>(&self, visitor: V) -> V::Output {
        match self.neighbours.count() {
            4 => visitor.visit(&Joined::<4>(self)),
            8 => visitor.visit(&Joined::<8>(self)),
            6 => visitor.visit(&Joined::<6>(self)),
            18 => visitor.visit(&Joined::<18>(self)),
            _ => visitor.visit(&Joined::<26>(self)),
        }
    }
}
