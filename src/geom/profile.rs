//! Profiles of solids of revolution: cones, and sketched outlines.

use crate::math::DVec2;

/// Longer outlines are thinned to this many points: distances are evaluated at every node of a graph.
const MOST_POINTS: usize = 96;
/// How far a hand-drawn outline may cross its axis, as a share of the axis' length.
const TOUCH: f64 = 0.02;

/// Why an outline is no profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProfileError {
    /// A point has a negative distance from the axis.
    #[error("the outline crosses its axis")]
    Crosses,
    /// A sketched outline lies on both sides of its axis.
    #[error("the outline crosses its axis: draw it on one side")]
    BothSides,
    /// The solid would have no volume.
    #[error("the outline encloses nothing: it needs a distance from its axis, and a height")]
    Empty,
    /// A sketch has no stroke but the axis.
    #[error("it has no stroke to turn around an axis")]
    NoOutline,
    /// The ends of the axis coincide.
    #[error("the axis has no length")]
    NoAxis,
}

/// The profile of a solid of revolution: x is the distance from the axis, y the height along it. It is closed along the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    points: Vec<DVec2>,
}

impl Profile {
    /// The profile with an open polyline as its outline.
    ///
    /// # Errors
    /// [`ProfileError::Crosses`], [`ProfileError::Empty`].
    pub fn new(points: Vec<DVec2>) -> Result<Self, ProfileError> {
        if points.iter().any(|p| p.x < 0.0) {
            return Err(ProfileError::Crosses);
        }
        let profile = Self { points };
        let area: f64 = profile.edges().map(|(a, b)| (a.x + b.x) * (b.y - a.y)).sum();
        if area.abs() <= 0.0 {
            return Err(ProfileError::Empty);
        }
        Ok(profile)
    }

    /// The outline in the strokes of a sketch, scaled so that its axis has this length. The axis is the stroke of two points,
    /// or the page's left edge over the height of the outline.
    ///
    /// # Errors
    /// [`ProfileError::NoOutline`], [`ProfileError::NoAxis`], [`ProfileError::BothSides`].
    pub fn outline(lines: &[Vec<DVec2>], length: f64) -> Result<Vec<DVec2>, ProfileError> {
        let is_axis = |line: &&Vec<DVec2>| line.len() == 2;
        let axis = lines.iter().find(is_axis).filter(|_| lines.len() > 1);
        let outline = lines.iter().filter(|line| axis.is_none_or(|axis| !std::ptr::eq(axis, *line)));
        let outline = outline.max_by_key(|line| line.len()).filter(|line| line.len() > 1);
        let outline = outline.ok_or(ProfileError::NoOutline)?;
        let low = outline.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let high = outline.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let (mut from, mut to) = axis.map_or((DVec2::new(0.0, low), DVec2::new(0.0, high)), |a| (a[0], a[1]));
        if from.y > to.y {
            std::mem::swap(&mut from, &mut to);
        }
        let along = (to - from).try_normalize().ok_or(ProfileError::NoAxis)?;
        let scale = length / (to - from).length();
        let side = outline.iter().map(|&p| along.perp_dot(p - from)).fold(0.0, |sum, s| sum + s);
        // The outline may be on either side of the axis.
        let side = if side < 0.0 { -1.0 } else { 1.0 };
        let step = outline.len().div_ceil(MOST_POINTS);
        let kept = outline.iter().enumerate().filter(|(i, _)| i % step == 0 || i + 1 == outline.len());
        kept.map(|(_, &p)| {
            let across = along.perp_dot(p - from) * scale * side;
            if across < -TOUCH * length {
                return Err(ProfileError::BothSides);
            }
            Ok(DVec2::new(across.max(0.0), along.dot(p - from) * scale))
        })
        .collect()
    }

    /// The edges of the closed profile, those to the axis and along it included.
    fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        let (start, end) = (DVec2::new(0.0, first.y), DVec2::new(0.0, last.y));
        let outline = self.points.windows(2).map(|w| (w[0], w[1]));
        [(start, first)].into_iter().chain(outline).chain([(last, end), (end, start)])
    }

    /// Signed distance of `p` from the surface, negative inside.
    #[must_use]
    pub fn distance(&self, p: DVec2) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut is_inside = false;
        for (a, b) in self.edges() {
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                is_inside = !is_inside;
            }
            // The axis is inside the solid, not on its surface.
            if a.x > 0.0 || b.x > 0.0 {
                let edge = b - a;
                let t = ((p - a).dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                nearest = nearest.min((p - a - edge * t).length_squared());
            }
        }
        let distance = libm::sqrt(nearest);
        if is_inside { -distance } else { distance }
    }

    /// The greatest distance from the axis, the least and the greatest height.
    #[must_use]
    pub fn extent(&self) -> (f64, f64, f64) {
        self.points.iter().fold((0.0, f64::INFINITY, f64::NEG_INFINITY), |(across, low, high), p| {
            (f64::max(across, p.x), f64::min(low, p.y), f64::max(high, p.y))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sketch_is_turned_around_its_axis() {
        let axis = vec![DVec2::new(0.5, 0.1), DVec2::new(0.5, 0.9)];
        for side in [-1.0, 1.0] {
            let stroke = vec![DVec2::new(0.5, 0.1), DVec2::new(0.5 + 0.2 * side, 0.5), DVec2::new(0.5, 0.9)];
            let outline = Profile::outline(&[stroke, axis.clone()], 8.0).unwrap();
            let profile = Profile::new(outline).unwrap();
            assert!((profile.extent().0 - 2.0).abs() < 1e-9);
            assert!((profile.distance(DVec2::new(2.5, 4.0)) - 0.5).abs() < 1e-9);
            assert!(profile.distance(DVec2::new(0.0, 4.0)) < -1.0);
        }
        let across = vec![DVec2::new(0.3, 0.1), DVec2::new(0.7, 0.4), DVec2::new(0.9, 0.9)];
        assert_eq!(Profile::outline(&[across, axis], 8.0), Err(ProfileError::BothSides));
        assert!(Profile::new(vec![DVec2::new(0.0, 0.0), DVec2::new(0.0, 2.0)]).is_err());
    }
}
