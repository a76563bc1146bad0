//! Points with room around them.

use std::collections::HashMap;

use crate::math::DVec3;

/// Points no two of which are nearer than a distance, in cells as wide as that.
pub(super) struct Crowd {
    apart: f64,
    cells: HashMap<[i64; 3], Vec<DVec3>>,
}

impl Crowd {
    pub fn new(apart: f64) -> Self {
        Self { apart, cells: HashMap::new() }
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        p.to_array().map(|c| libm::floor(c / self.apart) as i64)
    }

    pub fn has_room(&self, p: DVec3) -> bool {
        if self.apart <= 0.0 {
            return true;
        }
        let [x, y, z] = self.cell(p);
        (-1..=1).all(|dx| {
            (-1..=1).all(|dy| {
                (-1..=1).all(|dz| {
                    let cell = self.cells.get(&[x + dx, y + dy, z + dz]);
                    cell.is_none_or(|points| points.iter().all(|q| q.distance(p) >= self.apart))
                })
            })
        })
    }

    pub fn add(&mut self, p: DVec3) {
        if self.apart > 0.0 {
            self.cells.entry(self.cell(p)).or_default().push(p);
        }
    }
}
