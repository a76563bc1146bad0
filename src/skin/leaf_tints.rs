//! Colours of leaves: no two are alike, those inside a crown are darker.

use rand::RngExt;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::math::{Colour, DVec3, Stream};
use crate::skeleton::Skeleton;

/// Colours that leaves have in place of their material's own, in a few groups.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeafTints {
    /// From the darkest to the lightest, with what lies between them. A leaf's is by its shoot, by itself, and by how far out in the
    /// crown it is.
    #[schemars(length(min = 2, max = 16))]
    pub colours: Vec<Colour>,
    /// The share of leaves that have withered.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub withered: f64,
    /// Their colour.
    #[serde(default = "brown")]
    pub withered_colour: Colour,
}

fn brown() -> Colour {
    Colour([0.21, 0.12, 0.04])
}

/// Groups of leaves that are green: each is an object of its own.
const GROUPS: u8 = 8;
/// How much shoot, leaf and place count.
const WEIGHTS: [f64; 3] = [0.4, 0.35, 0.25];

impl LeafTints {
    /// The colour of each group.
    #[must_use]
    pub fn groups(&self) -> Vec<Colour> {
        let between = |t: f64| {
            let last = self.colours.len().saturating_sub(1);
            let at = t * last as f64;
            let first = (libm::floor(at) as usize).min(last.saturating_sub(1));
            self.colours[first].mixed(self.colours[(first + 1).min(last)], at - first as f64)
        };
        let green = (0..GROUPS).map(|group| between(f64::from(group) / f64::from(GROUPS - 1)));
        green.chain((self.withered > 0.0).then_some(self.withered_colour)).collect()
    }
}

/// Which group a leaf is in.
pub(super) struct Tinting<'a> {
    spec: &'a LeafTints,
    middle: DVec3,
    reach: f64,
}

impl<'a> Tinting<'a> {
    /// Of the leaves at the ends of `skeletons`.
    pub fn new(spec: &'a LeafTints, skeletons: &[&Skeleton]) -> Self {
        let ends = || skeletons.iter().flat_map(|s| s.ends(false).map(|(end, _)| s.nodes[end as usize].position));
        let middle = ends().sum::<DVec3>() / ends().count().max(1) as f64;
        let reach = ends().map(|p| p.distance(middle)).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        Self { spec, middle, reach }
    }

    /// The group of one leaf after the other, by where it is, on the shoot whose numbers are `stream`'s.
    pub fn shoot<'b>(&'b self, stream: &Stream) -> impl FnMut(DVec3) -> u8 + 'b {
        let mut random = stream.nth(0);
        let shoot: f64 = random.random();
        move |at| {
            let [own, fate]: [f64; 2] = std::array::from_fn(|_| random.random());
            if fate < self.spec.withered {
                return GROUPS;
            }
            let out = (at.distance(self.middle) / self.reach).min(1.0);
            let light = [shoot, own, out].into_iter().zip(WEIGHTS).map(|(x, weight)| x * weight).sum::<f64>();
            // The sum of what is even at random is seldom near its ends.
            let spread = ((light - 0.5) * 1.6 + 0.5).clamp(0.0, 1.0);
            ((spread * f64::from(GROUPS)) as u8).min(GROUPS - 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{Path, SkeletonNode};

    fn tints(withered: f64) -> LeafTints {
        let colours = [0.0, 0.2, 1.0].map(|x| Colour([x, 2.0 * x, 0.0])).to_vec();
        LeafTints { colours, withered, withered_colour: brown() }
    }

    #[test]
    fn groups_go_from_the_first_colour_to_the_last() {
        let groups = tints(0.1).groups();
        assert_eq!((groups.len(), groups[0].0, groups[8]), (9, [0.0; 3], brown()));
        assert!((groups[7].0[0] - 1.0).abs() < 1e-12 && groups.windows(2).take(7).all(|w| w[0].0[1] < w[1].0[1]));
        assert_eq!(tints(0.0).groups().len(), 8);
    }

    #[test]
    fn outer_leaves_are_lighter_and_some_wither() {
        let spec = tints(0.25);
        let node = |x: f64| SkeletonNode::new(DVec3::X * x, (x != 0.0).then_some(0), 0.0, 0);
        let skeleton = Skeleton {
            nodes: [0.0, 3.0, -3.0].map(node).to_vec(),
            paths: [1, 2].map(|end| Path { end, ..Path::default() }).to_vec(),
            ..Skeleton::default()
        };
        let tinting = Tinting::new(&spec, &[&skeleton]);
        let mean = |x: f64| {
            let groups: Vec<u8> = (0..2000).map(|i| tinting.shoot(&Stream::new(i, "leaves"))(DVec3::X * x)).collect();
            let green: Vec<f64> =
                groups.iter().filter(|&&group| group < GROUPS).map(|&group| f64::from(group)).collect();
            let withered = 1.0 - green.len() as f64 / 2000.0;
            assert!((withered - 0.25).abs() < 0.04, "{withered}");
            green.iter().sum::<f64>() / green.len() as f64
        };
        assert!(mean(3.0) > mean(0.0) + 1.5);
    }
}
