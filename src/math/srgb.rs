//! The sRGB encoding (IEC 61966-2-1).

use std::sync::LazyLock;

use super::power;

/// The least linear light that rounds to each code value above 0.
static STEPS: LazyLock<[f64; 255]> = LazyLock::new(|| std::array::from_fn(|i| from_srgb((i as f64 + 0.5) / 255.0)));

/// The sRGB code value nearest to linear light, clamped. A binary search: a power takes ten times as long.
#[must_use]
pub fn srgb_byte(linear: f64) -> u8 {
    STEPS.partition_point(|step| *step <= linear) as u8
}

/// The sRGB encoding, 0 to 1, of linear light clamped to 0 to 1.
#[must_use]
pub fn to_srgb(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * power(c, 1.0 / 2.4) - 0.055 }
}

/// Linear light from its sRGB encoding.
#[must_use]
pub fn from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { power((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives() {
        assert_eq!((srgb_byte(-1.0), srgb_byte(9.0), srgb_byte(f64::NAN)), (0, 255, 0));
        for i in 0..=255 {
            let x = f64::from(i) / 255.0;
            assert!((to_srgb(from_srgb(x)) - x).abs() < 1e-9);
            assert_eq!(srgb_byte(from_srgb(x)), i as u8);
        }
    }
}
