//! How high the ground is.

use crate::math::DVec2;
use crate::model::{GroundSpec, Object, Relief};

/// Limbs that come out of the ground count where they are at least this share of the thickest.
const THICK: f64 = 0.3;
/// A mound is a bell curve of this width, in radii of its limb.
const WIDE: f64 = 2.2;
/// Limbs that have mounds, at most.
const MOST: usize = 256;
/// The level ground lies below the relief by this share of what that may rise.
const BELOW: f64 = 0.05;

/// How high the ground of a scene is, wherever one asks.
pub(super) struct Heights {
    level: f64,
    layers: Vec<Relief>,
    mound: f64,
    /// Limbs that come out of the ground: where, and their radii.
    feet: Vec<(DVec2, f64)>,
    /// How far all layers may rise.
    rise: f64,
    /// The size of the smallest that there is.
    least: f64,
}

impl Heights {
    /// Of the ground `spec`, on which `objects` stand.
    pub fn new(spec: &GroundSpec, objects: &[Object]) -> Self {
        let feet = if spec.mound > 0.0 { feet(spec.height, objects) } else { Vec::new() };
        let smallest = spec.relief.iter().map(|layer| layer.size.max(layer.from) * 0.1);
        let narrowest = feet.iter().map(|&(_, radius)| radius * 0.3);
        Self {
            level: spec.height,
            layers: spec.relief.iter().map(|&layer| Relief::new(layer)).collect(),
            mound: spec.mound,
            rise: spec.relief.iter().map(|layer| layer.height).sum(),
            least: smallest.chain(narrowest).fold(f64::INFINITY, f64::min),
            feet,
        }
    }

    /// Is it level all over?
    pub fn is_level(&self) -> bool {
        self.layers.is_empty() && self.feet.is_empty()
    }

    /// The size of its finest shapes.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// The height of the level ground, which lies below all that rises.
    pub fn below(&self) -> f64 {
        self.level - self.rise * BELOW
    }

    /// Its height at a place.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let rise: f64 = self.layers.iter().map(|layer| layer.at(x, y)).sum();
        let mound = self.feet.iter().map(|&(foot, radius)| {
            let far = (DVec2::new(x, y) - foot).length_squared() / (WIDE * radius * WIDE * radius);
            if far < 16.0 { self.mound * radius * libm::exp(-far) } else { 0.0 }
        });
        self.level + rise + mound.fold(0.0, f64::max)
    }
}

/// Where limbs come out of the ground.
fn feet(level: f64, objects: &[Object]) -> Vec<(DVec2, f64)> {
    let limbs = objects.iter().filter(|object| object.body.limbs().is_some());
    let balls = limbs.flat_map(|object| object.balls_in_world());
    let mut feet: Vec<(DVec2, f64)> =
        balls.filter(|(p, radius)| (p.z - level).abs() <= *radius).map(|(p, radius)| (p.truncate(), radius)).collect();
    feet.sort_by(|a, b| b.1.total_cmp(&a.1));
    let least = feet.first().map_or(0.0, |&(_, radius)| radius * THICK);
    feet.retain(|&(_, radius)| radius >= least);
    feet.truncate(MOST);
    feet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use crate::model::{Ball, Body, Digits, Limbs};

    #[test]
    fn the_ground_rises_where_a_trunk_comes_out_of_it() {
        let ball =
            |x: f64, z: f64, radius| Ball { centre: DVec3::new(x, 0.0, z), radius, cost: 0.0, branch: 0, level: 0 };
        let balls = vec![ball(0.0, 0.1, 0.4), ball(0.0, 3.0, 0.4), ball(2.0, 0.0, 0.2), ball(3.0, 0.0, 0.01)];
        let limbs = Limbs { balls, ..Limbs::default() };
        let object = Object::new("tree", Body::Limbs(limbs), DVec3::new(5.0, 0.0, 1.0), Digits(4), 0);
        let spec = |more: &str| toml::from_str(&format!("colour = \"#445522\"\nheight = 1\n{more}")).unwrap();
        let mounds = Heights::new(&spec("mound = 0.5"), std::slice::from_ref(&object));
        // The trunk and a root, but not the fine one; what is in the air is none.
        assert_eq!(mounds.feet.len(), 2);
        assert!((mounds.at(5.0, 0.0) - 1.2).abs() < 1e-12 && (mounds.at(7.0, 0.0) - 1.1).abs() < 1e-2);
        assert_eq!((mounds.at(20.0, 0.0), mounds.below()), (1.0, 1.0));
        let hills =
            Heights::new(&spec("relief = [{ height = 2, size = 9 }, { height = 30, size = 80, from = 50 }]"), &[]);
        assert!((-40..40).all(|i| (1.0..=3.0).contains(&hills.at(f64::from(i), 0.3))));
        assert!(hills.below() < 1.0 && !hills.is_level());
        assert!(Heights::new(&spec("mound = 0.5"), &[]).is_level());
    }
}
