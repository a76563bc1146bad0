//! The meshes that leaves and fruit share.

use earcut::Earcut;

use crate::math::{DVec2, DVec3};
use crate::model::Mesh;

/// Rings and sectors of the ball that fruit are.
const BALL: [u32; 2] = [6, 10];

/// Why an outline is no leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LeafError {
    /// There is nothing.
    #[error("the outline has no points")]
    NoPoints,
    /// It is level.
    #[error("the outline has no height")]
    NoHeight,
    /// It is a line.
    #[error("the outline encloses nothing")]
    NoArea,
}

/// A leaf's mesh from its outline, whose lowest point is the stalk: of length 1 along y, z up, folded along its middle by
/// `fold` radians.
///
/// # Errors
/// [`LeafError`].
pub fn leaf_mesh(outline: &[DVec2], fold: f64) -> Result<Mesh, LeafError> {
    let foot = outline.iter().copied().reduce(|a, b| if b.y < a.y { b } else { a }).ok_or(LeafError::NoPoints)?;
    let top = outline.iter().map(|p| p.y - foot.y).fold(0.0, f64::max);
    if top <= 0.0 {
        return Err(LeafError::NoHeight);
    }
    let mut points: Vec<DVec2> = outline.iter().map(|&p| (p - foot) / top).collect();
    points.dedup_by(|a, b| a.distance(*b) < 1e-6);
    if points.first().zip(points.last()).is_some_and(|(a, b)| points.len() > 1 && a.distance(*b) < 1e-6) {
        points.pop();
    }
    // Where the outline crosses the middle line it gets a corner, so that halves fold along it.
    let mut ring: Vec<[f64; 2]> = Vec::new();
    for (i, a) in points.iter().enumerate() {
        let b = points[(i + 1) % points.len()];
        ring.push([a.x, a.y]);
        if (a.x < 0.0) != (b.x < 0.0) && a.x != 0.0 && b.x != 0.0 {
            ring.push([0.0, a.y + (b.y - a.y) * a.x / (a.x - b.x)]);
        }
    }
    // Each half on its own: triangles must not cross the fold.
    let mut mesh = Mesh::default();
    for side in [-1.0, 1.0] {
        let half: Vec<[f64; 2]> = ring.iter().copied().filter(|p| p[0] * side >= 0.0).collect();
        let mut triangles: Vec<u32> = Vec::new();
        Earcut::new().earcut(half.iter().copied(), &[], &mut triangles);
        let first = mesh.points.len() as u32;
        let lift = |[x, y]: [f64; 2]| DVec3::new(x * libm::cos(fold), y, x.abs() * libm::sin(fold));
        mesh.points.extend(half.into_iter().map(lift));
        mesh.triangles.extend(triangles.chunks_exact(3).map(|t| [first + t[0], first + t[1], first + t[2]]));
    }
    if mesh.triangles.is_empty() {
        return Err(LeafError::NoArea);
    }
    Ok(mesh)
}

/// A ball of diameter 1 whose top is at the origin: fruit.
#[must_use]
pub fn ball_mesh() -> Mesh {
    let [rings, sectors] = BALL;
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let (sin, cos) = {
            let angle = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            (libm::sin(angle), libm::cos(angle))
        };
        for sector in 0..sectors {
            let turn = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let normal = DVec3::new(sin * libm::cos(turn), -cos, sin * libm::sin(turn));
            mesh.points.push(normal * 0.5 + DVec3::Y * 0.5);
            mesh.normals.push(normal);
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let at = |ring: u32, sector: u32| ring * sectors + sector % sectors;
            let [a, b, c, d] = [at(ring, sector), at(ring, sector + 1), at(ring + 1, sector + 1), at(ring + 1, sector)];
            mesh.triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(|t| {
                let p = t.map(|i| mesh.points[i as usize]);
                (p[1] - p[0]).cross(p[2] - p[0]).length() > 1e-9
            }));
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_become_folded_leaves() {
        let diamond = [[5.0, 1.0], [7.0, 4.0], [5.0, 9.0], [3.0, 4.0]].map(|[x, y]| DVec2::new(x, y));
        let mesh = leaf_mesh(&diamond, 0.5).unwrap();
        assert_eq!(mesh.triangles.len(), 2);
        let high = mesh.points.iter().map(|p| p.y).fold(0.0, f64::max);
        assert!((high - 1.0).abs() < 1e-12 && mesh.points.contains(&DVec3::ZERO));
        assert!(mesh.points.iter().all(|p| (p.z - p.x.abs() * libm::tan(0.5)).abs() < 1e-12));
        // The outline's area, and the same side up all over.
        let area: f64 = mesh
            .triangles
            .iter()
            .map(|t| {
                let p = t.map(|i| mesh.points[i as usize]);
                let across = (p[1] - p[0]).cross(p[2] - p[0]);
                assert!(across.z > 0.0);
                across.length() * 0.5
            })
            .sum();
        assert!((area - 16.0 / 64.0).abs() < 1e-9, "{area}");
        assert!(leaf_mesh(&[DVec2::ZERO, DVec2::X], 0.0).is_err());
    }

    #[test]
    fn a_ball_is_closed() {
        let mesh = ball_mesh();
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|t| {
                let p = t.map(|i| mesh.points[i as usize]);
                p[0].dot(p[1].cross(p[2])) / 6.0
            })
            .sum();
        assert!((0.4..0.53).contains(&volume.abs()), "{volume}");
    }
}
