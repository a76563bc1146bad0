//! The colour of a black body.

/// Planck's second radiation constant, in nanometre kelvins.
const C2: f64 = 1.438_776_877e7;

/// The linear Rec. 709 colour, with luminance 1, of a black body at `kelvin`; negative components are clipped.
///
/// Planck's law over the CIE 1931 observer, by the fit of Wyman, Sloan and Shirley (2013).
#[must_use]
pub fn black_body(kelvin: f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for i in 0..96 {
        let nm = 360.0 + 5.0 * f64::from(i);
        let metres = nm * 1e-3;
        let planck = 1.0 / (metres * metres * metres * metres * metres * (libm::exp(C2 / (nm * kelvin)) - 1.0));
        let observer = observer(nm);
        (0..3).for_each(|c| xyz[c] += planck * observer[c]);
    }
    let [x, y, z] = xyz.map(|v| v / xyz[1]);
    let rgb = [
        3.240_97 * x - 1.537_383 * y - 0.498_611 * z,
        -0.969_244 * x + 1.875_968 * y + 0.041_555 * z,
        0.055_63 * x - 0.203_977 * y + 1.056_972 * z,
    ];
    let rgb = rgb.map(|c| c.max(0.0));
    let luminance = 0.212_639 * rgb[0] + 0.715_169 * rgb[1] + 0.072_192 * rgb[2];
    rgb.map(|c| c / luminance)
}

/// The CIE 1931 colour matching functions, as sums of two-sided Gaussians.
fn observer(nm: f64) -> [f64; 3] {
    let lobe = |scale: f64, middle: f64, low: f64, high: f64| {
        let t = (nm - middle) * if nm < middle { low } else { high };
        scale * libm::exp(-0.5 * t * t)
    };
    [
        lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hotter_is_bluer() {
        let white = black_body(6504.0);
        // Near the white of Rec. 709, whose daylight is a little greener.
        assert!(white.iter().all(|c| (c - 1.0).abs() < 0.06), "{white:?}");
        let (cool, hot) = (black_body(3000.0), black_body(20_000.0));
        assert!(cool[0] > 1.5 && cool[2] < 0.35 && hot[2] > 1.5 && hot[0] < 0.8, "{cool:?} {hot:?}");
    }
}
