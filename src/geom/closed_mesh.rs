//! Closed triangle meshes as shapes: point containment and signed distance.

use std::collections::HashMap;

use super::{Bounds, segment_distance};
use crate::math::DVec3;

/// Triangles in a leaf of the bounding volume hierarchy.
const LEAF: usize = 4;
/// Direction of the rays that count crossings: unlikely to be parallel to an edge or a face of a modelled mesh.
const RAY: DVec3 = DVec3::new(0.348_155_311_911_395_6, 0.217_597_069_944_622_2, 0.911_834_006_311_001);

/// Why a mesh encloses no solid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ClosedMeshError {
    /// It has no triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// Edges do not join exactly two triangles of consistent orientation.
    #[error(
        "the mesh is open or its faces disagree which side is out: {open} of its {edges} edges do not join two faces; close it first"
    )]
    Open {
        /// How many such edges there are.
        open: usize,
        /// How many edges there are.
        edges: usize,
    },
}

/// A closed, consistently oriented triangle mesh: every edge joins two triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedMesh {
    triangles: Vec<[DVec3; 3]>,
    /// A balanced binary tree of boxes; the children of i are 2 i + 1 and 2 i + 2.
    boxes: Vec<Bounds>,
}

impl ClosedMesh {
    /// The solid that `triangles` of indices of `points` enclose.
    ///
    /// # Errors
    /// [`ClosedMeshError`].
    pub fn new(points: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, ClosedMeshError> {
        if triangles.is_empty() {
            return Err(ClosedMeshError::Empty);
        }
        // Coincident vertices are one: files often repeat them for their normals.
        let mut named: HashMap<[u64; 3], u32> = HashMap::new();
        let mut name = |p: DVec3| {
            let next = named.len() as u32;
            *named.entry((p + 0.0).to_array().map(f64::to_bits)).or_insert(next)
        };
        let mut balance: HashMap<(u32, u32), i32> = HashMap::new();
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|i| name(points[i as usize]));
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *balance.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        let open = balance.values().filter(|&&sum| sum != 0).count();
        if open > 0 {
            return Err(ClosedMeshError::Open { open, edges: balance.len() });
        }
        let mut triangles: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|i| points[i as usize])).collect();
        let mut boxes = vec![Bounds::EMPTY; (2 * triangles.len()).next_power_of_two()];
        build(&mut triangles, 0, &mut boxes);
        Ok(Self { triangles, boxes })
    }

    /// Its bounding box.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.boxes[0]
    }

    /// Signed distance of `p` from the surface, negative inside.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        let mut nearest = f64::INFINITY;
        self.nearest(p, [0, 0, self.triangles.len()], &mut nearest);
        if self.contains(p) { -nearest } else { nearest }
    }

    /// Lowers `nearest` to the distance of the triangles of a node: its index, its first triangle and their number. The
    /// nearer child is descended first, so that most others are pruned.
    fn nearest(&self, p: DVec3, [node, first, count]: [usize; 3], nearest: &mut f64) {
        if count <= LEAF {
            let distances = self.triangles[first..first + count].iter().map(|triangle| triangle_distance(p, triangle));
            *nearest = distances.fold(*nearest, f64::min);
            return;
        }
        let half = count / 2;
        let halves = [[2 * node + 1, first, half], [2 * node + 2, first + half, count - half]];
        let far = halves.map(|[child, ..]| self.boxes[child].distance(p));
        let order = if far[1] < far[0] { [1, 0] } else { [0, 1] };
        for i in order {
            if far[i] < *nearest {
                self.nearest(p, halves[i], nearest);
            }
        }
    }

    /// Is `p` inside, by the parity of the crossings of a ray (Moeller and Trumbore 1997)?
    fn contains(&self, p: DVec3) -> bool {
        let mut is_inside = false;
        let is_ahead = |bounds: &Bounds| {
            // The slab test.
            let (low, high) = ((bounds.min - p) / RAY, (bounds.max - p) / RAY);
            low.min(high).max_element().max(0.0) <= low.max(high).min_element()
        };
        self.visit(0, 0, self.triangles.len(), &mut |bounds| is_ahead(bounds), &mut |&[a, b, c]| {
            let (e1, e2, o) = (b - a, c - a, p - a);
            let n = RAY.cross(e2);
            let det = e1.dot(n);
            let u = o.dot(n) / det;
            let q = o.cross(e1);
            let v = RAY.dot(q) / det;
            is_inside ^= u >= 0.0 && v >= 0.0 && u + v < 1.0 && e2.dot(q) / det > 0.0;
        });
        is_inside
    }

    /// Calls `leaf` with the triangles of every box for which `enter` is true.
    fn visit(
        &self,
        node: usize,
        first: usize,
        count: usize,
        enter: &mut dyn FnMut(&Bounds) -> bool,
        leaf: &mut dyn FnMut(&[DVec3; 3]),
    ) {
        if !enter(&self.boxes[node]) {
            return;
        }
        if count <= LEAF {
            return self.triangles[first..first + count].iter().for_each(leaf);
        }
        let half = count / 2;
        self.visit(2 * node + 1, first, half, enter, leaf);
        self.visit(2 * node + 2, first + half, count - half, enter, leaf);
    }
}

/// Sorts `triangles` into the subtree of `node`, halving at the median of the longest axis, and sets its boxes.
fn build(triangles: &mut [[DVec3; 3]], node: usize, boxes: &mut Vec<Bounds>) {
    if boxes.len() <= node {
        boxes.resize(node + 1, Bounds::EMPTY);
    }
    boxes[node] = Bounds::of_points(triangles.iter().flatten().copied());
    if triangles.len() <= LEAF {
        return;
    }
    let size = boxes[node].size();
    let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    let middle = |t: &[DVec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
    let half = triangles.len() / 2;
    triangles.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    let (low, high) = triangles.split_at_mut(half);
    build(low, 2 * node + 1, boxes);
    build(high, 2 * node + 2, boxes);
}

/// Distance of `p` from a triangle: from its plane where `p` projects into it, else from the nearest edge.
fn triangle_distance(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> f64 {
    let n = (b - a).cross(c - a);
    let is_over = [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| n.cross(to - from).dot(p - from) >= 0.0);
    if is_over && n != DVec3::ZERO {
        return (p - a).dot(n).abs() / n.length();
    }
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| segment_distance(p, from, to));
    edges.into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit cube.
    pub fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let points = Bounds { min: DVec3::ZERO, max: DVec3::ONE }.corners().to_vec();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        (points, faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
    }

    #[test]
    fn a_cube_is_a_box() {
        let (points, triangles) = cube();
        let mesh = ClosedMesh::new(points.clone(), triangles.clone()).unwrap();
        for i in 0..1000 {
            let p = DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)) * 0.21 - 0.47;
            let q = (p - 0.5).abs() - 0.5;
            let expected = q.max(DVec3::ZERO).length() + q.max_element().min(0.0);
            assert!((mesh.distance(p) - expected).abs() < 1e-12, "{p}: {} {expected}", mesh.distance(p));
        }
        let open = ClosedMesh::new(points.clone(), triangles[1..].to_vec());
        assert_eq!(open, Err(ClosedMeshError::Open { open: 3, edges: 18 }));
        assert_eq!(ClosedMesh::new(points, Vec::new()), Err(ClosedMeshError::Empty));
    }
}
