//! Endpoints: where paths are to go.

use std::collections::HashMap;

use rand::RngExt;
use rustc_hash::FxHashSet;

use super::Toward;
use crate::geom::Shape;
use crate::graph::{Lattice, Node};
use crate::math::{DVec3, PerRound, Stream};
use crate::skeleton::Skeleton;

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
    /// At the last of each list of points, by way of the others.
    Through(Vec<Vec<DVec3>>),
    /// At random, uniform in a shape (and the space), by rejection (2007, section 3).
    Random {
        /// How many; of a repeated step in each round, around each end.
        count: PerRound,
        /// The shape; without it the space's own. In a repeated step it lies in the space around each end.
        inside: Option<Shape>,
        /// Greatest depth below the shape's surface.
        shell: Option<f64>,
        /// Least distance between any two.
        apart: f64,
        /// Name of the random stream.
        stream: String,
    },
    /// At random in the vicinity of what a step grew.
    Near(Near),
}

/// Endpoints in the vicinity of a step.
#[derive(Clone, Debug)]
pub struct Near {
    /// How many.
    pub count: u32,
    /// Index of the step, which grew before.
    pub step: usize,
    /// Greatest distance from it where it starts.
    pub reach: f64,
    /// What `lower` is a bias towards.
    pub toward: Toward,
    /// Bias from 0 to 1: the direction is within `180 (1 - lower)` degrees of that.
    pub lower: f64,
    /// How much the reach has shrunk where the step ends, from 0 to 1.
    pub shorten: f64,
    /// Where they may be.
    pub inside: Shape,
    /// Least distance between any two.
    pub apart: f64,
    /// Name of the random stream.
    pub stream: String,
}

/// Endpoints near a step are no nearer than this share of the reach: shorter branches would not be seen.
const LEAST_REACH: f64 = 0.3;

impl Placement {
    /// How many endpoints there will be.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::At(points) => points.len(),
            Self::Through(lists) => lists.len(),
            Self::Random { count, .. } => count.at(0) as usize,
            Self::Near(Near { count, .. }) => *count as usize,
        }
    }

    /// The nodes of a lattice in the shape `own`, in order, and where exactly they are meant where that is told. A longer
    /// random set starts with the shorter one. `grown` is what the steps before have grown, by index.
    ///
    /// # Errors
    /// A sentence that says which endpoint cannot be placed.
    pub fn place<const N: usize>(
        &self,
        lattice: &Lattice<N>,
        own: &Shape,
        seed: u64,
        grown: &[Option<&Skeleton>],
    ) -> Result<Vec<(Node, Option<DVec3>)>, String> {
        match self {
            Self::At(points) => points
                .iter()
                .map(|&p| {
                    let node = lattice.nearest_within(p).ok_or_else(|| {
                        format!("the endpoint at {p} is outside the space or where nodes are forbidden")
                    })?;
                    Ok((node, Some(p)))
                })
                .collect(),
            Self::Through(_) => Err("`through` needs scattered nodes (`nodes.scatter`)".to_owned()),
            Self::Random { count, inside, apart, shell, stream } => {
                let inside = inside.as_ref().unwrap_or(own);
                let bounds = inside.bounds();
                let draw = |stream: &mut Stream| {
                    let [u, v, w]: [f64; 3] = std::array::from_fn(|_| stream.random());
                    let p = bounds.min + bounds.size() * DVec3::new(u, v, w);
                    if lattice.is_plane() { p.with_z(0.0) } else { p }
                };
                let fits = |p: DVec3| inside.contains(p) && shell.is_none_or(|shell| inside.depth(p) <= shell);
                reject(lattice, seed, count.at(0) as u32, &fits, *apart, stream, draw)
            }
            Self::Near(near) => {
                let draw = near.draw(grown, lattice.is_plane())?;
                let fits = |p: DVec3| near.inside.contains(p);
                reject(lattice, seed, near.count, &fits, near.apart, &near.stream, draw)
            }
        }
    }
}

