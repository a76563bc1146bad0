//! Terrain: ground with a relief as a mesh, the finer, the nearer to the middle.

use crate::math::DVec3;
use crate::model::Mesh;

/// Corners around the middle.
const SECTORS: u32 = 192;

/// The mesh of a ground of this radius about the origin, where it is `least` fine and `height` high, z up; its cells are about square.
#[must_use]
pub fn terrain(radius: f64, least: f64, height: impl Fn(f64, f64) -> f64) -> Mesh {
    let corner = |x: f64, y: f64| DVec3::new(x, y, height(x, y));
    let turn = std::f64::consts::TAU / f64::from(SECTORS);
    let ways: Vec<[f64; 2]> =
        (0..SECTORS).map(|i| f64::from(i) * turn).map(|angle| [libm::cos(angle), libm::sin(angle)]).collect();
    let mut mesh = Mesh { points: vec![corner(0.0, 0.0)], ..Mesh::default() };
    let mut at = least;
    loop {
        let r = at.min(radius);
        mesh.points.extend(ways.iter().map(|[x, y]| corner(r * x, r * y)));
        if at >= radius {
            break;
        }
        at *= 1.0 + turn;
    }
    let rings = (mesh.points.len() as u32 - 1) / SECTORS;
    let name = |ring: u32, i: u32| 1 + ring * SECTORS + i % SECTORS;
    mesh.triangles.extend((0..SECTORS).map(|i| [0, name(0, i), name(0, i + 1)]));
    for ring in 1..rings {
        for i in 0..SECTORS {
            let [a, b, c, d] = [name(ring - 1, i), name(ring, i), name(ring, i + 1), name(ring - 1, i + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.smooth();
    mesh
}

/// Bytes that [`terrain`] takes.
#[must_use]
pub fn terrain_bytes(radius: f64, least: f64) -> u64 {
    let turn = std::f64::consts::TAU / f64::from(SECTORS);
    let rings = (libm::log(radius / least) / libm::log(1.0 + turn)).max(0.0) as u64 + 2;
    // A corner with its normal, two triangles, and both once more while they are smoothed.
    rings * u64::from(SECTORS) * 2 * (2 * size_of::<DVec3>() + 2 * size_of::<[u32; 3]>()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_closed_up_to_its_rim_and_looks_up() {
        let mesh = terrain(50.0, 0.1, |x, y| 0.2 * libm::sin(x) * libm::cos(y));
        let mut edges = std::collections::BTreeMap::new();
        for [a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        let rim = edges.values().filter(|&&sum| sum != 0).count();
        assert_eq!(rim, SECTORS as usize);
        assert!(mesh.normals.iter().all(|n| n.z > 0.7) && mesh.normals.len() == mesh.points.len());
        let far = mesh.points.iter().map(|p| p.truncate().length()).fold(0.0, f64::max);
        assert!((far - 50.0).abs() < 1e-9);
        assert!(mesh.bytes() as u64 <= terrain_bytes(50.0, 0.1));
    }
}
