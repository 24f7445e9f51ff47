//! The expansion against the time domain: the observed order of accuracy.
//!
//! The expansion of order N, x_N(t) = sum_(n<=N) eps^n x_n(omega_N t), is compared with the
//! solution of the equation by the integrator of [`lindstedt_simulate`], which shares nothing with
//! the expansion but the equation. On a window of fixed length in omega_N t
//!
//!   e(eps) = max_t |x_N(t; eps) - x(t; eps)| = C eps^(N+1) (1 + O(eps)),
//!
//! so d ln e/d ln eps tends to N + 1 if every order is right, and to n if order n is wrong. The
//! start is the condition's: x(0) = 1, x'(0) = 0, or the point of largest x on the limit cycle,
//! found by Newton's method on the return map (a start taken from the expansion would hide an
//! error of the amplitude).

use crate::{Derivation, Error, Progress, Settings, Solution, Value, derive};
use lindstedt_coeff::ball::{Ball, Balls};
use lindstedt_equation::{Condition, Problem};
use lindstedt_phase::evaluate::{lobachevsky, of_rational, trigonometric};
use lindstedt_phase::lobachevsky_function::{LambdaTable, Point};
use lindstedt_simulate::{
    Digits, Integrator, Model, Parameters, Quantity, Real, Report, Settings as Precision, System,
    Trajectory, monodromy,
};
use rayon::prelude::*;
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// The observed order may differ from N + 1 by so much.
pub const TOLERANCE: f64 = 0.05;
/// Steps of Newton's method; the number of digits doubles in each.
const MOST_STEPS: usize = 20;

/// What to verify.
#[derive(Clone, Debug)]
pub struct VerifySettings {
    /// N.
    pub order: usize,
    /// Values of the small parameter, each smaller in modulus than the one before, none zero.
    pub small: Vec<Rational>,
    /// The window: so many periods 2 pi/omega_N.
    pub periods: u32,
    /// Points of the window.
    pub samples: u32,
    /// Digits of the integration; by default enough for the smallest error expected.
    pub digits: Option<u32>,
    /// Values of parameters by name.
    pub parameters: BTreeMap<String, Value>,
    /// The memory that may be used, in bytes.
    pub memory: u64,
}

impl Default for VerifySettings {
    /// Order 4 at 1/1000, 1/2000, 1/4000, 1/8000 on one period.
    fn default() -> Self {
        Self {
            order: 4,
            small: (0..4).map(|j| Rational::from((1, 1000 << j))).collect(),
            periods: 1,
            samples: 48,
            digits: None,
            parameters: BTreeMap::new(),
            memory: 8 << 30,
        }
    }
}

/// The comparison at one value of the small parameter.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The value.
    pub small: Rational,
    /// max |x_N - x| on the points of the window.
    pub error: Float,
    /// The estimated error of the integration (against one with 8 digits more).
    pub simulation_error: Float,
    /// ln(error/previous error)/ln(small/previous small); nothing for the first.
    pub slope: Option<f64>,
}

/// What the comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The observed order is N + 1 within [`TOLERANCE`].
    Agrees,
    /// It is not.
    Disagrees,
    /// The errors are not above those of the integration, or there are fewer than two.
    Undecided,
}

/// The result of [`verify`].
#[derive(Clone, Debug)]
pub struct Verification {
    /// N.
    pub order: usize,
    /// The name of the small parameter.
    pub parameter: String,
    /// One line per value, in the order given.
    pub comparisons: Vec<Comparison>,
    /// The slope between the last two values.
    pub observed: Option<f64>,
    /// The verdict.
    pub verdict: Verdict,
    /// The digits of the integration.
    pub digits: u32,
}

