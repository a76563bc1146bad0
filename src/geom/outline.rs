//! Outlines of the plane: letters and painted masks.

use super::{Bounds, Strokes, segment_distance};
use crate::math::{DVec2, DVec3};

/// Why outlines bound no region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OutlineError {
    /// There is no ring, or it has no area.
    #[error("it encloses nothing")]
    Empty,
}

/// The region that closed polylines enclose, by the non-zero winding rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    strokes: Strokes,
    bounds: Bounds,
    /// The edges that cross each horizontal band.
    rows: Vec<Vec<[DVec2; 2]>>,
    /// Height of a band.
    row: f64,
}

/// Edges for each band, on average.
const EDGES_PER_ROW: usize = 2;
/// Most bands.
const MOST_ROWS: usize = 4096;

impl Outline {
    /// The points about which the winding number of `rings` is not 0: a hole runs in the opposite direction. The last point
    /// of a ring need not repeat the first.
    ///
    /// # Errors
    /// [`OutlineError`].
    pub fn new(rings: &[Vec<DVec2>]) -> Result<Self, OutlineError> {
        let mut bounds = Bounds::EMPTY;
        let mut edges = Vec::new();
        let mut lines = Vec::new();
        for ring in rings.iter().filter(|ring| ring.len() > 2) {
            let mut line: Vec<DVec3> = ring.iter().map(|p| p.extend(0.0)).collect();
            line.push(line[0]);
            bounds = line.iter().copied().fold(bounds, Bounds::with_point);
            edges.extend(line.windows(2).map(|w| [w[0].truncate(), w[1].truncate()]));
            lines.push(line);
        }
        let size = bounds.size();
        if edges.is_empty() || size.x <= 0.0 || size.y <= 0.0 || !size.is_finite() {
            return Err(OutlineError::Empty);
        }
        let count = (edges.len() / EDGES_PER_ROW).clamp(1, MOST_ROWS);
        let row = size.y / count as f64;
        let mut rows = vec![Vec::new(); count];
        for edge in edges {
            let place = |y: f64| (((y - bounds.min.y) / row) as usize).min(count - 1);
            let (low, high) = (place(edge[0].y.min(edge[1].y)), place(edge[0].y.max(edge[1].y)));
            rows[low..=high].iter_mut().for_each(|row| row.push(edge));
        }
        Ok(Self { strokes: Strokes::new(lines), bounds, rows, row })
    }

    /// Its bounding box, flat along z.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Is `p` inside?
    #[must_use]
    pub fn contains(&self, p: DVec2) -> bool {
        let row = (p.y - self.bounds.min.y) / self.row;
        if row < 0.0 || p.y > self.bounds.max.y {
            return false;
        }
        // Contribution of an edge to the right of `p` to the winding number.
        let wind = |[a, b]: &[DVec2; 2]| {
            if (a.y <= p.y) == (b.y <= p.y) {
                return 0;
            }
            let cross = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
            if a.y <= p.y { i32::from(cross > 0.0) } else { -i32::from(cross < 0.0) }
        };
        self.rows[(row as usize).min(self.rows.len() - 1)].iter().map(wind).sum::<i32>() != 0
    }

    /// Signed distance of `p`, negative inside.
    #[must_use]
    pub fn distance(&self, p: DVec2) -> f64 {
        let distance = self.strokes.distance(p.extend(0.0));
        if self.contains(p) { -distance } else { distance }
    }
}

/// A polyline simplified to within `tolerance` (Ramer 1972; Douglas and Peucker 1973).
#[must_use]
pub fn simplified(line: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let mut keep = vec![false; line.len()];
    let mut parts = vec![(0, line.len().saturating_sub(1))];
    for &i in [0, line.len().saturating_sub(1)].iter().filter(|_| !line.is_empty()) {
        keep[i] = true;
    }
    while let Some((from, to)) = parts.pop() {
        let error = |i: usize| segment_distance(line[i].extend(0.0), line[from].extend(0.0), line[to].extend(0.0));
        let farthest = (from + 1..to).max_by(|&a, &b| error(a).total_cmp(&error(b)));
        if let Some(farthest) = farthest.filter(|&i| error(i) > tolerance) {
            keep[farthest] = true;
            parts.extend([(from, farthest), (farthest, to)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(&p, _)| p).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_outside() {
        let square = |r: f64| vec![DVec2::new(-r, -r), DVec2::new(r, -r), DVec2::new(r, r), DVec2::new(-r, r)];
        let mut hole = square(1.0);
        hole.reverse();
        let ring = Outline::new(&[square(3.0), hole]).unwrap();
        for (x, expected) in [(0.0, 1.0), (2.0, -1.0), (2.8, -0.2), (3.5, 0.5), (-2.0, -1.0)] {
            assert!((ring.distance(DVec2::new(x, 0.0)) - expected).abs() < 1e-12, "{x}");
        }
        assert!(Outline::new(&[vec![DVec2::ZERO; 5]]).is_err() && Outline::new(&[]).is_err());
        let line: Vec<DVec2> = (0..9).map(|i| DVec2::new(f64::from(i), if i == 4 { 2.0 } else { 0.0 })).collect();
        assert_eq!(simplified(&line, 0.1).len(), 5);
        assert_eq!(simplified(&line, 3.0).len(), 2);
    }
}
