//! Values from an expansion: period and frequency at given parameters, by resummation of the
//! series of T/2pi, beside the closed form where there is one.

pub mod averaged;
pub(crate) mod closed;
pub(crate) mod coefficients;
pub(crate) mod few;
pub(crate) mod setting;
mod solution;
pub(crate) mod source;

use crate::Number;
use crate::{Error, Exact, Progress};
use lindstedt_algebra::Stop;
use lindstedt_equation::{Condition, Problem};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::certified;
use lindstedt_series::resummation::{
    Growth, Kind, Method, Pade, Picture, ResummationError, Resummed, resum_until,
};
use rug::Float;
use setting::{Form, Setting};
pub use solution::{Displacement, Fourier, Trajectory};
use source::{Source, remembered};
use std::collections::BTreeMap;

/// What to evaluate.
#[derive(Clone, Debug)]
pub struct EvaluateSettings {
    /// The highest order of the expansion; a quick one if nothing.
    pub order: Option<usize>,
    /// The method; nothing is `auto`, the one with the least error estimate.
    pub method: Option<Method>,
    /// The normalisation; the problem's default if nothing.
    pub condition: Option<Condition>,
    /// Values of parameters by name, the small one included.
    pub parameters: BTreeMap<String, Exact>,
    /// Digits asked for; an estimate has as many of them as its error allows.
    pub digits: usize,
    /// The memory that may be used, in bytes.
    pub memory: u64,
    /// Asked within long steps whether to stop.
    pub stop: Stop,
}

impl Default for EvaluateSettings {
    fn default() -> Self {
        Self {
            order: None,
            method: None,
            condition: None,
            parameters: BTreeMap::new(),
            digits: 30,
            memory: 8 << 30,
            stop: Stop::default(),
        }
    }
}

