//! A hint to the cache, the project's one use of `unsafe`.
//!
//! `benches/plan.rs` justifies it: without the hint planning takes 1.5 to 2 times as long above 128^3
//! (`benches/README.md`).

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
