//! Outlines that are turned around an axis: cones, and what a user sketches.

use crate::math::DVec2;

/// More points than this are thinned out: distances are asked for at every node.
const MOST_POINTS: usize = 96;
/// An outline may touch its axis: this share of the axis' length beyond it is drawing by hand.
const TOUCH: f64 = 0.02;

/// An outline beside an axis: x is the distance from it, y the height along it. The outline is closed along the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    points: Vec<DVec2>,
}

impl Profile {
    /// From the outline's open polyline.
    ///
    /// # Errors
    /// A sentence where it encloses nothing or lies beyond the axis.
    pub fn new(points: Vec<DVec2>) -> Result<Self, String> {
        if points.iter().any(|p| p.x < 0.0) {
            return Err("the outline crosses its axis".to_owned());
        }
        let profile = Self { points };
        let area: f64 = profile.edges().map(|(a, b)| (a.x + b.x) * (b.y - a.y)).sum();
        if area.abs() <= 0.0 {
            return Err("the outline encloses nothing: it needs a distance from its axis, and a height".to_owned());
        }
        Ok(profile)
    }

    /// The outline of a sketch, scaled so that its axis has this length: the axis is the straight stroke of two points,
    /// or the page's left edge beside the outline.
    ///
    /// # Errors
    /// A sentence where there is no outline, or it crosses the axis.
    pub fn outline(lines: &[Vec<DVec2>], length: f64) -> Result<Vec<DVec2>, String> {
        let is_axis = |line: &&Vec<DVec2>| line.len() == 2;
        let axis = lines.iter().find(is_axis).filter(|_| lines.len() > 1);
        let outline = lines.iter().filter(|line| axis.is_none_or(|axis| !std::ptr::eq(axis, *line)));
        let outline = outline.max_by_key(|line| line.len()).filter(|line| line.len() > 1);
        let outline = outline.ok_or("it has no stroke to turn around an axis")?;
        let low = outline.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let high = outline.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let (mut from, mut to) = axis.map_or((DVec2::new(0.0, low), DVec2::new(0.0, high)), |a| (a[0], a[1]));
        if from.y > to.y {
            std::mem::swap(&mut from, &mut to);
        }
        let along = (to - from).try_normalize().ok_or("the axis has no length")?;
        let scale = length / (to - from).length();
        let side = outline.iter().map(|&p| along.perp_dot(p - from)).fold(0.0, |sum, s| sum + s);
        // The outline may be on either side of the axis.
        let side = if side < 0.0 { -1.0 } else { 1.0 };
        let step = outline.len().div_ceil(MOST_POINTS);
        let kept = outline.iter().enumerate().filter(|(i, _)| i % step == 0 || i + 1 == outline.len());
        kept.map(|(_, &p)| {
            let across = along.perp_dot(p - from) * scale * side;
            if across < -TOUCH * length {
                return Err("the outline crosses its axis: draw it on one side".to_owned());
            }
            Ok(DVec2::new(across.max(0.0), along.dot(p - from) * scale))
        })
        .collect()
    }

    /// The edges, those to the axis and along it included.
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
            // The axis is within the solid, not on its surface.
            if a.x > 0.0 || b.x > 0.0 {
                let way = b - a;
                let share = ((p - a).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                nearest = nearest.min((p - a - way * share).length_squared());
            }
        }
        let distance = libm::sqrt(nearest);
        if is_inside { -distance } else { distance }
    }

    /// Its greatest distance from the axis, and its least and greatest height.
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
        assert!(Profile::outline(&[across, axis], 8.0).unwrap_err().contains("crosses"));
        assert!(Profile::new(vec![DVec2::new(0.0, 0.0), DVec2::new(0.0, 2.0)]).is_err());
    }
}
