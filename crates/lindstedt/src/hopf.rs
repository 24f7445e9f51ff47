//! The question `derive --unknown` of an equation without a small parameter: where a cycle is born, and the cycle.

use crate::motion::equation::meaning;
use crate::refusal::{Kind, Refusal, Refused};
use crate::{Answer, Error, Exact, Number, Oscillator, Progress, Remark, Work};
use lindstedt_derivation::resonance::Sought;
use lindstedt_equation::classify::Reason;
use lindstedt_equation::{Expression, Problem};
use lindstedt_hopf::{
    Coefficient, HarmonicNumber, HopfCycle, HopfError, HopfPoint, HopfSettings, Law, Step,
};
use lindstedt_number::ball::Ball;
use lindstedt_recognise::delay_equation;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::time::Instant;

/// Digits of the Hopf points that are only listed.
const LISTED: usize = 12;

/// The parameter and the frequency of the cycle that is born at a Hopf point, as series in its amplitude:
///
///   s = omega t,   x = eps (e^(is) + e^(-is)) + eps^2 x_2(s) + ...,   x_n without the harmonic 1,
///
/// so that 2 eps is the amplitude of the first harmonic.
///
/// ```
/// use lindstedt::{HopfSeries, Oscillator, Work};
/// let rayleigh = Oscillator::parse("x'' + a*x' + x + x'^3 = 0")?;
/// let HopfSeries { cycle, .. } = rayleigh.hopf("a", 2, &Work::default())?.value;
/// // (e^(is) + e^(-is))'^3 has 3 i in its first harmonic.
/// assert_eq!(cycle.parameter[2].number.exact.as_deref(), Some("-3"));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct HopfSeries {
    /// The problem.
    pub problem: Problem,
    /// The parameter that is sought.
    pub unknown: String,
    /// The Hopf point nearest to this value of it was taken.
    pub near: Exact,
    /// The series.
    pub cycle: HopfCycle,
}

/// A parameter as a series, by solvability: where a forced oscillator keeps a periodic motion, in powers of the small
/// parameter, or at a Hopf point, in powers of the amplitude.
///
/// ```
/// use lindstedt::{Oscillator, SoughtSeries, Work};
/// let of = |text: &str| Oscillator::parse(text)?.set("a", "1")?.sought("a", 1, &Work::default());
/// let mathieu = of("x'' + (a - 2*eps*cos(2*t))*x = 0")?.value;
/// let cycle = of("x'' + a*x' + x + x'^3 = 0")?.value;
/// assert!(matches!((mathieu, cycle), (SoughtSeries::Edges(_), SoughtSeries::Cycle(_))));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
#[allow(clippy::large_enum_variant, reason = "one value per question")]
pub enum SoughtSeries {
    /// The motions of a forced oscillator that stay periodic.
    Edges(Sought),
    /// The cycle that is born at a Hopf point.
    Cycle(HopfSeries),
}

