//! Which methods take an equation, and what is against the others.

use crate::classification::{Algebra, Classification, Forcing, Method, Reason, evaluate};
use crate::monomials::expand;
use crate::roots::{rational_root, rational_square};
use crate::saddle::has_saddle;
use crate::symmetry::{Parity, parity, parity_in_x};
use crate::{Condition, Expression, Function, Problem};
use rug::Rational;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Fills in algebra and methods.
pub(crate) fn decide(
    problem: &Problem,
    rest: &Expression,
    values: &BTreeMap<String, Rational>,
    stiffness: Option<Rational>,
    parts: &mut Classification,
) {
    let time = terms_in_time(problem, rest);
    let weak = weakly_nonlinear(parts, rest, stiffness.as_ref());
    let lindstedt = lindstedt(problem, rest, stiffness.as_ref(), parts, &weak);
    let averaging = averaging(problem, rest, parts, (values, &weak));
    let logarithms = rest.find(&is_logarithmic).is_some();
    let unbound = rest.parameters().iter().any(|name| !values.contains_key(name));
    parts.algebra = match (lindstedt.is_empty(), averaging.is_empty()) {
        (false, false) => Algebra::Numeric,
        (_, true) if !parts.non_smooth.is_empty() => Algebra::HalfTurns,
        _ if logarithms => Algebra::Lobachevsky,
        (true, _) if !unbound => Algebra::TrigonometricOverRationals,
        _ => Algebra::TrigonometricOverParameters,
    };
    let polynomial = lindstedt.is_empty()
        && !logarithms
        && !rest.contains(&Expression::VELOCITY)
        && problem.conditions.contains(&Condition::InitialAmplitude);
    let energy = match polynomial || is_energy_form(rest) {
        true => Vec::new(),
        false => vec![Reason::Form],
    };
    let saddle_at_zero = stiffness.is_some_and(|kappa| kappa.cmp0() == Ordering::Less);
    // Without a force nothing splits, and a saddle is no reason to think of Melnikov.
    let saddle = !parts.forcing.is_empty()
        && parts.strong.iter().all(|t| parity(&t.term, false) == Some(Parity::Even))
        && parts.delays.is_empty()
        && parts.forcing.iter().all(|f| f.order > 0)
        && !parts.impact
        && (saddle_at_zero || has_saddle(rest, values) == Some(true));
    let melnikov = match saddle {
        true => Vec::new(),
        false if parts.forcing.is_empty() => vec![Reason::NoForce],
        false => vec![Reason::NoSaddle],
    };
    parts.methods = vec![
        (Method::LindstedtPoincare, lindstedt),
        (Method::Averaging, averaging),
        (Method::EnergyIntegral, energy),
        (Method::Melnikov, melnikov),
        (Method::TimeDomain, time),
    ];
}

/// What is against integration in time.
fn terms_in_time(problem: &Problem, rest: &Expression) -> Vec<Reason> {
    let equation = problem.time_domain.as_ref().unwrap_or(rest);
    let formal = equation.find(&|e| matches!(e, Expression::Formal(..)));
    let not_real = equation.find(&is_not_real);
    let formal = formal.map(|e| Reason::Formal(e.clone()));
    formal.into_iter().chain(not_real.map(|e| Reason::NotReal(e.clone()))).collect()
}

/// What is against terms of order zero: a delayed linear one is named first, for such equations have a method.
fn not_weak<'a>(mut terms: impl Iterator<Item = &'a Expression> + Clone) -> Option<Reason> {
    let delayed = terms.clone().find(|term| is_delayed_linear(term));
    let delayed = delayed.map(|term| Reason::DelayedLinearPart(term.clone()));
    delayed.or_else(|| terms.next().map(|term| Reason::NotWeaklyNonlinear(term.clone())))
}

/// An unknown at an earlier time times a constant.
fn is_delayed_linear(e: &Expression) -> bool {
    match e {
        Expression::Product(factors) => {
            let mut varying = factors.iter().filter(|factor| !factor.is_constant());
            varying.next().is_some_and(Expression::is_delayed) && varying.next().is_none()
        }
        other => other.is_delayed(),
    }
}

