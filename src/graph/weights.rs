//! Edge weights: `R^alpha` (Xu and Mould 2008, eq. 1), as a table of fixed-point integers indexed by a hash of the edge.

use crate::math::{Weights, power};

/// Entries of a table: the resolution of R. The top 12 bits of a hash are the index.
pub(super) const ENTRIES: usize = 1 << 12;
/// Fractional bits of a weight, unless the largest weight leaves no room for them.
const FRACTION: u32 = 12;
/// Least number of fractional bits: rounding is at most 1/16 of the least weight.
const LEAST_FRACTION: u32 = 4;
/// Most bits of a weight, so that costs can be compared modulo the bits of a cell.
const WEIGHT_BITS: u32 = 24;

/// Why weights cannot be tabulated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WeightError {
    /// The largest weight is out of range.
    #[error("an edge may weigh up to {largest:.3e}, which is more than {limit}: lower alpha, max or the cost fields")]
    TooLarge {
        /// The largest weight that an edge can have.
        largest: f64,
        /// The largest weight allowed.
        limit: u32,
    },
}

/// The bounds of a graph's weights, in fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeightRange {
    /// No edge weighs less; never 0.
    pub least: u32,
    /// No edge weighs more; below 2^24.
    pub most: u32,
    /// Fractional bits: a weight w stands for `w / 2^fraction`.
    pub fraction: u32,
}

impl WeightRange {
    /// The real number that the fixed-point `cost` stands for.
    #[must_use]
    pub fn real(self, cost: u64) -> f64 {
        cost as f64 / f64::from(1_u32 << self.fraction)
    }
}

/// Tables of `R^alpha` times the length of an edge, one for each of three length classes.
#[derive(Clone, Debug)]
pub struct WeightTable {
    entries: Box<[[u32; ENTRIES]; 3]>,
    fraction: u32,
}

impl WeightTable {
    /// Tables for edges of length 1, sqrt 2 and sqrt 3.
    ///
    /// `largest_factor` and `largest_sum` bound what cost fields multiply and add, so that the number of fractional
    /// bits follows from the largest weight and never from the size of the lattice.
    ///
    /// # Errors
    /// [`WeightError::TooLarge`] when weights leave less than four fractional bits.
    pub fn new(weights: Weights, largest_factor: f64, largest_sum: f64) -> Result<Self, WeightError> {
        let largest = (power(weights.max, weights.alpha) * largest_factor + largest_sum) * length(2);
        let limit = 1_u32 << (WEIGHT_BITS - LEAST_FRACTION);
        if largest.is_nan() || largest >= f64::from(limit) {
            return Err(WeightError::TooLarge { largest, limit });
        }
        let mut fraction = FRACTION;
        while largest * f64::from(1_u32 << fraction) >= f64::from(1_u32 << WEIGHT_BITS) {
            fraction -= 1;
        }
        let mut entries = Box::new([[0; ENTRIES]; 3]);
        for (class, row) in entries.iter_mut().enumerate() {
            for (i, entry) in row.iter_mut().enumerate() {
                let r = 1.0 + (weights.max - 1.0) * ((i as f64 + 0.5) / ENTRIES as f64);
                *entry = fixed(power(r, weights.alpha) * length(class), fraction);
            }
        }
        Ok(Self { entries, fraction })
    }

    /// Fractional bits of every entry.
    #[must_use]
    pub fn fraction(&self) -> u32 {
        self.fraction
    }

    /// The weight of an edge with the hash `h` and the length class `class` (0: 1, 1: sqrt 2, 2: sqrt 3).
    #[inline(always)]
    pub(super) fn entry(&self, class: usize, h: u64) -> u32 {
        self.entries[class][(h >> 52) as usize]
    }

    /// The smallest and largest entry of the first `classes` length classes.
    pub(super) fn bounds(&self, classes: usize) -> (u32, u32) {
        // R^alpha grows with R, and lengths grow with the class.
        (self.entries[0][0], self.entries[classes - 1][ENTRIES - 1])
    }
}

/// Length, in lattice steps, of an edge of a length class: the square root of `class + 1`, the number of coordinates that
/// change.
pub(super) fn length(class: usize) -> f64 {
    [1.0, std::f64::consts::SQRT_2, 1.732_050_807_568_877_2][class]
}

/// `x` rounded to fixed point; it must be in range.
pub(super) fn fixed(x: f64, fraction: u32) -> u32 {
    libm::floor(x * f64::from(1_u32 << fraction) + 0.5) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tables must have the same bits on every platform and in every release of an edition.
    #[test]
    fn tables_are_pinned() {
        let sum = |max, alpha| {
            let table = WeightTable::new(Weights { max, alpha }, 1.0, 0.0).unwrap();
            table.entries.iter().flatten().fold(0_u64, |sum, &e| sum.rotate_left(5) ^ u64::from(e))
        };
        assert_eq!(
            [sum(10.0, 0.3), sum(10.0, 1.0), sum(10.0, 3.0), sum(11.0, 1.0)],
            [
                5_251_410_454_428_352_591,
                1_940_053_902_947_470_439,
                7_240_820_820_853_094_106,
                3_628_366_266_119_417_321
            ]
        );
    }

    #[test]
    fn fraction_follows_the_largest_weight() {
        let fraction = |alpha| WeightTable::new(Weights { max: 10.0, alpha }, 1.0, 0.0).map(|t| t.fraction());
        assert_eq!(fraction(1.0), Ok(12));
        assert_eq!(fraction(3.0), Ok(12));
        assert_eq!(fraction(5.0), Ok(6));
        assert!(fraction(1000.0).is_err());
        assert!(fraction(f64::NAN).is_err());
    }
}