impl Oscillator {
    /// The parameter `name` as a series: by [`Self::hopf`] where nothing in the equation is small, where it is of first
    /// order, or where the linear part has a delay; else by [`Self::parameter_series`].
    ///
    /// # Errors
    /// Those of both.
    ///
    /// ```
    /// use lindstedt::{Oscillator, SoughtSeries, Work};
    /// let wright = Oscillator::parse("x' + alpha*x(t - 1)*(1 + x) = 0")?;
    /// assert!(matches!(wright.sought("alpha", 2, &Work::default())?.value, SoughtSeries::Cycle(_)));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn sought(
        &self,
        name: &str,
        order: usize,
        work: &Work,
    ) -> Result<Answer<SoughtSeries>, Error> {
        if self.has_hopf_form() {
            return Ok(self.hopf(name, order, work)?.map(SoughtSeries::Cycle));
        }
        Ok(self.parameter_series(name, order, work)?.map(SoughtSeries::Edges))
    }

    fn has_hopf_form(&self) -> bool {
        let problem = self.problem();
        let equation = &problem.equation;
        if !problem.others.is_empty() || equation.is_first_order() {
            return problem.others.is_empty();
        }
        let delayed = || {
            let parts = self.classify().ok();
            let reasons = parts.into_iter().flat_map(|parts| parts.methods).flat_map(|(_, r)| r);
            reasons.into_iter().any(|reason| matches!(reason, Reason::DelayedLinearPart(_)))
        };
        let forced = equation.contains(&Expression::Time);
        !forced && !equation.contains(&Expression::Small) || delayed()
    }

    /// The cycle that is born at x = 0 where the parameter `name` passes a Hopf point, up to an order: scalar equations of
    /// first or second order, polynomial in x, x' and their values at any number of earlier times, with the values of all
    /// other parameters. The characteristic function L(lambda; name) has the simple root i omega_0, which crosses the
    /// axis with a speed. Of all Hopf points the one nearest to the value of `name` is taken, or to 0 where it has none.
    ///
    /// Exact in Q(pi) where omega_0 is a rational multiple of a power of pi and turns every delay by multiples of pi/2,
    /// else enclosed. Put into the equation by another route. Cost: the search some milliseconds to seconds; O(N^4)
    /// products of numbers, of polynomials in pi where exact.
    ///
    /// # Errors
    /// [`Refused`] with the term that does not fit, for parameters without a value, and where there is no such point.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work};
    /// let wright = Oscillator::parse("x' + alpha*x(t - 1)*(1 + x) = 0")?;
    /// let found = wright.hopf("alpha", 2, &Work::default())?.value.cycle;
    /// let exact: Vec<_> = found.parameter.iter().map(|c| c.number.exact.as_deref()).collect();
    /// assert_eq!(exact, [Some("1/2*pi"), Some("0"), Some("3/10*pi - 1/5")]);
    /// assert_eq!((found.is_stable(), found.checked_orders), (Some(true), Some(3)));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn hopf(&self, name: &str, order: usize, work: &Work) -> Result<Answer<HopfSeries>, Error> {
        let start = Instant::now();
        self.one_unknown()?;
        self.check_hopf_name(name)?;
        let values = self.form_values(&[])?;
        let mut problem = self.problem().clone();
        problem.equation = problem.equation.substitute(&|e| meaning(self, e));
        // Order n of the parameter follows from order n + 1 of the equation.
        let degree = u32::try_from(order).unwrap_or(u32::MAX).saturating_add(1);
        let expanded = !problem.equation.nodes().all(is_polynomial);
        let equation = delay_equation(&problem, &values, name, degree);
        let equation = equation.map_err(|refusal| self.no_hopf_form(&refusal))?;
        let near = values.get(name).cloned().unwrap_or_else(|| Exact::from(0));
        let settings = HopfSettings {
            unknown: name.to_owned(),
            near: near.to_f64(),
            order,
            digits: work.printed_digits(),
        };
        let mut told = false;
        let mut goes_on = |step| match step {
            Step::Order(n) => work.goes_on(Progress::Order(n - 1, n)),
            Step::Checking if !told => {
                told = true;
                work.goes_on(Progress::Checking)
            }
            _ => !work.stop.asked(),
        };
        let cycle = lindstedt_hopf::cycle(&equation, &settings, &mut goes_on)?;
        let done = cycle.parameter.len() - 1;
        let mut remarks = self.remarks().to_vec();
        if expanded {
            let text = format!("functions of x are their Taylor polynomials of degree {degree}");
            remarks.push(Remark(text));
        }
        let orders = (order, done, cycle.checked_orders.is_some());
        let at = values.into_iter().filter(|(other, _)| other != name);
        let tier = if cycle.exact { "exact" } else { "certified" };
        let problem = self.problem().clone();
        let value = HopfSeries { problem, unknown: name.to_owned(), near, cycle };
        Ok(self.finished(at, orders, tier, remarks, start).map(|()| value))
    }

    fn check_hopf_name(&self, name: &str) -> Result<(), Error> {
        let known = self.problem().parameters.iter().map(|card| &*card.name);
        let known: Vec<&str> = known.collect();
        if !known.contains(&name) {
            let message = format!("{name:?} is no parameter of the equation");
            let hint = format!("it has {}", known.join(", "));
            return Err(Refused::usage("unknown-parameter", message, hint).into());
        }
        if ["omega", "frequency", "s"].contains(&name) {
            let message = format!("{name} stands for the frequency or the phase of the cycle here");
            return Err(Refused::usage("symbol-taken", message, "another name").into());
        }
        Ok(())
    }

    /// A refusal of the form: nothing here would be mended by a small parameter.
    fn no_hopf_form(&self, refusal: &lindstedt_recognise::Refusal) -> Error {
        let (kind, code, hint) = refusal.parts();
        let hint = match code {
            "no-method" => {
                let first = self.problem().equation.is_first_order();
                let time = "; `lindstedt simulate` takes x'' = ... as it is";
                let rest = "where the equation rests at another number c, c exact as 2 or ln(2), write c + x for x";
                format!("{rest}{}", if first { "" } else { time })
            }
            "no-value-set" => {
                format!("{hint}; one parameter is sought, all others have values")
            }
            _ => hint,
        };
        let message = format!("{}: {}", self.origin(), self.reason(refusal));
        Refused { code, kind, message, hint }.into()
    }
}

/// Whether the node of a tree leaves a polynomial in the unknowns one.
fn is_polynomial(e: &Expression) -> bool {
    let whole = |n: &Expression| n.as_number().is_some_and(|n| n.is_integer() && n >= 0);
    let moves = |e: &Expression| e.nodes().any(|e| matches!(e, Expression::Unknown(_)));
    match e {
        Expression::Power(base, n) => whole(n) || !moves(base) && !moves(n),
        Expression::Function(_, argument) => !moves(argument),
        _ => true,
    }
}

/// What to do where nothing is born at x = 0.
const OTHER_REST: &str = "x = 0 is the equilibrium that is looked at: another one, x = c, is put there by x = c + y, x' = -r*(1 + x)*x(t - 1) \
     for x' = r*x*(1 - x(t - 1)); --set NAME=VALUE searches about another value";