/// What both expansions need: an oscillator at order zero, and functions that a ring contains.
fn weakly_nonlinear(
    parts: &Classification,
    rest: &Expression,
    stiffness: Option<&Rational>,
) -> Vec<Reason> {
    let mut against = Vec::new();
    if let Some(e) = rest.find(&is_not_real) {
        against.push(Reason::NotReal(e.clone()));
    } else if let Some(e) = parts.non_smooth.first() {
        against.push(Reason::NonSmooth(e.clone()));
    } else if let Some(e) = rest.find(&is_not_polynomial) {
        against.push(Reason::NotPolynomial(e.clone()));
    }
    let divisor = |e: &Expression| crate::smooth::small_divisor(e).is_some();
    if let Some(e) = rest.find(&divisor) {
        against.push(Reason::Divided(e.clone()));
    } else if parts.stiffness == Expression::integer(0) {
        against.push(Reason::NoLinearPart);
    }
    against.extend(not_weak(parts.strong.iter().map(|term| &term.term)));
    if stiffness.is_some_and(|kappa| kappa.cmp0() == Ordering::Less) {
        against.push(Reason::NegativeStiffness);
    }
    if rest.find(&|e| *e == Expression::Small).is_none() && against.is_empty() {
        let linear = parts.weak.is_empty() && parts.forcing.is_empty();
        if !linear {
            against.push(Reason::NoSmallParameter);
        }
    }
    against
}

fn lindstedt(
    problem: &Problem,
    rest: &Expression,
    stiffness: Option<&Rational>,
    parts: &Classification,
    weak: &[Reason],
) -> Vec<Reason> {
    let mut against = weak.to_vec();
    if let Some(forcing) = parts.forcing.first() {
        against.push(Reason::Forced(forcing.term.clone()));
    }
    if let Some(delay) = parts.delays.first() {
        against.push(Reason::Delay(delay.clone()));
    }
    if parts.impact {
        against.push(Reason::Impact);
    }
    let condition = problem.conditions.first();
    if condition.is_none() && !rest.contains(&Expression::Small) {
        against.push(Reason::NoSmallParameter);
    } else if matches!(condition, None | Some(Condition::FreeAmplitude)) {
        against.push(Reason::Condition);
    } else if against.is_empty() {
        // The only term that works on x' has nothing to cancel against. Terms odd in x' that do no work
        // can do some together with others, and make a limit cycle.
        let odd = |e: &Expression| parity(e, false) == Some(Parity::Odd);
        let works = |e: &Expression| odd(e) && parity_in_x(e) == Some(Parity::Even);
        // The work of a monomial has one sign.
        let several = |e: &Expression| matches!(e, Expression::Sum(_) | Expression::Function(..));
        let mut drift = parts.weak.iter().filter(|t| parity(&t.term, false) != Some(Parity::Even));
        if let (Some(only), None) = (drift.next(), drift.next())
            && works(&only.term)
            && only.term.find(&several).is_none()
        {
            against.push(Reason::Drift(only.term.clone()));
        }
    }
    let has_velocity = rest.contains(&Expression::VELOCITY);
    if has_velocity && against.is_empty() {
        match stiffness {
            None => against.push(Reason::UnknownFrequency),
            // What is zero is said to be that where it is divided by.
            Some(kappa) if !kappa.is_zero() && rational_root(kappa).is_none() => {
                against.push(Reason::IrrationalFrequency);
            }
            _ => {}
        }
    }
    against
}

/// An unknown or its acceleration times a constant.
fn is_coupling(e: &Expression) -> bool {
    match e {
        Expression::Unknown(unknown) => unknown.derivative != 1 && unknown.delay.is_none(),
        Expression::Product(factors) => {
            let mut varying = factors.iter().filter(|factor| !factor.is_constant());
            varying.next().is_some_and(is_coupling) && varying.next().is_none()
        }
        _ => false,
    }
}

