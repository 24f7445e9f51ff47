//! The series of a problem at a point: what is summed, in which variable, and what the period
//! is by a closed form.

use super::{closed, coefficients};
use crate::derivation::limits::check_parameters;
use crate::{Error, Progress, Settings, Value, derive};
use lindstedt_algebra::{RationalAlgebra, Stop};
use lindstedt_coeff::ball::{Ball, Balls};
use lindstedt_equation::{AmplitudeRole, Condition, Problem};
use lindstedt_series::resummation::{Sample, UniformMap};
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// A formula for the value of T/2pi = factor * sum t_n x^n.
type Formula = Box<dyn Fn(Balls) -> Option<Ball> + Send + Sync>;
type Coefficients = Box<dyn Fn(u32) -> Option<Vec<Float>> + Send + Sync>;

/// The series of T/2pi at a point.
pub(super) struct Source {
    /// The variable of the series as it is printed.
    pub variable: &'static str,
    /// The parameters, as they stand.
    pub at: Vec<(&'static str, Value)>,
    /// t_n to so many bits.
    pub coefficients: Coefficients,
    /// x.
    pub point: Formula,
    /// The factor in front.
    pub factor: Formula,
    /// The period in closed form, with its formula.
    pub closed: Option<(&'static str, Formula)>,
    /// What is proved about the radius of convergence: its value, and why.
    pub radius: Option<(f64, &'static str)>,
    /// (scale, prefactor, radius) of the change of variable u = x/(scale + x).
    map: Option<(u32, Rational, Option<f64>)>,
}

impl Source {
    /// The sample at a precision.
    pub fn sample(&self, bits: u32) -> Option<Sample> {
        let point = (self.point)(Balls::new(bits).with_guard(64))?;
        let map = self.map.as_ref().map(|(scale, prefactor, radius)| UniformMap {
            scale: Float::with_val(bits, scale),
            prefactor: Float::with_val(bits, prefactor),
            radius: *radius,
        });
        Some(Sample {
            coefficients: (self.coefficients)(bits)?,
            point: Float::with_val(bits, point.midpoint()),
            map,
            radius: self.radius.map(|(radius, _)| radius),
            bits,
        })
    }
}

/// The parameters given, and the defaults of the others; n and delta determine each other.
struct Given<'a> {
    problem: &'a Problem,
    values: &'a BTreeMap<String, Value>,
}

impl Given<'_> {
    fn get(&self, name: &str) -> Result<Value, Error> {
        if let Some(value) = self.values.get(name) {
            return Ok(value.clone());
        }
        let card = self.problem.parameters.iter().find(|card| card.name == name);
        card.map_or(Err(Error::NoValue), |card| Value::parse(&card.default))
    }

    fn rational(&self, name: &'static str) -> Result<Rational, Error> {
        let value = self.get(name)?;
        value.as_rational().cloned().ok_or_else(|| Error::OutsideDomain {
            name: name.to_owned(),
            value: value.to_string(),
            domain: "the rational numbers",
        })
    }
}

/// As [`source`] without coefficients: the point, and the closed form.
pub(super) fn point(problem: &Problem, values: &BTreeMap<String, Value>) -> Result<Source, Error> {
    check_known(problem)?;
    check_parameters(problem, values)?;
    let given = Given { problem, values };
    match problem.amplitude {
        AmplitudeRole::ScalesFrequency { .. } => power_law(&given, 0, &Stop::default()),
        AmplitudeRole::InSums => pendulum(&given, 0, &Stop::default()),
        AmplitudeRole::InSmallParameter => duffing(&given, Vec::new()),
        AmplitudeRole::Determined => limit_cycle(&given, Vec::new()),
        AmplitudeRole::Free | AmplitudeRole::Scaled => Err(not_evaluated(problem)),
    }
}

/// The maps and closed forms below belong to the equations of the library; another equation with
/// the same role of its amplitude has others.
fn check_known(problem: &Problem) -> Result<(), Error> {
    let known = lindstedt_problems::find(&problem.name)
        .is_some_and(|known| known.equation == problem.equation);
    if known { Ok(()) } else { Err(not_evaluated(problem)) }
}

fn not_evaluated(problem: &Problem) -> Error {
    Error::NotEvaluated { problem: problem.name.to_string() }
}

/// The series of a problem. Problems over Q are derived by the driver to `order`; the others
/// have their coefficients by the energy integral when asked for.
pub(super) fn source(
    problem: &Problem,
    values: &BTreeMap<String, Value>,
    order: usize,
    (memory, stop): (u64, &Stop),
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Source, Error> {
    check_known(problem)?;
    check_parameters(problem, values)?;
    let given = Given { problem, values };
    match problem.amplitude {
        AmplitudeRole::ScalesFrequency { .. } => power_law(&given, order, stop),
        AmplitudeRole::InSums => pendulum(&given, order, stop),
        AmplitudeRole::InSmallParameter => {
            let series = over_rationals(problem, order, (memory, stop), observer)?;
            duffing(&given, series)
        }
        AmplitudeRole::Determined => {
            let series = over_rationals(problem, order, (memory, stop), observer)?;
            limit_cycle(&given, series)
        }
        AmplitudeRole::Free | AmplitudeRole::Scaled => Err(not_evaluated(problem)),
    }
}

fn power_law(given: &Given<'_>, order: usize, stop: &Stop) -> Result<Source, Error> {
    let delta = if given.values.contains_key("n") {
        (given.rational("n")? - 1u32) / 2u32
    } else {
        given.rational("delta")?
    };
    let amplitude = given.get("amplitude")?;
    let n = Rational::from(&delta * 2u32) + 1u32;
    // MPFR's exponents end at 2^30: beyond, no precision gives a^delta.
    let probe = Balls::new(64);
    let power = probe.ln(&amplitude.ball(probe)).map(|log| probe.mul_rational(&log, &delta));
    if power.is_none_or(|power| power.abs_upper() > 7e8) {
        return Err(Error::OutsideDomain {
            name: "amplitude^delta".to_owned(),
            value: format!("({amplitude})^({delta})"),
            domain: "between 10^(-3*10^8) and 10^(3*10^8)",
        });
    }
    let at = vec![
        ("n", Value::Rational(n)),
        ("delta", Value::Rational(delta.clone())),
        ("amplitude", amplitude.clone()),
    ];
    let (point, stop) = (delta.clone(), stop.clone());
    let (exponent, base) = (delta.clone(), amplitude.clone());
    let closed = move |balls: Balls| {
        closed::power_law(balls, &balls.from_rational(&delta), &amplitude.ball(balls))
    };
    Ok(Source {
        variable: "delta",
        at,
        coefficients: Box::new(move |bits| coefficients::power_law(order, bits, &stop)),
        point: Box::new(move |balls| Some(balls.from_rational(&point))),
        factor: Box::new(move |balls| {
            let log = balls.ln(&base.ball(balls))?;
            Some(balls.exp(&balls.neg(&balls.mul_rational(&log, &exponent))))
        }),
        closed: Some((
            "4*sqrt(pi*(1+delta))*Gamma(1+y)/Gamma(1/2+y)*a^(-delta), y = 1/(2+2*delta)",
            Box::new(closed),
        )),
        radius: Some((1.0, "the period is singular at delta = -1")),
        // sqrt(1 - u) T/2pi = Gamma(2-u) 2^u/Gamma(1-u/2)^2 has its nearest pole at u = 3.
        map: Some((1, Rational::from((1, 2)), Some(3.0))),
    })
}

fn pendulum(given: &Given<'_>, order: usize, stop: &Stop) -> Result<Source, Error> {
    let (delta, amplitude) = (given.rational("delta")?, given.get("amplitude")?);
    let at = vec![("amplitude", amplitude.clone()), ("delta", Value::Rational(delta.clone()))];
    let closed: Option<(&'static str, Formula)> = (delta == 1).then(|| {
        let amplitude = amplitude.clone();
        let formula = move |balls: Balls| closed::pendulum(balls, &amplitude.ball(balls));
        ("4*K(k), k = sin(a/2)", Box::new(formula) as Formula)
    });
    let stop = stop.clone();
    Ok(Source {
        variable: "delta",
        at,
        coefficients: Box::new(move |bits| {
            coefficients::pendulum(&|balls| amplitude.ball(balls), order, bits, &stop)
        }),
        point: Box::new(move |balls| Some(balls.from_rational(&delta))),
        factor: Box::new(|balls| Some(balls.one())),
        closed,
        // int x^(1 + 2 k delta) dx: a pole of the potential for every k.
        radius: Some((0.0, "the potential has poles at delta = -1/k for all k")),
        map: None,
    })
}

/// The rational coefficients of T/2pi in the small parameter, by the driver.
fn over_rationals(
    problem: &Problem,
    order: usize,
    (memory, stop): (u64, &Stop),
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Vec<Rational>, Error> {
    let condition = problem.conditions.first().copied();
    let condition = condition.filter(|c| *c != Condition::FundamentalAmplitude);
    let stop = stop.clone();
    let settings = Settings { order, condition, memory, stop, ..Settings::default() };
    let result = derive(problem, &settings, observer)?;
    let series = result.named("period_over_2pi").ok_or(Error::NoValue)?;
    let value = |c| result.ring.as_rational(c).ok_or(Error::NoValue);
    series.coefficients.iter().map(value).collect()
}

fn floats(list: Vec<Rational>) -> Coefficients {
    Box::new(move |bits| Some(list.iter().map(|q| Float::with_val(bits, q)).collect()))
}

fn duffing(given: &Given<'_>, series: Vec<Rational>) -> Result<Source, Error> {
    let (eps, amplitude) = (given.get("eps")?, given.get("amplitude")?);
    let at = vec![("eps", eps.clone()), ("amplitude", amplitude.clone())];
    let rho = move |balls: Balls| {
        Some(balls.mul(&eps.ball(balls), &balls.square(&amplitude.ball(balls))))
    };
    let probe = Balls::new(200);
    let below = rho(probe).map(|rho| balls_above_minus_one(probe, &rho));
    if below != Some(true) {
        return Err(Error::OutsideDomain {
            name: "eps*amplitude^2".to_owned(),
            value: rho(probe).map_or_else(String::new, |r| r.midpoint().to_f64().to_string()),
            domain: "greater than -1 (at -1 the amplitude is that of the saddle)",
        });
    }
    let closed = rho.clone();
    Ok(Source {
        variable: "rho = eps*amplitude^2",
        at,
        coefficients: floats(series),
        point: Box::new(rho),
        factor: Box::new(|balls| Some(balls.one())),
        closed: Some((
            "4*K(k)/sqrt(1+rho), k^2 = rho/(2+2*rho)",
            Box::new(move |balls| closed::duffing(balls, &closed(balls)?)),
        )),
        radius: Some((1.0, "the separatrix at rho = -1")),
        // sqrt(1 + rho) T/4 = K(k), 2 k^2 = u: analytic for |u| < 2; T ~ rho^(-1/2).
        map: Some((1, Rational::from((-1, 2)), Some(2.0))),
    })
}

fn balls_above_minus_one(balls: Balls, rho: &Ball) -> bool {
    balls.add(&balls.one(), rho).is_positive()
}

fn limit_cycle(given: &Given<'_>, series: Vec<Rational>) -> Result<Source, Error> {
    let eps = given.get("eps")?;
    let at = vec![("eps", eps.clone())];
    // The period is even in eps (t -> -t): a series in eps^2.
    let even = series.into_iter().step_by(2).collect();
    Ok(Source {
        variable: "eps^2",
        at,
        coefficients: floats(even),
        point: Box::new(move |balls| Some(balls.square(&eps.ball(balls)))),
        factor: Box::new(|balls| Some(balls.one())),
        closed: None,
        radius: None,
        // T ~ (3 - 2 ln 2) eps for eps -> infinity: relaxation oscillations.
        map: Some((1, Rational::from((1, 2)), None)),
    })
}