/// A period and how it was found.
#[derive(Debug)]
pub struct Evaluation {
    /// The parameters, the derived ones included.
    pub at: Vec<(String, Exact)>,
    /// The variable of the series.
    pub variable: String,
    /// The order of the expansion in the small parameter.
    pub order: usize,
    /// The period by resummation; nothing where not one digit is supported. Without an error
    /// where the coefficients are too few for an estimate.
    pub period: Option<Number>,
    /// 2 pi over the period.
    pub frequency: Option<Number>,
    /// The period by the closed form, and that form.
    pub exact_period: Option<Number>,
    /// |period - exact period|, where both are known.
    pub true_error: Option<String>,
    /// What was done, what the alternatives gave, what the coefficients tell.
    pub resummed: Resummed,
    /// The best truncation of a divergent series: order and partial sum of T.
    pub best_truncation: Option<(usize, Option<Number>)>,
    /// What is proved about the radius of convergence: its value, and why.
    pub radius: Option<(f64, &'static str)>,
    /// The best that is known of the period: the closed form, else the estimate.
    best_period: Ball,
    /// Whether an error of the period is known.
    is_estimated: bool,
    /// Whether the coefficients are too few for an estimate: a few digits of the sum are shown.
    no_estimate: bool,
    /// Bits asked for.
    accuracy: u32,
    /// In words.
    pub verdict: String,
    /// Poles and zeros of the diagonal Pade approximant of the highest order.
    pub picture: Option<Picture>,
}

/// The order that takes well below a second.
fn default_order(form: &Form) -> usize {
    match form {
        Form::PowerLaw { .. } => 20,
        Form::Sums => 24,
        Form::Cubic { .. } => 30,
        Form::Relaxation => 60,
        Form::Conservative | Form::Polynomial => 24,
        Form::Logarithmic => 8,
    }
}

/// Bits for so many digits, with a margin.
fn bits_for(digits: usize) -> u32 {
    u32::try_from(digits).unwrap_or(u32::MAX / 8).saturating_mul(4).saturating_add(32)
}

/// Evaluates the period of a problem: of the library, of a file, or built from an equation.
///
/// The series of T/2pi in the small parameter is summed; which quantity is truncated matters, and
/// it is always this one. `period` and `frequency` are estimated; `exact_period` is certified, and
/// there for x'' + k x (x^2)^delta, x'' + k x + c eps x^3 and the pendulum with a given amplitude.
///
/// # Errors
/// [`Error::NotEvaluated`] for a problem without a periodic solution that is expanded (no
/// condition, a free amplitude, a wall); [`Error::Unset`] where the small parameter or another one
/// has no value; [`Error::OutsideDomain`] and [`Error::UnknownParameter`] for parameters,
/// [`Error::Resummation`] where the method asked for does not apply, and what
/// [`crate::derive()`] returns.
///
/// ```
/// use lindstedt::evaluate::{EvaluateSettings, evaluate};
/// use lindstedt::problems;
/// let problem = problems::find("power-law").ok_or("no such problem")?;
/// let result = evaluate(&problem, &EvaluateSettings::default(), &mut |_| true)?;
/// let exact = result.exact_period.ok_or("no closed form")?;
/// assert_eq!(exact.decimal, "7.41629870920548767373540138878");
/// let period = result.period.ok_or("not one digit")?;
/// assert!(period.decimal.starts_with("7.41629870920548"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn evaluate(
    problem: &Problem,
    settings: &EvaluateSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Evaluation, Error> {
    let setting = Setting::new(problem, settings.condition, &settings.parameters)?;
    let order = settings.order.unwrap_or_else(|| default_order(&setting.form));
    let limits = (settings.memory, &settings.stop);
    let accuracy = bits_for(settings.digits);
    source::limit_memory(&setting.form, order, accuracy, settings.memory)?;
    let source = Source::new(&setting, order, limits, observer)?;
    if !observer(Progress::Checking) {
        return Err(lindstedt_expand::ExpandError::Interrupted { order }.into());
    }
    let sample = remembered(|bits| if settings.stop.asked() { None } else { source.sample(bits) });
    let few = few::partial_sum(&sample, source.known, settings.method, accuracy);
    let resummed =
        few.unwrap_or_else(|| resum_until(&sample, settings.method, accuracy, &settings.stop));
    if settings.stop.asked() {
        return Err(lindstedt_expand::ExpandError::Interrupted { order }.into());
    }
    let resummed = resummed
        .map_err(|reason| Error::Resummation { problem: problem.name.to_string(), reason })?;
    let exact_period = match &source.closed {
        None => None,
        Some((form, formula)) => {
            let found = certified(Some(form.clone()), settings.digits, formula);
            if settings.stop.asked() {
                return Err(lindstedt_expand::ExpandError::Interrupted { order }.into());
            }
            Some(found?)
        }
    };
    let balls = Balls::new(resummed.bits).with_guard(64);
    let scale = period_scale(&source, balls)?;
    let estimate = &resummed.outcome.estimate;
    let mut period = balls.mul(&balls.from_parts(&estimate.value, &estimate.error), &scale);
    let closed = source.closed.as_ref().and_then(|(_, formula)| formula(balls));
    let value = balls.mul(&balls.from_parts(&estimate.value, &Float::new(53)), &scale);
    let difference = closed.as_ref().map(|exact| balls.sub(&value, exact).abs_upper());
    if let Some(error) = &difference
        && (!estimate.error.is_finite() || error > period.radius())
    {
        // Too few orders for an estimate, or an estimate that fails: the closed form measures
        // the error.
        period = balls.add_error(&value, error);
    }
    let no_estimate = !estimate.error.is_finite() && few::has_no_estimate(source.known);
    let is_estimated = period.is_finite();
    if !is_estimated && no_estimate {
        period = value;
    }
    // A measured error above the value leaves no digit.
    let has_no_digit =
        no_estimate && is_estimated && *period.radius() >= period.midpoint().clone().abs();
    let number = |ball: &Ball| match no_estimate {
        _ if has_no_digit => None,
        false => Number::estimated(ball, settings.digits),
        true => few::plain(ball, settings.digits, is_estimated),
    };
    let frequency = balls.div(&balls.mul_i64(&balls.pi(), 2), &period);
    let best = best_truncation(&sample, &resummed, &scale, settings.digits);
    let picture = picture(&sample, resummed.bits, &settings.stop);
    if settings.stop.asked() {
        return Err(lindstedt_expand::ExpandError::Interrupted { order }.into());
    }
    let mut result = Evaluation {
        order,
        period: number(&period),
        frequency: frequency.and_then(|f| number(&f)),
        exact_period,
        true_error: difference.map(|error| short(&error)),
        resummed,
        best_truncation: best,
        radius: source.radius,
        best_period: closed.unwrap_or(period),
        is_estimated,
        no_estimate,
        accuracy,
        verdict: String::new(),
        picture,
        at: source.at.clone(),
        variable: source.variable.clone(),
    };
    result.verdict = result.describe();
    Ok(result)
}

/// 2 pi times the factor of the series.
fn period_scale(source: &Source, balls: Balls) -> Result<Ball, Error> {
    let factor = (source.factor)(balls).filter(Ball::is_finite).ok_or(Error::NoValue)?;
    Ok(balls.mul(&balls.mul_i64(&balls.pi(), 2), &factor))
}

fn short(x: &Float) -> String {
    if x.is_zero() { "0".to_owned() } else { format!("{:.1e}", Float::with_val(53, x)) }
}

/// The smallest term of a series that diverges at the point.
fn best_truncation(
    sample: &dyn Fn(u32) -> Option<lindstedt_series::resummation::Sample>,
    resummed: &Resummed,
    scale: &Ball,
    digits: usize,
) -> Option<(usize, Option<Number>)> {
    let outcome = sample(resummed.bits)?.sum(Method::PartialSum, None, 64).ok()?;
    let order = outcome.smallest_term?;
    let balls = Balls::new(resummed.bits);
    let ball = balls.from_parts(&outcome.estimate.value, &outcome.estimate.error);
    Some((order, Number::estimated(&balls.mul(&ball, scale), digits)))
}

/// The poles and zeros of the diagonal approximant.
fn picture(
    sample: &dyn Fn(u32) -> Option<lindstedt_series::resummation::Sample>,
    bits: u32,
    stop: &Stop,
) -> Option<Picture> {
    let sample = sample(bits)?;
    let order = sample.coefficients.len().checked_sub(1).filter(|order| *order > 1)?;
    let half = order / 2;
    Pade::until(stop, &sample.coefficients, order - half, half, bits)?.picture_until(stop)
}

/// A double with the digits that its error leaves, and the error rounded up to one digit.
#[must_use]
pub fn with_error(value: f64, error: f64) -> String {
    let [value, error] = rounded(value, error);
    format!("{value} +- {error}")
}

/// A double to the place of the first digit of its error, and the error rounded up to that digit.
#[must_use]
pub fn rounded(value: f64, error: f64) -> [String; 2] {
    let least = value.abs().max(f64::MIN_POSITIVE) * f64::EPSILON;
    let error = error.abs().max(least);
    let exponent = error.log10().floor();
    let unit = 10f64.powi(exponent as i32);
    let error = (error / unit * (1.0 - 1e-9)).ceil() * unit;
    let size = value.abs().max(error);
    if exponent > 0.0 || !(1e-4..1e6).contains(&size) {
        let digits = (size.log10().floor() - exponent).clamp(0.0, 17.0) as usize;
        return [format!("{value:.digits$e}"), format!("{error:.0e}")];
    }
    let places = (-exponent).clamp(0.0, 17.0) as usize;
    let error = if exponent < -4.0 { format!("{error:.0e}") } else { format!("{error:.places$}") };
    [format!("{value:.places$}"), error]
}

/// The name of a method in words.
#[must_use]
pub fn method_name(method: Method) -> &'static str {
    match method {
        Method::PartialSum => "partial sum",
        Method::Pade => "Pade",
        Method::Uniform => "uniform (series in u)",
        Method::UniformPade => "Pade in u",
        Method::ConformalPade => "conformal map and Pade",
        Method::BorelPade => "Borel and Pade",
        _ => "another method",
    }
}

