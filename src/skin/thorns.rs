//! Thorns: small cones on the surface of limbs, which renderers with displacement shaders make themselves (Xu and Mould 2007,
//! Fig. 12: staghorn coral).

use rand::RngExt;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::{DVec3, GOLDEN_ANGLE, Stream, rotation};
use crate::model::{Ball, Body, BodyError, Limbs, Object, Thorns};
use crate::skeleton::Skeleton;

/// Thorns on the surface of limbs: cones of their own for POV-Ray and the preview, in RIB a displacement of the limbs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThornsSpec {
    /// How far they stand out, in scene units.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub length: f64,
    /// Radius at their foot.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub radius: f64,
    /// About how far they are from each other.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub apart: f64,
    /// How far they lean towards the tip of the limb: 0 not at all, 1 by 45 degrees.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 5.0))]
    pub lean: f64,
}

/// Radius of a thorn's tip over that of its foot.
const POINT: f64 = 0.15;
impl ThornsSpec {
    /// Bytes that thorns on `skeletons` take at their peak; 0 where there are more than a body may have, which is told when they are
    /// made.
    #[must_use]
    pub fn bytes_needed(&self, skeletons: &[&Skeleton]) -> u64 {
        let count = skeletons.iter().map(|s| s.area()).sum::<f64>() / (self.apart * self.apart);
        if BodyError::check_count((count * 3.0) as usize).is_err() {
            return 0;
        }
        // Lists of unknown length are half empty at worst.
        (count * (2 * size_of::<Ball>() + size_of::<[u32; 2]>()) as f64 * 1.5) as u64
    }

    /// What displacement shaders need of it.
    #[must_use]
    pub fn displacement(&self) -> Thorns {
        Thorns { length: self.length, radius: self.radius, apart: self.apart, lean: self.lean }
    }

    /// The thorns on the limbs of `object` as an object of their own with the same foot; `None` where there are none.
    ///
    /// # Errors
    /// [`BodyError::TooMany`].
    pub fn on(&self, object: &Object, stream: &Stream) -> Result<Option<Object>, BodyError> {
        let Body::Limbs(limbs) = &object.body else { return Ok(None) };
        let mut thorns = Limbs { is_thorns: true, ..Limbs::default() };
        let mut random = stream.clone();
        let digits = object.digits;
        // Walking along limbs, a thorn falls due each time that much of their surface has passed.
        let each = self.apart * self.apart;
        let area = |[a, b]: [u32; 2]| {
            let [a, b] = [a, b].map(|ball| limbs.balls[ball as usize]);
            std::f64::consts::PI * (a.radius + b.radius) * a.centre.distance(b.centre)
        };
        // Before any is made.
        let expected = limbs.segments.iter().map(|&segment| area(segment)).sum::<f64>() / each;
        BodyError::check_count((expected * 3.0) as usize)?;
        let mut passed: f64 = random.random::<f64>() * each;
        let mut turn: f64 = 0.0;
        for &[a, b] in &limbs.segments {
            let (area, end) = (area([a, b]), b);
            let (a, b) = (limbs.balls[a as usize], limbs.balls[b as usize]);
            let along = b.centre - a.centre;
            let Some(way) = along.try_normalize() else { continue };
            let side = way.any_orthonormal_vector();
            let start = passed;
            passed += area;
            let first = libm::ceil(start / each);
            let due = libm::floor(passed / each - first + 1.0).max(0.0);
            BodyError::check_count(((thorns.balls.len() + thorns.segments.len()) as f64 + due * 3.0) as usize)?;
            for i in 0..due as u32 {
                let share = (((first + f64::from(i)) * each - start) / area).clamp(0.0, 1.0);
                // Successive thorns stand nowhere in rows.
                turn += GOLDEN_ANGLE + random.random_range(-0.3..0.3);
                let out = rotation(way, turn) * side;
                let radius = a.radius + (b.radius - a.radius) * share;
                let size = random.random_range(0.7..1.0);
                let foot = a.centre + along * share + out * (radius - self.radius * 0.5).max(0.0);
                let tip = foot + (out + way * self.lean).normalize() * (self.length * size + self.radius * 0.5);
                let ball = |centre: DVec3, radius: f64| Ball {
                    centre: digits.round_point(centre),
                    radius: digits.round(radius).max(1.0 / digits.scale()),
                    ..b
                };
                let from = thorns.balls.len() as u32;
                thorns.beyond.extend(limbs.beyond.get(end as usize).into_iter().flat_map(|&beyond| [beyond; 2]));
                thorns.balls.extend([ball(foot, self.radius * size), ball(tip, self.radius * size * POINT)]);
                thorns.segments.push([from, from + 1]);
            }
            passed %= each;
        }
        if thorns.balls.is_empty() {
            return Ok(None);
        }
        let name = format!("{}_thorns", object.name);
        Ok(Some(Object { name, instances: object.instances.clone(), body: Body::Limbs(thorns), ..*object }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Digits;

    /// As many as the surface has room for, feet within it and tips outside.
    #[test]
    fn thorns_stand_on_the_surface() {
        let ball = |z: f64| Ball { centre: DVec3::Z * z, radius: 1.0, cost: 0.0, branch: 0, level: 0 };
        let limbs = Limbs {
            balls: (0..11).map(|i| ball(f64::from(i))).collect(),
            segments: (0..10).map(|i| [i, i + 1]).collect(),
            ..Limbs::default()
        };
        let limb = Object::new("limb", Body::Limbs(limbs), DVec3::ZERO, Digits(6), 0);
        let spec = ThornsSpec { length: 0.3, radius: 0.1, apart: 0.4, lean: 0.5 };
        let thorns = spec.on(&limb, &Stream::new(1, "thorns")).unwrap().unwrap();
        let thorns = thorns.body.limbs().unwrap();
        let expected = 2.0 * std::f64::consts::PI * 10.0 / 0.16;
        assert!((thorns.segments.len() as f64 - expected).abs() < 2.0, "{} {expected}", thorns.segments.len());
        for &[a, b] in &thorns.segments {
            let off = |i: u32| thorns.balls[i as usize].centre.truncate().length();
            assert!(off(a) < 1.0 && off(b) > 1.1 && off(b) < 1.31);
        }
    }
}