/// Compares the expansion of a problem with the time domain.
///
/// Errors: those of [`derive()`]; [`Error::Simulate`]; [`Error::UnknownCondition`] for a problem whose
/// first normalisation fixes no start; [`Error::NoPeriodicOrbit`]. Cost: two integrations per value.
///
/// # Example
/// ```
/// use lindstedt::{problems, verify::{Verdict, VerifySettings, verify}};
/// let problem = problems::find("duffing").ok_or("no such problem")?;
/// let found = verify(&problem, &VerifySettings { order: 2, ..Default::default() }, &mut |_| true)?;
/// assert_eq!(found.verdict, Verdict::Agrees);
/// assert!(found.observed.is_some_and(|slope| (slope - 3.0).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn verify(
    problem: &Problem,
    settings: &VerifySettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Verification, Error> {
    let parameters = settings.parameters.clone();
    let derived = Settings { order: settings.order, parameters, ..Settings::default() };
    let derived = Settings { memory: settings.memory, ..derived };
    let derivation = derive(problem, &derived, observer)?;
    verify_derivation(&derivation, settings)
}

/// As [`verify`], for an expansion that is there; its order counts, not that of the settings.
///
/// # Errors
/// As [`verify`].
pub fn verify_derivation(
    derivation: &Derivation,
    settings: &VerifySettings,
) -> Result<Verification, Error> {
    let digits = settings.digits.unwrap_or_else(|| digits(derivation, settings));
    let expansion = Sampled::new(derivation, settings, digits)?;
    let judge = Judge::new(derivation, settings)?;
    let compare = |small: &Rational| expansion.compare(&judge, small, digits);
    let found: Result<Vec<_>, Error> = settings.small.par_iter().map(compare).collect();
    let mut comparisons = found?;
    for i in 1..comparisons.len() {
        let log = |c: &Comparison| c.error.clone().ln().to_f64();
        let size = |c: &Comparison| Float::with_val(80, &c.small).abs().ln().to_f64();
        let [before, after] = [&comparisons[i - 1], &comparisons[i]];
        let slope = (log(after) - log(before)) / (size(after) - size(before));
        comparisons[i].slope = slope.is_finite().then_some(slope);
    }
    let observed = comparisons.last().and_then(|last| last.slope);
    let drowned = |c: &Comparison| c.simulation_error.clone() * 1000u32 > c.error;
    let verdict = match observed {
        _ if comparisons.iter().rev().take(2).any(drowned) => Verdict::Undecided,
        None => Verdict::Undecided,
        Some(slope) if (slope - derivation.order as f64 - 1.0).abs() <= TOLERANCE => {
            Verdict::Agrees
        }
        Some(_) => Verdict::Disagrees,
    };
    Ok(Verification {
        order: derivation.order,
        parameter: derivation.problem.small.to_string(),
        comparisons,
        observed,
        verdict,
        digits,
    })
}

/// Enough for errors of the size eps^(N+1), and for the slow approach to a limit cycle, which
/// multiplies the errors of the return map by about 1/eps.
fn digits(derivation: &Derivation, settings: &VerifySettings) -> u32 {
    let sizes = settings.small.iter().map(|q| -Float::with_val(80, q).abs().log10().to_f64());
    let decades = sizes.fold(0.0, f64::max).min(1e6);
    let cycle = if derivation.condition == Condition::LimitCycle { 2.0 * decades } else { 0.0 };
    ((derivation.order as f64 + 1.0) * decades + cycle).ceil() as u32 + 16
}

/// The expansion at points of the phase, order by order.
struct Sampled {
    bits: u32,
    /// kappa W_n.
    frequency_squared: Vec<Float>,
    /// tau_j/pi.
    turns: Vec<Rational>,
    /// x_n(tau_j), by point and order.
    values: Vec<Vec<Float>>,
    /// x_n(0).
    amplitudes: Vec<Float>,
}