/// The name of a kind of singularity.
#[must_use]
pub fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Pole => "pole",
        Kind::SquareRoot => "square root",
        Kind::InverseSquareRoot => "inverse square root",
        Kind::Logarithm => "logarithm",
        _ => "power",
    }
}

impl Evaluation {
    /// What was done and why, in one or two sentences.
    fn describe(&self) -> String {
        let outcome = &self.resummed.outcome;
        let mut parts = Vec::new();
        let name = &self.variable;
        parts.push(match (self.radius, self.resummed.growth) {
            (Some((0.0, why)), _) => {
                format!("the series in {name} diverges for every {name} but 0 ({why}): it is asymptotic")
            }
            (Some((radius, why)), _) => {
                format!("the series in {name} has radius of convergence {radius} ({why})")
            }
            (None, Growth::Factorial { rate }) => format!(
                "the series in {name} seems to diverge for every {name} but 0 (coefficients grow like \
                 n!^{rate:.1}): asymptotic"
            ),
            (None, Growth::Entire) => {
                format!("the coefficients in {name} fall like those of an entire function")
            }
            _ => match self.estimated_radius() {
                Some((radius, error)) => {
                    let radius = with_error(radius, error);
                    format!("the series in {name} has radius of convergence {radius} (estimated)")
                }
                None => "too few coefficients to estimate the radius of convergence".to_owned(),
            },
        });
        if let Some((order, number)) = &self.best_truncation {
            let value = number.as_ref().map_or_else(String::new, |n| format!(": {}", n.decimal));
            parts.push(format!("best truncation at order {order}{value}"));
        }
        let method = method_name(self.resummed.method);
        let degrees = outcome.degrees.map_or_else(String::new, |(l, m)| format!(" [{l}/{m}]"));
        let choice = self.choice();
        parts.push(match &self.period {
            Some(Number { error: Some(error), .. }) if self.no_estimate => format!(
                "{method}{degrees} of order {}, no estimate from so few coefficients; against the \
                 closed form the error is {error}",
                self.order
            ),
            Some(Number { error: Some(error), .. }) => {
                format!("summed by {method}{degrees}{choice}, estimated error {error}")
            }
            Some(_) => format!(
                "{method}{degrees} of order {}, no estimate from so few coefficients",
                self.order
            ),
            None if self.no_estimate => format!(
                "{method}{degrees} of order {} gives not one digit: against the closed form the \
                 error is {}",
                self.order,
                self.true_error.as_deref().unwrap_or("larger than the value")
            ),
            None => format!(
                "{method}{degrees} gives not one digit: neighbouring approximants do not agree"
            ),
        });
        parts.join("; ")
    }

