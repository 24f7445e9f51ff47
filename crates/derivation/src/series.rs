//! The series of a result: powers of the frequency, in closed form, scaled to the amplitude.

use crate::binding::FORMAL;
use crate::energy::{period_over_2pi, power_law_frequency};
use crate::error::DerivationError as Error;
use crate::limits::has_logarithms;
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring, Stop};
use lindstedt_coeff::closed_forms::ClosedForms;
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem, Quantity};
use lindstedt_expand::{Binding, ExpandError, Period, compile, conservative_period};
use lindstedt_number::Exact;
use lindstedt_phase::Trigonometric;
use lindstedt_series::Series;
use rayon::prelude::*;
use rug::Rational;
use rug::ops::Pow;

/// A power series that belongs to the result: prefactor * sum c_n eps^n.
///
/// ```
/// use lindstedt_equation::Quantity;
/// use lindstedt_derivation::{Settings, derive};
/// let problem = lindstedt_problems::find("power-law").ok_or("no such problem")?;
/// let settings = Settings { order: 3, ..Settings::default() };
/// let law = derive(&problem, &settings, &mut |_| true)?;
/// assert_eq!(law.named(Quantity::Period).map(|series| series.coefficients.len()), Some(4));
/// assert!(law.named(Quantity::Amplitude).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct NamedSeries {
    /// What it is the series of: a power of the frequency, or x(0) where the condition leaves it open.
    pub quantity: Quantity,
    /// A factor kappa^(half_power/2) in front, kappa the linear stiffness; 0 when kappa = 1.
    pub half_power: i32,
    /// The coefficients in the small parameter, exact.
    pub coefficients: Vec<Polynomial>,
}

/// omega^2/kappa, its square root, and the reciprocal of that.
pub(crate) struct Powers {
    squared: Vec<Polynomial>,
    first: Vec<Polynomial>,
    inverse: Vec<Polynomial>,
    /// Whether the mu_m are put in already.
    closed: bool,
}

impl Powers {
    /// omega^2, omega and T/2pi as rational numbers.
    pub(crate) fn rational(
        ring: &PolynomialRing,
        [squared, first, inverse]: [&[Rational]; 3],
    ) -> Self {
        let over = |list: &[Rational]| list.iter().map(|q| ring.rational(q)).collect();
        Self::new(over(squared), over(first), over(inverse), false)
    }

    /// omega^2/kappa, its root, and the reciprocal of that; whether in closed form.
    pub(crate) fn new(
        squared: Vec<Polynomial>,
        first: Vec<Polynomial>,
        inverse: Vec<Polynomial>,
        closed: bool,
    ) -> Self {
        Self { squared, first, inverse, closed }
    }

    pub(crate) fn of_square(
        ring: &PolynomialRing,
        squared: Vec<Polynomial>,
    ) -> Result<Self, Error> {
        let series = Series::truncated(squared);
        let power = |exponent: (i32, u32)| {
            let power = series.power(ring, &Rational::from(exponent));
            power.map(|s| s.coefficients).ok_or(Error::NoValue)
        };
        let (first, inverse) = (power((1, 2))?, power((-1, 2))?);
        Ok(Self::new(series.coefficients, first, inverse, false))
    }
}

/// What is printed is the closed form where there is one; mu_m stay where S_n stand beside.
/// Without logarithms there is nothing to close (and tables to order 100 take minutes).
pub(crate) fn closes(problem: &Problem) -> bool {
    has_logarithms(&problem.equation) && !matches!(problem.amplitude, AmplitudeRole::InSums)
}

/// The series of the result.
pub(crate) fn series(
    problem: &Problem,
    ring: &PolynomialRing,
    (condition, stop): (Condition, &Stop),
    powers: Powers,
    amplitudes: Vec<Polynomial>,
    amplitude: Option<&Exact>,
    stiffness: &Polynomial,
) -> Result<Vec<NamedSeries>, Error> {
    let order = powers.squared.len() - 1;
    let closes = closes(problem) && !powers.closed;
    let lists = [&powers.squared, &powers.first, &powers.inverse];
    let monomials = lists.into_iter().flatten().flat_map(|p| p.terms());
    let symbols = monomials.flat_map(|(m, _)| m.factors()).map(|(symbol, _)| *symbol);
    let moments = symbols.filter_map(|s| if let Symbol::Moment(m) = s { Some(m) } else { None });
    let forms = closes.then(|| ClosedForms::new(moments.max().unwrap_or(0)));
    let close = |list: Vec<Polynomial>| -> Result<Vec<Polynomial>, Error> {
        let Some(forms) = &forms else { return Ok(list) };
        let closed = |p: &Polynomial| {
            if stop.asked() {
                return Err(ExpandError::Interrupted { order }.into());
            }
            forms.closed_form(ring, p).ok_or(Error::NoValue)
        };
        list.par_iter().map(closed).collect()
    };
    // a^(exponent eps) = exp(exponent eps ln a) for an amplitude other than one.
    let one = Rational::from(1);
    let rate = match (problem.amplitude, amplitude) {
        (AmplitudeRole::ScalesFrequency { exponent }, Some(a)) if a.as_rational() != Some(&one) => {
            exponent
        }
        _ => 0,
    };
    let half_power = |power: i32| if *stiffness == ring.one() { 0 } else { power };
    let named = |quantity: Quantity, list| -> Result<NamedSeries, Error> {
        let power = quantity.power();
        let log = ring.symbol(Symbol::Parameter(0));
        let log = ring.scale(&log, &Rational::from((rate * power, 2)));
        let mut coefficients = close(list)?;
        if rate != 0 {
            let factor = Series::truncated(exponential(ring, &log, order));
            coefficients = Series::truncated(coefficients).mul(ring, &factor, order).coefficients;
        }
        Ok(NamedSeries { quantity, half_power: half_power(power), coefficients })
    };
    let mut list = vec![
        named(Quantity::FrequencySquared, powers.squared)?,
        named(Quantity::Frequency, powers.first)?,
        named(Quantity::Period, powers.inverse)?,
    ];
    if let Some(quantity) = Quantity::start(condition).filter(|_| !amplitudes.is_empty()) {
        list.push(NamedSeries { quantity, half_power: 0, coefficients: amplitudes });
    }
    Ok(list)
}

