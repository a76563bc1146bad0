//! Rotations with the same bits on every platform.

use glam::{DMat3, DVec3};

/// The rotation by `angle` radians about `axis`, of length 1, counterclockwise seen against it (Rodrigues).
#[must_use]
pub fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let turn = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    DMat3::from_cols(turn(DVec3::X), turn(DVec3::Y), turn(DVec3::Z))
}

/// A rotation that takes z to `way`, of length 1.
#[must_use]
pub fn frame_along(way: DVec3) -> DMat3 {
    let (x, y) = way.any_orthonormal_pair();
    DMat3::from_cols(x, y, way)
}

/// `way`, of length 1, turned towards `target`, of length 1, by `angle` radians or until it is there.
#[must_use]
pub fn turned_toward(way: DVec3, target: DVec3, angle: f64) -> DVec3 {
    let between = libm::acos(way.dot(target).clamp(-1.0, 1.0));
    if between <= angle {
        return target;
    }
    // Straight away from the target any axis will do.
    let axis = way.cross(target).normalize_or(way.any_orthonormal_vector());
    (rotation(axis, angle) * way).normalize_or(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_stop_at_their_target() {
        let way = turned_toward(DVec3::X, DVec3::NEG_Z, 0.3);
        assert!((libm::acos(way.dot(DVec3::X)) - 0.3).abs() < 1e-12 && way.z < 0.0);
        assert_eq!(turned_toward(DVec3::X, DVec3::NEG_Z, 2.0), DVec3::NEG_Z);
        let back = turned_toward(DVec3::Z, DVec3::NEG_Z, 0.5);
        assert!((libm::acos(back.dot(DVec3::Z)) - 0.5).abs() < 1e-12);
        assert_eq!(frame_along(DVec3::Y) * DVec3::Z, DVec3::Y);
    }
}
