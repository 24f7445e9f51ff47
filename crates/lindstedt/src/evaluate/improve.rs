//! More digits than the sum has: Newton's method in Fourier space, from the sum.

use super::{Evaluate, Evaluation};
use crate::{Number, Oscillator, Work};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{Approximation, Request, Start, approximate};
use rug::Float;

/// The largest mode of the inverse: about a second.
const MOST_MODES: usize = 400;
/// The orbit found must be that of the sum: within so many of its estimated errors.
const SAME: u32 = 10;

impl Oscillator {
    /// Puts Newton's period in the place of one with fewer digits than were asked for, where the equation is
    /// polynomial and there is no closed form. What does not agree with the sum is not taken.
    pub(super) fn improve(&self, value: &mut Evaluation, question: &Evaluate, work: &Work) {
        let digits = work.printed_digits();
        let enough = value.period.as_ref().is_some_and(|period| has(period, digits));
        if enough || value.exact_period.is_some() || work.doubles {
            return;
        }
        let Ok(wanted) = self.wanted(work.digits) else { return };
        let request =
            Request { digits: work.digits + 2, modes_limit: MOST_MODES, stop: work.stop.clone() };
        let found = |start: &Start| {
            let found = approximate(&wanted.field, &wanted.kind, start, &request).ok()?;
            let period = period(&found)?;
            agrees(value, &period).then_some((period, found.modes))
        };
        let sum = self.by_sum(Some(value), question, work);
        let by_sum = sum.and_then(|start| Some(("the sum", found(&start)?)));
        let improved = by_sum.or_else(|| {
            let start = self.by_motion(&wanted, &work.stop)?;
            Some(("the motion in time", found(&start)?))
        });
        if let Some((from, (period, modes))) = improved {
            value.improve(&period, digits, from, modes);
        }
    }
}

/// 2 pi over the frequency with its estimated error.
fn period(found: &Approximation) -> Option<Ball> {
    let balls = Balls::new(found.frequency.prec()).with_guard(32);
    let frequency = balls.from_parts(&found.frequency, &found.error);
    balls.div(&balls.mul_i64(&balls.pi(), 2), &frequency)
}

/// Whether a number shows so many digits.
fn has(number: &Number, digits: usize) -> bool {
    let mantissa = number.decimal.split('e').next().unwrap_or_default();
    let shown = mantissa.trim_start_matches(['-', '0', '.']);
    shown.bytes().filter(u8::is_ascii_digit).count() >= digits
}

/// Whether a period is that of the sum, where the sum has one.
fn agrees(value: &Evaluation, period: &Ball) -> bool {
    let sum = &value.best_period;
    let distance = Float::with_val(53, sum.midpoint() - period.midpoint()).abs();
    value.period.is_none() || distance <= Float::with_val(53, sum.radius() * SAME)
}
