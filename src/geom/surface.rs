//! Triangle surfaces: area, volume, normals, smoothing, and whether they are closed manifolds.

use crate::math::DVec3;

/// An indexed triangle mesh; triangles are counterclockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Vertices.
    pub points: Vec<DVec3>,
    /// Three indices of vertices each.
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.points[..]) + size_of_val(&self.triangles[..])
    }

    /// The corners of a triangle.
    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        corners(&self.points, triangle)
    }

    /// The mesh with `transform` applied to every vertex.
    #[must_use]
    pub fn map(mut self, transform: impl Fn(DVec3) -> DVec3) -> Self {
        self.points.iter_mut().for_each(|p| *p = transform(*p));
        self
    }

    /// [`vertex_normals`] of the mesh.
    #[must_use]
    pub fn normals(&self) -> Vec<DVec3> {
        vertex_normals(&self.points, &self.triangles)
    }

    /// The enclosed volume (divergence theorem); negative where triangles are clockwise seen from outside.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let sixfold = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(t);
            a.dot(b.cross(c))
        };
        self.triangles.iter().map(sixfold).sum::<f64>() / 6.0
    }

    /// The total area.
    #[must_use]
    pub fn area(&self) -> f64 {
        let twice = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(t);
            (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(twice).sum::<f64>() * 0.5
    }

    /// Taubin smoothing, which nearly keeps the volume: `rounds` of a Laplacian step with lambda = 0.5 and one with mu = -0.53
    /// (Taubin 1995).
    pub fn smooth(&mut self, rounds: u32) {
        const STEPS: [f64; 2] = [0.5, -0.53];
        for step in (0..rounds).flat_map(|_| STEPS) {
            let mut sums = vec![(DVec3::ZERO, 0_u32); self.points.len()];
            // A closed surface has each edge twice, once in each direction.
            for t in &self.triangles {
                for i in 0..3 {
                    let sum = &mut sums[t[i] as usize];
                    *sum = (sum.0 + self.points[t[(i + 1) % 3] as usize], sum.1 + 1);
                }
            }
            for (p, (sum, count)) in self.points.iter_mut().zip(sums) {
                if count > 0 {
                    *p += (sum / f64::from(count) - *p) * step;
                }
            }
        }
    }

    /// Is it a closed, oriented 2-manifold: is every edge shared by exactly two triangles in opposite directions, are the
    /// triangles around every vertex one cycle, and is none degenerate? [`Surface::extract`] yields such surfaces.
    #[must_use]
    pub fn is_closed_manifold(&self) -> bool {
        let mut edges: Vec<[u32; 2]> =
            self.triangles.iter().flat_map(|t| (0..3).map(|i| [t[i], t[(i + 1) % 3]])).collect();
        edges.sort_unstable();
        let is_once = edges.windows(2).all(|pair| pair[0] != pair[1]);
        let is_paired = edges.iter().all(|&[a, b]| a != b && edges.binary_search(&[b, a]).is_ok());
        // The triangles around each vertex, as the successor of each neighbour.
        let mut corners: Vec<[u32; 3]> =
            self.triangles.iter().flat_map(|t| (0..3).map(|i| [t[i], t[(i + 1) % 3], t[(i + 2) % 3]])).collect();
        corners.sort_unstable();
        is_once
            && is_paired
            && corners.chunk_by(|a, b| a[0] == b[0]).all(|around| {
                let mut at = around[0][1];
                let next = |at: u32| around.binary_search_by_key(&at, |c| c[1]).ok().map(|i| around[i][2]);
                (1..=around.len()).all(|count| {
                    at = next(at).unwrap_or(u32::MAX);
                    (at == around[0][1]) == (count == around.len())
                })
            })
    }
}

/// The corners of a triangle.
fn corners(points: &[DVec3], triangle: &[u32; 3]) -> [DVec3; 3] {
    triangle.map(|i| points[i as usize])
}

/// The unit normal of each vertex: the area-weighted mean of the normals of the triangles around it.
#[must_use]
pub fn vertex_normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = corners(points, triangle);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&i| normals[i as usize] += normal);
    }
    normals.into_iter().map(|n| n.normalize_or(DVec3::Z)).collect()
}
