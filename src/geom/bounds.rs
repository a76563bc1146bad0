//! Axis-aligned bounding boxes.

use rand::RngExt;

use crate::math::{DVec3, Stream};

/// Places that [`Bounds::share`] looks at.
const SAMPLES: u32 = 4096;

/// An axis-aligned bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the lowest coordinates.
    pub min: DVec3,
    /// The corner with the highest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The empty box, the identity of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box that contains `points`.
    #[must_use]
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    /// The smallest box that contains it and `p`.
    #[must_use]
    pub fn with_point(self, p: DVec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// The smallest box that contains both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The bounding box of a ball.
    #[must_use]
    pub fn of_ball(centre: DVec3, radius: f64) -> Self {
        Self { min: centre - radius, max: centre + radius }
    }

    /// Translated by `by`.
    #[must_use]
    pub fn moved(self, by: DVec3) -> Self {
        Self { min: self.min + by, max: self.max + by }
    }

    /// Enlarged by `by` on every side.
    #[must_use]
    pub fn grown(self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    /// Extent along each axis.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The centre.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// The share of it where `is_in` holds, of 4096 places at random.
    #[must_use]
    pub fn share(&self, is_in: impl Fn(DVec3) -> bool) -> f64 {
        let mut random = Stream::new(0, "share");
        let mut place = || self.min + self.size() * DVec3::from_array(std::array::from_fn(|_| random.random()));
        (0..SAMPLES).filter(|_| is_in(place())).count() as f64 / f64::from(SAMPLES)
    }

    /// Its eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, axis: usize| if i & bit == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(1, 0), pick(2, 1), pick(4, 2))
        })
    }

    /// Distance of `p` from the box; 0 inside.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        self.offset(p).length()
    }

    /// Square of [`Bounds::distance`].
    #[must_use]
    pub fn distance_squared(&self, p: DVec3) -> f64 {
        self.offset(p).length_squared()
    }

    /// Distance of `p` from the box along each axis; 0 inside.
    fn offset(&self, p: DVec3) -> DVec3 {
        (self.min - p).max(p - self.max).max(DVec3::ZERO)
    }

    /// Is it empty along an axis?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Its greatest side, by which distances and digits are chosen; 1 where it is empty.
    #[must_use]
    pub fn extent(&self) -> f64 {
        if self.is_empty() { 1.0 } else { self.size().max_element() }
    }
}
