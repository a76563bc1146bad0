//! The forbidden nodes of a graph, as a bit set.

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

    /// The number of cells that are not forbidden.
    #[must_use]
    pub fn open(&self) -> usize {
        self.cells - self.blocked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knows_what_it_blocks() {
        let mask = Mask::from_words(vec![0b101, u64::MAX], 66);
        let blocked: Vec<_> = (0..66).filter(|&cell| mask.is_blocked(cell)).collect();
        assert_eq!(blocked, [0, 2, 64, 65]);
        assert_eq!(mask.open(), 62);
    }
}
