//! The period at given parameters: the sum of the series of T/2pi, beside the closed form where
//! there is one.

use crate::averaged::exponent;
use crate::digits::bits_for;
use crate::displacements::Displacements;
use crate::error::EvaluationError as Error;
use crate::few;
use crate::names::short;
use crate::setting::{Form, Setting};
use crate::source::{self, Source, remembered};
use lindstedt_algebra::Stop;
use lindstedt_derivation::{DerivationError, Progress, Work};
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{Exact, Number, Status, certified};
use lindstedt_series::resummation::{Method, Picture, Resummed, Sample, resum_with};
use rug::{Float, Rational};
use serde::Serialize;

/// A period and how it was found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Evaluation {
    /// The parameters, the derived ones included.
    pub at: Vec<(String, Exact)>,
    /// The variable of the series.
    pub variable: String,
    /// The order of the expansion in the small parameter.
    pub order: usize,
    /// The period by resummation; nothing where not one digit is supported. Its error is measured where the true period is
    /// known, else estimated, else (from too few coefficients) unknown.
    pub period: Option<Number>,
    /// 2 pi over the period.
    pub frequency: Option<Number>,
    /// The period by the closed form, and that form.
    pub exact_period: Option<Number>,
    /// |period - true period|, where that is known, too.
    pub true_error: Option<String>,
    /// What tells that error, in the place of an estimate: `the closed form` or `Newton's orbit`.
    pub measured_by: Option<&'static str>,
    /// Of a limit cycle, where it was asked for.
    pub stability: Option<Stability>,
    /// Orders 0, 1, ... of its Floquet exponent, and the value of the small parameter.
    pub(crate) exponent: Option<(Vec<Rational>, Exact)>,
    /// What was done, what the alternatives gave, what the coefficients tell.
    pub resummed: Resummed,
    /// The best truncation of a divergent series: order and partial sum of T.
    pub best_truncation: Option<(usize, Option<Number>)>,
    /// What is proved about the radius of convergence: its value, and why.
    pub radius: Option<(f64, &'static str)>,
    /// The best that is known of the period: the closed form, else Newton's orbit, else the estimate.
    pub best_period: Ball,
    /// The sum of the series with its own estimate.
    sum: Sum,
    /// Whether an error of the period is known.
    pub(crate) is_estimated: bool,
    /// Whether the coefficients are too few for an estimate: a few digits of the sum are shown.
    pub(crate) no_estimate: bool,
    /// Bits asked for.
    pub(crate) accuracy: u32,
    /// In words.
    pub verdict: String,
    /// Poles and zeros of the diagonal Pade approximant of the highest order.
    pub picture: Option<Picture>,
    /// The method that was asked for; nothing is `auto`.
    pub asked: Option<Method>,
    /// x(t), where times were asked for.
    pub solution: Option<Displacements>,
    /// What the sum gave, where Newton's method gives more digits.
    pub improved: Option<Improved>,
}

/// The stability of a limit cycle by the sum of its exponent.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Stability {
    /// Per unit of t; nothing where not one digit is supported.
    pub floquet_exponent: Option<Number>,
    /// Whether it is negative; nothing where the estimated error leaves it open.
    pub stable: Option<bool>,
}

/// Why the period is not that of the sum.
#[derive(Clone, Debug, Serialize)]
pub struct Improved {
    /// The period by the sum; nothing where not one digit was supported.
    pub sum: Option<Number>,
    /// Where Newton's method started: `the sum`, `the motion in time` or `harmonic balance`.
    pub from: &'static str,
    /// The modes it took.
    pub modes: usize,
}

impl Evaluation {
    /// Whether there is a period, but nothing is known of its error.
    #[must_use]
    pub fn is_without_estimate(&self) -> bool {
        self.period.as_ref().is_some_and(|period| period.status == Status::NoEstimate)
    }

    /// Sums the Floquet exponent of a limit cycle, by Pade approximants: whether it is stable.
    pub fn find_stability(&mut self, work: &Work) {
        self.stability = self.exponent.as_ref().map(|(series, small)| {
            let (floquet_exponent, stable) =
                exponent(series, small, work.printed_digits(), &work.stop);
            Stability { floquet_exponent, stable }
        });
    }

