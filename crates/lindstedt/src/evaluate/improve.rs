//! More digits than the sum has, or its true error: Newton's method in Fourier space, from the sum.

use super::wanted::Wanted;
use super::{Displacement, Displacements, Estimated, Evaluate, Evaluation, Fourier};
use crate::{Exact, Number, Oscillator, Work};
use lindstedt_equation::Condition;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{Approximation, Request, Start, approximate};
use rug::Float;

/// The largest mode of the inverse: about a second.
const MOST_MODES: usize = 400;
/// The orbit found must be that of the sum: within so many of its estimated errors,
const SAME: u32 = 10;
/// or within this part of the period where it measures them.
const NEAR: f64 = 0.3;

/// The orbit that Newton's method found.
pub(super) struct Improvement {
    wanted: Wanted,
    found: Approximation,
    /// The phase at which x' = 0.
    rest: Ball,
}

/// What the orbit of a sum is good for.
pub(super) enum Beside {
    /// Nobody asked, or there is none that is that of the sum.
    Nothing,
    /// Work was stopped before it was found.
    Stopped,
    /// It has more digits than the sum, and is taken in its place.
    Better(Improvement),
    /// It tells the error of a sum that was asked for.
    Truth(Improvement),
}

impl Oscillator {
    /// Newton's orbit beside a period with fewer digits than were asked for, where the equation is polynomial. Where neither
    /// order nor method was asked for and there is no closed form its period is put in the place of the sum's; else its
    /// distance is put in the place of the sum's estimated error, beside a closed form that of x(t) alone, where that is
    /// asked for, too.
    pub(super) fn beside(
        &self,
        value: &mut Evaluation,
        (question, with_motion): (&Evaluate, bool),
        work: &Work,
    ) -> Beside {
        let asked = question.order.is_some() || question.method.is_some();
        let digits = work.printed_digits();
        let closed = value.exact_period.is_some();
        let enough = value.period.as_ref().is_some_and(|period| has(period, digits));
        if work.doubles || if closed { !with_motion } else { enough } {
            return Beside::Nothing;
        }
        let replaces = !asked && !closed;
        let same =
            |period: &Ball| if replaces { agrees(value, period) } else { near(value, period) };
        let Some((found, period, from)) = self.orbit_of_sum(value, question, work, same) else {
            return if work.stop.asked() { Beside::Stopped } else { Beside::Nothing };
        };
        let modes = found.found.modes;
        match (replaces, closed) {
            (true, _) => value.improve(&period, digits, from, modes),
            (false, true) => {}
            (false, false) => value.measure(&period, digits, modes),
        }
        if replaces { Beside::Better(found) } else { Beside::Truth(found) }
    }

    /// The orbit that Newton's method finds from the sum, else from the motion in time, its period, and from what.
    fn orbit_of_sum(
        &self,
        value: &Evaluation,
        question: &Evaluate,
        work: &Work,
        same: impl Fn(&Ball) -> bool,
    ) -> Option<(Improvement, Ball, &'static str)> {
        let wanted = self.wanted(work.digits).ok()?;
        let request =
            Request { digits: work.digits + 2, modes_limit: MOST_MODES, stop: work.stop.clone() };
        let found = |start: &Start| {
            let found = approximate(&wanted.field, &wanted.kind, start, &request).ok()?;
            let period = period(&found)?;
            same(&period).then_some((period, found))
        };
        let sum = self.by_sum(Some(value), question, work);
        let by_sum = sum.and_then(|start| Some(("the sum", found(&start)?)));
        let improved = by_sum.or_else(|| {
            let start = self.by_motion(&wanted, &work.stop)?;
            Some(("the motion in time", found(&start)?))
        });
        let (from, (period, found)) = improved?;
        let cycle = self.condition() == Some(Condition::LimitCycle);
        let rest = if cycle { found.rest() } else { Balls::new(64).zero() };
        Some((Improvement { wanted, found, rest }, period, from))
    }
}

/// Harmonics above this share of the largest are all that doubles show.
const NEGLIGIBLE: f64 = 1e-15;

