//! Skins: from a skeleton to what is seen.

use std::collections::HashMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::surface::surface;
use super::{Ball, Digits, Instance, Mesh, Object, Pose, to_world};
use crate::geom::Surface;
use crate::grow::IsosurfaceSpec;
use crate::math::{DVec3, tolerance::INVISIBLE_RADIUS};
use crate::skeleton::{Skeleton, overlap};

/// Spheres stand no further apart than this share of the smaller radius: their union then dips by 3 % of it.
const SPHERE_GAP: f64 = 0.5;
/// Most spheres to a segment: a twig thinner than this allows is far below a pixel.
const MOST_SPHERES: u32 = 256;
/// More primitives than this in an object are refused: POV-Ray takes about a kilobyte for each.
pub(super) const MOST_PRIMITIVES: usize = 20_000_000;

/// How a skeleton becomes solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Skin {
    /// A sphere at each node, with more between them until they overlap (Xu and Mould 2008, section 4).
    Spheres,
    /// A round cone along each segment: the frustum tangent to the spheres at its ends, and these.
    #[default]
    Cones,
    /// One smooth surface of triangles around limbs that are joined where one leaves another, with places for a texture
    /// around and along them. Copies share it, and its leaves, which a union of cones does not in POV-Ray.
    Mesh,
    /// One surface around all that is no farther from the limbs than their width (2007, section 3.3).
    Isosurface(IsosurfaceSpec),
    /// Of steps by regions: their borders, an object each (2007, section 3.4).
    Surface,
}

/// Why a skeleton has no skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SkinError {
    /// Nothing would be seen.
    #[error("nothing is left to show: its steps have no paths, or its mesh no triangles")]
    Empty,
    /// Too much to write and render.
    #[error("{0} primitives are more than {MOST_PRIMITIVES}: use fewer endpoints, or cones in place of spheres")]
    TooMany(usize),
    /// Too small or too large for renderers.
    #[error("its size is out of the range that renderers show, 0.001 to 1e7 scene units: change the spacing")]
    Size,
}

impl Mesh {
    /// A closed surface as a mesh from `foot`, with smooth normals; in a flat scene its filled area.
    #[must_use]
    pub fn of_surface(surface: &Surface, foot: DVec3, is_flat: bool) -> Self {
        let points = surface.points.iter().map(|&p| to_world(p - foot, is_flat)).collect();
        let normals = if is_flat { Vec::new() } else { surface.normals() };
        Self { points, normals, triangles: surface.triangles.clone(), uvs: Vec::new() }
    }
}

impl Object {
    /// The object that `mesh` is, moved by `offset`; its foot is its origin.
    ///
    /// # Errors
    /// [`SkinError`].
    pub fn of_mesh(name: &str, mesh: &Mesh, offset: DVec3, material: usize) -> Result<Self, SkinError> {
        if mesh.triangles.is_empty() {
            return Err(SkinError::Empty);
        }
        if mesh.triangles.len() > MOST_PRIMITIVES {
            return Err(SkinError::TooMany(mesh.triangles.len()));
        }
        let size = mesh.points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        if !(1e-3..=1e7).contains(&size) {
            return Err(SkinError::Size);
        }
        let digits = Digits::for_size(size);
        let mesh = mesh.rounded(digits);
        Ok(Self {
            name: name.to_owned(),
            instances: vec![Instance::at(digits.round_point(offset))],
            material,
            balls: Vec::new(),
            segments: Vec::new(),
            mesh,
            poses: Vec::new(),
            digits,
            shadow: true,
            thorns: None,
            is_thorns: false,
        })
    }
}

impl Object {
    /// An object whose `mesh` stands at `poses`, from a foot at `foot` in the world.
    ///
    /// # Errors
    /// [`SkinError`].
    pub fn of_poses(
        name: &str,
        mesh: &Mesh,
        poses: Vec<Pose>,
        foot: DVec3,
        digits: Digits,
        material: usize,
    ) -> Result<Self, SkinError> {
        if poses.len() > MOST_PRIMITIVES {
            return Err(SkinError::TooMany(poses.len()));
        }
        let mesh = mesh.rounded(Digits(Pose::DIGITS));
        Ok(Self {
            name: name.to_owned(),
            instances: vec![Instance::at(foot)],
            material,
            balls: Vec::new(),
            segments: Vec::new(),
            mesh,
            poses,
            digits,
            shadow: true,
            thorns: None,
            is_thorns: false,
        })
    }
}

