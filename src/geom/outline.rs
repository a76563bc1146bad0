//! Outlines of the plane: letters and painted masks.

use super::shape::segment_distance;
use super::{Bounds, Strokes};
use crate::math::{DVec2, DVec3};

/// What closed outlines enclose.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    strokes: Strokes,
    bounds: Bounds,
    /// Edges by the row of heights that they cross.
    rows: Vec<Vec<[DVec2; 2]>>,
    row: f64,
}

/// Rows for each outline's edge, about: each is crossed by few.
const EDGES_PER_ROW: usize = 2;
/// Most rows.
const MOST_ROWS: usize = 4096;

impl Outline {
    /// What `rings`, closed polylines whose last point need not repeat the first, wind around (not by turns that cancel each
    /// other: a hole runs the other way).
    ///
    /// # Errors
    /// A sentence where they enclose nothing.
    pub fn new(rings: &[Vec<DVec2>]) -> Result<Self, String> {
        let mut bounds = Bounds::EMPTY;
        let mut edges = Vec::new();
        let mut lines = Vec::new();
        for ring in rings.iter().filter(|ring| ring.len() > 2) {
            let mut line: Vec<DVec3> = ring.iter().map(|p| p.extend(0.0)).collect();
            line.push(line[0]);
            bounds = line.iter().fold(bounds, |b, &p| b.union(Bounds { min: p, max: p }));
            edges.extend(line.windows(2).map(|w| [w[0].truncate(), w[1].truncate()]));
            lines.push(line);
        }
        let size = bounds.size();
        if edges.is_empty() || size.x <= 0.0 || size.y <= 0.0 || !size.is_finite() {
            return Err("it encloses nothing".to_owned());
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

    /// A box around it, flat.
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
        // How often the edges to the right wind around it.
        let wind = |[a, b]: &[DVec2; 2]| {
            if (a.y <= p.y) == (b.y <= p.y) {
                return 0;
            }
            let cross = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
            if a.y <= p.y { i32::from(cross > 0.0) } else { -i32::from(cross < 0.0) }
        };
        self.rows[(row as usize).min(self.rows.len() - 1)].iter().map(wind).sum::<i32>() != 0
    }

    /// Signed distance from the outline, negative inside.
    #[must_use]
    pub fn distance(&self, p: DVec2) -> f64 {
        let distance = self.strokes.distance(p.extend(0.0));
        if self.contains(p) { -distance } else { distance }
    }
}

/// Fewer points along a polyline: those within `slack` of what is left go (Ramer 1972; Douglas and Peucker 1973).
#[must_use]
pub fn simplified(line: &[DVec2], slack: f64) -> Vec<DVec2> {
    let mut keep = vec![false; line.len()];
    let mut parts = vec![(0, line.len().saturating_sub(1))];
    for &i in [0, line.len().saturating_sub(1)].iter().filter(|_| !line.is_empty()) {
        keep[i] = true;
    }
    while let Some((from, to)) = parts.pop() {
        let off = |i: usize| segment_distance(line[i].extend(0.0), line[from].extend(0.0), line[to].extend(0.0));
        let farthest = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)));
        if let Some(farthest) = farthest.filter(|&i| off(i) > slack) {
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
