//! What a plant looks like from far away: few triangles, which cover as much.
//!
//! After Cook et al., *Stochastic Simplification of Aggregate Detail* (2007): of what is small and many a part stays, the wider for it.

use crate::geom::Bounds;
use crate::math::DVec3;
use crate::model::{Instance, Limbs, Mesh, Pose};

/// The thickest pieces of limbs, which stay as they are, and of the others as many as stay.
const THICK: usize = 300;
const THIN: usize = 700;
/// Pieces of a limb become one within this share of the plant's size.
const COARSE: f64 = 0.01;
/// Sides of what limbs become.
const SIDES: u32 = 5;
/// Leaves, and triangles of other meshes, that stay.
const LEAVES: usize = 9000;
/// No piece of a limb is wider than this share of its length.
const WIDEST: f64 = 0.06;

/// Adds limbs that stand at `place` to `mesh`, which has normals: tubes of few sides.
pub fn distant_limbs(limbs: &Limbs, place: &Instance, mesh: &mut Mesh) {
    let limbs = &limbs.within(size(limbs) * COARSE);
    let ball = |i: u32| &limbs.balls[i as usize];
    let mut pieces: Vec<[u32; 2]> = limbs.segments.clone();
    pieces.sort_by(|a, b| ball(b[1]).radius.total_cmp(&ball(a[1]).radius));
    let (thick, thin) = pieces.split_at(pieces.len().min(THICK));
    let step = thin.len().div_ceil(THIN).max(1);
    let few = thin.iter().step_by(step).map(|piece| (piece, step as f64));
    for (&[a, b], wider) in thick.iter().map(|piece| (piece, 1.0)).chain(few) {
        let (a, b) = (ball(a), ball(b));
        let most = if wider > 1.0 { a.centre.distance(b.centre) * WIDEST } else { f64::INFINITY };
        let [ra, rb] = [a, b].map(|ball| (ball.radius * wider).min(most).max(ball.radius) * place.scale);
        tube(place.to_world(a.centre), ra, place.to_world(b.centre), rb, mesh);
    }
}

/// Adds a tube without ends.
fn tube(a: DVec3, ra: f64, b: DVec3, rb: f64, mesh: &mut Mesh) {
    let along = (b - a).normalize_or(DVec3::Z);
    let side = along.any_orthonormal_vector();
    let other = along.cross(side);
    let first = mesh.points.len() as u32;
    for i in 0..SIDES {
        let turn = f64::from(i) / f64::from(SIDES) * std::f64::consts::TAU;
        let way = side * libm::cos(turn) + other * libm::sin(turn);
        mesh.points.extend([a + way * ra, b + way * rb]);
        mesh.normals.extend([way; 2]);
        let [low, next] = [i, (i + 1) % SIDES].map(|side| first + 2 * side);
        mesh.triangles.extend([[low, next, next + 1], [low, next + 1, low + 1]]);
    }
}

