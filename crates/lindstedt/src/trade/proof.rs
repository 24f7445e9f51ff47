//! The period as a theorem, once for all rows: a row's true error is then proved, too.

use super::run::Found;
use super::{Bench, simulation};
use crate::Oscillator;
use lindstedt_equation::AmplitudeRole;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{Failure, Request, Start, prove};
use rug::Float;

/// Points of the motion that the guess is made from: a quarter as many harmonics.
const SAMPLES: usize = 256;
/// Digits of the proof beyond the most that are judged.
const MORE: u32 = 4;

/// The period with its radius; nothing for an equation that the contraction test does not take.
///
/// The guess is the motion in the time domain, in doubles. Newton's method and the test have the
/// time of a run.
pub(super) fn period(case: &Oscillator, bench: &Bench<'_>) -> Result<Option<Ball>, Failure> {
    let Ok((field, kind)) = case.field() else { return Ok(None) };
    let stop = bench.stop();
    let Ok(mut samples) = simulation::samples(&bench.setting, SAMPLES, &stop) else {
        return Err(Failure::NoStart);
    };
    if bench.setting.problem.amplitude == AmplitudeRole::InSmallParameter {
        // The equation that was integrated is that of x/a.
        let amplitude = bench.setting.amplitude.ball(Balls::new(64));
        let amplitude = amplitude.midpoint().to_f64();
        samples.iter_mut().for_each(|x| *x *= amplitude);
    }
    let start = Start::from_samples(bench.truth.period.to_f64(), &samples);
    let digits = bench.plan.most_digits() + MORE;
    let request = Request { digits, stop, ..Request::default() };
    Ok(Some(prove(&field, &kind, &start, &request)?.period))
}

/// A bound of the relative distance of what a run found from the proved period.
pub(super) fn error(period: &Ball, found: &Found) -> Option<f64> {
    let bits = period.midpoint().prec().max(found.period.prec());
    let balls = Balls::new(bits).with_guard(64);
    let run = balls.from_parts(&found.period, &Float::new(53));
    let ratio = balls.div(&balls.sub(&run, period), period)?;
    Some(ratio.abs_upper().to_f64_round(rug::float::Round::Up)).filter(|error| error.is_finite())
}
