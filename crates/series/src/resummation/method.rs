//! The methods, one value with an error estimate each.

use super::borel::{Nodes, borel_transform, laplace};
use super::estimate::{
    best_truncation, distance, geometric_tail, settle, sizes, tentative, widest,
};
use super::singularity::nearest_singularity_until;
use super::{Estimate, Growth, Map, Pade, ResummationError, Singularity, growth, partial_sums};
use lindstedt_algebra::Stop;
use rug::Float;
use rug::float::Special;
use std::fmt;
use std::str::FromStr;

/// A way from coefficients to a value.
///
/// ```
/// use lindstedt_series::resummation::Method;
/// assert_eq!("borel-pade".parse(), Ok(Method::BorelPade));
/// assert_eq!(Method::PartialSum.to_string(), "none");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Method {
    /// The partial sum; of a divergent series up to the smallest term.
    PartialSum,
    /// Diagonal Pade approximants.
    Pade,
    /// The series in u = x/(s + x) with a prefactor, its partial sum.
    Uniform,
    /// Diagonal Pade approximants in u.
    UniformPade,
    /// Pade approximants after the conformal map of the plane cut at the nearest singularities, with
    /// the prefactor of the change of variable where one is known.
    ConformalPade,
    /// Pade approximants of the Borel transform and Laplace's integral.
    BorelPade,
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Method {
    type Err = ResummationError;

    fn from_str(text: &str) -> Result<Self, ResummationError> {
        let found = || text.chars().take(60).collect();
        let method = Self::ALL.into_iter().find(|method| method.name() == text);
        method.ok_or_else(|| ResummationError::UnknownMethod { found: found() })
    }
}

impl Method {
    /// Its name in questions and results: `none`, `pade`, `uniform`, `uniform-pade`, `conformal`,
    /// `borel-pade`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PartialSum => "none",
            Self::Pade => "pade",
            Self::Uniform => "uniform",
            Self::UniformPade => "uniform-pade",
            Self::ConformalPade => "conformal",
            Self::BorelPade => "borel-pade",
        }
    }

    /// All of them, in the order in which `auto` prefers them among equals.
    pub const ALL: [Self; 6] = [
        Self::PartialSum,
        Self::Uniform,
        Self::Pade,
        Self::UniformPade,
        Self::ConformalPade,
        Self::BorelPade,
    ];
}

/// What is known of the function beyond its coefficients.
#[derive(Clone, Debug)]
pub struct UniformMap {
    /// s in u = x/(s + x).
    pub scale: Float,
    /// p: the series of (1 - u)^p f, and of the like for the conformal map, is re-expanded;
    /// f ~ x^p for x -> infinity makes it bounded.
    pub prefactor: Float,
    /// The radius of convergence in u where it is known; else it is estimated.
    pub radius: Option<f64>,
}

/// The coefficients and the point at some precision, with what they tell.
#[derive(Clone, Debug)]
pub struct Sample {
    /// c_0, c_1, ...
    pub coefficients: Vec<Float>,
    /// x.
    pub point: Float,
    /// The change of variable for [`Method::Uniform`].
    pub map: Option<UniformMap>,
    /// The radius of convergence where it is known, zero for a series that diverges everywhere;
    /// else it is estimated.
    pub radius: Option<f64>,
    /// The precision to which all of these are known, relative.
    pub bits: u32,
}

/// A value by one method.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The value with its error estimate.
    pub estimate: Estimate,
    /// The highest order of the series that is used.
    pub order: usize,
    /// Degrees of the numerator and the denominator, for the methods with Pade approximants.
    pub degrees: Option<(usize, usize)>,
    /// A less cautious estimate of the error, which means something only where a method that shares
    /// no approximants with this one agrees; nothing where there is none.
    pub tentative: Option<Float>,
    /// The order of the smallest term, where the series was cut there because it diverges.
    pub smallest_term: Option<usize>,
}

/// Approximants before the last one that enter the error estimate.
const APPROXIMANTS: usize = 9;
/// Approximants with a pole between 0 and the point before that is taken for a cut.
const CUT: usize = 3;

