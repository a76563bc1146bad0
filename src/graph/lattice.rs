//! Regular lattices whose weights are a pure function of (seed, edge, fields): nothing is stored per edge.

use super::field::{FieldSamples, LEAST_FACTOR};
use super::weights::{fixed, length};
use super::{Edge, FieldTable, FieldValue, Graph, LatticeError, Mask, Node, WeightRange, WeightTable, Window};
use crate::geom::Neighbours;
use crate::math::{DVec3, Stream, Weights, mix};

/// Odd multipliers of the coordinates in an edge's key: fractional parts of the square roots of 2, 3, 5.
const AXIS_KEYS: [u64; 3] = [0x6a09_e667_f3bc_c909, 0xbb67_ae85_84ca_a73b, 0x3c6e_f372_fe94_f82b];

/// Least number of nodes, in space, at which threads share a front (`benches/README.md`).
const WIDE: usize = 3_000_000;

/// Layers of a slab ([`Graph::slab`]).
const SLAB: u32 = 32;

/// A lattice with `N` neighbours a node: 4 or 8 in the plane, 6, 18 or 26 in space ([`Neighbours`]).
///
/// A [`Node`] packs the coordinates within the window, so that an edge can be hashed without dividing.
#[derive(Clone, Debug)]
pub struct Lattice<const N: usize> {
    window: Window,
    shift: [u32; 2],
    strides: [usize; 3],
    key: u64,
    node_step: [u32; N],
    cell_step: [usize; N],
    edge_key: [u64; N],
    table: WeightTable,
    field: Option<FieldTable>,
    field_step: [usize; N],
    length: [u64; N],
    mask: Option<Mask>,
    range: WeightRange,
}

impl<const N: usize> Lattice<N> {
    const PLANE: bool = N == 4 || N == 8;
    /// The step of each slot.
    const STEPS: [[i32; 3]; N] = Neighbours::steps::<N>();
    /// The length class of each slot: how many coordinates change, less one.
    const CLASS: [usize; N] = {
        let mut class = [0; N];
        let mut slot = 0;
        while slot < N {
            let [x, y, z] = Self::STEPS[slot];
            class[slot] = (x.abs() + y.abs() + z.abs()) as usize - 1;
            slot += 1;
        }
        class
    };

    /// A lattice whose random weights are functions of the key of `stream`. `field` is the axes along which it varies and its
    /// value at a position; `mask` has one bit a cell ([`Graph::cell`]).
    ///
    /// # Errors
    /// [`LatticeError::Weights`] when weights are out of range.
    pub fn new<F: Fn(DVec3) -> FieldValue + Sync>(
        window: Window,
        stream: &Stream,
        weights: Weights,
        field: Option<([bool; 3], F)>,
        mask: Option<Mask>,
    ) -> Result<Self, LatticeError> {
        let bits = window.size.map(|s| 32 - (s - 1).leading_zeros());
        let shift = [bits[0], bits[0] + bits[1]];
        let strides = [1, window.size[0] as usize, window.size[0] as usize * window.size[1] as usize];
        let samples = field.map(|(varies, value)| FieldSamples::new(&window, varies, value));
        let (low, high) = samples.as_ref().map_or(
            {
                let none = FieldValue { sum: 0.0, factor: 1.0 };
                (none, none)
            },
            FieldSamples::bounds,
        );
        let table = WeightTable::new(weights, high.factor.max(LEAST_FACTOR), high.sum)?;
        let fraction = table.fraction();
        let field = samples.map(|s| s.into_table(fraction));

        let mut lattice = Self {
            window,
            shift,
            strides,
            key: 0,
            node_step: [0; N],
            cell_step: [0; N],
            edge_key: [0; N],
            field_step: [0; N],
            length: [0; N],
            mask,
            range: WeightRange { least: 1, most: 1, fraction },
            table,
            field,
        };
        lattice.key = stream.key().wrapping_add(coordinate_key(window.origin));
        let unit = [1, 1_usize.checked_shl(shift[0]).unwrap_or(0), 1_usize.checked_shl(shift[1]).unwrap_or(0)];
        for slot in 0..N {
            let step = Self::STEPS[slot];
            lattice.cell_step[slot] = dot(step, strides);
            lattice.node_step[slot] = dot(step, unit) as u32;
            lattice.field_step[slot] = lattice.field.as_ref().map_or(0, |f| dot(step, f.strides));
            lattice.length[slot] = u64::from(fixed(length(Self::CLASS[slot]), 12));
            // An edge's key is that of its lower node and positive direction, and independent of `N`; a negative slot starts
            // from the upper node.
            let [x, y, z] = Self::STEPS[slot & !1];
            let axis = mix((x + 1 + 3 * (y + 1) + 9 * (z + 1)) as u64);
            let to_lower = if slot % 2 == 0 { 0 } else { coordinate_key(step) };
            lattice.edge_key[slot] = axis.wrapping_add(to_lower);
        }
        let classes = 1 + Self::CLASS[N - 1];
        lattice.range = lattice.bounds(classes, low, high);
        Ok(lattice)
    }

