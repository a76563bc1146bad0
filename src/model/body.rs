//! Bodies: round cones, or triangles, declared once or posed.

use super::{BodyError, Digits, Instance};
use crate::geom::{Bounds, vertex_normals};
use crate::math::{DMat3, DVec3};

/// What an object is made of, measured from its foot.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// Balls, and round cones between pairs of them.
    Limbs(Limbs),
    /// One mesh.
    Mesh(Mesh),
    /// One small mesh, posed many times: leaves.
    Posed(Mesh, Vec<Pose>),
}

/// Balls joined by frusta ([`crate::geom::frustum`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limbs {
    /// Spheres.
    pub balls: Vec<Ball>,
    /// Pairs of balls joined by the frustum tangent to both: from the root's side, outwards.
    pub segments: Vec<[u32; 2]>,
    /// Thorns on their surface, for renderers that displace it themselves.
    pub thorns: Option<Thorns>,
    /// Of each ball, the distance to the farthest end of limbs beyond it, where their material has [`super::Tips`]; thorns have that
    /// of what they stand on. Empty without.
    pub beyond: Vec<f32>,
    /// Are they the thorns of another object, which such renderers leave out?
    pub is_thorns: bool,
}

/// Thorns as a displacement shader makes them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thorns {
    /// How far they stand out, in scene units.
    pub length: f64,
    /// Radius at their foot, in scene units.
    pub radius: f64,
    /// Mean distance between neighbours, in scene units.
    pub apart: f64,
    /// Tangent of their angle to the normal, towards the tip of the limb.
    pub lean: f64,
}

impl Limbs {
    /// The balls from which no limb goes on, by index.
    #[must_use]
    pub fn ends(&self) -> Vec<u32> {
        let mut goes_on = vec![false; self.balls.len()];
        self.segments.iter().for_each(|&[from, _]| goes_on[from as usize] = true);
        (0..).zip(&goes_on).filter(|(_, goes_on)| !**goes_on).map(|(i, _)| i).collect()
    }

    /// Measures how far it is from each ball to the farthest end beyond it. Segments must be in order: what leads to a ball before
    /// what leaves it.
    pub fn measure_ends(&mut self) {
        let mut beyond = vec![0.0_f64; self.balls.len()];
        for &[from, to] in self.segments.iter().rev() {
            let [from, to] = [from, to].map(|i| i as usize);
            let length = self.balls[from].centre.distance(self.balls[to].centre);
            beyond[from] = beyond[from].max(beyond[to] + length);
        }
        self.beyond = beyond.into_iter().map(|x| x as f32).collect();
    }

    /// The balls that no segment joins, by index.
    #[must_use]
    pub fn lone(&self) -> Vec<u32> {
        let mut is_joined = vec![false; self.balls.len()];
        self.segments.iter().flatten().for_each(|&ball| is_joined[ball as usize] = true);
        (0..).zip(&is_joined).filter(|(_, joined)| !**joined).map(|(i, _)| i).collect()
    }
}

impl Body {
    /// Balls around all that it is: each ball, each corner as one without size, each pose as one as wide as its y axis is long.
    fn balls(&self) -> impl Iterator<Item = (DVec3, f64)> + Clone + '_ {
        let (balls, corners, poses): (&[Ball], &[DVec3], &[Pose]) = match self {
            Self::Limbs(limbs) => (&limbs.balls, &[], &[]),
            Self::Mesh(mesh) => (&[], &mesh.points, &[]),
            Self::Posed(_, poses) => (&[], &[], poses),
        };
        let balls = balls.iter().map(|b| (b.centre, b.radius));
        let corners = corners.iter().map(|&p| (p, 0.0));
        balls.chain(corners).chain(poses.iter().map(|pose| (pose.at, pose.axes.y_axis.length())))
    }

    /// Every ball around it as `place` puts it.
    pub(super) fn placed_balls(&self, place: Instance) -> impl Iterator<Item = (DVec3, f64)> + Clone + '_ {
        self.balls().map(move |(p, radius)| (place.to_world(p), radius * place.scale))
    }

    /// A box around it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.balls().map(|(p, radius)| Bounds::of_ball(p, radius)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// How far it reaches above its foot.
    #[must_use]
    pub fn height(&self) -> f64 {
        match self {
            Self::Posed(_, poses) => poses.iter().map(|pose| pose.at.z).fold(0.0, f64::max),
            Self::Limbs(_) | Self::Mesh(_) => self.balls().map(|(p, radius)| p.z + radius).fold(0.0, f64::max),
        }
    }

    /// How many spheres, cones and triangles there are, once each.
    #[must_use]
    pub fn primitives(&self) -> usize {
        match self {
            Self::Limbs(limbs) => limbs.balls.len() + limbs.segments.len(),
            Self::Mesh(mesh) => mesh.triangles.len(),
            Self::Posed(mesh, poses) => mesh.triangles.len() + poses.len(),
        }
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Limbs(limbs) => {
                size_of_val(&limbs.balls[..]) + size_of_val(&limbs.segments[..]) + size_of_val(&limbs.beyond[..])
            }
            Self::Mesh(mesh) => mesh.bytes(),
            Self::Posed(mesh, poses) => mesh.bytes() + size_of_val(&poses[..]),
        }
    }

    /// How many limbs [`Ball::branch`] tells apart; a mesh is one.
    #[must_use]
    pub fn branches(&self) -> u32 {
        match self {
            Self::Limbs(limbs) => limbs.balls.iter().map(|b| b.branch + 1).max().unwrap_or(1),
            Self::Mesh(_) | Self::Posed(..) => 1,
        }
    }

    /// Where its mesh is posed; empty for what is not.
    #[must_use]
    pub fn poses(&self) -> &[Pose] {
        if let Self::Posed(_, poses) = self { poses } else { &[] }
    }

    /// The limbs, where it is made of them.
    #[must_use]
    pub fn limbs(&self) -> Option<&Limbs> {
        if let Self::Limbs(limbs) = self { Some(limbs) } else { None }
    }

    /// The mesh, where it has one, and the poses that it stands at: `None` for as it is.
    #[must_use]
    pub fn mesh(&self) -> Option<(&Mesh, Vec<Option<&Pose>>)> {
        match self {
            Self::Limbs(_) => None,
            Self::Mesh(mesh) => Some((mesh, vec![None])),
            Self::Posed(mesh, poses) => Some((mesh, poses.iter().map(Some).collect())),
        }
    }
}

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
    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.points[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.uvs[..])
    }

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

    /// This mesh at each of `poses`, as one.
    ///
    /// # Errors
    /// [`BodyError::TooMany`].
    pub fn at_poses(&self, poses: &[Pose]) -> Result<Self, BodyError> {
        BodyError::check_count(poses.len().saturating_mul(self.triangles.len()))?;
        let mut all = Self::default();
        for pose in poses {
            let first = all.points.len() as u32;
            all.points.extend(self.points.iter().map(|&p| pose.to_object(p)));
            all.normals.extend(self.normals.iter().map(|&n| (pose.axes * n).normalize_or(DVec3::Z)));
            all.triangles.extend(self.triangles.iter().map(|t| t.map(|i| first + i)));
        }
        Ok(all)
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