    /// The period of the sum with its distance from that of an orbit, which Newton's method found, in the place of
    /// an estimate.
    pub fn measure(&mut self, orbit: &Ball, digits: usize, modes: usize) {
        let sum = &mut self.sum;
        let error = sum.balls.sub(&sum.value, orbit).abs_upper();
        self.true_error = Some(short(&error));
        sum.difference = Some(error);
        (self.period, self.frequency) = (sum.number(&sum.period(), digits), sum.frequency(digits));
        self.measured_by = Some("Newton's orbit");
        (self.best_period, self.is_estimated) = (orbit.clone(), true);
        let how = format!("; its error measured at the orbit of Newton's method, {modes} modes");
        self.verdict.push_str(&how);
    }

    /// The same with a period in the place of the sum's; the error is an estimate, too.
    pub fn improve(&mut self, period: &Ball, digits: usize, from: &'static str, modes: usize) {
        let balls = Balls::new(period.midpoint().prec());
        let turn = balls.mul_i64(&balls.pi(), 2);
        let frequency = balls.div(&turn, period);
        self.frequency = frequency.and_then(|ball| Number::estimated(&ball, digits));
        let sum = std::mem::replace(&mut self.period, Number::estimated(period, digits));
        (self.best_period, self.is_estimated, self.no_estimate) = (period.clone(), true, false);
        let how = format!("; Newton's method in Fourier space from {from}, {modes} modes");
        self.verdict.push_str(&how);
        self.improved = Some(Improved { sum, from, modes });
    }
}

/// The order that takes well below a second: of a polynomial of high degree, whose x_n have as many more terms, a lower one.
#[must_use]
pub fn default_order(form: &Form) -> usize {
    match form {
        Form::PowerLaw { .. } => 20,
        Form::Sums => 24,
        Form::Cubic { .. } => 30,
        Form::Relaxation { degree: 0..=3 } => 60,
        Form::Relaxation { degree } => (100 / degree).max(6),
        Form::Conservative | Form::Polynomial { degree: 0..=3 } => 24,
        Form::Polynomial { degree } => (60 / degree).max(6),
        Form::Logarithmic => 8,
    }
}

/// The period by the series of T/2pi up to an order (a quick one if nothing), beside the closed form;
/// of the methods the one asked for, else the one with the least error estimate.
///
/// # Errors
/// [`Error::Resummation`] where the method does not apply; those of [`Source::new`].
pub fn period(
    setting: &Setting,
    order: Option<usize>,
    method: Option<Method>,
    work: &Work,
) -> Result<Evaluation, Error> {
    let order = order.unwrap_or_else(|| default_order(&setting.form));
    let (digits, stop) = (work.printed_digits(), &work.stop);
    let accuracy = bits_for(digits);
    source::limit_memory(&setting.form, order, accuracy, work.memory)?;
    let mut observer = |progress| work.goes_on(progress);
    let source = Source::new(setting, order, (work.memory, stop), &mut observer)?;
    let goes_on = || match stop.asked() {
        true => Err(Error::from(ExpandError::Interrupted { order })),
        false => Ok(()),
    };
    work.tell(Progress::Checking);
    goes_on()?;
    let sample = remembered(|bits| if stop.asked() { None } else { source.sample(bits) });
    let few = few::partial_sum(&sample, source.known, method, accuracy);
    let shared = setting.sums();
    let resummed = few.unwrap_or_else(|| resum_with(&sample, method, accuracy, stop, &shared));
    goes_on()?;
    let problem = || setting.problem.name.to_string();
    let resummed = resummed.map_err(|reason| Error::Resummation { problem: problem(), reason })?;
    let closed = source.closed.as_ref();
    let exact_period = closed.map(|(form, formula)| certified(Some(form.clone()), digits, formula));
    goes_on()?;
    let exact_period = exact_period.transpose()?;
    let sum = Sum::new(&source, &resummed)?;
    let best_truncation = best_truncation(&sample, &resummed, &sum.scale, digits);
    let last = sample(resummed.bits);
    let picture = last.and_then(|sample| shared.picture(&sample, accuracy, stop));
    goes_on()?;
    let (period, frequency) = (sum.number(&sum.period(), digits), sum.frequency(digits));
    let alone = Sum { difference: None, closed: None, ..sum.clone() };
    let estimate = alone.number(&alone.period(), digits);
    let small = setting.small_alone().filter(|_| !source.exponent.is_empty());
    let exponent = small.map(|small| (source.exponent.clone(), small.clone()));
    let mut result = Evaluation {
        order,
        period,
        frequency,
        exact_period,
        stability: None,
        exponent,
        true_error: sum.difference.as_ref().map(short),
        resummed,
        best_truncation,
        radius: source.radius,
        measured_by: sum.difference.as_ref().map(|_| "the closed form"),
        is_estimated: sum.is_estimated(),
        no_estimate: sum.no_estimate,
        best_period: sum.closed.clone().unwrap_or_else(|| sum.period()),
        sum,
        accuracy,
        verdict: String::new(),
        picture,
        at: source.at.clone(),
        variable: source.variable.clone(),
        asked: method,
        solution: None,
        improved: None,
    };
    result.verdict = result.describe(estimate.as_ref());
    Ok(result)
}