impl Sample {
    /// The value by `method`.
    ///
    /// `singularity` is needed for [`Method::ConformalPade`] (see [`Self::singularity`]).
    /// `accuracy` is the number of bits beyond which a Laplace integral need not go.
    ///
    /// # Errors
    /// [`ResummationError`] where the method does not apply or gives no value.
    pub fn sum(
        &self,
        method: Method,
        singularity: Option<&Singularity>,
        accuracy: u32,
    ) -> Result<Outcome, ResummationError> {
        self.sum_until(method, singularity, accuracy, &Stop::default())
    }

    /// As [`Self::sum`], or [`ResummationError::Stopped`] once `stop` said so: it is asked in all
    /// long loops, and nothing that was computed with one broken off is returned.
    ///
    /// # Errors
    /// As [`Self::sum`].
    pub fn sum_until(
        &self,
        method: Method,
        singularity: Option<&Singularity>,
        accuracy: u32,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        let found = self.judged(method, singularity, accuracy, stop);
        if stop.asked() { Err(ResummationError::Stopped) } else { found }
    }

    fn judged(
        &self,
        method: Method,
        singularity: Option<&Singularity>,
        accuracy: u32,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        let known = self.coefficients.len();
        if known < 3 {
            return Err(ResummationError::TooFewCoefficients { known, needed: 3 });
        }
        if self.point.is_zero() {
            let value = Float::with_val(self.bits, &self.coefficients[0]);
            let estimate = Estimate { value, error: Float::new(53) };
            let (degrees, tentative, smallest_term) = (None, None, None);
            return Ok(Outcome { estimate, order: 0, degrees, tentative, smallest_term });
        }
        let mut outcome = self.by(method, singularity, accuracy, stop)?;
        // An error as large as half the value leaves not one digit, and is no estimate.
        let half = Float::with_val(53, outcome.estimate.value.abs_ref()) / 2u32;
        if self.is_unresolved() || outcome.estimate.error > half {
            outcome.estimate.error = Float::with_val(53, Special::Infinity);
            outcome.tentative = None;
        }
        Ok(outcome)
    }

    /// Whether the approximants of two methods are different: diagonal ones of one series are the
    /// same in x and in u = x/(s + x).
    pub(super) fn are_independent(a: Method, b: Method) -> bool {
        let kind = |m| if m == Method::UniformPade { Method::Pade } else { m };
        let by_approximants =
            |m| matches!(m, Method::Pade | Method::ConformalPade | Method::BorelPade);
        let (a, b) = (kind(a), kind(b));
        a != b && by_approximants(a) && by_approximants(b)
    }

    /// Whether the error of `method` follows from the terms and a known radius of convergence.
    pub(super) fn has_known_tail(&self, method: Method) -> bool {
        match method {
            Method::PartialSum => self.radius.is_some_and(|radius| radius > 0.0),
            Method::Uniform => self.map.as_ref().is_some_and(|map| map.radius.is_some()),
            _ => false,
        }
    }

    /// Whether no agreement means anything: the terms of an entire function (or of one with too
    /// few coefficients to tell) still grow at the last order.
    fn is_unresolved(&self) -> bool {
        let of_unknown_kind =
            matches!(growth(&self.coefficients), Growth::Entire | Growth::Undecided);
        if self.radius.is_some() || !of_unknown_kind {
            return false;
        }
        let terms = sizes(&self.coefficients, &self.point);
        let third = terms.len().div_ceil(3);
        let largest = |list: &[Float]| list.iter().cloned().reduce(|a, b| a.max(&b));
        let (early, late) = (terms.get(..third), terms.get(terms.len() - third..));
        late.and_then(largest) > early.and_then(largest)
    }

