//! Endpoints in the vicinity of what a step grew (Xu and Mould 2007, section 4: side branches of lightning).

use rand::RngExt;
use schemars::JsonSchema;
use serde::Deserialize;

use super::crowd::Crowd;
use super::error::Problem;
use crate::geom::Shape;
use crate::math::{DVec3, Stream};
use crate::skeleton::Skeleton;

/// Random placement gives up after this many rejections in a row.
pub(super) const MOST_REJECTIONS: u32 = 20_000;
/// Endpoints near a step are no nearer than this share of the reach: shorter branches would not be seen.
const LEAST_REACH: f64 = 0.3;

/// Where side branches tend to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Toward {
    /// Down.
    #[default]
    Down,
    /// The way that the step goes, from its root to the end of its first path.
    Along,
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

impl Near {
    /// What draws a place in the vicinity of the step, of what the steps before have grown.
    pub(super) fn draw<'a>(
        &'a self,
        grown: &[Option<&'a Skeleton>],
        is_plane: bool,
    ) -> Result<impl Fn(&mut Stream) -> DVec3 + 'a, Problem> {
        let skeleton = grown[self.step].filter(|s| s.segments().next().is_some());
        let skeleton = skeleton.ok_or(Problem::NothingNear)?;
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
    /// [`Problem::NoRoom`].
    pub(super) fn draw_places(
        &self,
        seed: u64,
        grown: &[Option<&Skeleton>],
        is_plane: bool,
    ) -> Result<Vec<DVec3>, Problem> {
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
                    return Err(Problem::NoRoom { placed: places.len(), count: self.count, apart: self.apart });
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