fn averaging(
    problem: &Problem,
    rest: &Expression,
    parts: &Classification,
    (values, weak): (&BTreeMap<String, Rational>, &[Reason]),
) -> Vec<Reason> {
    let mut against = weak.to_vec();
    // A constant force of order zero moves the centre: the response to it is no expansion's first term, but
    // part of u_0. What couples several unknowns linearly belongs to their normal modes.
    let coupling = |e: &Expression| !problem.others.is_empty() && is_coupling(e);
    let strong = parts.strong.iter().map(|t| &t.term);
    let strong = strong.filter(|e| !e.is_constant() && !coupling(e));
    let strong = not_weak(strong);
    if strong != not_weak(parts.strong.iter().map(|term| &term.term)) {
        against.retain(|reason| {
            !matches!(reason, Reason::NotWeaklyNonlinear(_) | Reason::DelayedLinearPart(_))
        });
        against.extend(strong);
    }
    if !parts.non_smooth.is_empty() && problem.others.is_empty() && !parts.impact {
        // What jumps at turning points only is averaged between them.
        let at = against.iter().position(|reason| matches!(reason, Reason::NonSmooth(_)));
        if let Some(at) = at {
            against.splice(at..=at, rest.between_turning_points().err());
        }
    }
    for force in &parts.forcing {
        match (&force.frequency, force.resonance) {
            (None, _) => against.push(Reason::Forced(force.term.clone())),
            (Some(_), Some((1, 1))) if force.order == 0 => {
                against.push(Reason::Resonant(force.term.clone(), (1, 1)));
            }
            (Some(_), _) if force.order == 0 && force.parametric => {
                against.push(Reason::NotWeaklyNonlinear(force.term.clone()));
            }
            _ => {}
        }
    }
    // (k/m)^2, as of x'' + 2*x and cos(sqrt(2)*t).
    let has_ratio = |frequency: &Expression| {
        let stiffness = evaluate(&parts.stiffness, values).filter(|kappa| !kappa.is_zero())?;
        rational_root(&(rational_square(&frequency.with_values(values))? / stiffness))
    };
    let of_frequency = |force: &Forcing| {
        let frequency = force.frequency.as_ref()?;
        // The frequencies of coupled unknowns are not those of their rows: the derivation, which knows them, judges.
        let alone = problem.others.is_empty();
        if alone && frequency.find(&is_irrational).is_some() && has_ratio(frequency).is_none() {
            return Some(Reason::IrrationalRatio(force.term.clone()));
        }
        // 2 - omega_1 beside a force of omega_1 is a combination of independent frequencies.
        let names = frequency.parameters();
        let others = parts.forcing.iter().filter(|other| other.term != force.term);
        let mut others = others.filter_map(|other| other.frequency.as_ref());
        let combined =
            others.any(|other| other.parameters().iter().any(|name| names.contains(name)));
        let detuned = is_detuned(frequency) && !combined && evaluate(frequency, values).is_none();
        detuned.then(|| match frequency.find(&is_irrational) {
            Some(_) => Reason::IrrationalRatio(force.term.clone()),
            None => Reason::LargeDetuning(force.term.clone()),
        })
    };
    let angle = |force: &Forcing| angle(force, values);
    if let Some(reason) = parts.forcing.iter().find_map(of_frequency) {
        against.push(reason);
        return against;
    }
    // Forces are harmonics of one omega t.
    let first = parts.forcing.first().map(angle);
    let other = parts.forcing.iter().find(|force| {
        let own = angle(force);
        own.is_none() || first.as_ref() != Some(&own)
    });
    if let Some(force) = other.filter(|force| force.frequency.is_some()) {
        against.push(Reason::Frequency(force.term.clone()));
    }
    if let Some(e) = rest.find(&is_logarithmic) {
        against.push(Reason::NotPolynomial(e.clone()));
    }
    if !problem.conditions.contains(&Condition::FreeAmplitude) {
        against.push(Reason::Condition);
    }
    against
}

/// The factors of t, numbers apart, in the angle of a force; nothing for an angle with a phase.
fn angle(force: &Forcing, values: &BTreeMap<String, Rational>) -> Option<BTreeMap<String, i32>> {
    if force.frequency.as_ref().is_some_and(|f| is_detuned(f) && evaluate(f, values).is_some()) {
        return Some(BTreeMap::new());
    }
    let force = &force.term;
    let harmonic = |e: &Expression| {
        matches!(e, Expression::Function(Function::Sin | Function::Cos, z)
            if z.contains(&Expression::Time))
    };
    let Some(Expression::Function(_, z)) = force.find(&harmonic) else { return None };
    let all = expand(z)?;
    let mut leading = all.terms.keys().filter(|monomial| monomial.order == 0);
    let (Some(monomial), None) = (leading.next(), leading.next()) else { return None };
    Some(monomial.parameters.clone())
}