    /// The radius of convergence and its error, both estimated, where the coefficients have one:
    /// the modulus of the nearest singularity where that is found and agrees with the slope of
    /// log |c_n|, else that slope.
    #[must_use]
    pub fn estimated_radius(&self) -> Option<(f64, f64)> {
        let found = self.resummed.singularity.as_ref();
        // The disagreement of a few approximants is no bound: twice as much.
        let modulus = found.map(|s| (s.at.abs().to_f64(), 2.0 * s.error.to_f64()));
        match self.resummed.growth {
            Growth::Radius { radius, error } => {
                let agrees = |pair: &(f64, f64)| (pair.0 - radius).abs() <= error + pair.1;
                Some(modulus.filter(agrees).unwrap_or((radius, error)))
            }
            Growth::Undecided => modulus,
            _ => None,
        }
    }

    /// Why the method was taken, where there was a choice.
    fn choice(&self) -> String {
        let Resummed { tried, method, outcome, .. } = &self.resummed;
        let errors = || tried.iter().filter_map(|(m, e)| Some((m, e.as_ref().ok()?)));
        let finite = || errors().filter(|(_, error)| error.is_finite());
        let Some((_, own)) = errors().find(|(m, _)| *m == method).filter(|_| tried.len() > 1)
        else {
            return String::new();
        };
        let count = finite().count();
        let floor = Float::with_val(53, outcome.estimate.value.abs_ref()) >> self.accuracy;
        if count == 1 {
            format!(", the only one of {} methods with an error estimate", tried.len())
        } else if *own <= floor {
            format!(
                ", the simplest of {} methods whose error is below the working precision",
                tried.len()
            )
        } else if finite().all(|(_, error)| own <= error) {
            format!(", the least error estimate of {count} methods")
        } else {
            let least = finite().map(|(_, error)| error.clone()).reduce(|a, b| a.min(&b));
            let near = least.map_or(count, |least| {
                let bound = least * 10u32;
                finite().filter(|(_, error)| **error <= bound).count()
            });
            format!(
                ", the simplest of {near} methods whose error estimate is within a factor 10 of \
                 the least"
            )
        }
    }

    /// Whether the coefficients are too few for an estimate of the error; the error of the period,
    /// if there is one, is then measured by the closed form.
    #[must_use]
    pub fn has_no_estimate(&self) -> bool {
        self.no_estimate
    }

    /// Why a method gave nothing, or its error estimate relative to 2 pi times the factor.
    #[must_use]
    pub fn tried(&self) -> Vec<(&'static str, String)> {
        let text = |found: &Result<Float, ResummationError>| match found {
            Ok(error) => short(error),
            Err(reason) => reason.to_string(),
        };
        self.resummed.tried.iter().map(|(m, found)| (method_name(*m), text(found))).collect()
    }
}