impl Near {
    /// What draws a place in the vicinity of the step, of what the steps before have grown.
    fn draw<'a>(
        &'a self,
        grown: &[Option<&'a Skeleton>],
        is_plane: bool,
    ) -> Result<impl Fn(&mut Stream) -> DVec3 + 'a, String> {
        let skeleton = grown[self.step].filter(|s| s.segments().next().is_some());
        let skeleton = skeleton.ok_or("the step that they are to be near has no limbs")?;
        let ends: Vec<f64> = skeleton
            .segments()
            .scan(0.0, |sum, (a, b)| {
                *sum += (b.position - a.position).length();
                Some(*sum)
            })
            .collect();
        let segments: Vec<_> = skeleton.segments().collect();
        let whole = ends[ends.len() - 1];
        let way = match (self.toward, skeleton.paths.first()) {
            (Toward::Along, Some(path)) => skeleton.nodes[path.end as usize].position - skeleton.nodes[0].position,
            _ => DVec3::ZERO,
        };
        let down = if is_plane { DVec3::NEG_Y } else { DVec3::NEG_Z };
        let way = way.normalize_or(down);
        let oldest = skeleton.nodes.iter().map(|n| n.age).fold(f64::MIN_POSITIVE, f64::max);
        Ok(move |stream: &mut Stream| {
            let [u, v, w, x, y]: [f64; 5] = std::array::from_fn(|_| stream.random());
            let i = ends.partition_point(|&end| end < u * whole).min(segments.len() - 1);
            let (from, to) = segments[i];
            let start = from.position + (to.position - from.position) * v;
            let reach = self.reach * (1.0 - self.shorten * (from.age / oldest));
            start + self.direction(way, w, x, is_plane) * reach * (LEAST_REACH + (1.0 - LEAST_REACH) * y)
        })
    }

    /// Places in the vicinity of the step, apart from each other.
    ///
    /// # Errors
    /// A sentence where there is no room for as many.
    pub(super) fn draw_places(
        &self,
        seed: u64,
        grown: &[Option<&Skeleton>],
        is_plane: bool,
    ) -> Result<Vec<DVec3>, String> {
        let draw = self.draw(grown, is_plane)?;
        let mut stream = Stream::new(seed, &format!("endpoints/{}", self.stream));
        let mut crowd = Crowd::new(self.apart);
        let mut places = Vec::new();
        let mut rejections = 0;
        while places.len() < self.count as usize {
            let p = draw(&mut stream);
            if self.inside.contains(p) && crowd.has_room(p) {
                crowd.add(p);
                places.push(p);
                rejections = 0;
            } else {
                rejections += 1;
                if rejections == MOST_REJECTIONS {
                    return Err(no_room(places.len(), self.count, self.apart));
                }
            }
        }
        Ok(places)
    }

    /// A direction of length 1 within `180 (1 - lower)` degrees of `way`, even over them, from two numbers of 0 to 1.
    fn direction(&self, way: DVec3, u: f64, v: f64, is_plane: bool) -> DVec3 {
        let half = std::f64::consts::PI * (1.0 - self.lower);
        if is_plane {
            let angle = half * (2.0 * u - 1.0);
            let aside = DVec3::new(-way.y, way.x, 0.0);
            return way * libm::cos(angle) + aside * libm::sin(angle);
        }
        let cos = 1.0 - u * (1.0 - libm::cos(half));
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let turn = std::f64::consts::TAU * v;
        let (x, y) = way.any_orthonormal_pair();
        way * cos + x * (sin * libm::cos(turn)) + y * (sin * libm::sin(turn))
    }
}

/// Draws places until there are enough: in the shape, on nodes of their own, apart from each other (2007, section 3).
fn reject<const N: usize>(
    lattice: &Lattice<N>,
    seed: u64,
    count: u32,
    fits: &dyn Fn(DVec3) -> bool,
    apart: f64,
    stream: &str,
    draw: impl Fn(&mut Stream) -> DVec3,
) -> Result<Vec<(Node, Option<DVec3>)>, String> {
    let mut stream = Stream::new(seed, &format!("endpoints/{stream}"));
    let mut placed = Crowd::new(apart);
    let mut taken: FxHashSet<Node> = FxHashSet::default();
    let mut nodes = Vec::new();
    let mut rejections = 0;
    while nodes.len() < count as usize {
        let p = draw(&mut stream);
        let node = if fits(p) { lattice.nearest(p) } else { None };
        let Some(node) = node.filter(|node| !taken.contains(node) && placed.has_room(p)) else {
            rejections += 1;
            if rejections == MOST_REJECTIONS {
                return Err(no_room(nodes.len(), count, apart));
            }
            continue;
        };
        rejections = 0;
        taken.insert(node);
        placed.add(p);
        nodes.push((node, None));
    }
    Ok(nodes)
}

fn no_room(placed: usize, count: u32, apart: f64) -> String {
    format!(
        "only {placed} of {count} endpoints could be placed: make `inside` larger, `apart` ({apart}) smaller, or ask for fewer"
    )
}

/// Points with room around them, in cells as wide as the least distance.
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
