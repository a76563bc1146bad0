//! The neighbourhoods of regular lattices.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How many neighbours a lattice node has: 4 or 8 in the plane, 6, 18 or 26 in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "u32", into = "u32")]
#[schemars(extend("enum" = [4, 8, 6, 18, 26]))]
pub struct Neighbours(u32);

/// Half of the 26 directions: the positive one of each pair, shorter first.
const POSITIVE: [[i32; 3]; 13] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [1, -1, 0],
    [1, 0, 1],
    [1, 0, -1],
    [0, 1, 1],
    [0, 1, -1],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [1, -1, -1],
];

impl Neighbours {
    /// The 8-neighbourhood of the plane.
    pub const EIGHT: Self = Self(8);

    /// The neighbourhood with `count` neighbours, or `None` if there is none.
    #[must_use]
    pub const fn new(count: u32) -> Option<Self> {
        match count {
            4 | 8 | 6 | 18 | 26 => Some(Self(count)),
            _ => None,
        }
    }

    /// The number of neighbours of an interior node.
    #[must_use]
    pub const fn count(self) -> u32 {
        self.0
    }

    /// 2 for a plane lattice, 3 for one in space.
    #[must_use]
    pub const fn dimensions(self) -> u32 {
        if matches!(self.0, 4 | 8) { 2 } else { 3 }
    }

    /// Is the lattice one of the plane?
    #[must_use]
    pub const fn is_plane(self) -> bool {
        self.dimensions() == 2
    }

    /// The step of each slot: opposite steps in pairs, the positive one first.
    #[inline(always)]
    #[must_use]
    pub const fn steps(self) -> &'static [[i32; 3]] {
        match self.0 {
            4 => const { &steps_of::<4>() },
            8 => const { &steps_of::<8>() },
            6 => const { &steps_of::<6>() },
            18 => const { &steps_of::<18>() },
            _ => const { &steps_of::<26>() },
        }
    }
}

/// The steps of the neighbourhood with `N` neighbours.
const fn steps_of<const N: usize>() -> [[i32; 3]; N] {
    let mut steps = [[0; 3]; N];
    let (mut slot, mut i) = (0, 0);
    while i < POSITIVE.len() {
        let [x, y, z] = POSITIVE[i];
        let changes = x.abs() + y.abs() + z.abs();
        let belongs = match N {
            4 => z == 0 && changes == 1,
            8 => z == 0,
            6 => changes == 1,
            18 => changes <= 2,
            _ => true,
        };
        if belongs {
            steps[slot] = [x, y, z];
            steps[slot + 1] = [-x, -y, -z];
            slot += 2;
        }
        i += 1;
    }
    assert!(slot == N);
    steps
}

/// A number of neighbours that no lattice has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} is not one of 4, 8 (2D), 6, 18, 26 (3D)")]
pub struct NeighboursError(pub u32);

impl TryFrom<u32> for Neighbours {
    type Error = NeighboursError;

    fn try_from(count: u32) -> Result<Self, NeighboursError> {
        Self::new(count).ok_or(NeighboursError(count))
    }
}

impl From<Neighbours> for u32 {
    fn from(neighbours: Neighbours) -> Self {
        neighbours.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposite_slots_are_pairs() {
        for count in [4, 8, 6, 18, 26] {
            let steps = Neighbours::new(count).unwrap().steps();
            assert_eq!(steps.len(), count as usize);
            for slot in 0..steps.len() {
                assert_eq!(steps[slot ^ 1], steps[slot].map(|c| -c));
            }
        }
        assert!(Neighbours::new(7).is_none());
    }
}