impl Mesh {
    /// This mesh at each of `poses`, as one.
    ///
    /// # Errors
    /// [`SkinError::TooMany`].
    pub fn at_poses(&self, poses: &[Pose]) -> Result<Self, SkinError> {
        let count = poses.len().saturating_mul(self.triangles.len());
        if count > MOST_PRIMITIVES {
            return Err(SkinError::TooMany(count));
        }
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

/// The foot of an object made of `skeletons`: their first root.
#[must_use]
pub fn foot(skeletons: &[&Skeleton]) -> Option<DVec3> {
    skeletons.iter().find_map(|s| s.nodes.first()).map(|node| node.position)
}

impl Object {
    /// This object as one for each level of growth, each with the same foot; alone where it has only one level. Limbs that
    /// go on from another level start with a ball of it.
    #[must_use]
    pub fn by_level(self) -> Vec<Self> {
        let mut levels: Vec<u16> = self.balls.iter().map(|ball| ball.level).collect();
        levels.sort_unstable();
        levels.dedup();
        if levels.len() < 2 {
            return vec![self];
        }
        let of = |level: u16| {
            let mut renamed: HashMap<u32, u32> = HashMap::new();
            let mut own = Self {
                name: format!("{}_level_{level}", self.name),
                balls: Vec::new(),
                segments: Vec::new(),
                ..self.clone()
            };
            let mut put = |own: &mut Self, i: u32| {
                *renamed.entry(i).or_insert_with(|| {
                    own.balls.push(self.balls[i as usize]);
                    own.balls.len() as u32 - 1
                })
            };
            for &[a, b] in self.segments.iter().filter(|[_, b]| self.balls[*b as usize].level == level) {
                let segment = [put(&mut own, a), put(&mut own, b)];
                own.segments.push(segment);
            }
            // Balls that no segment shows are shown alone.
            for (i, _) in (0..).zip(&self.balls).filter(|(_, ball)| ball.level == level) {
                put(&mut own, i);
            }
            own
        };
        levels.into_iter().map(of).collect()
    }
}

impl Skin {
    /// The object that `skeletons` become, with the first root as its foot, moved by `offset` (in scene space).
    ///
    /// # Errors
    /// [`SkinError`].
    pub fn dress(
        self,
        name: &str,
        skeletons: &[&Skeleton],
        is_flat: bool,
        offset: DVec3,
        material: usize,
    ) -> Result<Object, SkinError> {
        let root = foot(skeletons).ok_or(SkinError::Empty)?;
        let dense;
        if self == Self::Mesh {
            let mesh = surface(skeletons, root);
            return Object::of_mesh(name, &mesh, to_world(root + offset, is_flat), material);
        }
        let skeletons: Vec<&Skeleton> = match self {
            Self::Cones | Self::Mesh | Self::Isosurface(_) | Self::Surface => skeletons.to_vec(),
            Self::Spheres => {
                dense = skeletons.iter().map(|s| overlap(s, SPHERE_GAP, MOST_SPHERES)).collect::<Vec<_>>();
                dense.iter().collect()
            }
        };
        let size = skeletons
            .iter()
            .flat_map(|s| &s.nodes)
            .map(|n| (n.position - root).abs().max_element() + n.radius)
            .fold(0.0, f64::max);
        if !(1e-3..=1e7).contains(&size) {
            return Err(SkinError::Size);
        }
        let digits = Digits::for_size(size);
        let count = skeletons.iter().map(|s| s.nodes.len()).sum::<usize>() * (1 + usize::from(self == Self::Cones));
        if count > MOST_PRIMITIVES {
            return Err(SkinError::TooMany(count));
        }

        let mut object = Object {
            name: name.to_owned(),
            instances: vec![Instance::at(digits.round_point(to_world(root + offset, is_flat)))],
            material,
            balls: Vec::with_capacity(count),
            segments: Vec::new(),
            mesh: Mesh::default(),
            poses: Vec::new(),
            digits,
            shadow: true,
            thorns: None,
            is_thorns: false,
        };
        let mut branches = 0;
        for skeleton in skeletons {
            let first = object.balls.len() as u32;
            for (i, node) in skeleton.nodes.iter().enumerate() {
                let at = first + i as u32;
                object.balls.push(Ball {
                    centre: digits.round_point(to_world(node.position - root, is_flat)),
                    radius: digits.round(node.radius).max(INVISIBLE_RADIUS * 2.0),
                    cost: node.cost,
                    branch: branches + node.branch,
                    level: node.level,
                });
                if self == Self::Cones
                    && let Some(parent) = node.parent
                {
                    object.segments.push([first + parent, at]);
                }
            }
            branches += skeleton.nodes.iter().map(|n| n.branch + 1).max().unwrap_or(0);
        }
        Ok(object)
    }
}
