//! The trees that benchmarks trace.

use lichtenberg::bvh::RoundCone;
use lichtenberg::math::{DVec3, Stream};
use rand::RngExt;

/// A random tree of `count` segments, about 12 units tall: limbs of ten segments, each with limbs at its joints.
pub fn tree(count: usize) -> Vec<RoundCone> {
    let mut random = Stream::new(1, "bench");
    let mut unit = || {
        let z = random.random_range(-1.0..1.0_f64);
        let turn = random.random_range(0.0..std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * libm::cos(turn), r * libm::sin(turn), z)
    };
    let mut cones = Vec::with_capacity(count);
    let mut open = std::collections::VecDeque::from([(DVec3::ZERO, DVec3::Z, 5.0_f64, 0.3_f64)]);
    while cones.len() < count {
        let Some((mut at, mut way, length, radius)) = open.pop_front() else { break };
        for i in 0..10 {
            let r = |i: f64| radius * (1.0 - 0.06 * i);
            way = (way + unit() * 0.25).normalize();
            let to = at + way * (length / 10.0);
            cones.push(RoundCone { a: at, ra: r(f64::from(i)), b: to, rb: r(f64::from(i + 1)) });
            at = to;
            if i >= 3 {
                open.push_back((at, (way + unit() * 0.9).normalize(), length * 0.62, radius * 0.55));
            }
        }
    }
    cones.truncate(count);
    cones
}
