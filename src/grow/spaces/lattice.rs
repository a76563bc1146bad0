//! Spaces with a regular lattice, and the lattice that one becomes.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::{Bounds, Neighbours, Shape};
use crate::graph::{CostField, Lattice, LatticeError, Mask, Window};
use crate::math::{DVec3, Stream, Weights, power};
use crate::plan;

/// A regular lattice: its nodes are the multiples of the spacing within the shape.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LatticeSpec {
    /// Distance between neighbours along an axis, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub spacing: f64,
    /// 4 or 8 neighbours in the plane, 6, 18 or 26 in space; longer edges cost in proportion.
    pub neighbours: Neighbours,
}

/// Bytes of a node of a path, and of the table where it is found again.
const PATH_NODE_BYTES: u64 = 160;
/// The union of least-cost paths over the length of a shortest tree: from 1.2 to 4 in the scenes (`benches/README.md`).
const MEETING: f64 = 2.0;

/// A regular lattice in a shape.
#[derive(Clone, Debug)]
pub struct LatticeSpace {
    /// Where nodes are.
    pub shape: Shape,
    /// Where none are.
    pub forbid: Option<Shape>,
    /// The window onto the infinite lattice around the shape.
    pub window: Window,
    /// How nodes are joined.
    pub neighbours: Neighbours,
    /// The random part of the weights.
    pub weights: Weights,
    /// The rest of them.
    pub fields: Vec<CostField>,
    /// Name of the random stream.
    pub stream: String,
}

impl LatticeSpace {
    /// A lattice with weights from 1 to 10, and nothing forbidden.
    ///
    /// # Errors
    /// As [`Window::new`].
    pub fn new(shape: Shape, spacing: f64, neighbours: Neighbours) -> Result<Self, LatticeError> {
        let window = Self::window(&shape, spacing, neighbours)?;
        let (weights, fields, stream) = (Weights::default(), Vec::new(), "space".to_owned());
        Ok(Self { shape, forbid: None, window, neighbours, weights, fields, stream })
    }

    /// Every shape in it, to change.
    pub(in crate::grow) fn shapes_mut(&mut self) -> Vec<&mut Shape> {
        let fields = self.fields.iter_mut().filter_map(CostField::shape_mut);
        std::iter::once(&mut self.shape).chain(&mut self.forbid).chain(fields).collect()
    }

    /// The window around `shape`.
    ///
    /// # Errors
    /// As [`Window::new`].
    pub fn window(shape: &Shape, spacing: f64, neighbours: Neighbours) -> Result<Window, LatticeError> {
        let bounds = shape.bounds();
        Window::new(bounds.min, bounds.max, spacing, neighbours.dimensions())
    }

    /// Index of the coordinate that points up: y in the plane, z in space.
    #[must_use]
    pub fn up(&self) -> usize {
        if self.neighbours.dimensions() == 2 { 1 } else { 2 }
    }

    /// May paths pass through `p`?
    #[must_use]
    pub fn is_open(&self, p: DVec3) -> bool {
        // Nodes on the surface belong to the shape, whatever rounding says.
        let slack = self.window.spacing * 1e-6;
        self.shape.distance(p) <= slack && !self.forbid.as_ref().is_some_and(|f| f.contains(p))
    }

    fn is_masked(&self) -> bool {
        self.forbid.is_some() || !self.shape.is_box()
    }

    fn varies(&self) -> [bool; 3] {
        let mut varies = [false; 3];
        for field in &self.fields {
            for (axis, v) in field.varies().into_iter().enumerate() {
                varies[axis] |= v && (axis < 2 || self.up() == 2);
            }
        }
        varies
    }

