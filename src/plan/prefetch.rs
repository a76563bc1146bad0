//! A hint to the cache, the project's one use of `unsafe`.
//!
//! Left out, `benches/plan.rs` takes 1.5 times as long at 256^3 and 1.2 times at 2048^2 (`benches/README.md`).

/// Asks for the cache line of `slice[index]`; does nothing where the index is out of range.
#[inline(always)]
pub(super) fn prefetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if index < slice.len() {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        #[allow(unsafe_code)]
        // SAFETY: the pointer is within the slice; a prefetch neither reads nor writes what a program can see.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(slice.as_ptr().add(index).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, index);
}
