//! Regular lattices whose weights are a pure function of (seed, edge, fields): nothing is stored per edge.

use super::field::{FieldSamples, LEAST_FACTOR};
use super::weights::{fixed, length};
use super::{FieldTable, FieldValue, Graph, LatticeError, Mask, Node, WeightRange, WeightTable, Window};
use crate::geom::Neighbours;
use crate::math::{DVec3, Stream, Weights, mix};

/// Odd multipliers of the coordinates in an edge's key: fractional parts of the square roots of 2, 3, 5.
pub(super) const AXIS_KEYS: [u64; 3] = [0x6a09_e667_f3bc_c909, 0xbb67_ae85_84ca_a73b, 0x3c6e_f372_fe94_f82b];

/// Most neighbours of a node.
const MOST: usize = 26;

/// A lattice with 4 or 8 neighbours a node in the plane, 6, 18 or 26 in space ([`Neighbours`]).
///
/// A [`Node`] packs the coordinates within the window, so that an edge can be hashed without dividing.
#[derive(Clone, Debug)]
pub struct Lattice {
    pub(super) neighbours: Neighbours,
    pub(super) window: Window,
    pub(super) shift: [u32; 2],
    pub(super) strides: [usize; 3],
    pub(super) key: u64,
    pub(super) node_step: [u32; MOST],
    pub(super) cell_step: [usize; MOST],
    pub(super) edge_key: [u64; MOST],
    pub(super) table: WeightTable,
    pub(super) field: Option<FieldTable>,
    pub(super) field_step: [usize; MOST],
    pub(super) length: [u64; MOST],
    pub(super) mask: Option<Mask>,
    pub(super) range: WeightRange,
}

impl Lattice {
    /// A lattice whose random weights are functions of the key of `stream`. `field` is the axes along which it varies and its
    /// value at a position; `mask` has one bit a cell ([`Graph::cell`]).
    ///
    /// # Errors
    /// [`LatticeError::Weights`] when weights are out of range.
    pub fn new<F: Fn(DVec3) -> FieldValue + Sync>(
        window: Window,
        neighbours: Neighbours,
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
            neighbours,
            window,
            shift,
            strides,
            key: 0,
            node_step: [0; MOST],
            cell_step: [0; MOST],
            edge_key: [0; MOST],
            field_step: [0; MOST],
            length: [0; MOST],
            mask,
            range: WeightRange { least: 1, most: 1, fraction },
            table,
            field,
        };
        lattice.key = stream.key().wrapping_add(coordinate_key(window.origin));
        let unit = [1, 1_usize.checked_shl(shift[0]).unwrap_or(0), 1_usize.checked_shl(shift[1]).unwrap_or(0)];
        let steps = neighbours.steps();
        for (slot, &step) in steps.iter().enumerate() {
            lattice.cell_step[slot] = dot(step, strides);
            lattice.node_step[slot] = dot(step, unit) as u32;
            lattice.field_step[slot] = lattice.field.as_ref().map_or(0, |f| dot(step, f.strides));
            lattice.length[slot] = u64::from(fixed(length(length_class(step)), 12));
            // An edge's key is that of its lower node and positive direction, whatever the neighbourhood; a negative slot
            // starts from the upper node.
            let [x, y, z] = steps[slot & !1];
            let axis = mix((x + 1 + 3 * (y + 1) + 9 * (z + 1)) as u64);
            let to_lower = if slot % 2 == 0 { 0 } else { coordinate_key(step) };
            lattice.edge_key[slot] = axis.wrapping_add(to_lower);
        }
        let classes = 1 + length_class(steps[steps.len() - 1]);
        lattice.range = lattice.bounds(classes, low, high);
        Ok(lattice)
    }

    /// A lattice without cost fields and forbidden nodes.
    ///
    /// # Errors
    /// As [`Lattice::new`].
    pub fn plain(
        window: Window,
        neighbours: Neighbours,
        stream: &Stream,
        weights: Weights,
    ) -> Result<Self, LatticeError> {
        Self::new(window, neighbours, stream, weights, None::<([bool; 3], fn(DVec3) -> FieldValue)>, None)
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
        let z = if self.is_plane() { 0 } else { at[2] << (self.shift[1] % 32) };
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
        self.window.position(self.coordinates(node))
    }

    /// How nodes are joined.
    #[must_use]
    pub fn neighbours(&self) -> Neighbours {
        self.neighbours
    }

    /// The steps to the neighbours of a node.
    #[must_use]
    pub fn steps(&self) -> &'static [[i32; 3]] {
        self.neighbours.steps()
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
        self.neighbours.is_plane()
    }

    /// The number of undirected edges between open nodes.
    #[must_use]
    pub fn count_edges(&self) -> u64 {
        if self.mask.is_none() {
            let [x, y, z] = self.window.size.map(i64::from);
            return self
                .steps()
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
        self.joined().unpack(node)
    }
}

/// The length class of a step: how many coordinates change, less one.
pub(super) const fn length_class([x, y, z]: [i32; 3]) -> usize {
    (x.abs() + y.abs() + z.abs()) as usize - 1
}

/// The key of lattice coordinates or of a difference of them.
fn coordinate_key(at: [i32; 3]) -> u64 {
    at.iter().zip(AXIS_KEYS).fold(0, |sum: u64, (&c, key)| sum.wrapping_add((i64::from(c) as u64).wrapping_mul(key)))
}

/// The offset of a step in an array with these strides; wraps for negative steps.
fn dot(step: [i32; 3], strides: [usize; 3]) -> usize {
    step.iter().zip(strides).fold(0, |sum, (&d, stride)| sum.wrapping_add((d as isize as usize).wrapping_mul(stride)))
}