/// The period that the sum of the series gives.
#[derive(Clone, Debug)]
struct Sum {
    balls: Balls,
    /// 2 pi times the factor of the series.
    scale: Ball,
    value: Ball,
    /// Its estimated error.
    estimate: Float,
    closed: Option<Ball>,
    /// |value - true period|.
    difference: Option<Float>,
    no_estimate: bool,
}

impl Sum {
    fn new(source: &Source, resummed: &Resummed) -> Result<Self, Error> {
        let balls = Balls::new(resummed.bits).with_guard(64);
        let scale = period_scale(source, balls)?;
        let estimate = &resummed.outcome.estimate;
        let value = balls.mul(&balls.from_parts(&estimate.value, &Float::new(53)), &scale);
        let with_error = balls.mul(&balls.from_parts(&estimate.value, &estimate.error), &scale);
        let closed = source.closed.as_ref().and_then(|(_, formula)| formula(balls));
        let difference = closed.as_ref().map(|exact| balls.sub(&value, exact).abs_upper());
        let no_estimate = !estimate.error.is_finite() && few::has_no_estimate(source.known);
        let estimate = Float::with_val(53, with_error.radius());
        Ok(Self { balls, scale, value, estimate, closed, difference, no_estimate })
    }

    /// Whether an error is known: measured or estimated.
    fn is_estimated(&self) -> bool {
        self.difference.is_some() || self.estimate.is_finite()
    }

    /// The sum with its error; without one where nothing is known.
    fn period(&self) -> Ball {
        match (&self.difference, self.no_estimate) {
            (Some(error), _) => self.balls.add_error(&self.value, error),
            (None, true) => self.value.clone(),
            (None, false) => self.balls.from_parts(self.value.midpoint(), &self.estimate),
        }
    }

    fn number(&self, ball: &Ball, digits: usize) -> Option<Number> {
        // A measured error above the value leaves no digit, and a sum that is no period has none.
        let period = self.period();
        let size = period.midpoint();
        let none = self.is_estimated() && period.radius() >= size;
        if *size <= 0 || none {
            None
        } else if self.no_estimate {
            few::plain(ball, digits, self.is_estimated())
        } else {
            // Where there is a digit: not rounded to the error, a coarse decimal would be worse than the
            // estimate.
            Number::estimated(ball, digits)?;
            Number::with_error(ball.midpoint(), ball.radius(), digits)
        }
    }

    fn frequency(&self, digits: usize) -> Option<Number> {
        let two_pi = self.balls.mul_i64(&self.balls.pi(), 2);
        self.number(&self.balls.div(&two_pi, &self.period())?, digits)
    }
}

/// 2 pi times the factor of the series.
fn period_scale(source: &Source, balls: Balls) -> Result<Ball, Error> {
    let factor = (source.factor)(balls).filter(Ball::is_finite).ok_or(DerivationError::NoValue)?;
    Ok(balls.mul(&balls.mul_i64(&balls.pi(), 2), &factor))
}

/// The smallest term of a series that diverges at the point.
fn best_truncation(
    sample: &dyn Fn(u32) -> Option<Sample>,
    resummed: &Resummed,
    scale: &Ball,
    digits: usize,
) -> Option<(usize, Option<Number>)> {
    let outcome =
        sample(resummed.bits)?.sum(Method::PartialSum, None, 64, &Stop::default()).ok()?;
    let order = outcome.smallest_term?;
    let balls = Balls::new(resummed.bits);
    let ball = balls.from_parts(&outcome.estimate.value, &outcome.estimate.error);
    Some((order, Number::estimated(&balls.mul(&ball, scale), digits)))
}
