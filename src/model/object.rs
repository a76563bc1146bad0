//! Objects: balls and the limbs between them, or a mesh; and where they stand.

use super::ThornsSpec;
use crate::geom::{Bounds, vertex_normals};
use crate::math::{DMat3, DVec3, Degrees};

/// A sphere with what was known of its place in the skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle, from the object's foot.
    pub centre: DVec3,
    /// Its radius, above 0.
    pub radius: f64,
    /// Least path cost from the generator.
    pub cost: f64,
    /// The limb that it belongs to.
    pub branch: u32,
    /// The round of growth that made it.
    pub level: u16,
}

/// Triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners, from the object's foot.
    pub points: Vec<DVec3>,
    /// A unit normal a corner, for smooth shading; empty for flat triangles.
    pub normals: Vec<DVec3>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
    /// Places in a texture of each triangle's corners: around the limb from 0 to 1, and along it in circumferences; empty
    /// where there is none.
    pub uvs: Vec<[[f64; 2]; 3]>,
}

impl Mesh {
    /// Gives each corner the normal of the triangles around it, by their area.
    pub fn smooth(&mut self) {
        self.normals = vertex_normals(&self.points, &self.triangles);
    }

    /// Every number rounded once: points with these digits.
    #[must_use]
    pub fn rounded(&self, digits: Digits) -> Self {
        Self {
            points: self.points.iter().map(|&p| digits.round_point(p)).collect(),
            normals: self.normals.iter().map(|&n| Digits(6).round_point(n)).collect(),
            triangles: self.triangles.clone(),
            uvs: self.uvs.iter().map(|uvs| uvs.map(|uv| uv.map(|x| Digits(5).round(x)))).collect(),
        }
    }
}

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

/// A place within an object where its mesh stands: turned and scaled, then moved. A leaf's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where its origin is, from the object's foot.
    pub at: DVec3,
    /// Its axes there, as long as its scale.
    pub axes: DMat3,
}

impl Pose {
    /// Rounded once, here.
    #[must_use]
    pub fn new(at: DVec3, axes: DMat3) -> Self {
        let unit = Digits(Self::DIGITS);
        let rounded = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| unit.round_point(axis));
        Self { at, axes: DMat3::from_cols(rounded[0], rounded[1], rounded[2]) }
    }

    /// Digits behind the point of its axes.
    pub const DIGITS: u32 = 7;

    /// A point of the object from the mesh's own.
    #[must_use]
    pub fn to_object(&self, p: DVec3) -> DVec3 {
        self.axes * p + self.at
    }
}

/// What a scene declares as one thing: balls, and round cones between pairs of them; or a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name in the scene.
    pub name: String,
    /// Where it stands, one or more times.
    pub instances: Vec<Instance>,
    /// Index of its material.
    pub material: usize,
    /// Spheres, from the foot.
    pub balls: Vec<Ball>,
    /// Pairs of balls joined by the frustum tangent to both ([`crate::geom::frustum`]): from the root's side, outwards.
    pub segments: Vec<[u32; 2]>,
    /// Triangles.
    pub mesh: Mesh,
    /// Where the mesh stands within the object; where there are none, once as it is.
    pub poses: Vec<Pose>,
    /// Digits behind the point of all its numbers.
    pub digits: Digits,
    /// Does it cast shadows?
    pub shadow: bool,
    /// What stands on its surface, for renderers that displace it themselves.
    pub thorns: Option<ThornsSpec>,
    /// Is it the thorns of another, which such renderers leave out?
    pub is_thorns: bool,
}

impl Object {
    /// Every ball, and every corner of its mesh as a ball without size, wherever it stands: centre, radius.
    pub fn balls_in_world(&self) -> impl Iterator<Item = (DVec3, f64)> + Clone {
        self.instances.iter().flat_map(move |place| {
            let balls = self.balls.iter().map(|b| (b.centre, b.radius));
            let corners = self.mesh.points.iter().map(|&p| (p, 0.0));
            let corners = corners.take(if self.poses.is_empty() { usize::MAX } else { 0 });
            // A posed mesh is as wide as its longest axis, about.
            let posed = self.poses.iter().map(|pose| (pose.at, pose.axes.y_axis.length()));
            balls.chain(corners).chain(posed).map(|(p, radius)| (place.to_world(p), radius * place.scale))
        })
    }

    /// A box around it in the world.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.balls_in_world().map(|(p, radius)| Bounds::of_ball(p, radius)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// How far it reaches above its foot, as declared.
    #[must_use]
    pub fn height(&self) -> f64 {
        let balls = self.balls.iter().map(|b| b.centre.z + b.radius);
        let corners = self.mesh.points.iter().map(|p| p.z).take(if self.poses.is_empty() { usize::MAX } else { 0 });
        let posed = self.poses.iter().map(|pose| pose.at.z);
        balls.chain(corners).chain(posed).fold(0.0, f64::max)
    }

    /// How many spheres, cones and triangles there are, once each.
    #[must_use]
    pub fn primitives(&self) -> usize {
        self.balls.len() + self.segments.len() + self.mesh.triangles.len() + self.poses.len()
    }
}

/// How many decimal digits behind the point numbers keep: six figures of an object's size, as POV-Ray shows no more
/// (`reference/povray.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits(pub u32);

impl Digits {
    /// The digits for something of this size.
    #[must_use]
    pub fn for_size(size: f64) -> Self {
        let figures = 6 - libm::floor(libm::log10(size.max(1e-30))) as i32;
        Self(figures.clamp(3, 12) as u32)
    }

    /// 10 to the number of digits.
    #[must_use]
    pub fn scale(self) -> f64 {
        (0..self.0).fold(1.0, |scale, _| scale * 10.0)
    }

    /// `x` with this many digits.
    #[must_use]
    pub fn round(self, x: f64) -> f64 {
        libm::round(x * self.scale()) / self.scale()
    }

    /// Every coordinate of `p` with this many digits.
    #[must_use]
    pub fn round_point(self, p: DVec3) -> DVec3 {
        DVec3::new(self.round(p.x), self.round(p.y), self.round(p.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_size() {
        assert_eq!(Digits::for_size(13.2), Digits(5));
        assert_eq!(Digits::for_size(0.02), Digits(8));
        assert_eq!(Digits(5).round(1.234_567_89), 1.234_57);
    }
}
