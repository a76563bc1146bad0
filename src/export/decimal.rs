//! Decimal numbers, as short as exactness needs.

use crate::math::DVec3;
use crate::model::Digits;

/// Appends `x` with at most `digits` behind the point: no exponent, no zeros that say nothing (`.25`, `-3`, `0`).
pub(super) fn push_number(out: &mut Vec<u8>, x: f64, digits: Digits, scale: f64) {
    debug_assert!(x.is_finite());
    // Numbers in a model are below 1e7 with six figures, far inside 64 bits.
    let scaled = libm::round(x * scale) as i64;
    if scaled < 0 {
        out.push(b'-');
    }
    let mut rest = scaled.unsigned_abs();
    if rest == 0 {
        out.push(b'0');
        return;
    }
    let mut behind = digits.0;
    while behind > 0 && rest.is_multiple_of(10) {
        rest /= 10;
        behind -= 1;
    }
    let mut text = [0; 24];
    let mut at = text.len();
    let mut written = 0;
    while rest > 0 || written < behind {
        at -= 1;
        text[at] = b'0' + (rest % 10) as u8;
        rest /= 10;
        written += 1;
        if written == behind {
            at -= 1;
            text[at] = b'.';
        }
    }
    out.extend_from_slice(&text[at..]);
}

/// [`push_number`] with a digit before the point, as every reader takes it.
pub(super) fn push_plain(out: &mut Vec<u8>, x: f64, digits: Digits, scale: f64) {
    let start = out.len();
    push_number(out, x, digits, scale);
    let at = start + usize::from(out[start] == b'-');
    if out[at] == b'.' {
        out.insert(at, b'0');
    }
}

/// `x` as text with a digit before the point.
pub(super) fn plain_number(x: f64, digits: Digits) -> String {
    let mut out = Vec::new();
    push_plain(&mut out, x, digits, digits.scale());
    out.into_iter().map(char::from).collect()
}

/// Appends `<x,y,z>`.
pub(super) fn push_vector(out: &mut Vec<u8>, p: DVec3, digits: Digits, scale: f64) {
    for (c, before) in p.to_array().into_iter().zip([b'<', b',', b',']) {
        out.push(before);
        push_number(out, c, digits, scale);
    }
    out.push(b'>');
}

/// `x` as text.
pub(super) fn number(x: f64, digits: Digits) -> String {
    let mut out = Vec::new();
    push_number(&mut out, x, digits, digits.scale());
    out.into_iter().map(char::from).collect()
}

/// `p` as text, with spaces for people.
pub(super) fn vector(p: DVec3, digits: Digits) -> String {
    format!("<{}, {}, {}>", number(p.x, digits), number(p.y, digits), number(p.z, digits))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn says_no_more_than_it_must() {
        let texts: Vec<_> =
            [0.0, 1.0, -0.25, 1200.0, 0.000_01, 12.345_678, -0.000_001].map(|x| number(x, Digits(5))).to_vec();
        assert_eq!([0.5, -0.25, 3.0].map(|x| plain_number(x, Digits(5))), ["0.5", "-0.25", "3"]);
        assert_eq!(texts, ["0", "1", "-.25", "1200", ".00001", "12.34568", "0"].map(|t| t.replace("-0", "0")));
    }

    proptest! {
        #[test]
        fn reads_back(x in -1e6..1e6_f64, digits in 0..8_u32) {
            let digits = Digits(digits);
            let text = number(x, digits);
            let back: f64 = text.parse().unwrap();
            prop_assert_eq!(back, digits.round(x));
            prop_assert!(!text.contains('e') && (!text.contains('.') || !text.ends_with('0')));
        }
    }
}