    fn by(
        &self,
        method: Method,
        singularity: Option<&Singularity>,
        accuracy: u32,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        match method {
            Method::PartialSum => self.partial_sum(),
            Method::Pade => diagonal(&self.coefficients, &self.point, self.bits, stop),
            Method::Uniform => {
                let (c, u, factor) = self.uniform(stop)?;
                let known = self.map.as_ref().and_then(|map| map.radius);
                let radius = disc(&c, known);
                if let Some(radius) = radius.filter(|radius| u.clone().abs() >= *radius) {
                    return Err(ResummationError::OutsideDisc { radius, at: u.to_f64() });
                }
                convergent(&c, &u, (radius, known.is_some()), self.bits)
                    .map(|outcome| scaled(outcome, &factor))
            }
            Method::UniformPade => {
                let (c, u, factor) = self.uniform(stop)?;
                diagonal(&c, &u, self.bits, stop).map(|outcome| scaled(outcome, &factor))
            }
            Method::ConformalPade => {
                let singularity = singularity.ok_or(ResummationError::NoSingularity)?;
                let map = wedge(singularity, self.bits);
                let w = map.inverse_until(&self.point, self.bits, stop)?;
                let p = self.map.as_ref().map_or_else(|| Float::new(53), |m| m.prefactor.clone());
                let c = map.expand_until(&self.coefficients, &p, self.bits, stop);
                let factor = map.factor(&self.point, &w, &p, self.bits);
                diagonal(&c, &w, self.bits, stop).map(|outcome| scaled(outcome, &factor))
            }
            Method::BorelPade => {
                let b = borel_transform(&self.coefficients, &self.point, self.bits);
                // The integral is no better than the approximants: many digits only where they
                // agree to as many.
                let mut asked = accuracy.min(128);
                loop {
                    let nodes = Nodes::new(asked, self.bits, stop);
                    let value = |pade: &Pade| Ok((laplace(pade, &nodes)?, None));
                    let mut outcome = staircase(&b, self.bits, &widest, value, stop)?;
                    outcome.tentative = None;
                    let size = Float::with_val(53, outcome.estimate.value.abs_ref());
                    // What the integral was not asked for.
                    let rest = size >> asked;
                    let limited = outcome.estimate.error < Float::with_val(53, &rest << 16);
                    outcome.estimate.error += rest;
                    if !limited || asked >= accuracy {
                        return Ok(outcome);
                    }
                    asked = asked.saturating_mul(4).min(accuracy);
                }
            }
        }
    }

    /// The nearest singularity in the coefficients, on the circle of convergence where that is known
    /// (see [`nearest_singularity`](super::nearest_singularity)).
    #[must_use]
    pub fn singularity(&self) -> Option<Singularity> {
        self.singularity_until(&Stop::default())
    }

    /// As [`Self::singularity`]; nothing once `stop` said so.
    pub(super) fn singularity_until(&self, stop: &Stop) -> Option<Singularity> {
        nearest_singularity_until(&self.coefficients, self.radius, self.bits, stop)
    }

    fn partial_sum(&self) -> Result<Outcome, ResummationError> {
        let sums = partial_sums(&self.coefficients, &self.point, self.bits);
        let radius = disc(&self.coefficients, self.radius);
        let outside = radius.is_some_and(|radius| self.point.clone().abs() >= radius);
        if !outside {
            let known = self.radius.is_some();
            return convergent(&self.coefficients, &self.point, (radius, known), self.bits);
        }
        let asymptotic = radius == Some(0.0);
        // The smallest term among the last ones is no smallest term yet.
        let inside = |order: usize| {
            if asymptotic { order + 2 < sums.len() } else { 3 * order < 2 * sums.len() }
        };
        let terms = sizes(&self.coefficients, &self.point);
        let best = best_truncation(&sums, &terms).filter(|(order, _)| inside(*order));
        // Terms that do not grow well beyond the smallest ones are no divergence yet.
        let late = terms.into_iter().skip(sums.len() * 2 / 3).reduce(|a, b| a.max(&b));
        let grows = |estimate: &Estimate| {
            late.as_ref().is_some_and(|late| *late > Float::with_val(53, &estimate.error * 4u32))
        };
        let mut outcome = match best {
            Some((order, estimate)) if grows(&estimate) => {
                let smallest_term = Some(order);
                Outcome { estimate, order, degrees: None, tentative: None, smallest_term }
            }
            _ => last_sum(&sums)?,
        };
        if self.radius != Some(0.0) {
            // Outside a disc of convergence nothing bounds the error by the terms, and a finite
            // number of coefficients does not prove that a series is asymptotic.
            outcome.estimate.error = Float::with_val(53, Special::Infinity);
        } else if outcome.smallest_term.is_some() {
            // An asymptotic series has its error below the smallest term or near it.
            outcome.estimate.error *= 3u32;
        }
        Ok(outcome)
    }

