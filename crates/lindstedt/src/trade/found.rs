//! What a run finds, and the fastest of some.

use super::Summation;
use crate::Error;
use lindstedt_algebra::Stop;
use rug::Float;
use std::time::Instant;

/// What a run found.
pub(super) struct Found {
    pub(super) summation: Option<Summation>,
    pub(super) seconds: f64,
    /// For one more value of the small parameter.
    pub(super) again: f64,
    pub(super) bytes: u64,
    pub(super) period: Float,
    /// The stated absolute error; infinite where there is no estimate.
    pub(super) error: Float,
}

/// The fastest of some runs with its seconds; one that takes longer than `long` is not repeated.
pub(super) fn fastest<T>(
    (repeats, long): (u32, f64),
    stop: &Stop,
    run: &dyn Fn() -> Result<T, Error>,
) -> Result<(T, f64), Error> {
    let once = || {
        let start = Instant::now();
        run().map(|found| (found, start.elapsed().as_secs_f64()))
    };
    let mut best = once()?;
    for _ in 1..repeats {
        if best.1 > long || stop.asked() {
            break;
        }
        // A repetition that runs out of time does not count.
        match once() {
            Ok(again) if again.1 < best.1 => best = again,
            _ => {}
        }
    }
    Ok(best)
}
