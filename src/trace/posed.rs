//! Meshes that are posed many times, as leaves are, in one tree: a ray meets all leaves of a crown at once, in place of the box of
//! each.

use crate::bvh::{Hit, Ray, Triangle, Triangles};
use crate::math::DVec3;
use crate::model::{Body, Instance, Mesh, Model, Object, Pose};

/// The tree has no more triangles, of some 100 bytes each while it is built: what is left has a box for each leaf.
const MOST: usize = 1 << 22;

/// All triangles of posed meshes.
pub(super) struct PosedTree<'a> {
    parts: Vec<Part<'a>>,
    triangles: Triangles,
}

/// An object where it stands once.
struct Part<'a> {
    /// The number of its first triangle.
    first: usize,
    object: u32,
    mesh: &'a Mesh,
    poses: &'a [Pose],
    instance: Instance,
}

/// One triangle of a posed mesh.
pub(super) struct PosedTriangle<'a> {
    pub object: u32,
    pub mesh: &'a Mesh,
    pub instance: &'a Instance,
    pub pose: &'a Pose,
    /// Its number in the mesh.
    pub triangle: u32,
}

/// Which objects are in the tree: as many as it has room for. What casts no shadow is not, since the tree is asked for shadows as a
/// whole.
pub(super) fn in_tree(model: &Model) -> Vec<bool> {
    let mut left = MOST;
    let mut takes = |object: &Object| {
        let triangles = triangles(object);
        let fits = object.shadow && triangles > 0 && triangles <= left;
        left -= if fits { triangles } else { 0 };
        fits
    };
    model.objects.iter().map(&mut takes).collect()
}

/// Bytes that the triangles of those in the tree take at their peak.
pub(super) fn bytes_needed(model: &Model, in_tree: &[bool]) -> usize {
    let objects = model.objects.iter().zip(in_tree).filter(|(_, is_in)| **is_in);
    Triangles::bytes_needed(objects.map(|(object, _)| triangles(object)).sum())
}

/// The triangles of its poses wherever it stands; none of what is not posed.
fn triangles(object: &Object) -> usize {
    let Body::Posed(mesh, poses) = &object.body else { return 0 };
    mesh.triangles.len().saturating_mul(poses.len()).saturating_mul(object.instances.len())
}

impl<'a> PosedTree<'a> {
    pub fn new(model: &'a Model, in_tree: &[bool]) -> Self {
        let mut parts: Vec<Part<'a>> = Vec::new();
        let mut count = 0;
        for (number, object) in (0..).zip(&model.objects).filter(|(i, _)| in_tree[*i as usize]) {
            let Body::Posed(mesh, poses) = &object.body else { continue };
            for &instance in &object.instances {
                parts.push(Part { first: count, object: number, mesh, poses, instance });
                count += mesh.triangles.len() * poses.len();
            }
        }
        let triangles = Triangles::new(count, |id| of(&parts, id).1);
        Self { parts, triangles }
    }

    /// The nearest triangle on the ray.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.triangles.closest(ray)
    }

    /// Does any stand in the way?
    pub fn is_blocked(&self, ray: &Ray) -> bool {
        self.triangles.is_blocked(ray)
    }

    /// The triangle of a hit.
    pub fn triangle(&self, id: u32) -> PosedTriangle<'_> {
        let (part, ..) = of(&self.parts, id as usize);
        let (pose, triangle) = part.split(id as usize);
        PosedTriangle {
            object: part.object,
            mesh: part.mesh,
            instance: &part.instance,
            pose,
            triangle: triangle as u32,
        }
    }
}

impl<'a> Part<'a> {
    /// The pose and the number within the mesh of a triangle of the tree.
    fn split(&self, id: usize) -> (&'a Pose, usize) {
        let (within, each) = (id - self.first, self.mesh.triangles.len());
        (&self.poses[within / each], within % each)
    }
}

/// The part that triangle `id` of a tree is of, and the triangle in the world.
fn of<'p, 'a>(parts: &'p [Part<'a>], id: usize) -> (&'p Part<'a>, Triangle) {
    let part = &parts[parts.partition_point(|part| part.first <= id) - 1];
    let (pose, triangle) = part.split(id);
    let corner = |i: u32| part.instance.to_world(pose.at + pose.axes * part.mesh.points[i as usize]);
    let corners: [DVec3; 3] = part.mesh.triangles[triangle].map(corner);
    (part, Triangle(corners))
}
