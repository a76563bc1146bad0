//! Rotations with the same bits on every platform.

use glam::{DMat3, DVec3};

/// The right-handed rotation by `angle` radians about the unit vector `axis` (Rodrigues' formula).
#[must_use]
pub fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let turn = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    DMat3::from_cols(turn(DVec3::X), turn(DVec3::Y), turn(DVec3::Z))
}

/// A right-handed frame whose z axis is the unit vector `z`; x and y are arbitrary (Duff et al. 2017, by `glam`).
#[must_use]
pub fn frame_along(z: DVec3) -> DMat3 {
    let (x, y) = z.any_orthonormal_pair();
    DMat3::from_cols(x, y, z)
}

/// The unit vector `direction` rotated towards the unit vector `target` by `angle` radians, but not past it.
#[must_use]
pub fn rotated_toward(direction: DVec3, target: DVec3, angle: f64) -> DVec3 {
    let between = libm::acos(direction.dot(target).clamp(-1.0, 1.0));
    if between <= angle {
        return target;
    }
    // Opposite to the target the axis is arbitrary.
    let axis = direction.cross(target).normalize_or(direction.any_orthonormal_vector());
    (rotation(axis, angle) * direction).normalize_or(direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_stop_at_their_target() {
        let turned = rotated_toward(DVec3::X, DVec3::NEG_Z, 0.3);
        assert!((libm::acos(turned.dot(DVec3::X)) - 0.3).abs() < 1e-12 && turned.z < 0.0);
        assert_eq!(rotated_toward(DVec3::X, DVec3::NEG_Z, 2.0), DVec3::NEG_Z);
        let back = rotated_toward(DVec3::Z, DVec3::NEG_Z, 0.5);
        assert!((libm::acos(back.dot(DVec3::Z)) - 0.5).abs() < 1e-12);
        assert_eq!(frame_along(DVec3::Y) * DVec3::Z, DVec3::Y);
    }
}