    /// A lattice without cost fields and forbidden nodes.
    ///
    /// # Errors
    /// As [`Lattice::new`].
    pub fn plain(window: Window, stream: &Stream, weights: Weights) -> Result<Self, LatticeError> {
        Self::new(window, stream, weights, None::<([bool; 3], fn(DVec3) -> FieldValue)>, None)
    }

    /// Bounds of all weights, rounding included.
    fn bounds(&self, classes: usize, low: FieldValue, high: FieldValue) -> WeightRange {
        let (least, most) = self.table.bounds(classes);
        let fraction = self.table.fraction();
        let scale = f64::from(1_u32 << fraction);
        let (least, most) = if self.field.is_some() {
            (
                (f64::from(least) * low.factor + low.sum * scale) * (1.0 - 1e-3) - 2.0,
                (f64::from(most) * high.factor + high.sum * length(classes - 1) * scale) * (1.0 + 1e-3) + 2.0,
            )
        } else {
            (f64::from(least), f64::from(most))
        };
        WeightRange { least: (least as u32).max(1), most: most as u32, fraction }
    }

    /// The window onto the infinite lattice.
    #[must_use]
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// The node with these coordinates within the window, which must contain them.
    #[must_use]
    pub fn node(&self, at: [u32; 3]) -> Node {
        let z = if Self::PLANE { 0 } else { at[2] << (self.shift[1] % 32) };
        Node(at[0] | at[1] << (self.shift[0] % 32) | z)
    }

    /// The node nearest to `position`, or `None` if that is outside the window or masked.
    #[must_use]
    pub fn nearest(&self, position: DVec3) -> Option<Node> {
        let node = self.node(self.window.nearest(position)?);
        self.is_open(node).then_some(node)
    }

    /// [`Lattice::nearest`], also for a position outside the window by less than a step, as on the border of a shape.
    #[must_use]
    pub fn nearest_within(&self, position: DVec3) -> Option<Node> {
        self.nearest(position).or_else(|| {
            let last = [0, 1, 2].map(|axis| self.window.size[axis] - 1);
            let inside = position.clamp(self.window.position([0; 3]), self.window.position(last));
            let is_near = (inside - position).abs().max_element() < self.window.spacing;
            is_near.then(|| self.nearest(inside)).flatten()
        })
    }

    /// Is `node` not masked?
    #[must_use]
    pub fn is_open(&self, node: Node) -> bool {
        self.mask.as_ref().is_none_or(|mask| !mask.is_blocked(self.cell(node)))
    }

    /// The position of `node`, in scene units.
    #[must_use]
    pub fn position(&self, node: Node) -> DVec3 {
        self.window.position(self.unpack(node))
    }

    /// The steps to the neighbours of a node.
    #[must_use]
    pub fn steps(&self) -> &'static [[i32; 3]; N] {
        &Self::STEPS
    }

    /// The open nodes in the order of cells.
    pub fn nodes(&self) -> impl Iterator<Item = Node> + '_ {
        let [x, y, z] = self.window.size;
        (0..z)
            .flat_map(move |z| (0..y).flat_map(move |y| (0..x).map(move |x| self.node([x, y, z]))))
            .filter(|&node| self.is_open(node))
    }

    /// Is it a lattice of the plane?
    #[must_use]
    pub fn is_plane(&self) -> bool {
        Self::PLANE
    }

    /// The number of undirected edges between open nodes.
    #[must_use]
    pub fn count_edges(&self) -> u64 {
        if self.mask.is_none() {
            let [x, y, z] = self.window.size.map(i64::from);
            return Self::STEPS
                .iter()
                .step_by(2)
                .map(|s| {
                    let span = |size: i64, step: i32| (size - i64::from(step.abs())).max(0);
                    (span(x, s[0]) * span(y, s[1]) * span(z, s[2])) as u64
                })
                .sum();
        }
        let mut ends = 0;
        self.nodes().for_each(|node| self.edges(node, |_| ends += 1));
        ends / 2
    }

    /// The number of open nodes.
    #[must_use]
    pub fn open_nodes(&self) -> u64 {
        self.mask.as_ref().map_or_else(|| self.window.nodes(), |m| m.open() as u64)
    }

    /// The coordinates of `node` within the window.
    #[inline]
    #[must_use]
    pub fn coordinates(&self, node: Node) -> [u32; 3] {
        self.unpack(node)
    }

    #[inline(always)]
    fn unpack(&self, node: Node) -> [u32; 3] {
        let [sx, sy] = self.shift;
        if Self::PLANE {
            return [node.0 & ((1 << sx) - 1), (u64::from(node.0) >> sx) as u32, 0];
        }
        let wide = u64::from(node.0);
        [(wide & ((1 << sx) - 1)) as u32, (wide >> sx & ((1 << (sy - sx)) - 1)) as u32, (wide >> sy) as u32]
    }

    #[inline(always)]
    fn cell_at(&self, [x, y, z]: [u32; 3]) -> usize {
        let plane = x as usize + y as usize * self.strides[1];
        if Self::PLANE { plane } else { plane + z as usize * self.strides[2] }
    }

    #[inline(always)]
    fn is_interior(&self, at: [u32; 3]) -> bool {
        let inside = |axis: usize| at[axis].wrapping_sub(1) < self.window.size[axis].wrapping_sub(2);
        // The bound wraps where the window is one node wide, so its width is tested as well.
        let wide = |axis: usize| self.window.size[axis] > 2;
        inside(0) && inside(1) && wide(0) && wide(1) && (Self::PLANE || (inside(2) && wide(2)))
    }

    #[inline(always)]
    fn is_inside(&self, at: [u32; 3], slot: usize) -> bool {
        (0..3).all(|axis| at[axis].wrapping_add_signed(Self::STEPS[slot][axis]) < self.window.size[axis])
    }

    /// The node's part of the keys of its edges.
    #[inline(always)]
    fn node_key(&self, [x, y, z]: [u32; 3]) -> u64 {
        let key = self
            .key
            .wrapping_add(u64::from(x).wrapping_mul(AXIS_KEYS[0]))
            .wrapping_add(u64::from(y).wrapping_mul(AXIS_KEYS[1]));
        if Self::PLANE { key } else { key.wrapping_add(u64::from(z).wrapping_mul(AXIS_KEYS[2])) }
    }

    #[inline(always)]
    fn field_at(&self, at: [u32; 3]) -> usize {
        self.field.as_ref().map_or(0, |f| {
            at[0] as usize * f.strides[0] + at[1] as usize * f.strides[1] + at[2] as usize * f.strides[2]
        })
    }

    #[inline(always)]
    fn random(&self, node_key: u64, slot: usize) -> u32 {
        self.table.entry(Self::CLASS[slot], scramble(node_key.wrapping_add(self.edge_key[slot])))
    }

    #[inline(always)]
    fn weight(&self, node_key: u64, field_at: usize, slot: usize) -> u32 {
        let random = self.random(node_key, slot);
        match &self.field {
            None => random,
            Some(field) => {
                let other = field_at.wrapping_add(self.field_step[slot]);
                field.weight(random, self.length[slot], field_at, other)
            }
        }
    }
}

