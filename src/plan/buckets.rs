//! A cyclic array of buckets, no wider than the least weight: a bucket that is popped is final (Dial 1969; Dinitz 1978).

use crate::graph::Node;

/// Places in a chunk: the first holds the link to the next chunk, the others a node each. A power of two.
pub(super) const CHUNK: usize = 64;

/// The cursor of an empty bucket: the last place of chunk 0, which no bucket owns. Its first node so takes the same
/// rare branch as one that fills a chunk, and what is written to that place is never read.
const EMPTY: u32 = CHUNK as u32 - 1;

/// Nodes by the bucket of their cost.
pub(super) struct Buckets {
    /// For each bucket, the place in `pool` where its next node goes.
    cursors: Vec<u32>,
    /// Chunks, one after the other.
    pool: Vec<u32>,
    free: Vec<u32>,
}

/// The rest of a bucket that has been emptied: its chunks are read by [`Buckets::next_chunk`].
pub(super) struct Taken {
    chunk: u32,
    len: u32,
}

impl Buckets {
    /// `count` buckets, a power of two.
    pub fn new(count: usize) -> Self {
        Self { cursors: vec![EMPTY; count], pool: vec![0; CHUNK], free: Vec::new() }
    }

    /// Puts `node` in `bucket` if `wanted`, without a branch on that.
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

    /// Adds a chunk to `bucket`, whose cursor ran to the end of one.
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

    /// Empties `bucket`.
    #[inline]
    pub fn take(&mut self, bucket: usize) -> Taken {
        let cursor = std::mem::replace(&mut self.cursors[bucket], EMPTY);
        let chunk = cursor & !(CHUNK as u32 - 1);
        Taken { chunk, len: cursor - chunk }
    }

    /// The next nodes of a taken bucket, or nothing when it has no more.
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

    /// The nodes that [`Buckets::next_chunk`] would give next, to look ahead.
    #[inline]
    pub fn upcoming(&self, taken: &Taken) -> &[u32] {
        if taken.chunk == 0 {
            return &[];
        }
        let start = taken.chunk as usize;
        &self.pool[start + 1..start + taken.len as usize]
    }
}
