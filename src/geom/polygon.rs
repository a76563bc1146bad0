//! Polygons with holes, cut into triangles.

use earcut::Earcut;

use super::Surface;
use crate::math::{DVec2, DVec3};

/// The edges of a closed polyline, the last one to its first point.
fn edges(ring: &[DVec2]) -> impl Iterator<Item = (&DVec2, &DVec2)> {
    ring.iter().zip(ring.iter().cycle().skip(1))
}

/// Twice the signed area, positive where the ring is counterclockwise (the shoelace formula).
fn double_area(ring: &[DVec2]) -> f64 {
    edges(ring).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

/// Is `p` inside `ring`, by the even-odd rule?
fn contains(ring: &[DVec2], p: DVec2) -> bool {
    let crosses =
        |(a, b): (&DVec2, &DVec2)| (a.y <= p.y) != (b.y <= p.y) && a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x;
    edges(ring).filter(|&edge| crosses(edge)).count() % 2 == 1
}

/// Triangulates the polygons that `rings` bound: outer rings are counterclockwise, holes clockwise (ear clipping).
#[must_use]
pub fn fill(rings: &[Vec<DVec2>]) -> Surface {
    let (outer, holes): (Vec<&Vec<DVec2>>, Vec<&Vec<DVec2>>) = rings.iter().partition(|ring| double_area(ring) > 0.0);
    // A hole belongs to the smallest ring around it.
    let owner = |hole: &[DVec2]| {
        let around = (0..outer.len()).filter(|&i| contains(outer[i], hole[0]));
        around.min_by(|&a, &b| double_area(outer[a]).total_cmp(&double_area(outer[b])))
    };
    let mut owned: Vec<Vec<&Vec<DVec2>>> = vec![Vec::new(); outer.len()];
    for hole in holes {
        if let Some(owner) = owner(hole) {
            owned[owner].push(hole);
        }
    }
    let mut surface = Surface::default();
    for (ring, holes) in outer.iter().zip(owned) {
        let mut points: Vec<[f64; 2]> = ring.iter().map(|p| p.to_array()).collect();
        let mut starts: Vec<u32> = Vec::new();
        for hole in holes {
            starts.push(points.len() as u32);
            points.extend(hole.iter().map(|p| p.to_array()));
        }
        let mut triangles: Vec<u32> = Vec::new();
        Earcut::new().earcut(points.iter().copied(), &starts, &mut triangles);
        let first = surface.points.len() as u32;
        surface.points.extend(points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)));
        surface.triangles.extend(triangles.chunks_exact(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
    }
    surface
}
