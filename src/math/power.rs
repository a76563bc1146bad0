//! Powers with the same bits on every platform.

/// `base` to the power `exponent`, by the pinned `libm`: std's `powf` differs between platforms.
#[inline]
#[must_use]
pub fn power(base: f64, exponent: f64) -> f64 {
    libm::pow(base, exponent)
}
