//! Turf: a mesh of blades of grass, to stand in many places.

use rand::RngExt;

use crate::math::{DVec3, Stream};
use crate::model::Mesh;

/// Blades of a piece of turf.
const BLADES: u32 = 240;
/// Width of a blade at its foot, as a share of its length.
const WIDTH: f64 = 0.05;
/// A blade bends over in so many pieces, each leaning further: four fifths of the way up it leans by about a right angle's half.
const PIECES: u32 = 3;

/// Blades of length 1 at most on a square of this side, as long again, about the origin; z is up. `stream` is theirs alone.
#[must_use]
pub fn turf(side: f64, stream: &Stream) -> Mesh {
    let mut mesh = Mesh::default();
    let mut random = stream.clone();
    for _ in 0..BLADES {
        let [x, y, turn, length, lean, curl]: [f64; 6] = std::array::from_fn(|_| random.random());
        let foot = DVec3::new((x - 0.5) * side, (y - 0.5) * side, 0.0);
        let turn = turn * std::f64::consts::TAU;
        let way = DVec3::new(libm::cos(turn), libm::sin(turn), 0.0);
        blade(&mut mesh, foot, way, 0.45 + 0.55 * length, [0.05 + 0.35 * lean, 0.15 + 0.35 * curl]);
    }
    mesh
}

/// Adds a blade that leans towards `way`, by the first angle at its foot and by the second more with each piece, in radians.
fn blade(mesh: &mut Mesh, foot: DVec3, way: DVec3, length: f64, [lean, curl]: [f64; 2]) {
    let across = DVec3::new(-way.y, way.x, 0.0) * (WIDTH * 0.5);
    let first = mesh.points.len() as u32;
    let mut at = foot;
    for piece in 0..PIECES {
        let width = 1.0 - f64::from(piece) / f64::from(PIECES) * 0.6;
        mesh.points.extend([at - across * width, at + across * width]);
        let angle = lean + curl * f64::from(piece);
        at += (way * libm::sin(angle) + DVec3::Z * libm::cos(angle)) * (length / f64::from(PIECES));
    }
    mesh.points.push(at);
    for piece in 0..PIECES - 1 {
        let a = first + 2 * piece;
        mesh.triangles.extend([[a, a + 1, a + 3], [a, a + 3, a + 2]]);
    }
    let a = first + 2 * (PIECES - 1);
    mesh.triangles.push([a, a + 1, a + 2]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blades_stand_on_their_square() {
        let mesh = turf(4.0, &Stream::new(1, "turf"));
        assert_eq!((mesh.points.len(), mesh.triangles.len()), (240 * 7, 240 * 5));
        assert!(mesh.points.iter().all(|p| (0.0..=1.0).contains(&p.z) && p.truncate().abs().max_element() < 3.0));
        let tips = mesh.points.chunks(7).map(|blade| blade[6].z);
        assert!(tips.clone().all(|z| z > 0.3) && tips.fold(0.0, f64::max) > 0.85);
    }
}