impl Refusal for HopfError {
    fn parts(&self) -> (Kind, &'static str, String) {
        use Kind::{NoAnswer, Stopped, Undecided, Usage};
        let (kind, code, hint) = match self {
            Self::NoPoint { .. } => (NoAnswer, "no-hopf-point", OTHER_REST),
            Self::NoRoot | Self::NoSpeed | Self::Unbounded => (NoAnswer, "no-hopf-point", ""),
            Self::Still { .. } => {
                (NoAnswer, "no-hopf-point", "--unknown of a parameter of the linear part")
            }
            Self::Even => (NoAnswer, "no-hopf-point", "`lindstedt simulate` follows its motions"),
            Self::Resonant { .. } => (NoAnswer, "resonance", "another value of a parameter"),
            Self::Field => (Usage, "no-value", "a constant of the equation is not real"),
            Self::NotEnoughBits { .. } => (Undecided, "not-enough-digits", "fewer --digits"),
            Self::Stopped => (Stopped, "interrupted", ""),
            _ => (Undecided, "could-not-decide", "--set NAME=VALUE searches about another value"),
        };
        (kind, code, hint.to_owned())
    }
}

impl HopfSeries {
    /// (alpha, omega) of a listed Hopf point.
    #[must_use]
    pub fn listed(point: &HopfPoint) -> [Number; 2] {
        let number = |ball: &Ball| Number::of_ball(ball, LISTED).unwrap_or_else(Number::undefined);
        [number(&point.parameter), number(&point.frequency)]
    }
}

/// What is said of the points that were found.
#[derive(Serialize)]
struct Points<'a> {
    near: &'a Exact,
    interval: [f64; 2],
    points: Vec<[Number; 2]>,
    crossing: [&'a Number; 2],
    unstable_roots: Option<usize>,
}

#[derive(Serialize)]
struct LawNumbers<'a> {
    order: usize,
    amplitude: &'a Number,
    frequency_slope: &'a Number,
    side: &'static str,
    criticality: &'static str,
}

#[derive(Serialize)]
struct Wave {
    harmonic: usize,
    cos: Number,
    sin: Number,
}

/// The orders from 1 at which the equation was satisfied: exactly, or within the enclosures.
#[derive(Serialize)]
struct Residual {
    checked_orders: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    zero: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    encloses_zero: Option<bool>,
}

fn numbers(list: &[Coefficient]) -> Vec<&Number> {
    list.iter().map(|c| &c.number).collect()
}

/// Of a law: 0, ..., 0, beta_m.
fn floquet(law: &Law) -> Vec<Number> {
    let zero = lindstedt_number::rational(&rug::Rational::new(), 1);
    let zeros = std::iter::repeat_n(zero.ok(), law.order).flatten();
    zeros.chain([law.floquet_exponent.number.clone()]).collect()
}

impl Serialize for HopfSeries {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let cycle = &self.cycle;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &*self.problem.small)?;
        map.serialize_entry("unknown", &self.unknown)?;
        let series = [(&*self.unknown, &cycle.parameter), ("frequency", &cycle.frequency)];
        let series = series.map(|(name, list)| (name, numbers(list)));
        map.serialize_entry("series", &std::collections::BTreeMap::from(series))?;
        let solution: Vec<&str> = cycle.solution.iter().map(|x| &*x[0]).collect();
        map.serialize_entry("solution", &solution)?;
        let wave = |w: &HarmonicNumber| Wave {
            harmonic: w.harmonic,
            cos: w.cos.clone(),
            sin: w.sin.clone(),
        };
        let harmonics = cycle.harmonics.iter().map(|x| x.iter().map(wave).collect::<Vec<_>>());
        map.serialize_entry("harmonics", &harmonics.collect::<Vec<_>>())?;
        let [re, im] = &cycle.crossing;
        let points = Points {
            near: &self.near,
            interval: cycle.points.interval,
            points: cycle.points.points.iter().map(Self::listed).collect(),
            crossing: [&re.number, &im.number],
            unstable_roots: cycle.unstable_roots,
        };
        map.serialize_entry("hopf", &points)?;
        let law = cycle.law.as_ref().map(|law| LawNumbers {
            order: law.order,
            amplitude: &law.amplitude.number,
            frequency_slope: &law.frequency_slope.number,
            side: if law.above { "above" } else { "below" },
            criticality: if law.supercritical { "supercritical" } else { "subcritical" },
        });
        map.serialize_entry("law", &law)?;
        map.serialize_entry("floquet_exponent", &cycle.law.as_ref().map(floquet))?;
        map.serialize_entry("stable", &cycle.is_stable())?;
        let residual = Residual {
            checked_orders: cycle.checked_orders,
            zero: cycle.checked_orders.filter(|_| cycle.exact).map(|_| true),
            encloses_zero: cycle.checked_orders.filter(|_| !cycle.exact).map(|_| true),
        };
        map.serialize_entry("residual", &residual)?;
        map.end()
    }
}
