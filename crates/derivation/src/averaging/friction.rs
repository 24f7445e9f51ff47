//! Averaging of laws that jump where the velocity changes its sign, between turning points:
//!
//!   x'' + omega_0^2 x + eps h(x, x'; eps) = 0,   h(-x, -x') = -h(x, x'),   h a polynomial where x' < 0.
//!
//! In the time omega_0 t it is x'' + x + eps h(x, omega_0 x')/omega_0^2 = 0, which the engine of half turns takes;
//! the rates are omega_0 times those in that time. Coefficients are in Q[pi, 1/pi], and in the parameters without
//! a value with their inverses: exact.

use super::coefficients::Coefficients;
use super::{Averaging, AveragingSettings, Coefficient, Formula, RateTerm, limit_memory};
use crate::error::DerivationError as Error;
use crate::limits::{refuse_taken, unknown_parameter};
use crate::work::Progress;
use lindstedt_algebra::Rationals;
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::sparse::Monomial as _;
use lindstedt_coeff::{Polynomial, PolynomialRing, PowerProduct, Symbol};
use lindstedt_equation::classify::Reason;
use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Problem};
use lindstedt_expand::ExpandError;
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_phase::half_turn::{FrictionTerm, HalfTurn, HalfTurnExpansion, average_half_turn};
use rug::Rational;
use std::collections::BTreeMap;

/// Whether this route takes the problem, or says what is against it.
pub(super) fn jumps(problem: &Problem) -> bool {
    problem.others.is_empty()
        && problem.impact.is_none()
        && problem.equation.smooth_powers().jump().is_some()
}

/// Exponents of the answer stay below this, far from the ends of their type.
const MOST_POWER: usize = 16_000;

/// q times powers of pi and of parameters.
type Scaled = (Rational, PowerProduct);

/// The problem in the time omega_0 t.
struct HalfTurnProblem {
    /// The parameters without a value.
    names: Vec<String>,
    frequency: Scaled,
    law: Vec<FrictionTerm>,
}

