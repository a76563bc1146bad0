//! The sectors of Yao graphs: cones of directions about a node, between rays in the plane or planes in space.

use crate::math::{DVec2, DVec3};

/// Why there are no such sectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SectorsError {
    /// Not a number of sectors for the plane.
    #[error("a Yao graph in the plane has 3 to 24 sectors, not {0}")]
    Plane(u32),
    /// Not a number of sectors for space.
    #[error("a Yao graph in space has 6, 8 or 24 sectors, not {0}")]
    Space(u32),
}

impl From<SectorsError> for String {
    fn from(error: SectorsError) -> Self {
        error.to_string()
    }
}

/// A partition of the directions about a node.
#[derive(Clone, Debug, PartialEq)]
pub enum Sectors {
    /// By this many rays in the plane, the first along x (Xu and Mould 2012, Fig. 3 has six).
    Rays(Vec<DVec2>),
    /// By the six faces of a cube.
    Faces,
    /// By the three coordinate planes: eight orthants.
    Orthants,
    /// Orthants and faces together: 24.
    Both,
}

impl Sectors {
    /// Most sectors there can be.
    pub const MOST: usize = 24;

    /// The partition into `count` sectors: 3 to 24 in the plane; 6, 8 or 24 in space.
    ///
    /// # Errors
    /// [`SectorsError`].
    pub fn new(count: u32, is_plane: bool) -> Result<Self, SectorsError> {
        match (is_plane, count) {
            (true, 3..=24) => {
                let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(count);
                Ok(Self::Rays((0..count).map(|i| DVec2::new(libm::cos(angle(i)), libm::sin(angle(i)))).collect()))
            }
            (false, 6) => Ok(Self::Faces),
            (false, 8) => Ok(Self::Orthants),
            (false, 24) => Ok(Self::Both),
            (true, _) => Err(SectorsError::Plane(count)),
            (false, _) => Err(SectorsError::Space(count)),
        }
    }

    /// The number of sectors.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Rays(rays) => rays.len(),
            Self::Faces => 6,
            Self::Orthants => 8,
            Self::Both => 24,
        }
    }

    /// The rays between the sectors of a plane, each of length 1; none in space.
    #[must_use]
    pub fn rays(&self) -> &[DVec2] {
        match self {
            Self::Rays(rays) => rays,
            Self::Faces | Self::Orthants | Self::Both => &[],
        }
    }

    /// The sector that contains the vector `d`, which must not be 0. A border belongs to one of its sectors.
    #[inline]
    #[must_use]
    pub fn of(&self, d: DVec3) -> usize {
        let orthant = || usize::from(d.x < 0.0) | usize::from(d.y < 0.0) << 1 | usize::from(d.z < 0.0) << 2;
        let axis = || {
            let a = d.abs();
            if a.x >= a.y && a.x >= a.z {
                0
            } else if a.y >= a.z {
                1
            } else {
                2
            }
        };
        match self {
            Self::Rays(rays) => {
                let d = d.truncate();
                let is_in = |i: &usize| {
                    let (from, to) = (rays[*i], rays[(i + 1) % rays.len()]);
                    from.perp_dot(d) >= 0.0 && to.perp_dot(d) < 0.0
                };
                (0..rays.len()).find(is_in).unwrap_or(0)
            }
            Self::Faces => 2 * axis() + usize::from(d[axis()] < 0.0),
            Self::Orthants => orthant(),
            Self::Both => 8 * axis() + orthant(),
        }
    }

    /// May sector `i` intersect the box from `low` to `high`, relative to the node? Conservative: only `false` is certain.
    #[must_use]
    pub fn may_hold(&self, i: usize, low: DVec3, high: DVec3) -> bool {
        let orthant =
            |i: usize| (0..3).all(|axis| if i >> axis & 1 == 0 { high[axis] >= 0.0 } else { low[axis] <= 0.0 });
        let face = |axis: usize, is_back: bool| if is_back { low[axis] <= 0.0 } else { high[axis] >= 0.0 };
        match self {
            Self::Rays(rays) => {
                let (from, to) = (rays[i], rays[(i + 1) % rays.len()]);
                let reaches = |n: DVec2| {
                    let far = |axis: usize| if n[axis] >= 0.0 { high[axis] } else { low[axis] };
                    n.x * far(0) + n.y * far(1) >= -1e-9 * (high - low).length()
                };
                reaches(from.perp()) && reaches(-to.perp())
            }
            Self::Faces => face(i / 2, i % 2 == 1),
            Self::Orthants => orthant(i),
            Self::Both => orthant(i % 8),
        }
    }
}
