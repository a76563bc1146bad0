//! Contours of a sampled function by marching squares.

use std::collections::{HashMap, HashSet};

use crate::math::DVec2;

/// The zero contours of `value` on a grid of `size` samples, in grid steps, with negative values on their left. Closed contours
/// end at their first point. Squares with a NaN are left out.
///
/// In an ambiguous square, with two opposite negative corners, each corner is cut off separately.
#[must_use]
pub fn contours(size: [u32; 2], value: impl Fn(u32, u32) -> f64) -> Vec<Vec<DVec2>> {
    let inside = |x: u32, y: u32| {
        let value = value(x, y);
        (!value.is_nan()).then_some(value < 0.0)
    };
    trace(size, inside, |from, to| {
        let (a, b) = (value(from[0], from[1]), value(to[0], to[1]));
        position(from) + (position(to) - position(from)) * (a / (a - b))
    })
}

/// The closed contours around the samples inside on a grid of `size` samples; beyond the grid everything is outside.
/// `crossing` is the distance of the contour from a sample inside, as a share of the step to its neighbour outside: along an
/// axis, upwards (`true`) or downwards.
#[must_use]
pub fn rings(
    size: [u32; 2],
    is_inside: impl Fn(u32, u32) -> bool,
    crossing: impl Fn([u32; 2], usize, bool) -> f64,
) -> Vec<Vec<DVec2>> {
    // Padded by one sample: those of the grid start at 1.
    let inside = |x: u32, y: u32| {
        let is_there = (1..=size[0]).contains(&x) && (1..=size[1]).contains(&y);
        Some(is_there && is_inside(x - 1, y - 1))
    };
    let lines = trace(size.map(|s| s + 2), inside, |from, to| {
        let axis = usize::from(from[0] == to[0]);
        let share = crossing(from.map(|c| c - 1), axis, to[axis] > from[axis]).clamp(0.02, 0.98);
        position(from) + (position(to) - position(from)) * share - 1.0
    });
    // The last point repeats the first.
    lines.into_iter().map(|mut line| line.split_off(1)).collect()
}

fn position(at: [u32; 2]) -> DVec2 {
    DVec2::new(at[0].into(), at[1].into())
}

/// The contours between samples inside and outside, `None` for no value; `crossing` is a contour's point between a sample
/// inside and a neighbour outside.
fn trace(
    size: [u32; 2],
    inside: impl Fn(u32, u32) -> Option<bool>,
    crossing: impl Fn([u32; 2], [u32; 2]) -> DVec2,
) -> Vec<Vec<DVec2>> {
    // The successor of each crossing. A crossing is identified by its edge: the lower sample and the axis.
    let mut next: HashMap<[u32; 3], [u32; 3]> = HashMap::new();
    let mut points: HashMap<[u32; 3], DVec2> = HashMap::new();
    let mut order = Vec::new();
    for y in 0..size[1].saturating_sub(1) {
        for x in 0..size[0].saturating_sub(1) {
            let corners = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
            let [Some(a), Some(b), Some(c), Some(d)] = corners.map(|[x, y]| inside(x, y)) else { continue };
            let is_in = [a, b, c, d];
            let mut cross = |i: usize, from: [u32; 2], to: [u32; 2]| {
                let (a, b) = (corners[i % 4], corners[(i + 1) % 4]);
                let name = [a[0].min(b[0]), a[1].min(b[1]), u32::from(a[0] == b[0])];
                points.entry(name).or_insert_with(|| crossing(from, to));
                name
            };
            for i in 0..4 {
                if !is_in[i] && is_in[(i + 1) % 4] {
                    let last = i + (1..4).find(|&j| !is_in[(i + 1 + j) % 4]).unwrap_or(3);
                    let enters = cross(i, corners[(i + 1) % 4], corners[i]);
                    let leaves = cross(last, corners[last % 4], corners[(last + 1) % 4]);
                    // The inside is on the left.
                    next.insert(leaves, enters);
                    order.push(leaves);
                }
            }
        }
    }
    let reached: HashSet<[u32; 3]> = next.values().copied().collect();
    // Open contours from their first points, then closed ones from any crossing.
    let starts = order.iter().filter(|at| !reached.contains(*at)).chain(&order);
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

    #[test]
    fn rings_run_around_what_is_inside() {
        // Two squares that touch at a corner, and a hole.
        let is_inside = |x: u32, y: u32| (x < 4 && y < 4 && (x, y) != (1, 1)) || (x >= 4 && y >= 4);
        let rings = rings([6, 6], is_inside, |_, _, _| 0.5);
        let area = |ring: &Vec<DVec2>| {
            let after = ring.iter().cycle().skip(1);
            ring.iter().zip(after).map(|(a, b)| a.perp_dot(*b) * 0.5).sum::<f64>()
        };
        let mut areas: Vec<f64> = rings.iter().map(area).collect();
        areas.sort_by(f64::total_cmp);
        // Half a square of the grid is cut off at each corner: an eighth.
        assert_eq!(areas, [-0.5, 3.5, 15.5]);
    }
}
