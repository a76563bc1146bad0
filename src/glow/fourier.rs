//! The fast Fourier transform of rows whose lengths have no factors but 2, 3 and 5. The same bits on every machine.

/// A complex number: its real and its imaginary part.
pub(super) type Complex = [f32; 2];

/// Transforms of one length, in one direction.
pub(super) struct Fourier {
    /// The factors of the length, 4 before 2.
    factors: Vec<usize>,
    /// `e^(i tau k / length)`, or its conjugate, for every k below the length.
    turns: Vec<Complex>,
    is_inverse: bool,
}

pub(super) fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

fn plus(a: Complex, b: Complex) -> Complex {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Complex, b: Complex) -> Complex {
    [a[0] - b[0], a[1] - b[1]]
}

impl Fourier {
    pub fn new(length: usize, is_inverse: bool) -> Self {
        let mut factors = Vec::new();
        let mut rest = length;
        for factor in [4, 2, 3, 5] {
            while rest.is_multiple_of(factor) {
                factors.push(factor);
                rest /= factor;
            }
        }
        debug_assert!(rest == 1, "{length} has other factors");
        let sign = if is_inverse { 1.0 } else { -1.0 };
        let turn = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / length as f64;
            [libm::cos(angle) as f32, (sign * libm::sin(angle)) as f32]
        };
        Self { factors, turns: (0..length).map(turn).collect(), is_inverse }
    }

    /// The transform of `data`, in its place, not scaled; `room` is as long and is overwritten.
    ///
    /// Stockham's passes (Van Loan 1992, *Computational frameworks for the fast Fourier transform*, section 1.7): each joins
    /// `factor` transforms of a part into one and leaves all in order.
    pub fn transform(&self, data: &mut [Complex], room: &mut [Complex]) {
        let length = data.len();
        let (mut from, mut to) = (data, room);
        let mut part = length;
        let mut stride = 1;
        for &factor in &self.factors {
            part /= factor;
            match factor {
                2 => self.pass(from, to, part, stride, |x: [Complex; 2]| [plus(x[0], x[1]), minus(x[0], x[1])]),
                3 => self.pass::<3>(from, to, part, stride, |x| self.small(x)),
                4 => self.pass(from, to, part, stride, |x| self.four(x)),
                _ => self.pass::<5>(from, to, part, stride, |x| self.small(x)),
            }
            stride *= factor;
            std::mem::swap(&mut from, &mut to);
        }
        // After an odd number of passes the result is in the room.
        if self.factors.len() % 2 == 1 {
            to.copy_from_slice(from);
        }
    }

    /// One pass: `part` groups of `stride` numbers, each with `N` inputs.
    fn pass<const N: usize>(
        &self,
        from: &[Complex],
        to: &mut [Complex],
        part: usize,
        stride: usize,
        butterfly: impl Fn([Complex; N]) -> [Complex; N],
    ) {
        for group in 0..part {
            let turns: [Complex; N] = std::array::from_fn(|j| self.turns[j * group * stride]);
            let inputs: [&[Complex]; N] = std::array::from_fn(|j| &from[(group + part * j) * stride..][..stride]);
            let mut outputs = to[group * N * stride..][..N * stride].chunks_exact_mut(stride);
            let mut outputs: [&mut [Complex]; N] = std::array::from_fn(|_| outputs.next().unwrap_or_default());
            for i in 0..stride {
                let sums = butterfly(std::array::from_fn(|j| inputs[j][i]));
                for ((output, sum), turn) in outputs.iter_mut().zip(sums).zip(turns) {
                    output[i] = times(sum, turn);
                }
            }
        }
    }

    fn four(&self, x: [Complex; 4]) -> [Complex; 4] {
        let (a, b) = (plus(x[0], x[2]), minus(x[0], x[2]));
        let (c, d) = (plus(x[1], x[3]), minus(x[1], x[3]));
        // d turned by a quarter.
        let d = if self.is_inverse { [-d[1], d[0]] } else { [d[1], -d[0]] };
        [plus(a, c), plus(b, d), minus(a, c), minus(b, d)]
    }

    /// By the definition.
    fn small<const N: usize>(&self, x: [Complex; N]) -> [Complex; N] {
        let step = self.turns.len() / N;
        std::array::from_fn(|k| (1..N).fold(x[0], |sum, j| plus(sum, times(x[j], self.turns[j * k % N * step]))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_by_the_definition_and_back() {
        for length in [1, 2, 3, 4, 5, 6, 8, 12, 30, 60, 100, 128, 225, 360] {
            let data: Vec<Complex> = (0..length).map(|i| [(i * i % 7) as f32 - 3.0, (i % 5) as f32]).collect();
            let (mut found, mut room) = (data.clone(), vec![[0.0; 2]; length]);
            let forward = Fourier::new(length, false);
            forward.transform(&mut found, &mut room);
            for (k, found) in found.iter().enumerate() {
                let sum = (0..length).fold([0.0; 2], |sum, j| plus(sum, times(data[j], forward.turns[j * k % length])));
                assert!((0..2).all(|i| (sum[i] - found[i]).abs() < 1e-3 * length as f32), "{length}, {k}");
            }
            Fourier::new(length, true).transform(&mut found, &mut room);
            for (found, data) in found.iter().zip(&data) {
                assert!((0..2).all(|i| (found[i] / length as f32 - data[i]).abs() < 1e-4), "{length}");
            }
        }
    }
}
