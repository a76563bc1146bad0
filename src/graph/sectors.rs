//! The sectors of Yao graphs: space around a node cut by rays (in the plane) or planes (in space).

use crate::math::{DVec2, DVec3};

/// How space around a node is cut up.
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

    /// `count` sectors.
    ///
    /// # Errors
    /// A sentence that tells what counts there are.
    pub fn new(count: u32, is_plane: bool) -> Result<Self, String> {
        match (is_plane, count) {
            (true, 3..=24) => {
                let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(count);
                Ok(Self::Rays((0..count).map(|i| DVec2::new(libm::cos(angle(i)), libm::sin(angle(i)))).collect()))
            }
            (false, 6) => Ok(Self::Faces),
            (false, 8) => Ok(Self::Orthants),
            (false, 24) => Ok(Self::Both),
            (true, _) => Err(format!("a Yao graph in the plane has 3 to 24 sectors, not {count}")),
            (false, _) => Err(format!("a Yao graph in space has 6, 8 or 24 sectors, not {count}")),
        }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Rays(rays) => rays.len(),
            Self::Faces => 6,
            Self::Orthants => 8,
            Self::Both => 24,
        }
    }

    /// The sector in which `d` lies, which is not zero. Borders belong to one side.
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

    /// May something in the box from `low` to `high`, seen from the node, lie in sector `i`? Never wrong where the answer
    /// is no.
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
