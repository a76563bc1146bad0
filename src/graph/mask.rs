//! Which nodes of a graph are forbidden: one bit a node.

/// A set of cells that no path enters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    words: Vec<u64>,
    cells: usize,
    blocked: usize,
}

impl Mask {
    /// A mask over `words.len() * 64` cells or fewer: bit i of word w blocks cell `64 w + i`.
    #[must_use]
    pub fn from_words(mut words: Vec<u64>, cells: usize) -> Self {
        words.truncate(cells.div_ceil(64));
        if !cells.is_multiple_of(64)
            && let Some(last) = words.last_mut()
        {
            *last &= (1 << (cells % 64)) - 1;
        }
        let blocked = words.iter().map(|w| w.count_ones() as usize).sum();
        Self { words, cells, blocked }
    }

    /// Is `cell` forbidden?
    #[inline]
    #[must_use]
    pub fn is_blocked(&self, cell: usize) -> bool {
        self.words[cell / 64] >> (cell % 64) & 1 == 1
    }

    /// How many cells stay open.
    #[must_use]
    pub fn open(&self) -> usize {
        self.cells - self.blocked
    }

    /// The forbidden cells in ascending order.
    pub fn blocked(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().flat_map(|(w, &word)| {
            std::iter::successors((word != 0).then_some(word), |&rest| {
                let rest = rest & (rest - 1);
                (rest != 0).then_some(rest)
            })
            .map(move |rest| w * 64 + rest.trailing_zeros() as usize)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_what_it_blocks() {
        let mask = Mask::from_words(vec![0b101, u64::MAX], 66);
        assert_eq!(mask.blocked().collect::<Vec<_>>(), [0, 2, 64, 65]);
        assert_eq!(mask.open(), 62);
        assert!(mask.is_blocked(2) && !mask.is_blocked(1));
    }
}
