//! Lines of equal value on a grid of samples, by marching squares.

use std::collections::HashMap;

use crate::math::DVec2;

/// The lines where `value` changes sign on a grid of `size` samples, in steps of the grid: what is below 0 is on their left. Closed
/// ones end where they start. Squares with a value that is not a number are left out.
///
/// Where two opposite corners of a square are below 0, both are cut off on their own.
#[must_use]
pub fn contours(size: [u32; 2], value: impl Fn(u32, u32) -> f64) -> Vec<Vec<DVec2>> {
    // Each segment leads from one crossing to the next; a crossing is named by its edge: the sample and the axis.
    let mut next: HashMap<[u32; 3], [u32; 3]> = HashMap::new();
    let mut points: HashMap<[u32; 3], DVec2> = HashMap::new();
    let mut order = Vec::new();
    for y in 0..size[1].saturating_sub(1) {
        for x in 0..size[0].saturating_sub(1) {
            let corners = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
            let values = corners.map(|[x, y]| value(x, y));
            if values.iter().any(|v| v.is_nan()) {
                continue;
            }
            let crossing = |i: usize| {
                let (a, b) = (values[i % 4], values[(i + 1) % 4]);
                let ([ax, ay], [bx, by]) = (corners[i % 4], corners[(i + 1) % 4]);
                let (from, to) = (DVec2::new(ax.into(), ay.into()), DVec2::new(bx.into(), by.into()));
                ([ax.min(bx), ay.min(by), u32::from(ax == bx)], from + (to - from) * (a / (a - b)))
            };
            for i in 0..4 {
                if values[i] >= 0.0 && values[(i + 1) % 4] < 0.0 {
                    let leaves = (1..4).find(|&j| values[(i + 1 + j) % 4] >= 0.0).unwrap_or(3);
                    let ((from, p), (to, q)) = (crossing(i), crossing(i + leaves));
                    points.insert(from, p);
                    points.insert(to, q);
                    // Counterclockwise around the corners, below 0 comes after `from`.
                    next.insert(to, from);
                    order.push(to);
                }
            }
        }
    }
    let mut has_previous: HashMap<[u32; 3], bool> = HashMap::new();
    next.values().for_each(|to| {
        has_previous.insert(*to, true);
    });
    // Open lines from their beginnings, then closed ones from any of theirs.
    let starts = order.iter().filter(|at| !has_previous.contains_key(*at)).chain(&order);
    let mut lines = Vec::new();
    for &start in starts {
        let mut line = Vec::new();
        let mut at = start;
        while let Some(to) = next.remove(&at) {
            line.push(points[&at]);
            at = to;
        }
        if !line.is_empty() {
            line.push(points[&at]);
            lines.push(line);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_has_one_closed_line_around_it() {
        let value = |x: u32, y: u32| (DVec2::new(x.into(), y.into()) - 10.0).length() - 6.5;
        let lines = contours([21, 21], value);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0][0], lines[0][lines[0].len() - 1]);
        assert!(lines[0].iter().all(|p| ((*p - 10.0).length() - 6.5).abs() < 0.05));
        let area: f64 = lines[0].windows(2).map(|w| w[0].perp_dot(w[1]) * 0.5).sum();
        assert!((area / (std::f64::consts::PI * 42.25) - 1.0).abs() < 0.01, "{area}");
        // Cut by the border, it is open.
        let lines = contours([10, 21], value);
        assert!(lines.len() == 1 && lines[0][0] != lines[0][lines[0].len() - 1]);
    }
}
