//! x' = f or x'' = f with delays, as a series about x = 0: sum_t c_t(alpha) prod_f D^n_f x(t - T_f) = 0.

use crate::bound::{bind, missing, named};
use crate::refusal::{Refusal, Why};
use lindstedt_equation::monomials::{MOST_TERMS, Monomial, Monomials, expand};
use lindstedt_equation::near_rest::{NoSeries, near_rest};
use lindstedt_equation::{Expression, Problem, Unknown};
use lindstedt_hopf::{DelayEquation, Factor, Field, Term};
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use lindstedt_number::ball::ring::BallRing;
use rug::Rational;
use std::collections::BTreeMap;

/// Bits of the sum that decides whether the equation is satisfied at x = 0.
const UNDECIDED: u32 = 256;

/// The constants of an equation by powers of the parameter that is sought, and its delays.
type Delays = Vec<Vec<Expression>>;

/// The equation with the values of its parameters, the small one among them, but for the one that is sought, up to a
/// degree in x: of a motion of size eps all orders up to that degree are those of the equation as it is.
///
/// # Errors
/// [`Refusal`], naming the term that does not fit.
///
/// ```
/// use lindstedt_problem_file::ProblemFile;
/// let file = ProblemFile::parse("equation = \"x' + alpha*x(t - 1)*(1 + x) = 0\"")?;
/// let found = lindstedt_recognise::delay_equation(&file.problem, &Default::default(), "alpha", 2)?;
/// assert_eq!((found.order, found.delays.len(), found.terms.len()), (1, 2, 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn delay_equation(
    problem: &Problem,
    values: &BTreeMap<String, Exact>,
    unknown: &str,
    degree: u32,
) -> Result<DelayEquation<Expression>, Refusal> {
    if problem.impact.is_some() {
        return Err(Refusal::WallAtHopf);
    }
    let mut values = values.clone();
    values.remove(unknown);
    let small = problem.small.to_string();
    let named_small = |e: &Expression| match e {
        Expression::Small => Some(Expression::parameter(&small)),
        _ => None,
    };
    let whole = problem.equation.substitute(&named_small).canonical();
    let needed = whole.parameters();
    let needed = needed.into_iter().filter(|name| name != unknown && name != crate::bound::PI);
    missing(&needed.collect::<Vec<_>>(), &values)?;
    let all = series(&whole, &values, degree)?;
    let order = if whole.is_first_order() { 1 } else { 2 };
    let zero = vec![Expression::integer(0)];
    let mut found = DelayEquation { order, delays: vec![zero], terms: Vec::new() };
    // That x = 0 is no equilibrium is said where nothing else is wrong.
    let (still, moving): (Vec<_>, Vec<_>) = all.terms.iter().partition(|(m, _)| m.atoms.is_empty());
    let undecided = may_vanish(&all, &still, unknown);
    for (m, q) in moving.into_iter().chain(still) {
        let (factors, power) = read(&all, m, unknown, &mut found.delays).map_err(|why| {
            let why = if why == Why::NotAtRest && undecided { Why::RestUndecided } else { why };
            let fits = |all: &Monomials, m: &Monomial| {
                read(all, m, unknown, &mut Vec::new()).err().filter(|own| *own == why)
            };
            named(&whole, &values, (all.tree(m, q), why), &fits)
        })?;
        let coefficient = coefficient(&all, m, q, unknown);
        let known = found.terms.iter().position(|term| term.factors == factors);
        let place = known.unwrap_or_else(|| {
            found.terms.push(Term { coefficient: Vec::new(), factors });
            found.terms.len() - 1
        });
        let list = &mut found.terms[place].coefficient;
        list.resize(list.len().max(power + 1), Expression::integer(0));
        list[power] = (list[power].clone() + coefficient).canonical();
    }
    Ok(found)
}

/// The terms up to a degree; refused is the first term, as it is written, that has none.
fn series(
    whole: &Expression,
    values: &BTreeMap<String, Exact>,
    degree: u32,
) -> Result<Monomials, Refusal> {
    let of = |e: &Expression| near_rest(&bind(e, values), degree);
    of(whole).map_err(|fault| {
        let why = match fault {
            NoSeries::TooLong => return Refusal::TooManyTerms { limit: MOST_TERMS },
            NoSeries::Time => Why::DependsOnTime,
            NoSeries::Singular(_) => Why::SingularAtRest,
            NoSeries::NotAnalytic(_) => Why::NotAnalyticAtRest,
            NoSeries::UnknownSign(_) => Why::UnknownSignAtRest,
        };
        let kind = std::mem::discriminant(&fault);
        let own = |term: &&Expression| of(term).is_err_and(|e| std::mem::discriminant(&e) == kind);
        let term = whole.terms().iter().find(own).unwrap_or(whole);
        Refusal::Term { term: Box::new(term.clone()), why }
    })
}