impl Sampled {
    fn new(d: &Derivation, settings: &VerifySettings, digits: u32) -> Result<Self, Error> {
        let bits = Digits::for_digits(digits + 8).bits();
        let balls = Balls::new(bits).with_guard(64);
        let float = |ball: &Ball| Float::with_val(bits, ball.midpoint());
        let series = d.named("frequency_squared").ok_or(Error::NoValue)?;
        let orders = 0..=d.order;
        let ball = |n| d.ball(series, n, balls).ok_or(Error::NoValue);
        let frequency_squared = orders.clone().map(|n| Ok(float(&ball(n)?)));
        let frequency_squared = frequency_squared.collect::<Result<Vec<_>, Error>>()?;
        // No point is an odd multiple of pi/2, where cos tau = 0 and ln|cos tau| has no value:
        // the denominator's factor 1009 does not cancel.
        let (periods, samples) = (settings.periods.max(1), settings.samples.max(2));
        let turn = |j: u32| {
            let numerator = (1009 * u64::from(j) + 504) * 2 * u64::from(periods);
            Rational::from((numerator, 1009 * u64::from(samples)))
        };
        let turns: Vec<Rational> = (0..samples).map(turn).collect();
        let at = |point: &Point| -> Option<Vec<Float>> {
            let values: Option<Vec<Ball>> = match &d.solution {
                Solution::Lobachevsky(e) => {
                    let table = LambdaTable::new(d.order + 1, balls);
                    let value =
                        |x| lobachevsky(x, point, &table, |c| d.constants.evaluate(c, balls));
                    e.solution.iter().take(d.order + 1).map(value).collect()
                }
                Solution::Rational(e) => {
                    let value = |x| trigonometric(x, point, balls, of_rational(balls));
                    e.expansion.solution.iter().take(d.order + 1).map(value).collect()
                }
                Solution::FrequencyOnly => None,
            };
            Some(values?.iter().map(float).collect())
        };
        let points = turns.par_iter().map(|q| at(&Point::PiTimes(q.clone())));
        let values: Option<Vec<_>> = points.collect();
        let values = values.ok_or(Error::NoValue)?;
        let amplitudes = at(&Point::Rational(Rational::new())).ok_or(Error::NoValue)?;
        Ok(Self { bits, frequency_squared, turns, values, amplitudes })
    }

    fn sum(&self, coefficients: &[Float], small: &Rational) -> Float {
        let eps = Float::with_val(self.bits, small);
        coefficients.iter().rev().fold(Float::new(self.bits), |sum, c| sum * &eps + c)
    }

    fn compare(&self, judge: &Judge, small: &Rational, digits: u32) -> Result<Comparison, Error> {
        let square = self.sum(&self.frequency_squared, small);
        if !(square.is_finite() && square > 0) {
            return Err(judge.no_orbit(small));
        }
        let frequency = square.sqrt();
        let pi = Float::with_val(self.bits, rug::float::Constant::Pi);
        let times: Vec<Float> =
            self.turns.iter().map(|q| Float::with_val(self.bits, &pi * q) / &frequency).collect();
        let guess = (
            self.sum(&self.amplitudes, small),
            Float::with_val(self.bits, &pi * 2u32) / &frequency,
        );
        let coarse = judge.run(small, &guess, &times, digits)?;
        let fine = judge.run(small, &guess, &times, digits + 8)?;
        let (mut error, mut simulation_error) = (Float::new(64), Float::new(64));
        for ((terms, coarse), fine) in self.values.iter().zip(&coarse).zip(&fine) {
            let x = self.sum(terms, small);
            error.max_mut(&Float::with_val(64, &x - fine).abs());
            simulation_error.max_mut(&Float::with_val(64, fine - coarse).abs());
        }
        Ok(Comparison { small: small.clone(), error, simulation_error, slope: None })
    }
}

/// The time domain.
struct Judge {
    model: Model,
    parameters: Parameters,
    small: String,
    limit_cycle: bool,
}

impl Judge {
    fn new(derivation: &Derivation, settings: &VerifySettings) -> Result<Self, Error> {
        let problem = &derivation.problem;
        let limit_cycle = match derivation.condition {
            Condition::InitialAmplitude => false,
            Condition::LimitCycle => true,
            _ => return Err(Error::UnknownCondition { problem: problem.name.to_string() }),
        };
        let mut parameters = Parameters::new();
        for card in &problem.parameters {
            let value = match settings.parameters.get(&*card.name) {
                Some(value) => value.clone(),
                None => Value::parse(&card.default)?,
            };
            parameters.set(&card.name, quantity(&value));
        }
        let model = Model::of_problem(problem)?;
        let small = problem.small.to_string();
        Ok(Self { model, parameters, small, limit_cycle })
    }

