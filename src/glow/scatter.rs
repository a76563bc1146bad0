//! The halo: the atmospheric point spread function (Narasimhan and Nayar 2003, "Shedding light on the weather", as Kim
//! and Lin 2004 used it for lightning).

/// The series ends with the term below this share of the first.
const NEGLIGIBLE: f64 = 1e-12;
/// Most terms, sufficient for an optical thickness of 1.05 and above.
const MOST_TERMS: usize = 4096;

/// The angular distribution of a point source's light after multiple scattering: `I(T, mu) = sum over m of (g_m + g_(m+1)) L_m(mu)`
/// with `g_m = exp(-beta_m T - alpha_m ln T)`, `alpha_m = m + 1`, `beta_m = (2m + 1) / m (1 - q^(m-1))`, `g_0 = 0`.
#[derive(Clone, Debug)]
pub struct Scattering {
    /// `g_m + g_(m+1)`.
    terms: Vec<f64>,
}

impl Scattering {
    /// For an optical `thickness` T above 1 and a forward scattering parameter `q` from 0 to 1.
    #[must_use]
    pub fn new(thickness: f64, q: f64) -> Self {
        let mut g = vec![0.0];
        let mut power = 1.0;
        for m in 1..MOST_TERMS {
            let order = m as f64;
            // q^(m - 1)
            if m > 1 {
                power *= q;
            }
            let beta = (2.0 * order + 1.0) / order * (1.0 - power);
            g.push(libm::exp(-beta * thickness - (order + 1.0) * libm::log(thickness)));
            if g[m] < g[1] * NEGLIGIBLE {
                break;
            }
        }
        let terms = (0..g.len()).map(|m| g[m] + g.get(m + 1).copied().unwrap_or(0.0)).collect();
        Self { terms }
    }

    /// The radiance at an angle with the cosine `mu` from the source, in arbitrary units.
    #[must_use]
    pub fn at(&self, mu: f64) -> f64 {
        // Legendre polynomials by Bonnet's recursion.
        let (mut before, mut now) = (0.0, 1.0);
        let mut sum = 0.0;
        for (m, term) in self.terms.iter().enumerate() {
            sum += term * now;
            let order = m as f64;
            let next = ((2.0 * order + 1.0) * mu * now - order * before) / (order + 1.0);
            (before, now) = (now, next);
        }
        sum.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Legendre moments of the published series, by numerical integration.
    #[test]
    fn has_the_published_moments() {
        let legendre: [fn(f64) -> f64; 4] =
            [|_| 1.0, |x| x, |x| (3.0 * x * x - 1.0) / 2.0, |x| (35.0 * x * x * x * x - 30.0 * x * x + 3.0) / 8.0];
        let orders = [0.0_f64, 1.0, 2.0, 4.0];
        for (thickness, q) in [(1.2_f64, 0.75_f64), (1.5, 0.9), (4.0, 0.2)] {
            let g = |m: f64| {
                if m == 0.0 {
                    return 0.0;
                }
                let beta = (2.0 * m + 1.0) / m * (1.0 - libm::pow(q, m - 1.0));
                libm::exp(-beta * thickness) / libm::pow(thickness, m + 1.0)
            };
            let scattering = Scattering::new(thickness, q);
            for (polynomial, m) in legendre.iter().zip(orders) {
                let n = 20_000;
                let moment: f64 = (0..n)
                    .map(|i| {
                        let x = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(n);
                        scattering.at(x) * polynomial(x) * 2.0 / f64::from(n)
                    })
                    .sum();
                let expected = (g(m) + g(m + 1.0)) * 2.0 / (2.0 * m + 1.0);
                assert!((moment - expected).abs() < 2e-3 * g(1.0), "T {thickness} q {q} m {m}: {moment} {expected}");
            }
        }
    }

    /// A sharp peak with wide tails, unlike a Gaussian.
    #[test]
    fn is_peaked_and_broad() {
        let scattering = Scattering::new(1.06, 0.9);
        let at = |degrees: f64| scattering.at(libm::cos(degrees.to_radians()));
        assert!(at(0.0) > 1.5 * at(10.0) && at(10.0) > 1.4 * at(20.0) && at(90.0) > 0.02 * at(0.0));
        // Thicker air blurs more.
        let thick = Scattering::new(4.0, 0.9);
        let share = |s: &Scattering| s.at(libm::cos(0.2)) / s.at(1.0);
        assert!(share(&thick) > share(&scattering));
    }
}
