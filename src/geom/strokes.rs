//! Strokes of a sketch: polylines, and the distance to the nearest of them.

use super::{Bounds, segment_distance_squared};
use crate::math::DVec3;

/// Segments that share a bounding box, and boxes that share one.
const GROUP: usize = 4;

/// Polylines with a fast distance query.
#[derive(Clone, Debug, PartialEq)]
pub struct Strokes {
    lines: Vec<Vec<DVec3>>,
    segments: Vec<[DVec3; 2]>,
    /// Boxes about [`GROUP`] segments each, then about as many of these, and so on up to one.
    boxes: Vec<Vec<Bounds>>,
}

impl Strokes {
    /// Strokes along `lines`; a line of a single point is a point.
    #[must_use]
    pub fn new(lines: Vec<Vec<DVec3>>) -> Self {
        let segments: Vec<[DVec3; 2]> = lines
            .iter()
            .flat_map(|line| match line[..] {
                [point] => vec![[point, point]],
                _ => line.windows(2).map(|w| [w[0], w[1]]).collect(),
            })
            .collect();
        let about = |group: &[[DVec3; 2]]| Bounds::of_points(group.iter().flatten().copied());
        let mut boxes = vec![segments.chunks(GROUP).map(about).collect::<Vec<_>>()];
        while let Some(below) = boxes.last().filter(|below| below.len() > 1) {
            boxes.push(
                below.chunks(GROUP).map(|group| group.iter().copied().fold(Bounds::EMPTY, Bounds::union)).collect(),
            );
        }
        Self { lines, segments, boxes }
    }

    /// The polylines.
    #[must_use]
    pub fn lines(&self) -> &[Vec<DVec3>] {
        &self.lines
    }

    /// Distance of `p` from the nearest stroke; infinite without strokes.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        if self.segments.is_empty() {
            f64::INFINITY
        } else {
            libm::sqrt(self.nearer(p, self.boxes.len(), 0, f64::INFINITY))
        }
    }

    /// The square of the distance of `p` from what is below a box of a level, or from segments below level 0, where that is
    /// less than `nearest`.
    fn nearer(&self, p: DVec3, level: usize, number: usize, nearest: f64) -> f64 {
        let first = number * GROUP;
        let Some(level) = level.checked_sub(1) else {
            let group = &self.segments[first..self.segments.len().min(first + GROUP)];
            return group.iter().map(|&[a, b]| segment_distance_squared(p, a, b)).fold(nearest, f64::min);
        };
        let group = &self.boxes[level][first..self.boxes[level].len().min(first + GROUP)];
        let mut near = [(f64::INFINITY, 0); GROUP];
        near.iter_mut().zip(group).zip(first..).for_each(|((near, bounds), i)| *near = (bounds.distance_squared(p), i));
        let near = &mut near[..group.len()];
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        // The nearest box first: most of the others are then beyond what it found.
        near.iter().fold(
            nearest,
            |nearest, &(least, i)| {
                if least < nearest { self.nearer(p, level, i, nearest) } else { nearest }
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geom::segment_distance;

    proptest! {
        #[test]
        fn groups_do_not_change_the_distance(
            lines in prop::collection::vec(prop::collection::vec((-9.0..9.0, -9.0..9.0), 1..60), 0..4),
            x in -20.0..20.0, y in -20.0..20.0
        ) {
            let at = |(x, y)| DVec3::new(x, y, 0.0);
            let lines: Vec<Vec<_>> = lines.into_iter().map(|line| line.into_iter().map(at).collect()).collect();
            let p = at((x, y));
            let pairs = lines.iter().flat_map(|line| line.windows(2).map(|w| (w[0], w[1])).chain([(line[0], line[0])]));
            let nearest = pairs.map(|(a, b)| segment_distance(p, a, b)).fold(f64::INFINITY, f64::min);
            let found = Strokes::new(lines).distance(p);
            // But for rounding.
            prop_assert!(found == nearest || (found - nearest).abs() < 1e-12, "{found} {nearest}");
        }
    }
}
