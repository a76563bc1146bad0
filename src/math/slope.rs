//! The line nearest to points.

/// The slope of the least-squares line through `points`; 0 for fewer than two, or for points of one abscissa.
#[must_use]
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let over = points.iter().map(|p| (p.0 - mean.0) * (p.1 - mean.1)).sum::<f64>();
    let under = points.iter().map(|p| (p.0 - mean.0) * (p.0 - mean.0)).sum::<f64>();
    if under > 0.0 { over / under } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_their_slope() {
        assert_eq!(slope(&[]), 0.0);
        assert_eq!(slope(&[(2.0, 5.0), (2.0, 7.0)]), 0.0);
        assert!((slope(&[(0.0, 1.0), (1.0, 4.0), (3.0, 10.0)]) - 3.0).abs() < 1e-12);
    }
}
