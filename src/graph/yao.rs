//! Neighbour search for scattered nodes: the Yao graph (Yao 1977; the orthant neighbourhood graph of Germer and Strothotte
//! 2007), or all within a radius.

use rayon::prelude::*;

use super::Sectors;
use crate::geom::Bounds;
use crate::math::DVec3;

/// Most cells for each node: nodes may be far apart.
const MOST_CELLS: f64 = 8.0;
/// Rings of cells around a node that are searched exhaustively; beyond them the pyramid is descended.
const RINGS: i32 = 2;
/// Nodes in a thread's unit of work.
const CHUNK: usize = 1024;

/// A uniform grid of nodes, with a pyramid of bounding boxes over its cells.
pub(super) struct NodeGrid<'a> {
    nodes: &'a [DVec3],
    /// Which edges are allowed.
    owners: Option<&'a [u8]>,
    origin: DVec3,
    side: f64,
    size: [i32; 3],
    /// The index in `members` of each cell's first node.
    starts: Vec<u32>,
    members: Vec<u32>,
    /// From the cells up to a single box.
    levels: Vec<Level>,
}

/// A level of the pyramid.
struct Level {
    size: [i32; 3],
    /// The bounding box of the nodes in each cell.
    boxes: Vec<Bounds>,
}

/// The nearest node in each sector: distance squared, number.
type Best = [(f64, u32); Sectors::MOST];

impl<'a> NodeGrid<'a> {
    /// `nodes` in cells of at least this side. Nodes of two different owners other than 0 are never joined.
    pub fn new(nodes: &'a [DVec3], owners: Option<&'a [u8]>, side: f64) -> Self {
        let bounds = Bounds::of_points(nodes.iter().copied());
        let size = |side: f64| (bounds.size() / side).to_array().map(|c| libm::floor(c) + 1.0);
        let mut side = side;
        while size(side).iter().product::<f64>() > MOST_CELLS * nodes.len() as f64 + 64.0 {
            side *= 1.25;
        }
        let size = size(side).map(|s| s as i32);
        let mut own = Self {
            nodes,
            owners,
            origin: bounds.min,
            side,
            size,
            starts: Vec::new(),
            members: Vec::new(),
            levels: Vec::new(),
        };
        let count = size.iter().map(|&s| s as usize).product::<usize>();
        let cells: Vec<u32> = nodes.iter().map(|&p| own.index(own.cell(p)) as u32).collect();
        // A counting sort is stable: it keeps the order of nodes within a cell.
        own.starts = vec![0; count + 1];
        for &cell in &cells {
            own.starts[cell as usize + 1] += 1;
        }
        for i in 0..count {
            own.starts[i + 1] += own.starts[i];
        }
        own.members = vec![0; nodes.len()];
        let mut next = own.starts.clone();
        for (i, &cell) in (0..).zip(&cells) {
            let place = &mut next[cell as usize];
            own.members[*place as usize] = i;
            *place += 1;
        }
        // Small graphs are searched exhaustively.
        if size.iter().any(|&s| s > 2 * RINGS + 1) {
            own.levels = own.pyramid();
        }
        own
    }

    fn cell(&self, p: DVec3) -> [i32; 3] {
        let at = ((p - self.origin) / self.side).to_array().map(|c| libm::floor(c) as i32);
        [0, 1, 2].map(|axis| at[axis].clamp(0, self.size[axis] - 1))
    }

    fn index(&self, [x, y, z]: [i32; 3]) -> usize {
        x as usize + self.size[0] as usize * (y as usize + self.size[1] as usize * z as usize)
    }

    fn pyramid(&self) -> Vec<Level> {
        let cells = self.starts.windows(2).map(|w| {
            let members = &self.members[w[0] as usize..w[1] as usize];
            Bounds::of_points(members.iter().map(|&i| self.nodes[i as usize]))
        });
        let mut levels = vec![Level { size: self.size, boxes: cells.collect() }];
        while let Some(level) = levels.last().filter(|level| level.boxes.len() > 1) {
            let size = level.size.map(|s| (s + 1) / 2);
            let mut boxes = Vec::with_capacity(size.iter().map(|&s| s as usize).product());
            for z in 0..size[2] {
                for y in 0..size[1] {
                    for x in 0..size[0] {
                        let within = children(level.size, [x, y, z]).map(|i| level.boxes[i]);
                        boxes.push(within.fold(Bounds::EMPTY, Bounds::union));
                    }
                }
            }
            levels.push(Level { size, boxes });
        }
        levels
    }

    fn may_join(&self, i: u32, j: u32) -> bool {
        i != j
            && self.owners.is_none_or(|owners| {
                let (a, b) = (owners[i as usize], owners[j as usize]);
                a == b || a == 0 || b == 0
            })
    }

    /// Calls `visit` with the nodes in the cells within `ring` of the cell `at`.
    fn around(&self, at: [i32; 3], ring: i32, mut visit: impl FnMut(u32)) {
        let range = |axis: usize| (at[axis] - ring).max(0)..(at[axis] + ring + 1).min(self.size[axis]);
        let across = range(0);
        for z in range(2) {
            for y in range(1) {
                let row = self.index([0, y, z]);
                let first = self.starts[row + across.start as usize] as usize;
                let last = self.starts[row + across.end as usize] as usize;
                self.members[first..last].iter().for_each(|&j| visit(j));
            }
        }
    }

