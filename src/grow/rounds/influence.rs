//! What favours some ends over others: ends are ranked, and what was drawn for their round is dealt out by rank (Xu and
//! Mould 2012, section 3.4).

use rand::RngExt;
use rayon::prelude::*;

use super::light::{Canopy, sky};
use super::spec::ShadeSpec;
use crate::geom::Shape;
use crate::math::{DVec3, Stream};

/// Rays start this many clumps away from their end: its own leaves do not shade it.
const OFF: f64 = 1.5;

/// What favours some ends over others, with its names resolved.
#[derive(Clone, Debug)]
pub struct Influence {
    /// Its name.
    pub name: String,
    /// What ends are ranked by.
    pub rank: Rank,
    /// Least and greatest count of endpoints.
    pub count: Option<[u32; 2]>,
    /// Least and greatest loss of lifespan.
    pub loss: Option<[u32; 2]>,
    /// Least and greatest size.
    pub size: Option<[f64; 2]>,
}

/// What ends are ranked by.
#[derive(Clone, Debug)]
pub enum Rank {
    /// The angle to this direction, of length 1.
    Angle(DVec3),
    /// The distance from this shape, the nearest first.
    Near(Shape),
    /// The distance from this shape, the farthest first.
    Far(Shape),
    /// Blocked rays to the sky.
    Shade(ShadeSpec),
}

/// What an end is dealt.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Share {
    pub count: Option<u32>,
    pub loss: Option<u32>,
    pub size: Option<f64>,
    /// It is too dark to live.
    pub dies: bool,
}

impl Influence {
    /// How thick limbs are for [`Canopy`], where it needs one.
    #[must_use]
    pub fn clump(&self) -> Option<f64> {
        if let Rank::Shade(shade) = &self.rank { Some(shade.clump) } else { None }
    }

    /// What each of `ends` (where it is, and its way) is dealt. The best has the least loss, the greatest count and size.
    pub(super) fn deal(&self, ends: &[(DVec3, DVec3)], canopy: Option<&Canopy>, mut random: Stream) -> Vec<Share> {
        let mut shares = vec![Share::default(); ends.len()];
        let mut ranks: Vec<(f64, usize)> = match &self.rank {
            Rank::Angle(to) => ends.iter().map(|(_, way)| -way.dot(*to)).collect::<Vec<f64>>(),
            Rank::Near(shape) => ends.iter().map(|(p, _)| shape.distance(*p)).collect(),
            Rank::Far(shape) => ends.iter().map(|(p, _)| -shape.distance(*p)).collect(),
            Rank::Shade(shade) => {
                let sky = sky(shade.rays, shade.open.radians());
                let near = shade.clump * OFF;
                let blocked: Vec<u32> =
                    ends.par_iter().map(|(p, _)| canopy.map_or(0, |c| c.blocked(*p, &sky, near))).collect();
                for (share, &blocked) in shares.iter_mut().zip(&blocked) {
                    share.dies = f64::from(blocked) > shade.dies * f64::from(shade.rays);
                }
                blocked.into_iter().map(f64::from).collect()
            }
        }
        .into_iter()
        .zip(0..)
        .collect();
        ranks.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut whole = |range: Option<[u32; 2]>| {
            range.map(|[least, most]| {
                let mut drawn: Vec<u32> = ends.iter().map(|_| random.random_range(least..=most)).collect();
                drawn.sort_unstable();
                drawn
            })
        };
        let (counts, losses) = (whole(self.count), whole(self.loss));
        let sizes = self.size.map(|[least, most]| {
            let mut drawn: Vec<f64> = ends.iter().map(|_| least + (most - least) * random.random::<f64>()).collect();
            drawn.sort_by(f64::total_cmp);
            drawn
        });
        for (place, &(_, end)) in ranks.iter().enumerate() {
            let from_top = ends.len() - 1 - place;
            let share = &mut shares[end];
            share.count = counts.as_ref().map(|drawn| drawn[from_top]);
            share.loss = losses.as_ref().map(|drawn| drawn[place]);
            share.size = sizes.as_ref().map(|drawn| drawn[from_top]);
        }
        shares
    }
}

impl Share {
    /// What both deal: the later one has the last word, sizes multiply.
    pub fn with(self, other: Self) -> Self {
        Self {
            count: other.count.or(self.count),
            loss: other.loss.or(self.loss),
            size: match (self.size, other.size) {
                (Some(a), Some(b)) => Some(a * b),
                (a, b) => a.or(b),
            },
            dies: self.dies || other.dies,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::Skeleton;

    #[test]
    fn the_best_get_the_most() {
        let influence = Influence {
            name: "sun".to_owned(),
            rank: Rank::Angle(DVec3::X),
            count: Some([0, 9]),
            loss: Some([1, 4]),
            size: Some([0.5, 2.0]),
        };
        let ends: Vec<_> = (0..50)
            .map(|i| {
                let turn = f64::from(i * 7 % 50) * 0.06;
                (DVec3::ZERO, DVec3::new(libm::cos(turn), libm::sin(turn), 0.0))
            })
            .collect();
        let shares = influence.deal(&ends, None, Stream::new(3, "deal"));
        for (a, (_, way)) in shares.iter().zip(&ends) {
            for (b, (_, other)) in shares.iter().zip(&ends) {
                if way.x > other.x {
                    assert!(a.count >= b.count && a.loss <= b.loss && a.size >= b.size);
                }
            }
        }
        let counts: Vec<_> = shares.iter().filter_map(|s| s.count).collect();
        assert!(counts.contains(&0) && counts.contains(&9));
    }

    #[test]
    fn a_roof_takes_the_light() {
        let mut skeleton = Skeleton::new(vec!["main".to_owned()]);
        let mut known = std::collections::HashMap::new();
        let row = (0..40_u32).map(|i| (i, DVec3::new(f64::from(i) - 20.0, 0.0, 3.0), 0.0));
        skeleton.add_path(&mut known, 0, row);
        let canopy = Canopy::new(&[&skeleton], 1.0);
        let shade = ShadeSpec { clump: 1.0, rays: 64, dies: 0.2, open: crate::math::Degrees(75.0) };
        let influence = Influence {
            name: "shade".to_owned(),
            rank: Rank::Shade(shade),
            count: Some([0, 5]),
            loss: None,
            size: None,
        };
        let ends = [(DVec3::ZERO, DVec3::Z), (DVec3::new(0.0, 40.0, 0.0), DVec3::Z)];
        let shares = influence.deal(&ends, Some(&canopy), Stream::new(1, "deal"));
        assert!(shares[0].dies && !shares[1].dies && shares[0].count <= shares[1].count);
    }
}
