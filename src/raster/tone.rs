//! The tone curve of finished pictures.

/// The value at which the shoulder starts.
const SHOULDER: f64 = 0.8;

/// A tone curve with a filmic shoulder: highlights roll off exponentially towards 1, lower values are unchanged, so that renderers
/// without it agree but for highlights.
#[must_use]
pub fn filmic(linear: f64) -> f64 {
    if linear <= SHOULDER {
        return linear;
    }
    let room = 1.0 - SHOULDER;
    SHOULDER + room * (1.0 - libm::exp(-(linear - SHOULDER) / room))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_smooth_and_ends_at_white() {
        assert_eq!(filmic(0.3), 0.3);
        assert!(filmic(0.8 + 1e-6) - filmic(0.8) < 1.1e-6 && filmic(50.0) <= 1.0 && filmic(50.0) > 0.999);
    }
}
