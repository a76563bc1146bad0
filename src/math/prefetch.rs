//! Prefetching, the project's one use of `unsafe`.
//!
//! Without it `benches/plan.rs` takes 1.5 times as long at 256^3 and 1.2 times at 2048^2, and `benches/trace.rs` 1.1
//! times for a million segments (`benches/README.md`).

/// Size of a cache line in bytes.
const LINE: usize = 64;

/// Prefetches the cache lines of `slice[index]`; does nothing where the index is out of range.
#[inline(always)]
pub(crate) fn prefetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if index < slice.len() {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        #[allow(unsafe_code)]
        // SAFETY: the pointers are within the slice; a prefetch neither reads nor writes what a program can see.
        unsafe {
            let first: *const i8 = slice.as_ptr().add(index).cast();
            for offset in (0..size_of::<T>()).step_by(LINE) {
                _mm_prefetch::<_MM_HINT_T0>(first.add(offset));
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, index);
}
