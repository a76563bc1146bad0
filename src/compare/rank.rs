//! The k-th of many values that are visited again and again, none of them kept.

/// Bits of a value that one visit settles.
const DIGIT: u32 = 16;

/// Hands all values to what it is given.
pub(super) type Visit<'a> = dyn Fn(&mut dyn FnMut(f64)) + 'a;

/// The value with the rank that `rank` chooses, of as many as it is told, from 0 for the least; `None` where there are none.
/// `visit` hands over the values, the same each time, no NaN among them.
pub(super) fn ranked(visit: &Visit<'_>, rank: impl FnOnce(usize) -> usize) -> Option<f64> {
    let mut count = 0;
    visit(&mut |_| count += 1);
    let mut rank = rank(count);
    if rank >= count {
        return None;
    }
    // Radix selection: the digits of its key from the highest on.
    let mut known = 0;
    for shift in (0..u64::BITS / DIGIT).rev().map(|i| i * DIGIT) {
        let mut counts = vec![0_usize; 1 << DIGIT];
        visit(&mut |value| {
            let key = key(value);
            // A shift by all bits is none.
            if key.checked_shr(shift + DIGIT).unwrap_or(0) == known {
                counts[(key >> shift) as usize & ((1 << DIGIT) - 1)] += 1;
            }
        });
        let digit = counts.iter().position(|&count| {
            let is_here = rank < count;
            if !is_here {
                rank -= count;
            }
            is_here
        })?;
        known = known << DIGIT | digit as u64;
    }
    Some(value(known))
}

/// Bits in the order of the values.
fn key(value: f64) -> u64 {
    let bits = value.to_bits();
    if value.is_sign_negative() { !bits } else { bits | 1 << 63 }
}

/// The inverse of [`key`].
fn value(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 1 { key & !(1 << 63) } else { !key })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn sorting_gives_the_same(mut values in prop::collection::vec(-1e9..1e9_f64, 1..200), at in any::<prop::sample::Index>()) {
            let k = at.index(values.len());
            let found = ranked(&|visit| values.iter().copied().for_each(visit), |_| k);
            values.sort_by(f64::total_cmp);
            prop_assert_eq!(found, Some(values[k]));
        }
    }

    #[test]
    fn nothing_has_no_rank() {
        assert_eq!(ranked(&|_| {}, |count| count / 2), None);
        assert_eq!(ranked(&|visit| visit(f64::INFINITY), |count| count - 1), Some(f64::INFINITY));
    }
}