/// A root or a function of numbers.
fn is_irrational(e: &Expression) -> bool {
    let root = |n: &Expression| n.as_number().is_none_or(|n| !n.is_integer());
    matches!(e, Expression::Power(_, n) if root(n)) || matches!(e, Expression::Function(..))
}

/// A number and a parameter: 1 + sigma.
fn is_detuned(frequency: &Expression) -> bool {
    let Some(all) = expand(frequency) else { return false };
    all.terms.len() > 1 && all.terms.keys().any(|m| m.parameters.is_empty())
}

/// The equations of the energy integral: x (x^2)^small and x S(small ln x^2).
fn is_energy_form(rest: &Expression) -> bool {
    let x = || Expression::DISPLACEMENT;
    let square = || x().pow(2);
    let rest = rest.canonical();
    let power = x() * square().pow(Expression::Small);
    let formal = |name: &str| x() * (Expression::Small * square().ln()).formal(name);
    match rest.find(&|e| matches!(e, Expression::Formal(..))) {
        Some(Expression::Formal(name, _)) => rest == formal(name),
        _ => rest == power,
    }
}

/// ln, exp, formal functions, powers with the small parameter in the exponent.
pub(crate) fn is_logarithmic(e: &Expression) -> bool {
    match e {
        Expression::Function(Function::Ln | Function::Exp, z) => {
            !z.is_constant() && !z.contains(&Expression::Time)
        }
        Expression::Formal(..) => true,
        Expression::Power(base, exponent) => {
            !base.is_constant() && exponent.contains(&Expression::Small)
        }
        _ => false,
    }
}

/// A function of x or x' that is in neither ring.
pub(crate) fn is_not_polynomial(e: &Expression) -> bool {
    let varies = |z: &Expression| z.nodes().any(|e| matches!(e, Expression::Unknown(_)));
    let in_time = |z: &Expression| z.contains(&Expression::Time) && !varies(z);
    match e {
        Expression::Function(Function::Sin | Function::Cos, z) => !in_time(z),
        Expression::Function(Function::Abs | Function::Sign, _) => true,
        Expression::Function(Function::Exp, z) => !in_time(z) && !is_multiple_of_small(z),
        Expression::Function(Function::Ln, z) => !in_time(z) && !is_square_of_x(z),
        Expression::Power(base, exponent) if varies(base) || varies(exponent) => {
            let whole = exponent.as_number().is_some_and(|n| n.is_integer() && n >= 0);
            let vanishing = is_multiple_of_small(exponent) && is_square_of_x(base);
            !(whole || vanishing)
        }
        Expression::Power(_, exponent) if !in_time(e) => {
            !exponent.as_number().is_some_and(|n| n.is_integer())
        }
        _ => false,
    }
}

fn is_square_of_x(e: &Expression) -> bool {
    matches!(e, Expression::Power(base, n) if **base == Expression::DISPLACEMENT
        && n.as_number().is_some_and(|n| n > 0 && n.is_integer() && n.numer().is_even()))
}

/// Whether the small parameter is a factor of every term.
fn is_multiple_of_small(e: &Expression) -> bool {
    match e {
        Expression::Small => true,
        Expression::Sum(list) => list.iter().all(is_multiple_of_small),
        Expression::Product(list) => list.iter().any(is_multiple_of_small),
        _ => false,
    }
}

/// A real power or a logarithm of something that can be negative.
fn is_not_real(e: &Expression) -> bool {
    match e {
        Expression::Power(base, exponent) => {
            let whole = exponent.as_number().is_some_and(|n| n.is_integer());
            !whole && !is_non_negative(base)
        }
        Expression::Function(Function::Ln, z) => !is_non_negative(z),
        _ => false,
    }
}

/// Whether the form of an expression shows that it is never negative; parameters are taken to be
/// positive here.
fn is_non_negative(e: &Expression) -> bool {
    match e {
        Expression::Number(q) => q.cmp0() != Ordering::Less,
        Expression::Parameter(_) | Expression::Small => true,
        Expression::Function(Function::Abs | Function::Exp, _) => true,
        Expression::Sum(list) | Expression::Product(list) => list.iter().all(is_non_negative),
        Expression::Power(base, n) => {
            let even = n.as_number().is_some_and(|n| n.is_integer() && n.numer().is_even());
            even || is_non_negative(base)
        }
        _ => false,
    }
}
