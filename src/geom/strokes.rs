//! Strokes of a sketch: polylines, and the distance to the nearest of them.

use super::{Bounds, segment_distance};
use crate::math::DVec3;

/// Segments that share a bounding box.
const GROUP: usize = 16;

/// Polylines with a fast distance query.
#[derive(Clone, Debug, PartialEq)]
pub struct Strokes {
    lines: Vec<Vec<DVec3>>,
    groups: Vec<(Bounds, Vec<[DVec3; 2]>)>,
}

impl Strokes {
    /// Strokes along `lines`; a line of a single point is a point.
    #[must_use]
    pub fn new(lines: Vec<Vec<DVec3>>) -> Self {
        let groups = lines
            .iter()
            .flat_map(|line| {
                let segments: Vec<[DVec3; 2]> = match line[..] {
                    [point] => vec![[point, point]],
                    _ => line.windows(2).map(|w| [w[0], w[1]]).collect(),
                };
                segments.chunks(GROUP).map(<[_]>::to_vec).collect::<Vec<_>>()
            })
            .map(|group| {
                let bounds = Bounds::of_points(group.iter().flatten().copied());
                (bounds, group)
            })
            .collect();
        Self { lines, groups }
    }

    /// The polylines.
    #[must_use]
    pub fn lines(&self) -> &[Vec<DVec3>] {
        &self.lines
    }

    /// Distance of `p` from the nearest stroke; infinite without strokes.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        self.groups.iter().fold(f64::INFINITY, |nearest, (bounds, group)| {
            if bounds.distance(p) >= nearest {
                return nearest;
            }
            group.iter().map(|&[a, b]| segment_distance(p, a, b)).fold(nearest, f64::min)
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn groups_do_not_change_the_distance(
            line in prop::collection::vec((-9.0..9.0, -9.0..9.0), 1..60), x in -20.0..20.0, y in -20.0..20.0
        ) {
            let line: Vec<_> = line.into_iter().map(|(x, y)| DVec3::new(x, y, 0.0)).collect();
            let p = DVec3::new(x, y, 0.0);
            let nearest = line.windows(2).map(|w| segment_distance(p, w[0], w[1])).fold((p - line[0]).length(), f64::min);
            prop_assert_eq!(Strokes::new(vec![line]).distance(p), nearest);
        }
    }
}
