//! The state of a search: four bytes a node for its cost and the slot of its predecessor.

use std::sync::atomic::{AtomicU32, Ordering};

use bytemuck::allocation::zeroed_slice_box;

use crate::graph::Graph;

/// One cell a node: `cost << slot_bits | slot + 1`, the cost modulo the remaining bits.
///
/// 0 is a node not yet reached, so that untouched pages of memory are never allocated. A generator has slot bits 0 and a cost
/// above 0. Costs are compared modulo 2^32: neighbours differ by at most the largest weight, far below half of that.
pub(super) struct Cells {
    cells: Box<[AtomicU32]>,
}

/// The bits of a cell that hold the slot.
#[inline(always)]
pub(super) fn slot_mask(graph: &impl Graph) -> u32 {
    (1 << graph.slot_bits()) - 1
}

/// Difference by which an unreached node is above every cost that is compared with it.
const FAR: u32 = 1 << 30;

impl Cells {
    pub fn new(len: usize) -> Self {
        Self { cells: zeroed_slice_box(len) }
    }

    #[inline(always)]
    pub fn get(&self, cell: usize) -> u32 {
        self.cells[cell].load(Ordering::Relaxed)
    }

    pub fn set(&self, cell: usize, value: u32) {
        self.cells[cell].store(value, Ordering::Relaxed);
    }

    /// Stores the minimum of `new` and the old value; returns the old value, or one far above `new` if the node was unreached.
    /// Only one thread may write.
    #[inline(always)]
    pub fn lower(&self, cell: usize, new: u32) -> u32 {
        let slot = &self.cells[cell];
        let old = slot.load(Ordering::Relaxed);
        let old = if old == 0 { new.wrapping_add(FAR) } else { old };
        let less = (new.wrapping_sub(old) as i32) < 0;
        slot.store(if less { new } else { old }, Ordering::Relaxed);
        old
    }

    /// [`Cells::lower`], atomic.
    #[inline(always)]
    pub fn lower_shared(&self, cell: usize, new: u32) -> u32 {
        let slot = &self.cells[cell];
        let mut stored = slot.load(Ordering::Relaxed);
        loop {
            let old = if stored == 0 { new.wrapping_add(FAR) } else { stored };
            if (new.wrapping_sub(old) as i32) >= 0 {
                return old;
            }
            match slot.compare_exchange_weak(stored, new, Ordering::Relaxed, Ordering::Relaxed) {
                Ok(_) => return old,
                Err(other) => stored = other,
            }
        }
    }

    #[inline(always)]
    pub fn prefetch(&self, cell: usize) {
        crate::math::prefetch(&self.cells, cell);
    }
}
