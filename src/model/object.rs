//! Objects: a body, its material, and where it stands.

use super::{Body, BodyError, Digits, Instance, Mesh, Pose};
use crate::geom::Bounds;
use crate::math::DVec3;

/// What a scene declares as one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name in the scene.
    pub name: String,
    /// Where it stands, one or more times.
    pub instances: Vec<Instance>,
    /// Index of its material.
    pub material: usize,
    /// What it is made of.
    pub body: Body,
    /// Digits behind the point of all its numbers.
    pub digits: Digits,
    /// Does it cast shadows?
    pub shadow: bool,
    /// Does it stand about what the scene is of, so that it does not count for its size?
    pub is_scenery: bool,
}

impl Object {
    /// An object with its foot at `foot` in the world; `digits` have been applied to `body`.
    #[must_use]
    pub fn new(name: &str, body: Body, foot: DVec3, digits: Digits, material: usize) -> Self {
        let instances = vec![Instance::at(digits.round_point(foot))];
        Self { name: name.to_owned(), instances, material, body, digits, shadow: true, is_scenery: false }
    }

    /// The object that `mesh` is, with its foot at `foot` in the world.
    ///
    /// # Errors
    /// [`BodyError`].
    pub fn of_mesh(name: &str, mesh: &Mesh, foot: DVec3, material: usize) -> Result<Self, BodyError> {
        if mesh.triangles.is_empty() {
            return Err(BodyError::Empty);
        }
        BodyError::check_count(mesh.triangles.len())?;
        let size = mesh.points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        BodyError::check_size(size)?;
        let digits = Digits::for_size(size);
        Ok(Self::new(name, Body::Mesh(mesh.rounded(digits)), foot, digits, material))
    }

    /// An object whose `mesh` stands at `poses`, with its foot at `foot` in the world.
    ///
    /// # Errors
    /// [`BodyError::TooMany`].
    pub fn of_poses(
        name: &str,
        mesh: &Mesh,
        poses: Vec<Pose>,
        foot: DVec3,
        digits: Digits,
        material: usize,
    ) -> Result<Self, BodyError> {
        BodyError::check_count(poses.len())?;
        let body = Body::Posed(mesh.rounded(Digits(Pose::DIGITS)), poses);
        let object = Self::new(name, body, foot, digits, material);
        Ok(Self { instances: vec![Instance::at(foot)], ..object })
    }

    /// Balls around all that it is, wherever it stands: centre, radius.
    pub fn balls_in_world(&self) -> impl Iterator<Item = (DVec3, f64)> + Clone {
        self.instances.iter().flat_map(|&place| self.body.placed_balls(place))
    }

    /// A box around it in the world.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.balls_in_world().map(|(p, radius)| Bounds::of_ball(p, radius)).fold(Bounds::EMPTY, Bounds::union)
    }
}
