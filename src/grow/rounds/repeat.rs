//! How a step is repeated, with its names resolved.

use rand::RngExt;

use super::influence::Influence;
use super::spec::{Index, LifespanSpec, Loss, Orient};
use crate::geom::Shape;
use crate::math::{DVec3, PerRound, Stream};

/// How a step is repeated, with its names resolved.
#[derive(Clone, Debug)]
pub struct Repeat {
    /// How many rounds at most.
    pub times: u32,
    /// Size of the space around an end over that of the space as it is written.
    pub size: PerRound,
    /// What counts the rounds.
    pub by: Index,
    /// Where the z of that space points.
    pub orient: Orient,
    /// Turns of that direction.
    pub turns: Vec<Turn>,
    /// How many more rounds an end may sprout.
    pub lifespan: LifespanSpec,
    /// What favours some ends over others.
    pub influences: Vec<Influence>,
}

/// A turn of a direction.
#[derive(Clone, Debug)]
pub struct Turn {
    /// Where to.
    pub target: Target,
    /// By how much, in degrees.
    pub by: PerRound,
}

/// Where a direction is turned to.
#[derive(Clone, Debug)]
pub enum Target {
    /// This direction, of length 1.
    Along(DVec3),
    /// Away from this shape, where it is no farther than this.
    From(Shape, f64),
}

impl LifespanSpec {
    /// How much shorter the lifespan of a new end is, where that of the one it sprouted from is `lifespan`.
    pub(super) fn lose(&self, lifespan: u32, random: &mut Stream) -> u32 {
        let u: f64 = random.random();
        match &self.loss {
            Loss::Constant(loss) => *loss,
            Loss::Random(end) if u < *end => lifespan,
            Loss::Random(_) => (libm::ceil(random.random::<f64>() * f64::from(lifespan)) as u32).max(1),
            Loss::Chances(chances) => {
                let mut sum = 0.0;
                let drawn = chances.iter().find(|[chance, _]| {
                    sum += chance;
                    u < sum
                });
                drawn.or(chances.last()).map_or(1, |[_, loss]| *loss as u32).max(1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 30 % end, and the others lose a part that is even over 1 to their lifespan (2012, section 3.3.3).
    #[test]
    fn lifespans_are_lost_as_the_paper_has_it() {
        let spec = LifespanSpec { first: 5, loss: Loss::Random(0.3) };
        let mut random = Stream::new(1, "loss");
        let mut counts = [0_u32; 6];
        let n = 20_000;
        for _ in 0..n {
            counts[spec.lose(5, &mut random) as usize] += 1;
        }
        // A loss of 5 ends it too: 0.3, and a fifth of 0.7.
        let expected = [0.0, 0.14, 0.14, 0.14, 0.14, 0.44].map(|share| share * f64::from(n));
        let chi2: f64 = (1..6)
            .map(|i| (f64::from(counts[i]) - expected[i]) * (f64::from(counts[i]) - expected[i]) / expected[i])
            .sum();
        assert!(counts[0] == 0 && chi2 < 18.5, "{counts:?}: chi-squared {chi2} over 4 degrees of freedom");
        let spec = LifespanSpec { first: 5, loss: Loss::Chances(vec![[0.25, 1.0], [0.75, 3.0]]) };
        let threes = (0..n).filter(|_| spec.lose(5, &mut random) == 3).count() as f64 / f64::from(n);
        assert!((threes - 0.75).abs() < 0.02);
    }
}
