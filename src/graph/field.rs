//! Cost fields tabulated on a lattice, along the axes on which they vary and no others.

use rayon::prelude::*;

use super::Window;
use super::weights::fixed;
use crate::math::DVec3;

/// Fractional bits of a factor.
const FACTOR_FRACTION: u32 = 12;
/// Factors are kept at or above this, so that no weight vanishes.
pub(super) const LEAST_FACTOR: f64 = 1.0 / 16.0;

/// What cost fields make of a place: an edge weighs `R^alpha * factor + sum`, times its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldValue {
    /// At least 0.
    pub sum: f64,
    /// Kept at 1/16 or above.
    pub factor: f64,
}

/// One [`FieldValue`] for each node, as integers; an edge takes the mean of its two ends.
#[derive(Clone, Debug)]
pub struct FieldTable {
    /// How far apart the values of neighbours along x, y and z are; 0 where nothing changes.
    pub(super) strides: [usize; 3],
    values: Vec<[u32; 2]>,
}

/// Values of a field before they are rounded to integers: their bounds set the fractional bits.
#[derive(Clone, Debug)]
pub(super) struct FieldSamples {
    strides: [usize; 3],
    values: Vec<FieldValue>,
}

impl FieldSamples {
    /// Evaluates `value` at every node of `window`; `varies` says along which axes it can change.
    pub fn new(window: &Window, varies: [bool; 3], value: impl Fn(DVec3) -> FieldValue + Sync) -> Self {
        let size = [0, 1, 2].map(|axis| if varies[axis] { window.size[axis] as usize } else { 1 });
        let strides = [1, size[0], size[0] * size[1]];
        let values = (0..size[0] * size[1] * size[2])
            .into_par_iter()
            .map(|i| {
                let at = [i % size[0], i / strides[1] % size[1], i / strides[2]];
                let FieldValue { sum, factor } = value(window.position(at.map(|c| c as u32)));
                FieldValue { sum: sum.max(0.0), factor: factor.max(LEAST_FACTOR) }
            })
            .collect();
        Self { strides: [0, 1, 2].map(|axis| if varies[axis] { strides[axis] } else { 0 }), values }
    }

    /// The least and largest sum and factor.
    pub fn bounds(&self) -> (FieldValue, FieldValue) {
        let first = self.values[0];
        self.values.iter().fold((first, first), |(low, high), v| {
            (
                FieldValue { sum: low.sum.min(v.sum), factor: low.factor.min(v.factor) },
                FieldValue { sum: high.sum.max(v.sum), factor: high.factor.max(v.factor) },
            )
        })
    }

    /// The table with `fraction` bits behind the point.
    pub fn into_table(self, fraction: u32) -> FieldTable {
        FieldTable {
            strides: self.strides,
            values: self.values.iter().map(|v| [fixed(v.sum, fraction), fixed(v.factor, FACTOR_FRACTION)]).collect(),
        }
    }
}

impl FieldTable {
    /// The weight of an edge between the values `a` and `b`: `random` is `R^alpha` times the length, `length` has
    /// 12 fractional bits.
    #[inline(always)]
    pub(super) fn weight(&self, random: u32, length: u64, a: usize, b: usize) -> u32 {
        let ([sum_a, factor_a], [sum_b, factor_b]) = (self.values[a], self.values[b]);
        let factor = u64::from(factor_a) + u64::from(factor_b);
        let sum = u64::from(sum_a) + u64::from(sum_b);
        // Halved, since both are sums over two ends.
        (((u64::from(random) * factor) >> (FACTOR_FRACTION + 1)) + ((sum * length) >> 13)) as u32
    }
}