    /// Bytes that planning in it takes at its peak.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        self.bytes_beside(plan::bytes_needed(self.window.nodes()))
    }

    /// Bytes that it takes at its peak, with so many more once it is there.
    pub(in crate::grow) fn bytes_beside(&self, more: u64) -> u64 {
        let nodes = self.window.nodes();
        let varies = self.varies();
        let table: u64 = (0..3).map(|axis| if varies[axis] { u64::from(self.window.size[axis]) } else { 1 }).product();
        // A field table has 8 bytes an entry, made from samples of 16.
        let fields = if self.fields.is_empty() { 0 } else { table * 24 };
        let mask = if self.is_masked() { nodes / 8 } else { 0 };
        (more + mask).max(nodes / 8 + fields) + fields / 3
    }

    /// The share of its nodes that are open, of a sample; shapes of what has not grown yet are empty.
    fn open_share(&self) -> f64 {
        if !self.is_masked() {
            return 1.0;
        }
        let corners = [[0; 3], self.window.size.map(|s| s - 1)].map(|at| self.window.position(at));
        Bounds { min: corners[0], max: corners[1] }.share(|p| self.is_open(p))
    }

    /// How many nodes the union of so many paths has, about: a tree that joins n random points is as long as n to the power of
    /// (d - 1) / d (Steele 1988), one of least-cost paths longer, for these meet later ([`MEETING`]); no path is longer than
    /// the lattice is wide.
    fn nodes_of_paths(&self, paths: u64) -> u64 {
        let open = self.window.nodes() as f64 * self.open_share();
        let across: f64 = self.window.size.iter().map(|&s| f64::from(s)).sum();
        let dimensions = f64::from(self.neighbours.dimensions());
        let paths = paths as f64;
        let tree = MEETING * power(paths, 1.0 - 1.0 / dimensions) * power(open, 1.0 / dimensions);
        (tree + across).min(paths * across).min(open) as u64
    }

    /// Bytes that planning so many paths in it takes, where a method keeps `each` bytes of every node beside the search.
    #[must_use]
    pub fn bytes_with_paths(&self, paths: u64, each: u64) -> u64 {
        let nodes = self.window.nodes();
        let skeleton = self.nodes_of_paths(paths) * PATH_NODE_BYTES;
        self.bytes_needed().saturating_add(skeleton).saturating_add(nodes.saturating_mul(each))
    }

    /// The lattice of a scene with this seed.
    ///
    /// # Errors
    /// [`LatticeError`] when no node is open or weights are out of range.
    pub fn lattice(&self, seed: u64) -> Result<Lattice, LatticeError> {
        let mask = self.is_masked().then(|| self.mask());
        if mask.as_ref().is_some_and(|mask| mask.open() == 0) {
            return Err(LatticeError::Empty);
        }
        self.lattice_in(self.window, &self.stream, seed, mask)
    }

    /// A lattice with the weights and fields of this space, but its own window, random stream and mask.
    ///
    /// # Errors
    /// [`LatticeError::Weights`] where weights are out of range.
    pub(in crate::grow) fn lattice_in(
        &self,
        window: Window,
        stream: &str,
        seed: u64,
        mask: Option<Mask>,
    ) -> Result<Lattice, LatticeError> {
        let field = (!self.fields.is_empty()).then(|| (self.varies(), |p| CostField::combine(&self.fields, p)));
        Lattice::new(window, self.neighbours, &Stream::new(seed, &format!("space/{stream}")), self.weights, field, mask)
    }

    fn mask(&self) -> Mask {
        let [x, y, _] = self.window.size.map(u64::from);
        let nodes = self.window.nodes();
        let words = (0..nodes.div_ceil(64))
            .into_par_iter()
            .map(|word| {
                (0..64).fold(0_u64, |bits, bit| {
                    let cell = word * 64 + bit;
                    let at = [cell % x, cell / x % y, cell / (x * y)].map(|c| c as u32);
                    let blocked = cell < nodes && !self.is_open(self.window.position(at));
                    bits | u64::from(blocked) << bit
                })
            })
            .collect();
        Mask::from_words(words, nodes as usize)
    }
}