/// The averaged expansion as [`Averaging`].
pub(super) fn average(
    problem: &Problem,
    settings: &AveragingSettings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Averaging, Error> {
    let scaled = HalfTurnProblem::new(problem, &settings.parameters, settings.order)?;
    limit_memory(settings, scaled.names.len())?;
    let mut told = |order, terms| observer(Progress::Order(order, terms));
    let found = average_half_turn(&scaled.law, settings.order, &settings.stop, &mut told);
    observer(Progress::Checking);
    let order = found.solution.len() - 1;
    let checked_orders = found.checked_orders(&scaled.law);
    if checked_orders < order && !settings.stop.asked() {
        return Err(ExpandError::Residual { order: checked_orders + 1 }.into());
    }
    scaled.finish(problem, settings, &found, checked_orders)
}

impl HalfTurnProblem {
    fn new(
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        order: usize,
    ) -> Result<Self, Error> {
        let law = on_half_turn(problem, values)?;
        let unsupported = |e: &Expression| {
            let term = e.print(&problem.small, Style::Text);
            Error::from(ExpandError::UnsupportedTerm { term })
        };
        let all = expand(&law).ok_or_else(|| unsupported(&law))?;
        let open = law.parameters();
        // In the order of the data card, which is the order of printing.
        let cards = problem.parameters.iter().map(|card| card.name.to_string());
        let mut names: Vec<String> = cards.filter(|name| open.contains(name)).collect();
        names.extend(
            open.iter().filter(|n| *n != "pi" && !names.contains(n)).cloned().collect::<Vec<_>>(),
        );
        refuse_taken(&names, |base, numbered| match base {
            "a" if !numbered => Some("the amplitude"),
            "psi" if !numbered => Some("the phase"),
            "A" | "B" | "u" if numbered => Some("a coefficient"),
            _ => None,
        })?;
        let mut terms: BTreeMap<(usize, usize), Vec<HalfTurn>> = BTreeMap::new();
        let frequency = frequency(&all, &names, problem)?;
        for (m, q) in all.terms.iter().filter(|(m, _)| m.order > 0) {
            let constants = constants(m, &names).ok_or_else(|| unsupported(&all.tree(m, q)))?;
            let power = i32::try_from(m.velocity).unwrap_or(i32::MAX) - 2;
            let (factor, scale) = raised(&frequency, power);
            let constants = constants.times(&scale);
            if highest_power(m, &constants).saturating_mul(order) > MOST_POWER {
                return Err(unsupported(&all.tree(m, q)));
            }
            let factor = HalfTurn::constant(factor * q, constants);
            let factors = terms.entry((m.x as usize, m.velocity as usize)).or_default();
            let at = m.order as usize - 1;
            factors.resize(factors.len().max(at + 1), HalfTurn::default());
            factors[at] = factors[at].plus(&factor);
        }
        let law = terms.into_iter().map(|((displacement, velocity), factors)| FrictionTerm {
            factors,
            displacement,
            velocity,
        });
        Ok(Self { law: law.collect(), names, frequency })
    }

    fn finish(
        &self,
        problem: &Problem,
        settings: &AveragingSettings,
        found: &HalfTurnExpansion,
        checked_orders: usize,
    ) -> Result<Averaging, Error> {
        let term = |(exponent, c): (i32, Polynomial)| {
            Ok(RateTerm { exponent, coefficient: self.coefficient(&c, settings.digits)? })
        };
        let (factor, scale) = &self.frequency;
        let frequency = HalfTurn::constant(factor.clone(), scale.clone());
        let rate = |f: &HalfTurn| {
            f.times(&frequency).by_powers_of_amplitude().into_iter().map(term).collect()
        };
        let rates = |list: &[HalfTurn]| list.iter().map(rate).collect::<Result<Vec<_>, Error>>();
        let mut phase_rate = rates(&found.phase_rate)?;
        if let Some(first) = phase_rate.first_mut() {
            *first = frequency
                .by_powers_of_amplitude()
                .into_iter()
                .map(term)
                .collect::<Result<_, Error>>()?;
        }
        let printed = |u: &HalfTurn| {
            let (u, names) = (u.clone(), self.names.clone());
            Formula::new(move |style| u.print(&names, style))
        };
        Ok(Averaging {
            problem: problem.clone(),
            order: found.solution.len() - 1,
            checked_orders,
            amplitude_rate: rates(&found.amplitude_rate)?,
            phase_rate,
            solution: found.solution.iter().map(printed).collect(),
            terms: found.solution.iter().map(|u| u.terms().count()).collect(),
            symbols: self.names.clone(),
            exact: true,
            cycles: None,
            single_cycle: None,
            convergence: None,
            description: None,
        })
    }

    /// A formula, or a number in pi with its decimals.
    fn coefficient(&self, c: &Polynomial, digits: usize) -> Result<Coefficient, Error> {
        let ring = PolynomialRing { parameters: self.names.clone() };
        let parameter = |&(symbol, _): &(Symbol, i16)| matches!(symbol, Symbol::Parameter(_));
        if c.terms().iter().any(|(m, _)| m.factors().iter().any(parameter)) {
            let c = c.clone();
            return Ok(Coefficient::Formula(Formula::new(move |style| ring.print(&c, style))));
        }
        let [text, latex] = [Style::Text, Style::Latex].map(|style| ring.print(c, style));
        let value = |balls: Balls| {
            let target = BallRing { balls };
            Some(ring.substitute(&target, c, |_| Enclosure(balls.pi()))?.0)
        };
        let number = lindstedt_number::certified(Some(text), digits, value)?;
        Ok(Coefficient::ClosedForm { number, latex })
    }
}

/// The equation without x'' where x' < 0, its values put in; the number pi is a name.
fn on_half_turn(problem: &Problem, values: &BTreeMap<String, Exact>) -> Result<Expression, Error> {
    let cards = &problem.parameters;
    if let Some(name) = values.keys().find(|name| cards.iter().all(|card| card.name != **name)) {
        return Err(unknown_parameter(problem, name));
    }
    let unit = problem.equation.acceleration_alone();
    let unit = unit.map_err(|_| ExpandError::UnsupportedTerm { term: "x''".to_owned() })?;
    let used = unit.parameters();
    let root =
        |(name, value): &(&String, &Exact)| matches!(value, Exact::Root(_)) && used.contains(name);
    if let Some((name, value)) = values.iter().find(root) {
        return Err(Error::Irrational { name: name.clone(), value: value.to_string() });
    }
    let put_in = |e: &Expression| match e {
        Expression::Parameter(name) => match values.get(name)? {
            Exact::Rational(q) => Some(Expression::Number(q.clone())),
            Exact::PiTimes(q) => Some(Expression::Number(q.clone()) * Expression::parameter("pi")),
            Exact::Root(_) => None,
        },
        e if *e == Expression::ACCELERATION => Some(Expression::integer(0)),
        _ => None,
    };
    let rest = unit.substitute(&put_in).smooth_powers().canonical();
    rest.between_turning_points().map_err(|reason| against(problem, reason))
}

fn against(problem: &Problem, reason: Reason) -> Error {
    let in_time = |e: &Expression| matches!(e, Expression::Time) || e.is_delayed();
    let late_or_forced = problem.equation.find(&in_time).is_some();
    let small = problem.small.to_string();
    Error::BetweenTurningPoints { reason: Box::new(reason), small, late_or_forced }
}

/// omega_0, a number times powers of parameters.
fn frequency(all: &Monomials, names: &[String], problem: &Problem) -> Result<Scaled, Error> {
    let mut leading = all.terms.iter().filter(|(m, _)| m.order == 0);
    if let Some((m, q)) = leading.clone().find(|(m, _)| !m.is_power(1, 0)) {
        return Err(against(problem, Reason::NotWeaklyNonlinear(all.tree(m, q))));
    }
    let (Some((m, q)), None) = (leading.next(), leading.next()) else {
        let none = all.terms.keys().all(|m| m.order > 0);
        let fault = if none { ExpandError::NoStiffness } else { ExpandError::StiffnessNotSquare };
        return Err(fault.into());
    };
    if q.is_negative() {
        return Err(ExpandError::NegativeStiffness.into());
    }
    let constants = constants(m, names).filter(|c| c.factors().iter().all(|(_, n)| n % 2 == 0));
    let factor = Rationals.square_root(q);
    let (factor, constants) = factor.zip(constants).ok_or(ExpandError::StiffnessNotSquare)?;
    let halves = constants.factors().iter().map(|(symbol, n)| PowerProduct::power(*symbol, n / 2));
    Ok((factor, halves.fold(PowerProduct::unit(), |product, half| product.times(&half))))
}

/// The parameters of a monomial, pi among them; nothing where a factor is none of the names.
fn constants(m: &Monomial, names: &[String]) -> Option<PowerProduct> {
    if !m.atoms.is_empty() {
        return None;
    }
    let mut product = PowerProduct::unit();
    for (name, exponent) in &m.parameters {
        let position = || u16::try_from(names.iter().position(|known| known == name)?).ok();
        let symbol = match &**name {
            "pi" => Symbol::Pi,
            _ => Symbol::Parameter(position()?),
        };
        product = product.times(&PowerProduct::power(symbol, i16::try_from(*exponent).ok()?));
    }
    Some(product)
}

/// The highest power that a term brings into each order.
fn highest_power(m: &Monomial, constants: &PowerProduct) -> usize {
    let powers = constants.factors().iter().map(|(_, n)| usize::from(n.unsigned_abs()));
    powers.max().unwrap_or(0).max(m.x as usize + m.velocity as usize)
}

/// A power of a number times powers of parameters.
fn raised((factor, constants): &Scaled, power: i32) -> Scaled {
    let base = if power < 0 { Rational::from(factor.recip_ref()) } else { factor.clone() };
    let number = lindstedt_coeff::polynomial::power(&Rationals, &base, power.unsigned_abs());
    let n = i16::try_from(power).unwrap_or(i16::MAX);
    let each = constants.factors().iter();
    let each = each.map(|(symbol, m)| PowerProduct::power(*symbol, m.saturating_mul(n)));
    (number, each.fold(PowerProduct::unit(), |product, power| product.times(&power)))
}