impl Improvement {
    /// x at a time, x(t) = X(omega t + phase) with X'(0) = 0.
    pub fn at(&self, time: &Exact, phase: &Exact) -> Option<Ball> {
        let balls = Balls::new(self.found.frequency.prec());
        let frequency = balls.from_parts(&self.found.frequency, &self.found.error);
        let begin = balls.add(&self.rest, &phase.ball(balls));
        let turned = balls.mul(&frequency, &time.ball(balls));
        let (x, _) = self.wanted.state(self.found.at_phase(&balls.add(&turned, &begin)))?;
        Some(x)
    }

    /// x at times.
    pub fn table(
        &self,
        value: &Evaluation,
        times: &[Exact],
        phase: &Exact,
        work: &Work,
    ) -> Displacements {
        let digits = work.printed_digits();
        let at = |time: &Exact| {
            let x = self.at(time, phase)?;
            let (double, error) = (x.midpoint().to_f64(), x.radius().to_f64());
            Some(Displacement::new(time.clone(), Number::estimated(&x, digits), double, error))
        };
        let mut points = Vec::new();
        for time in times {
            if work.stop.asked() {
                break;
            }
            points.extend(at(time));
        }
        let complete = points.len() == times.len();
        Displacements::by_newton(value.order, points, complete)
    }

    /// The harmonics of x(t) = X(omega t + phase) in omega t up to one; what is left out deviates by at most the sum of its
    /// sizes.
    pub fn fourier(&self, harmonics: usize, phase: &Exact) -> Option<Fourier> {
        let start = self.found.start();
        if self.wanted.is_substituted() {
            return None;
        }
        let (sin, cos) = (self.rest.midpoint().to_f64() + phase.to_f64()).sin_cos();
        let (mut c, mut s) = (1.0, 0.0);
        let mut list = Vec::new();
        let modes = start.cosines.len().max(start.sines.len());
        for k in 0..modes.max(harmonics + 1) {
            let at = |list: &[f64]| list.get(k).copied().unwrap_or(0.0);
            // a cos k(tau + p) + b sin k(tau + p) with c = cos k p, s = sin k p.
            let (a, b) = (at(&start.cosines), at(&start.sines));
            list.push((a * c + b * s, b * c - a * s));
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
        }
        let deviation = list.split_off(harmonics + 1).iter().map(|(a, b)| a.hypot(*b)).sum::<f64>();
        let size = list.iter().fold(0.0f64, |m, (a, b)| m.max(a.abs()).max(b.abs()));
        let error = Some(NEGLIGIBLE * size);
        let deviation = deviation + NEGLIGIBLE * size;
        Some(Fourier { coefficients: list, deviation, error, largest_error: NEGLIGIBLE * size })
    }

    /// The harmonics of a sum with their distance from the orbit's in the place of estimates.
    pub fn measured(&self, sum: Fourier, phase: &Exact) -> Fourier {
        let harmonics = sum.coefficients.len().saturating_sub(1);
        let Some(truth) = self.fourier(harmonics, phase) else { return sum };
        let pairs = sum.coefficients.iter().zip(&truth.coefficients);
        let distances = || pairs.clone().map(|(a, b)| (a.0 - b.0).hypot(a.1 - b.1));
        let largest_error = truth.largest_error + distances().sum::<f64>();
        let error = Some(distances().fold(truth.largest_error, f64::max));
        Fourier { deviation: truth.deviation, error, largest_error, ..sum }
    }

    /// omega with its estimated error.
    pub fn frequency(&self) -> Estimated {
        let value = self.found.frequency.to_f64();
        let error = self.found.error.to_f64() + value.abs() * f64::EPSILON;
        Estimated { value, error }
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

/// Whether a period is about that of the sum.
fn near(value: &Evaluation, period: &Ball) -> bool {
    let sum = value.best_period.midpoint();
    let distance = Float::with_val(53, sum - period.midpoint()).abs();
    distance <= Float::with_val(53, sum * NEAR).abs()
}

/// Whether a period is that of the sum within its error, where the sum has one.
fn agrees(value: &Evaluation, period: &Ball) -> bool {
    let sum = &value.best_period;
    let distance = Float::with_val(53, sum.midpoint() - period.midpoint()).abs();
    value.period.is_none() || distance <= Float::with_val(53, sum.radius() * SAME)
}