    /// The coefficients in u, u itself, and (1 - u)^-p.
    fn uniform(&self, stop: &Stop) -> Result<(Vec<Float>, Float, Float), ResummationError> {
        let map = self.map.as_ref().ok_or(ResummationError::NoMap)?;
        let change = Map::Rational { scale: map.scale.clone() };
        let u = change.inverse(&self.point, self.bits)?;
        let c = change.expand_until(&self.coefficients, &map.prefactor, self.bits, stop);
        // 1 - u = s/(s + x), without the cancellation for x -> infinity.
        let rest = Float::with_val(self.bits, &self.point + &map.scale);
        let rest = Float::with_val(self.bits, rest / &map.scale);
        let factor = rug::ops::Pow::pow(rest, &map.prefactor);
        Ok((c, u, factor))
    }
}

/// The wedge whose tips are the singularity and its conjugate.
fn wedge(singularity: &Singularity, bits: u32) -> Map {
    // The same map at every precision: the tips need not be right to all bits, so they are
    // rounded to doubles, and rounding is then what the comparison of two precisions measures.
    let modulus = Float::with_val(bits, singularity.at.abs().to_f64());
    let fraction = singularity.at.arg().to_f64().abs() / std::f64::consts::PI;
    // A real singularity has an imaginary part from rounding only.
    let nearest = fraction.round();
    let fraction = if (fraction - nearest).abs() < 1e-12 { nearest } else { fraction };
    Map::Wedge { modulus, fraction: Float::with_val(bits, fraction) }
}

fn scaled(mut outcome: Outcome, factor: &Float) -> Outcome {
    outcome.estimate.value *= factor;
    let size = Float::with_val(53, factor.abs_ref());
    outcome.estimate.error *= &size;
    outcome.tentative = outcome.tentative.map(|error| error * size);
    outcome
}

/// The radius of convergence as far as it may be relied on; zero for a series that diverges
/// everywhere, nothing for an entire function or too few coefficients.
///
/// N coefficients n^p R^-n with p not known to better than 2 give R to a factor 1 - 2/N.
fn disc(c: &[Float], known: Option<f64>) -> Option<f64> {
    known.or(match growth(c) {
        Growth::Radius { radius, .. } => Some(radius * (1.0 - 2.0 / c.len().max(3) as f64)),
        Growth::Factorial { .. } => Some(0.0),
        _ => None,
    })
}

/// The last partial sum, judged by those before it alone.
fn last_sum(sums: &[Float]) -> Result<Outcome, ResummationError> {
    let order = sums.len() - 1;
    let late = sums.get(order.saturating_sub(APPROXIMANTS)..).unwrap_or(sums);
    let estimate = settle(late, order).ok_or(ResummationError::Undefined)?;
    Ok(Outcome { estimate, order, degrees: None, tentative: None, smallest_term: None })
}

/// The last partial sum of a series that converges, |x| below the radius (and whether that is
/// known, not estimated).
fn convergent(
    c: &[Float],
    x: &Float,
    (radius, known): (Option<f64>, bool),
    bits: u32,
) -> Result<Outcome, ResummationError> {
    let sums = partial_sums(c, x, bits);
    let mut outcome = last_sum(&sums)?;
    let ratio = radius.map_or_else(|| Float::new(53), |r| Float::with_val(53, x.abs_ref()) / r);
    outcome.estimate.error = geometric_tail(&sizes(c, x), &ratio, known);
    Ok(outcome)
}

