//! Endpoints: where paths are to go.

use std::collections::{HashMap, HashSet};

use rand::RngExt;

use crate::geom::Shape;
use crate::graph::{Lattice, Node};
use crate::math::{DVec3, Stream};

/// Random placement gives up after this many rejections in a row.
const MOST_REJECTIONS: u32 = 20_000;

/// A set of endpoints whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct Endpoints {
    /// The set's name within its step.
    pub name: String,
    /// The class of its paths, as an index of the step's classes.
    pub class: u16,
    /// Where they are.
    pub placement: Placement,
}

/// Where a set of endpoints is.
#[derive(Clone, Debug)]
pub enum Placement {
    /// At these points, each carried to the nearest node.
    At(Vec<DVec3>),
    /// At random, uniform in a shape (and the space), by rejection (2007, section 3).
    Random {
        /// How many.
        count: u32,
        /// The shape.
        inside: Shape,
        /// Least distance between any two.
        apart: f64,
        /// Name of the random stream.
        stream: String,
    },
}

impl Placement {
    /// How many endpoints there will be.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::At(points) => points.len(),
            Self::Random { count, .. } => *count as usize,
        }
    }

    /// The nodes, in order. A longer random set starts with the shorter one.
    ///
    /// # Errors
    /// A sentence that says which endpoint cannot be placed.
    pub fn place<const N: usize>(&self, lattice: &Lattice<N>, seed: u64) -> Result<Vec<Node>, String> {
        match self {
            Self::At(points) => points
                .iter()
                .map(|&p| {
                    lattice
                        .nearest(p)
                        .ok_or_else(|| format!("the endpoint at {p} is outside the space or where nodes are forbidden"))
                })
                .collect(),
            Self::Random { count, inside, apart, stream } => {
                let mut stream = Stream::new(seed, &format!("endpoints/{stream}"));
                let bounds = inside.bounds();
                let mut placed = Crowd::new(*apart);
                let mut taken = HashSet::new();
                let mut nodes = Vec::new();
                let mut rejections = 0;
                while nodes.len() < *count as usize {
                    let [u, v, w]: [f64; 3] = std::array::from_fn(|_| stream.random());
                    let p = bounds.min + bounds.size() * DVec3::new(u, v, w);
                    let p = if lattice.is_plane() { p.with_z(0.0) } else { p };
                    let node = if inside.contains(p) { lattice.nearest(p) } else { None };
                    let node = node.filter(|node| !taken.contains(node) && placed.has_room(p));
                    let Some(node) = node else {
                        rejections += 1;
                        if rejections == MOST_REJECTIONS {
                            return Err(format!(
                                "only {} of {count} endpoints could be placed: make `inside` larger, `apart` ({apart}) smaller, or ask for fewer",
                                nodes.len(),
                            ));
                        }
                        continue;
                    };
                    rejections = 0;
                    taken.insert(node);
                    placed.add(p);
                    nodes.push(node);
                }
                Ok(nodes)
            }
        }
    }
}

/// Points with room around them, in cells as wide as the least distance.
struct Crowd {
    apart: f64,
    cells: HashMap<[i64; 3], Vec<DVec3>>,
}

impl Crowd {
    fn new(apart: f64) -> Self {
        Self { apart, cells: HashMap::new() }
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        p.to_array().map(|c| libm::floor(c / self.apart) as i64)
    }

    fn has_room(&self, p: DVec3) -> bool {
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

    fn add(&mut self, p: DVec3) {
        if self.apart > 0.0 {
            self.cells.entry(self.cell(p)).or_default().push(p);
        }
    }
}