/// The Taylor coefficients of exp(rate eps).
fn exponential(ring: &PolynomialRing, rate: &Polynomial, order: usize) -> Vec<Polynomial> {
    let mut list = vec![ring.one()];
    for n in 1..=order {
        let term = ring.mul(&list[n - 1], rate);
        list.push(ring.scale(&term, &Rational::from((1, n))));
    }
    list
}

/// The powers of the frequency and kappa of a polynomial force, where x(0) is the amplitude.
fn polynomial_integral(ring: &PolynomialRing, period: &Period) -> (Powers, Polynomial) {
    let lists = [&period.frequency_squared, &period.frequency, &period.period_over_2pi];
    let powers = Powers::rational(ring, lists.map(Vec::as_slice));
    (powers, ring.rational(&period.stiffness))
}

/// The powers of the frequency and kappa by the energy integral.
pub(crate) fn energy_integral(
    problem: &Problem,
    ring: &PolynomialRing,
    (condition, order): (Condition, usize),
    stop: &Stop,
    given: &dyn Binding<Rationals>,
) -> Result<(Powers, Polynomial), Error> {
    let unavailable = || Error::NoSuchRoute { problem: problem.name.to_string() };
    if !has_logarithms(&problem.equation) {
        if condition != Condition::InitialAmplitude {
            return Err(unavailable());
        }
        let equation = compile(&Trigonometric::new(Rationals), &problem.equation, given, order)?;
        return match conservative_period(&equation, order, stop) {
            Err(ExpandError::UnsupportedTerm { .. }) => Err(unavailable()),
            found => Ok(polynomial_integral(ring, &found?)),
        };
    }
    // Nothing comes from an interruption only, once the equation is known.
    let interrupted = || Error::from(ExpandError::Interrupted { order });
    // The formulas hold for these two equations, whatever the problem is called.
    let x = || Expression::DISPLACEMENT;
    let square = || x().pow(2);
    let power_law = Expression::ACCELERATION + x() * square().pow(Expression::Small);
    let formal = (Expression::Small * square().ln()).formal(FORMAL);
    let expected = match problem.amplitude {
        AmplitudeRole::ScalesFrequency { .. } => power_law,
        _ => Expression::ACCELERATION + x() * formal,
    };
    if problem.equation != expected {
        return Err(unavailable());
    }
    let size = u16::try_from(order).map_err(|_| unavailable())?;
    match problem.amplitude {
        AmplitudeRole::ScalesFrequency { exponent: 2 } => {
            let power = |p| power_law_frequency(ring, p, size, stop).ok_or_else(interrupted);
            Ok((Powers::new(power(2)?, power(1)?, power(-1)?, false), ring.one()))
        }
        AmplitudeRole::InSums => {
            let sums: Vec<Polynomial> = (0..=size).map(|n| ring.symbol(Symbol::Sum(n))).collect();
            let inverse = period_over_2pi(ring, &sums, order, stop).ok_or_else(interrupted)?;
            let period = Series::truncated(inverse);
            let power = |p: i32| {
                let power = period.power_while(ring, &Rational::from(p), &|| !stop.asked());
                power.map(|s| s.coefficients).ok_or_else(interrupted)
            };
            let (squared, first) = (power(-2)?, power(-1)?);
            let powers = Powers::new(squared, first, period.coefficients, false);
            Ok((powers, ring.symbol(Symbol::Sum(0))))
        }
        _ => Err(unavailable()),
    }
}

/// Powers of the frequency in the time of the problem: omega = w Omega.
pub(crate) fn undo_time_scale(series: &mut [NamedSeries], ring: &PolynomialRing, w: &Rational) {
    if *w == 1 {
        return;
    }
    for named in series {
        let factor = w.clone().pow(named.quantity.power());
        for coefficient in &mut named.coefficients {
            *coefficient = ring.scale(coefficient, &factor);
        }
    }
}