/// The approximants [n/n], [n-1/n] ... at x.
fn diagonal(c: &[Float], x: &Float, bits: u32, stop: &Stop) -> Result<Outcome, ResummationError> {
    let value = |pade: &Pade| {
        let (top, bottom) = pade.parts(x);
        let value = top / bottom;
        value.is_finite().then(|| (value, pade.jump(x))).ok_or(ResummationError::Undefined)
    };
    staircase(c, bits, &settle, value, stop)
}

/// A value from the last steps of the staircase [k - k/2 / k/2], k = N - 9 .. N.
///
/// `value` tells besides whether the denominator changes its sign between 0 and the point. Poles
/// there that come and go with the degree are a cut across the path: that of a pair of branch
/// points r exp(+-i phi) is an arc of the circle through 0, r and r exp(i phi), which meets the
/// axis at r/cos phi (it is a straight line in 1/x: the set of least capacity, H. Stahl), and the
/// approximants converge behind it to another branch. The error is then at least the jump of the
/// cut, as large as any of these poles makes it.
///
/// A step whose value stands apart from both neighbours by more than a thousand times their
/// distance is computed again without its spurious poles.
fn staircase(
    c: &[Float],
    bits: u32,
    judge: &dyn Fn(&[Float], usize) -> Option<Estimate>,
    value: impl Fn(&Pade) -> Result<(Float, Option<Float>), ResummationError>,
    stop: &Stop,
) -> Result<Outcome, ResummationError> {
    let order = c.len().saturating_sub(1);
    let first = order.saturating_sub(APPROXIMANTS);
    let degrees = |k: usize| (k - k / 2, k / 2);
    let mut values = Vec::new();
    let mut jumps = Vec::new();
    let mut failure = ResummationError::Undefined;
    let mut last = None;
    for k in first..=order {
        let (l, m) = degrees(k);
        if stop.asked() {
            return Err(ResummationError::Stopped);
        }
        let Some(pade) = Pade::until(stop, c, l, m, bits) else { continue };
        // Inside a block of the table there is none: one of lower degree ignores coefficients.
        if pade.degrees() != (l, m) && !pade.begins_with(&c[..=k]) {
            continue;
        }
        match value(&pade) {
            Ok((v, jump)) => {
                values.push((k, v));
                jumps.extend(jump);
                last = Some((k, pade.degrees()));
            }
            Err(error) => {
                failure = error;
                // A pole next to the path: without the doublet it may be gone.
                let robust = Pade::robust_until(stop, c, l, m, bits);
                let robust = robust.filter(|p| p.degrees() != pade.degrees());
                if let Some(pade) = robust
                    && let Ok((v, _)) = value(&pade)
                {
                    values.push((k, v));
                    last = Some((k, pade.degrees()));
                }
            }
        }
    }
    // Where the last of them have no value those before agree about something else.
    let Some((used, pade_degrees)) = last.filter(|(used, _)| values.len() > 1 && used + 1 >= order)
    else {
        return Err(failure);
    };
    for i in 1..values.len() {
        let far = |j: usize| Some(distance(&values.get(j)?.1, &values[i].1));
        let between = match values.get(i + 1) {
            Some(next) => distance(&next.1, &values[i - 1].1),
            None if i > 1 => distance(&values[i - 2].1, &values[i - 1].1),
            None => continue,
        };
        let apart =
            [far(i - 1), far(i + 1)].into_iter().flatten().all(|d| d > between.clone() * 1000u32);
        if apart {
            let (l, m) = degrees(values[i].0);
            let again = Pade::robust_until(stop, c, l, m, bits);
            let again = again.and_then(|pade| value(&pade).ok());
            if let Some((v, _)) = again {
                values[i].1 = v;
            }
        }
    }
    let list: Vec<Float> = values.into_iter().map(|(_, v)| v).collect();
    let mut tentative = tentative(&list, order);
    let mut estimate = judge(&list, order).ok_or(ResummationError::Undefined)?;
    if jumps.len() >= CUT
        && let Some(jump) = jumps.into_iter().reduce(|a, b| a.max(&b))
    {
        estimate.error = estimate.error.max(&jump);
        tentative = None;
    }
    let degrees = Some(pade_degrees);
    Ok(Outcome { estimate, order: used, degrees, tentative, smallest_term: None })
}
