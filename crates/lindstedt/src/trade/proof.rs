//! The period as a theorem, once for all rows: a row's true error is then proved, too.

use super::found::Found;
use crate::Oscillator;
use crate::evaluate::turn::TimeDomain;
use lindstedt_algebra::Stop;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{Failure, Request, prove};
use rug::Float;

/// The period with its radius; nothing for an equation that the contraction test does not take, and
/// where the motion in the time domain, which is the guess, is not periodic.
pub(super) fn period(
    case: &Oscillator,
    motion: &TimeDomain<'_>,
    digits: u32,
    stop: Stop,
) -> Result<Option<Ball>, Failure> {
    let Ok(wanted) = case.wanted(digits) else { return Ok(None) };
    let Ok(start) = wanted.start(motion, &stop) else { return Ok(None) };
    let request = Request { digits, stop, ..Request::default() };
    Ok(Some(prove(&wanted.field, &wanted.kind, &start, &request)?.period))
}

/// A bound of the relative distance of what a run found from the proved period.
pub(super) fn error(period: &Ball, found: &Found) -> Option<f64> {
    let bits = period.midpoint().prec().max(found.period.prec());
    let balls = Balls::new(bits).with_guard(64);
    let run = balls.from_parts(&found.period, &Float::new(53));
    let ratio = balls.div(&balls.sub(&run, period), period)?;
    Some(ratio.abs_upper().to_f64_round(rug::float::Round::Up)).filter(|error| error.is_finite())
}
