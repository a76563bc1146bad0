//! A cyclic bucket queue whose buckets are no wider than the least weight, so that a popped bucket is final (Dial 1969;
//! Dinitz 1978).

use crate::graph::Node;

/// Most buckets: more would cost more to walk than the nodes in them.
pub(super) const MOST_BUCKETS: u32 = 1 << 20;

/// Slots of a chunk: the first links to the next chunk, the others hold a node each. A power of two.
pub(super) const CHUNK: usize = 64;

/// The cursor of an empty bucket: the last slot of chunk 0, which no bucket owns. So the first node takes the same rare branch
/// as one that fills a chunk; what is written to that slot is never read.
const EMPTY: u32 = CHUNK as u32 - 1;

/// Nodes by bucket, as linked lists of chunks.
pub(super) struct Buckets {
    /// For each bucket, the index in `pool` of the slot for its next node.
    cursors: Vec<u32>,
    /// All chunks.
    pool: Vec<u32>,
    /// Unused chunks.
    free: Vec<u32>,
}

/// The contents of a bucket that has been emptied, to be read by [`Buckets::next_chunk`].
pub(super) struct Taken {
    chunk: u32,
    len: u32,
}

impl Buckets {
    /// `count` buckets, a power of two.
    pub fn new(count: usize) -> Self {
        Self { cursors: vec![EMPTY; count], pool: vec![0; CHUNK], free: Vec::new() }
    }

    /// Pushes `node` into `bucket` if `wanted`, branchless.
    #[inline(always)]
    pub fn push_if(&mut self, wanted: bool, bucket: usize, node: Node) {
        let cursor = self.cursors[bucket];
        self.pool[cursor as usize] = node.0;
        let next = cursor + u32::from(wanted);
        self.cursors[bucket] = next;
        if next.is_multiple_of(CHUNK as u32) {
            self.grow(bucket, next, node);
        }
    }

    /// Adds a chunk to `bucket`, whose cursor has reached the end of one.
    #[cold]
    #[inline(never)]
    fn grow(&mut self, bucket: usize, cursor: u32, node: Node) {
        let full = cursor - CHUNK as u32;
        let chunk = self.free.pop().unwrap_or_else(|| {
            self.pool.resize(self.pool.len() + CHUNK, 0);
            (self.pool.len() - CHUNK) as u32
        });
        self.pool[chunk as usize] = full;
        self.cursors[bucket] = chunk + 1;
        if full == 0 {
            self.pool[chunk as usize + 1] = node.0;
            self.cursors[bucket] += 1;
        }
    }

    /// Pops `bucket`.
    #[inline]
    pub fn take(&mut self, bucket: usize) -> Taken {
        let cursor = std::mem::replace(&mut self.cursors[bucket], EMPTY);
        let chunk = cursor & !(CHUNK as u32 - 1);
        Taken { chunk, len: cursor - chunk }
    }

    /// How many buckets from `from` on are empty, up to `most`; the first follows the last.
    pub fn empties(&self, from: usize, most: usize) -> usize {
        let (before, after) = self.cursors.split_at(from);
        let after = &after[..most.min(after.len())];
        let count = leading_empties(after);
        if count < after.len() { count } else { count + leading_empties(&before[..before.len().min(most - count)]) }
    }

    /// The next chunk of a popped bucket with its length, `None` at the end. The nodes start at 1.
    #[inline]
    pub fn next_chunk(&mut self, taken: &mut Taken) -> Option<([u32; CHUNK], usize)> {
        if taken.chunk == 0 {
            return None;
        }
        let start = taken.chunk as usize;
        let mut places = [0; CHUNK];
        places.copy_from_slice(&self.pool[start..start + CHUNK]);
        self.free.push(taken.chunk);
        let len = taken.len as usize;
        *taken = Taken { chunk: places[0], len: CHUNK as u32 };
        Some((places, len))
    }

    /// The nodes that [`Buckets::next_chunk`] will give next, for prefetching.
    #[inline]
    pub fn upcoming(&self, taken: &Taken) -> &[u32] {
        if taken.chunk == 0 {
            return &[];
        }
        let start = taken.chunk as usize;
        &self.pool[start + 1..start + taken.len as usize]
    }
}

/// How many cursors at the start of `cursors` are those of empty buckets.
fn leading_empties(cursors: &[u32]) -> usize {
    // A block has no branch within, which suits vector instructions.
    let is_empty = |block: &&[u32]| block.iter().fold(true, |all, &cursor| all & (cursor == EMPTY));
    let whole = cursors.chunks_exact(CHUNK).take_while(is_empty).count() * CHUNK;
    whole + cursors[whole..].iter().take_while(|&&cursor| cursor == EMPTY).count()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn empties_are_counted_round_the_end(
            full in proptest::collection::vec(0..512_usize, 0..4), from in 0..512_usize, most in 0..513_usize
        ) {
            let mut buckets = Buckets::new(512);
            for &bucket in &full {
                buckets.push_if(true, bucket, Node(7));
            }
            let expected = (0..most).take_while(|i| !full.contains(&((from + i) % 512))).count();
            prop_assert_eq!(buckets.empties(from, most), expected);
        }
    }
}