/// Whether what is left at x = 0 is not told from zero, for all values of the parameter that is sought.
fn may_vanish(all: &Monomials, still: &[(&Monomial, &Rational)], unknown: &str) -> bool {
    let ring = BallRing { balls: Balls::new(UNDECIDED) };
    let mut sums: BTreeMap<usize, Vec<Expression>> = BTreeMap::new();
    for (m, q) in still {
        let Ok(power) = power_of(all, m, unknown) else { return false };
        sums.entry(power).or_default().push(coefficient(all, m, q, unknown));
    }
    let vanishes = |e: Vec<Expression>| {
        ring.constant(&Expression::Sum(e))
            .is_some_and(|ball| !ball.0.is_positive() && !ball.0.is_negative())
    };
    sums.into_values().all(vanishes)
}

/// The factors of a term and the power of the parameter that is sought.
fn read(
    all: &Monomials,
    m: &Monomial,
    unknown: &str,
    delays: &mut Delays,
) -> Result<(Vec<Factor>, usize), Why> {
    let plain =
        |derivative, n: u32| std::iter::repeat_n(Factor { derivative, delay: 0 }, n as usize);
    let mut factors: Vec<Factor> = plain(0, m.x).chain(plain(1, m.velocity)).collect();
    for (key, n) in &m.atoms {
        let factor = match all.atoms.get(key) {
            Some(Expression::Unknown(Unknown { index: 0, derivative, delay })) => {
                let delay = delay.as_deref().map(|by| place(by, unknown, delays));
                Factor { derivative: *derivative, delay: delay.transpose()?.unwrap_or(0) }
            }
            _ => return Err(Why::NotAnalyticAtRest),
        };
        factors.extend(std::iter::repeat_n(factor, *n as usize));
    }
    factors.sort_unstable();
    if factors.is_empty() {
        return Err(Why::NotAtRest);
    }
    Ok((factors, power_of(all, m, unknown)?))
}

/// The power of the parameter that is sought in a term.
fn power_of(all: &Monomials, m: &Monomial, unknown: &str) -> Result<usize, Why> {
    let inside = m.parameters.keys().filter(|name| *name != unknown);
    let mut inside = inside.filter_map(|name| all.atoms.get(name));
    let holds = |e: &Expression| e.contains(&Expression::parameter(unknown));
    if inside.any(holds) {
        return Err(Why::UnknownInside);
    }
    let power = m.parameters.get(unknown).copied().unwrap_or(0);
    usize::try_from(power).map_err(|_| Why::UnknownInside)
}

/// The factor of a term that is a number.
fn coefficient(all: &Monomials, m: &Monomial, q: &Rational, unknown: &str) -> Expression {
    let mut parameters = m.parameters.clone();
    parameters.remove(unknown);
    all.tree(&Monomial { parameters, ..Monomial::default() }, q)
}

/// The place of a delay in the list, to which it is added if it is new.
fn place(by: &Expression, unknown: &str, delays: &mut Delays) -> Result<usize, Why> {
    let all = expand(by).ok_or(Why::BadDelay)?;
    let mut powers: Vec<Expression> = Vec::new();
    for (m, q) in &all.terms {
        let bare = Monomial { parameters: m.parameters.clone(), ..Monomial::default() };
        if bare != *m {
            return Err(Why::BadDelay);
        }
        let power = power_of(&all, m, unknown)?;
        powers.resize(powers.len().max(power + 1), Expression::integer(0));
        powers[power] = (powers[power].clone() + coefficient(&all, m, q, unknown)).canonical();
    }
    // A delay without the parameter must be positive; with it the search looks.
    let number = |e: &Expression| e.as_number().is_some_and(|q| q <= 0);
    if powers.is_empty() || powers.len() == 1 && number(&powers[0]) {
        return Err(Why::BadDelay);
    }
    if let Some(known) = delays.iter().position(|known| *known == powers) {
        return Ok(known);
    }
    delays.push(powers);
    Ok(delays.len() - 1)
}
