//! Counter-based random streams: every number is a pure function of (scene seed, stream name, index).

use std::convert::Infallible;

use rand::rand_core::TryRng;

use super::fnv1a;

/// The odd integer nearest to 2^64 divided by the golden ratio: the step of a Weyl sequence.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A bijective hash in which every bit of `x` affects every bit of the result (the finaliser of SplitMix64, Steele et al.
/// 2014).
#[inline]
#[must_use]
pub const fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The name of child `index` of the thing named `parent`; children of different parents differ.
#[must_use]
pub const fn name_of(parent: u64, index: u64) -> u64 {
    // An offset and two rounds: otherwise 0 would stay 0 and equal numbers would cancel.
    mix(mix(parent.wrapping_add(GOLDEN)) ^ index)
}

/// A named stream of random numbers.
///
/// The n-th number is a function of seed, name and n: streams are independent of each other, and a shorter draw is a
/// prefix of a longer one. It implements `rand`'s generator traits; a test pins the values of `rand`'s distributions.
///
/// ```
/// use lichtenberg::math::Stream;
/// use rand::RngExt;
///
/// let mut a = Stream::new(7, "elm/limbs");
/// let mut b = Stream::new(7, "elm/limbs");
/// assert_eq!(a.random::<f64>(), b.random::<f64>());
/// assert_ne!(a.key(), Stream::new(7, "elm/twigs").key());
/// ```
#[derive(Clone, Debug)]
pub struct Stream {
    key: u64,
    next: u64,
}

impl Stream {
    /// The stream called `name` of the scene whose seed is `seed`.
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Self {
        Self { key: mix(mix(seed.wrapping_add(GOLDEN)) ^ mix(fnv1a(name.bytes()))), next: 0 }
    }

    /// The substream `index` of this stream.
    #[must_use]
    pub fn nth(&self, index: u64) -> Self {
        Self { key: mix(self.key ^ mix(index.wrapping_add(GOLDEN))), next: 0 }
    }

    /// The key by which this stream differs from all others.
    #[must_use]
    pub fn key(&self) -> u64 {
        self.key
    }
}

impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.try_next_u64().map(|x| (x >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.next = self.next.wrapping_add(1);
        Ok(mix(self.key.wrapping_add(self.next.wrapping_mul(GOLDEN))))
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            chunk.copy_from_slice(&self.try_next_u64()?.to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    #[test]
    fn values_are_pinned() {
        // A change here changes every scene: it needs a new edition.
        let mut stream = Stream::new(7, "elm/limbs");
        assert_eq!(stream.key(), 18_049_931_897_138_220_873);
        let drawn = (stream.random::<f64>(), stream.random_range(0..1000_u32), stream.random_range(-1.0..1.0));
        assert_eq!(drawn, (0.527_226_411_811_676, 284, 0.971_403_784_495_351_8));
    }

    #[test]
    fn numbers_are_even() {
        let mut stream = Stream::new(1, "even");
        let n = 100_000;
        let mut bins = [0_u32; 16];
        for _ in 0..n {
            bins[(stream.random::<f64>() * 16.0) as usize] += 1;
        }
        let expected = f64::from(n) / 16.0;
        let chi2: f64 = bins.iter().map(|&b| (f64::from(b) - expected) * (f64::from(b) - expected) / expected).sum();
        assert!(chi2 < 37.7, "chi-squared {chi2} over 15 degrees of freedom");
    }
}
