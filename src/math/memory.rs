//! The handle by which long work asks for memory before it takes it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// More memory is needed than may be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("about {} MB of memory, more than the {} MB allowed", needed.div_ceil(1_000_000), limit / 1_000_000)]
pub struct OutOfMemory {
    /// Bytes that are needed.
    pub needed: u64,
    /// Bytes that may be taken.
    pub limit: u64,
}

/// How many bytes may be taken, and the most that work has thought it would take at once. Clones share that; the default has
/// no limit.
///
/// ```
/// use lichtenberg::math::Memory;
///
/// let memory = Memory::new(1000);
/// memory.ask(600)?;
/// let rest = memory.beside(600);
/// assert!(rest.ask(500).is_err());
/// assert_eq!(memory.most(), 600);
/// # Ok::<(), lichtenberg::math::OutOfMemory>(())
/// ```
#[derive(Clone, Debug)]
pub struct Memory {
    limit: u64,
    /// What is taken already, as far as whoever holds this handle is told.
    taken: u64,
    most: Arc<AtomicU64>,
}

impl Default for Memory {
    fn default() -> Self {
        Self::new(u64::MAX)
    }
}

impl Memory {
    /// A handle for at most `limit` bytes.
    #[must_use]
    pub fn new(limit: u64) -> Self {
        Self { limit, taken: 0, most: Arc::default() }
    }

    /// The same where so many bytes more are taken already.
    #[must_use]
    pub fn beside(&self, bytes: u64) -> Self {
        Self { taken: self.taken.saturating_add(bytes), ..self.clone() }
    }

    /// Bytes that may still be taken.
    #[must_use]
    pub fn left(&self) -> u64 {
        self.limit.saturating_sub(self.taken)
    }

    /// Asks for so many bytes at once, beside what is taken.
    ///
    /// # Errors
    /// [`OutOfMemory`] where they are more than the limit.
    pub fn ask(&self, bytes: u64) -> Result<(), OutOfMemory> {
        let needed = self.taken.saturating_add(bytes);
        if needed > self.limit {
            return Err(OutOfMemory { needed, limit: self.limit });
        }
        self.most.fetch_max(needed, Ordering::Relaxed);
        Ok(())
    }

    /// The most bytes that were asked for, with what was taken then.
    #[must_use]
    pub fn most(&self) -> u64 {
        self.most.load(Ordering::Relaxed)
    }
}
