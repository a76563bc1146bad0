//! Times of several runs.

use std::time::Instant;

/// The median of the seconds that `runs` of `run` take.
pub fn median(mut run: impl FnMut(), runs: usize) -> f64 {
    let mut seconds: Vec<f64> = (0..runs)
        .map(|_| {
            let begun = Instant::now();
            run();
            begun.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[runs / 2]
}
