//! The route by one shift of a clock: the still part derived and checked, all functions from it, and theirs
//! checked against it (`docs/src/concepts/clock.md`).

use crate::binding::{FORMAL, Given};
use crate::derivation::Solution;
use crate::error::DerivationError as Error;
use crate::found::Found;
use crate::series::{Powers, closes};
use crate::settings::Settings;
use crate::work::Progress;
use lindstedt_algebra::{RationalAlgebra, Rationals, Ring, Stop, Stopping};
use lindstedt_coeff::closed_forms::ClosedForms;
use lindstedt_coeff::packed::{PackedPolynomial, PackedSums};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_equation::{Condition, Expression, Problem};
use lindstedt_expand::{
    Binding, ClockExpansion, ClockMean, ExpandError, Expansion, OrderWork, Request, check_clock,
    clock_variable, compile, expand_clock,
};
use lindstedt_phase::Lobachevsky;
use lindstedt_phase::lobachevsky::{Clock, Formal};
use rug::Rational;

/// The values of names, as constants without moments.
struct Unmeasured<'a, C: Ring>(&'a dyn Binding<C>);

impl<C: Ring> Binding<Formal<C>> for Unmeasured<'_, C> {
    fn parameter(&self, name: &str) -> Option<C::Element> {
        self.0.parameter(name)
    }
    fn formal(&self, name: &str, n: usize) -> Option<C::Element> {
        self.0.formal(name, n)
    }
}

/// The values of names, with the sums S_n packed.
struct Packing<'a>(&'a PackedSums, &'a Given<'a>);

impl Binding<PackedSums> for Packing<'_> {
    fn parameter(&self, name: &str) -> Option<PackedPolynomial> {
        Some(self.0.rational(&Binding::<Rationals>::parameter(self.1, name)?))
    }
    fn formal(&self, name: &str, n: usize) -> Option<PackedPolynomial> {
        (name == FORMAL).then(|| self.0.sum(n)).flatten()
    }
}