    fn no_orbit(&self, small: &Rational) -> Error {
        Error::NoPeriodicOrbit { parameter: self.small.clone(), value: small.to_string() }
    }

    /// x at the times.
    fn run(
        &self,
        small: &Rational,
        guess: &(Float, Float),
        times: &[Float],
        digits: u32,
    ) -> Result<Vec<Float>, Error> {
        let real = Digits::for_digits(digits);
        let parameters = self.parameters.clone().with(&self.small, small.clone());
        let precision = Precision::for_digits(digits);
        let start = if self.limit_cycle {
            let model = self.model.clone().linearised();
            let cycle = cycle(&model.compile(real, &parameters)?, guess, precision)?;
            cycle.ok_or_else(|| self.no_orbit(small))?
        } else {
            real.double(1.0)
        };
        let system = self.model.compile(real, &parameters)?;
        let mut flow = Integrator::new(&system, &real.zero(), &[start, real.zero()], precision)?;
        let mut trajectory = Trajectory::new(real);
        let end = times.last().map_or_else(|| real.zero(), |t| real.float(t));
        flow.advance(&end, &mut |report| trajectory.record(report))?;
        // The end of the last segment may be rounded to just before the end itself.
        let last = || flow.state().first().cloned();
        let value = |t: &Float| {
            let t = real.float(t);
            if t >= *flow.time() { last() } else { trajectory.value(0, &t) }
        };
        times.iter().map(|t| value(t).ok_or(Error::NoValue)).collect()
    }
}

/// The value of a parameter for the integrator.
#[must_use]
pub fn quantity(value: &Value) -> Quantity {
    match value {
        Value::Rational(q) => Quantity::Rational(q.clone()),
        Value::PiTimes(q) => Quantity::PiMultiple(q.clone()),
    }
}

/// x(0) of the limit cycle with x'(0) = 0: Newton's method for x(T) = x(0), x'(T) = 0 in x(0) and
/// T, with the derivative of the flow from its linearisation.
fn cycle(
    system: &System<Digits>,
    guess: &(Float, Float),
    precision: Precision,
) -> Result<Option<Float>, Error> {
    let real = system.real();
    let zero = real.zero();
    let (mut a, mut period) = (real.float(&guess.0), real.float(&guess.1));
    let mut last = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let start = [a.clone(), zero.clone()];
        let flow = monodromy(system, (&zero, &period), &start, precision)?;
        let [x, v] = &flow.end[..] else { return Ok(None) };
        let [first, second] = &flow.matrix[..] else { return Ok(None) };
        // x''(0), at the solution x''(T).
        let mut acceleration = real.zero();
        let mut one = Integrator::new(system, &zero, &start, precision)?;
        one.advance(&period, &mut |report| {
            if let Report::Segment(segment) = report
                && let Some(rate) = segment.coefficients(1).and_then(|c| c.get(1))
            {
                acceleration = rate.clone();
            }
            ControlFlow::Break(())
        })?;
        let (p, q) = (real.difference(&first[0], &real.double(1.0)), v.clone());
        let (r, s) = (second[0].clone(), acceleration);
        let (f, g) = (real.difference(x, &a), v.clone());
        let determinant = real.difference(&real.product(&p, &s), &real.product(&q, &r));
        let da = real.difference(&real.product(&q, &g), &real.product(&s, &f));
        let dt = real.difference(&real.product(&r, &f), &real.product(&p, &g));
        let (da, dt) = (real.quotient(&da, &determinant), real.quotient(&dt, &determinant));
        a += &da;
        period += &dt;
        let size = real.log2(&da);
        // At the noise of the integration the steps cease to shrink.
        let small = -std::f64::consts::LOG2_10 * f64::from(precision.digits);
        if size < small || (size >= last && last < -40.0) {
            return Ok(Some(a));
        }
        if size.is_nan() || size > 0.0 {
            return Ok(None);
        }
        last = size;
    }
    Ok(None)
}
