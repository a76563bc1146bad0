//! Where objects stand in the world.

use crate::math::{DVec3, Degrees};

/// A place where an object stands: first scaled, then turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Where its foot is in the world.
    pub at: DVec3,
    /// Angle about the vertical, counterclockwise seen from above, in degrees.
    pub turn: f64,
    /// Its size over the declared one, above 0.
    pub scale: f64,
}

impl Instance {
    /// Neither turned nor scaled.
    #[must_use]
    pub fn at(at: DVec3) -> Self {
        Self { at, turn: 0.0, scale: 1.0 }
    }

    /// A direction in the world from the object's own.
    #[must_use]
    pub fn turned(&self, d: DVec3) -> DVec3 {
        if self.turn == 0.0 {
            return d;
        }
        let turn = Degrees(self.turn).radians();
        let (sin, cos) = (libm::sin(turn), libm::cos(turn));
        DVec3::new(d.x * cos - d.y * sin, d.x * sin + d.y * cos, d.z)
    }

    /// A direction in the object's own space from the world's.
    #[must_use]
    pub fn unturned(&self, d: DVec3) -> DVec3 {
        Self { turn: -self.turn, ..*self }.turned(d)
    }

    /// A point in the world from the object's own.
    #[must_use]
    pub fn to_world(&self, p: DVec3) -> DVec3 {
        self.at + self.turned(p * self.scale)
    }

    /// A point in the object's own space from the world's.
    #[must_use]
    pub fn to_object(&self, p: DVec3) -> DVec3 {
        self.unturned(p - self.at) / self.scale
    }
}