/// Adds every `step`th of the leaves that stand at `poses` within `place` to `mesh`: kites of as much area as all.
pub fn distant_leaves(leaf: &Mesh, poses: &[Pose], step: usize, place: &Instance, mesh: &mut Mesh) {
    let length = leaf.points.iter().map(|p| p.y).fold(0.0, f64::max);
    let width = if length > 0.0 { 2.0 * area(leaf) / length } else { 0.0 };
    let size = libm::sqrt(step as f64);
    let half = DVec3::X * (width * 0.5);
    let middle = DVec3::Y * (length * 0.5);
    let kite = [-middle, half, middle, -half].map(|p| p * size + middle);
    for pose in poses.iter().step_by(step) {
        let first = mesh.points.len() as u32;
        mesh.points.extend(kite.map(|p| place.to_world(pose.to_object(p))));
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
}

/// Adds every `step`th of the triangles of a mesh that stands at `place` to `mesh`, which has normals: each as large as those that it
/// stands for.
pub fn distant_triangles(from: &Mesh, step: usize, place: &Instance, mesh: &mut Mesh) {
    let size = libm::sqrt(step as f64);
    for corners in from.triangles.iter().step_by(step) {
        let first = mesh.points.len() as u32;
        let [a, b, c] = corners.map(|i| from.points[i as usize]);
        let middle = (a + b + c) / 3.0;
        let normal = place.turned((b - a).cross(c - a)).normalize_or(DVec3::Z);
        mesh.points.extend([a, b, c].map(|p| place.to_world(middle + (p - middle) * size)));
        mesh.normals.extend([normal; 3]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
}

/// Which of `count` leaves or triangles stay: every so manyeth.
#[must_use]
pub fn distant_step(count: usize) -> usize {
    count.div_ceil(LEAVES).max(1)
}

/// The greatest extent of where limbs are.
fn size(limbs: &Limbs) -> f64 {
    let points = limbs.balls.iter().map(|ball| Bounds::of_ball(ball.centre, 0.0));
    let bounds = points.fold(Bounds::EMPTY, Bounds::union);
    if bounds.is_empty() { 0.0 } else { bounds.size().max_element() }
}

fn area(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles.iter().map(|t| t.map(|i| mesh.points[i as usize]));
    corners.map(|[a, b, c]| (b - a).cross(c - a).length() * 0.5).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DMat3;
    use crate::model::Ball;

    #[test]
    fn few_leaves_cover_as_much_as_all() {
        let leaf = Mesh {
            points: vec![DVec3::ZERO, DVec3::new(0.3, 0.4, 0.0), DVec3::Y, DVec3::new(-0.2, 0.5, 0.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let poses: Vec<Pose> =
            (0..12_000).map(|i| Pose::new(DVec3::X * f64::from(i), DMat3::from_diagonal(DVec3::splat(0.5)))).collect();
        let step = distant_step(poses.len());
        let mut mesh = Mesh::default();
        let place = Instance { at: DVec3::Z, turn: 30.0, scale: 2.0 };
        distant_leaves(&leaf, &poses, step, &place, &mut mesh);
        assert_eq!((step, mesh.triangles.len()), (2, 12000));
        let whole = area(&leaf) * 12_000.0;
        assert!((area(&mesh) / whole - 1.0).abs() < 1e-6);
        let mut fewer = Mesh::default();
        distant_triangles(&mesh, 4, &place, &mut fewer);
        assert!((area(&fewer) / (4.0 * whole) - 1.0).abs() < 1e-6 && fewer.triangles.len() == 3000);
    }

    #[test]
    fn thick_limbs_stay_as_they_are() {
        let ball = |x: f64, z: f64, radius| {
            let centre = DVec3::new(x, libm::sin(z) * x.min(1.0), z);
            Ball { centre, radius, cost: 0.0, branch: 0, level: 0 }
        };
        // A straight trunk, and crooked twigs from its top.
        let mut balls = vec![ball(0.0, 0.0, 0.5), ball(0.0, 50.0, 0.5), ball(0.0, 100.0, 0.5)];
        let mut segments = vec![[0, 1], [1, 2]];
        for twig in 0..3000_u32 {
            let (x, first) = (f64::from(twig % 60) * 2.0, balls.len() as u32);
            balls.extend([ball(x, 110.0, 0.002), ball(x + 4.0, 120.0, 0.001)]);
            segments.extend([[2, first], [first, first + 1]]);
        }
        let limbs = Limbs { balls, segments, ..Limbs::default() };
        let mut mesh = Mesh::default();
        distant_limbs(&limbs, &Instance::at(DVec3::ZERO), &mut mesh);
        assert!(mesh.triangles.len() <= 10 * (THICK + THIN) && mesh.triangles.len() > 10 * THICK);
        let near = |z: f64| mesh.points.iter().filter(move |p| (p.z - z).abs() < 1.0);
        // The trunk in one piece, as wide as it was; twigs wider, since fewer.
        assert!(near(0.0).all(|p| (p.truncate().length() - 0.5).abs() < 1e-9) && near(50.0).count() == 0);
        assert!(near(100.0).any(|p| (p.truncate().length() - 0.5).abs() < 1e-9));
        assert_eq!(mesh.points.len(), mesh.normals.len());
    }
}
