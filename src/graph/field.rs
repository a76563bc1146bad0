//! Cost fields tabulated on a lattice, along those axes only on which they vary.

use rayon::prelude::*;

use super::weights::fixed;
use super::window::Window;
use crate::math::DVec3;

/// Fractional bits of a factor.
const FACTOR_FRACTION: u32 = 12;
/// Least factor, so that no weight vanishes.
pub(super) const LEAST_FACTOR: f64 = 1.0 / 16.0;

/// The combined cost fields at a point: an edge weighs `(R^alpha * factor + sum) * length`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldValue {
    /// Sum of the added fields, at least 0.
    pub sum: f64,
    /// Product of the multiplying fields, clamped to 1/16 and above.
    pub factor: f64,
}

/// A [`FieldValue`] for each node in fixed point; an edge has the mean of its two ends.
#[derive(Clone, Debug)]
pub struct FieldTable {
    /// Strides along x, y and z; 0 where the fields do not vary.
    pub(super) strides: [usize; 3],
    values: Vec<[u32; 2]>,
}

/// Samples of cost fields before rounding to fixed point: their bounds determine the fractional bits.
#[derive(Clone, Debug)]
pub(super) struct FieldSamples {
    strides: [usize; 3],
    values: Vec<FieldValue>,
}

impl FieldSamples {
    /// Evaluates `value` at the nodes of `window` along the axes on which it `varies`.
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

    /// The table with `fraction` fractional bits.
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
        // Halved: both are sums over the two ends.
        (((u64::from(random) * factor) >> (FACTOR_FRACTION + 1)) + ((sum * length) >> 13)) as u32
    }
}