/// The key of lattice coordinates or of a difference of them.
fn coordinate_key(at: [i32; 3]) -> u64 {
    at.iter().zip(AXIS_KEYS).fold(0, |sum: u64, (&c, key)| sum.wrapping_add((i64::from(c) as u64).wrapping_mul(key)))
}

/// The offset of a step in an array with these strides; wraps for negative steps.
fn dot(step: [i32; 3], strides: [usize; 3]) -> usize {
    step.iter().zip(strides).fold(0, |sum, (&d, stride)| sum.wrapping_add((d as isize as usize).wrapping_mul(stride)))
}

/// A multiplicative hash: its top bits depend on all bits of the key.
#[inline(always)]
fn scramble(key: u64) -> u64 {
    (key ^ (key >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93)
}

impl<const N: usize> Graph for Lattice<N> {
    const SLOT_BITS: u32 = if N <= 6 {
        3
    } else if N == 8 {
        4
    } else {
        5
    };

    fn cells(&self) -> usize {
        self.window.nodes() as usize
    }

    #[inline(always)]
    fn cell(&self, node: Node) -> usize {
        self.cell_at(self.unpack(node))
    }

    #[inline(always)]
    fn edges(&self, node: Node, mut visit: impl FnMut(Edge)) {
        let at = self.unpack(node);
        let cell = self.cell_at(at);
        let key = self.node_key(at);
        let interior = self.is_interior(at);
        let edge = |slot: usize, weight: u32| Edge {
            node: Node(node.0.wrapping_add(self.node_step[slot])),
            cell: cell.wrapping_add(self.cell_step[slot]),
            back: slot as u32 ^ 1,
            weight,
        };
        if interior && self.field.is_none() && self.mask.is_none() {
            for slot in 0..N {
                visit(edge(slot, self.random(key, slot)));
            }
        } else {
            let field_at = self.field_at(at);
            for slot in 0..N {
                if interior || self.is_inside(at, slot) {
                    let edge = edge(slot, self.weight(key, field_at, slot));
                    if self.mask.as_ref().is_none_or(|mask| !mask.is_blocked(edge.cell)) {
                        visit(edge);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn ahead(&self, cell: usize, mut visit: impl FnMut(usize)) {
        // Neighbours along x share the node's cache line, so one visit for each other row suffices.
        for slot in 0..N {
            if Self::STEPS[slot][0] == 0 {
                visit(cell.wrapping_add(self.cell_step[slot]));
            }
        }
    }

    fn follow(&self, node: Node, slot: u32) -> (Node, u32) {
        let at = self.unpack(node);
        let slot = slot as usize;
        let weight = self.weight(self.node_key(at), self.field_at(at), slot);
        (Node(node.0.wrapping_add(self.node_step[slot])), weight)
    }

    fn is_wide(&self) -> bool {
        !Self::PLANE && self.cells() >= WIDE
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

    fn weight_range(&self) -> WeightRange {
        self.range
    }
}