/// The expansion by the clock, over the constants that the equation needs; nothing where the solution is not found as
/// one function of a clock.
pub(crate) fn derive(
    problem: &Problem,
    given: &Given<'_>,
    condition: Condition,
    settings: &Settings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Option<Found>, Error> {
    let (ring, order) = (given.ring, settings.order);
    let question = (problem, ring, condition, settings);
    if !problem.equation.nodes().any(|e| matches!(e, Expression::Formal(..))) {
        let lift = |q: &Rational| ring.rational(q);
        let between: Between<'_, _> = (&lift, &|c| ring.as_rational(c));
        return over(&Rationals, given, between, question, observer);
    }
    // F^(j) has weight n + j at order n, and j goes to the order + 2.
    match PackedSums::new(order + 2, 2 * order + 8) {
        Some(packed) => {
            let between: Between<'_, _> = (&|c| packed.unpack(c), &|c| packed.pack(c));
            over(&packed, &Packing(&packed, given), between, question, observer)
        }
        None => {
            let between: Between<'_, _> = (&Polynomial::clone, &|c| Some(c.clone()));
            over(ring, given, between, question, observer)
        }
    }
}

/// A constant as one of the target, and back where that is possible.
type Between<'a, E> =
    (&'a (dyn Fn(&E) -> Polynomial + Sync), &'a (dyn Fn(&Polynomial) -> Option<E> + Sync));

/// The same over the constants that the equation needs.
fn over<C: RationalAlgebra + Clone>(
    constants: &C,
    binding: &dyn Binding<C>,
    (lift, restrict): Between<'_, C::Element>,
    (problem, ring, condition, settings): (&Problem, &PolynomialRing, Condition, &Settings),
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Option<Found>, Error> {
    let stop = &settings.stop;
    let algebra = Lobachevsky::new(Formal(constants.clone())).with_stop(stop.clone());
    let leading_amplitude = Rational::from(1);
    let request = Request { condition, order: settings.order, leading_amplitude };
    let mut on_order = |work: &OrderWork| observer(Progress::Order(work.order, work.terms));
    let compiled = compile(&algebra, &problem.equation, &Unmeasured(binding), settings.order);
    let found = compiled.and_then(|equation| {
        let found = expand_clock(&algebra, &equation, &request, &mut on_order)?;
        Ok((equation, found))
    });
    let (equation, found) = match found {
        Ok(both) => both,
        Err(error @ ExpandError::Interrupted { .. }) => return Err(error.into()),
        // The driver says what it is, or finds another form.
        Err(_) => return Ok(None),
    };
    let ClockExpansion { still, numbers } = &found;
    let clock = Clock { constants, target: ring, lift, restrict, numbers, stop: stop.clone() };
    let interrupted = || ExpandError::Interrupted { order: still.order() };
    let solution = clock.unfold(&still.solution).ok_or_else(interrupted)?;
    let (squared, powers) = frequency(&clock, ring, &still.frequency_squared, closes(problem))?;
    observer(Progress::Checking);
    let checked_orders = proved(check_clock(&algebra, &equation, &found), || {
        clock.check(&still.solution, &solution)
    })?;
    let terms = still.work.iter().zip(&solution[1..]);
    let work = terms.map(|(work, x)| OrderWork { terms: x.len(), ..*work }).collect();
    let expansion: Expansion<Lobachevsky<PolynomialRing>> = Expansion {
        condition,
        stiffness: lift(&still.stiffness),
        frequency_squared: squared,
        amplitude: still.amplitude.iter().map(lift).collect(),
        solution,
        work,
        certificates: Vec::new(),
    };
    Ok(Some(Found {
        powers,
        amplitudes: expansion.amplitude.clone(),
        stiffness: expansion.stiffness.clone(),
        solution: Solution::Lobachevsky(Box::new(expansion)),
        checked_orders,
    }))
}

/// W, and the powers of the frequency, in closed form if that is printed.
fn frequency<C: RationalAlgebra>(
    clock: &Clock<'_, C, PolynomialRing>,
    ring: &PolynomialRing,
    pace: &[C::Element],
    closes: bool,
) -> Result<(Vec<Polynomial>, Powers), Error> {
    let as_rational = |list: &Vec<C::Element>| -> Option<Vec<Rational>> {
        list.iter().map(|c| clock.constants.as_rational(c)).collect()
    };
    let rational: Option<Vec<_>> = clock.numbers.iter().map(as_rational).collect();
    let variable = rational.and_then(|numbers| clock_variable(&numbers));
    let mean = match variable {
        Some(_) => moments(ring, pace.len() - 1),
        None => clock.mean_pace(),
    };
    let pace: Vec<Polynomial> = pace.iter().map(clock.lift).collect();
    let whole = Stopping(ring, &clock.stop);
    // A judge that had to do without products says nothing.
    let interrupted = || ExpandError::Interrupted { order: pace.len() - 1 };
    let mean = ClockMean::new(&whole, mean);
    let mean = if clock.stop.asked() { Err(interrupted()) } else { mean }?;
    let frequency = |mean: &ClockMean<Polynomial>| {
        let found = mean.frequency(&whole, &pace, variable.as_deref());
        if clock.stop.asked() { Err(interrupted()) } else { found }
    };
    let found = frequency(&mean)?;
    if !closes {
        let squared = found.squared.clone();
        return Ok((squared, Powers::new(found.squared, found.first, found.period, false)));
    }
    let closed = closed(ring, &mean, &clock.stop)?;
    let closed = frequency(&closed)?;
    Ok((found.squared, Powers::new(closed.squared, closed.first, closed.period, true)))
}

/// The last order that both judges confirm; nothing where one was stopped.
fn proved(
    still: Result<usize, ExpandError>,
    functions: impl FnOnce() -> Option<Result<(), usize>>,
) -> Result<Option<usize>, ExpandError> {
    let order = match still {
        Err(ExpandError::Interrupted { .. }) => return Ok(None),
        other => other?,
    };
    match functions() {
        None => Ok(None),
        Some(Ok(())) => Ok(Some(order)),
        Some(Err(order)) => Err(ExpandError::Residual { order }),
    }
}

/// 1, mu_1, mu_2, ...
fn moments(ring: &PolynomialRing, order: usize) -> Vec<Polynomial> {
    let symbols = (0u16..).map(|m| match m {
        0 => ring.one(),
        m => ring.symbol(Symbol::Moment(m)),
    });
    symbols.take(order + 1).collect()
}

/// With the mu_m in closed form.
fn closed(
    ring: &PolynomialRing,
    mean: &ClockMean<Polynomial>,
    stop: &Stop,
) -> Result<ClockMean<Polynomial>, Error> {
    let order = u16::try_from(mean.order()).map_err(|_| Error::NoValue)?;
    let forms = ClosedForms::new(order);
    let form = |p: &Polynomial| if stop.asked() { None } else { forms.closed_form(ring, p) };
    let interrupted = ExpandError::Interrupted { order: mean.order() };
    mean.map(form).ok_or_else(|| if stop.asked() { interrupted.into() } else { Error::NoValue })
}