    /// The nearest node in each sector around node `i`, no farther than `longest`; of equally near ones the first.
    fn nearest(&self, i: u32, sectors: &Sectors, longest: f64) -> Best {
        let p = self.nodes[i as usize];
        let at = self.cell(p);
        let mut best = [(longest * longest, u32::MAX); Sectors::MOST];
        let rings = if self.levels.is_empty() { 2 * RINGS } else { RINGS };
        self.around(at, rings, |j| {
            let d = self.nodes[j as usize] - p;
            let found = (d.length_squared(), j);
            let best = &mut best[sectors.of(d)];
            if found < *best && self.may_join(i, j) {
                *best = found;
            }
        });
        if self.levels.is_empty() {
            return best;
        }
        // Nodes outside the searched cells are at least this far.
        let low = self.origin + DVec3::from_array(at.map(|c| f64::from(c - RINGS))) * self.side;
        let high = self.origin + DVec3::from_array(at.map(|c| f64::from(c + RINGS + 1))) * self.side;
        let flat = |axis: &usize| self.size[*axis] > 1;
        let safe = (0..3).filter(flat).map(|a| (p[a] - low[a]).min(high[a] - p[a])).fold(f64::INFINITY, f64::min);
        let safe = (safe * (1.0 - 1e-9)).max(0.0);
        for (sector, best) in best.iter_mut().enumerate().take(sectors.count()) {
            if best.0 > safe * safe {
                self.descend(i, sectors, sector, best);
            }
        }
        best
    }

    /// Searches the pyramid for a nearer node in `sector`: depth first, nearest box first.
    fn descend(&self, i: u32, sectors: &Sectors, sector: usize, best: &mut (f64, u32)) {
        let p = self.nodes[i as usize];
        let mut stack = vec![(self.levels.len() - 1, [0_i32; 3], 0_usize)];
        while let Some((rank, at, index)) = stack.pop() {
            let own = self.levels[rank].boxes[index];
            let is_far = own.distance_squared(p) > best.0;
            if own.min.x > own.max.x || is_far || !sectors.may_hold(sector, own.min - p, own.max - p) {
                continue;
            }
            if rank == 0 {
                for &j in &self.members[self.starts[index] as usize..self.starts[index + 1] as usize] {
                    let d = self.nodes[j as usize] - p;
                    let found = (d.length_squared(), j);
                    if found < *best && self.may_join(i, j) && sectors.of(d) == sector {
                        *best = found;
                    }
                }
                continue;
            }
            let below = &self.levels[rank - 1];
            // The nearest is pushed last, and so popped first.
            let mut next: Vec<(f64, [i32; 3], usize)> = children(below.size, at)
                .map(|index| {
                    let (x, rest) = (index as i32 % below.size[0], index as i32 / below.size[0]);
                    let cell = [x, rest % below.size[1], rest / below.size[1]];
                    (below.boxes[index].distance_squared(p), cell, index)
                })
                .collect();
            next.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.2.cmp(&a.2)));
            stack.extend(next.into_iter().map(|(_, cell, index)| (rank - 1, cell, index)));
        }
    }

    /// The nearest node in each sector of each node, no farther than `longest`: `sectors.count()` numbers a node, `u32::MAX`
    /// where there is none.
    pub fn yao(&self, sectors: &Sectors, longest: f64) -> Vec<u32> {
        let count = sectors.count();
        let mut found = vec![u32::MAX; self.nodes.len() * count];
        let fill = |first: usize, rows: &mut [u32]| {
            for (row, i) in rows.chunks_mut(count).zip(first as u32..) {
                let best = self.nearest(i, sectors, longest);
                row.iter_mut().zip(best).for_each(|(to, (_, j))| *to = j);
            }
        };
        if self.nodes.len() <= 2 * CHUNK {
            fill(0, &mut found);
        } else {
            let chunks = found.par_chunks_mut(CHUNK * count).enumerate();
            chunks.for_each(|(chunk, rows)| fill(chunk * CHUNK, rows));
        }
        found
    }

    /// For each node those with a higher number within `reach`, which must not exceed the cells' side.
    pub fn within(&self, reach: f64) -> Vec<Vec<u32>> {
        let one = |i: u32| {
            let p = self.nodes[i as usize];
            let mut found = Vec::new();
            self.around(self.cell(p), 1, |j| {
                if j > i && self.may_join(i, j) && self.nodes[j as usize].distance_squared(p) <= reach * reach {
                    found.push(j);
                }
            });
            found.sort_unstable();
            found
        };
        (0..self.nodes.len() as u32).into_par_iter().map(one).collect()
    }

    /// The node nearest to `p`; of equally near ones the first.
    pub fn nearest_to(&self, p: DVec3) -> Option<u32> {
        let mut best = (f64::INFINITY, u32::MAX);
        let at = self.cell(p);
        for ring in 0..self.size.into_iter().max().unwrap_or(1) {
            // Cells of this ring and beyond are at least this far.
            let far = f64::from(ring - 1) * self.side;
            if ring > 1 && best.0 < far * far {
                break;
            }
            self.around(at, ring, |j| best = min(best, (self.nodes[j as usize].distance_squared(p), j)));
        }
        (best.1 != u32::MAX).then_some(best.1)
    }
}

fn min(a: (f64, u32), b: (f64, u32)) -> (f64, u32) {
    if b < a { b } else { a }
}

/// The cells, in a level of this size, under a cell of the level above.
fn children(size: [i32; 3], at: [i32; 3]) -> impl Iterator<Item = usize> {
    let range = move |axis: usize| 2 * at[axis]..(2 * at[axis] + 2).min(size[axis]);
    range(2).flat_map(move |z| {
        range(1).flat_map(move |y| {
            range(0).map(move |x| x as usize + size[0] as usize * (y as usize + size[1] as usize * z as usize))
        })
    })
}
