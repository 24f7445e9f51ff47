//! The route by one shift of a clock: the still part derived and checked, the parts of all functions from it and
//! judged, and what is printed from these (`docs/src/concepts/clock.md`).

mod frequency;
mod functions;
mod point;

use crate::binding::{FORMAL, Given};
use crate::derivation::Solution;
use crate::error::DerivationError as Error;
use crate::found::Found;
use crate::series::closes;
use crate::settings::Settings;
use crate::work::Progress;
use frequency::Clockwork;
use functions::Lift;
use lindstedt_algebra::{RationalAlgebra, Rationals};
use lindstedt_coeff::packed::{PackedPolynomial, PackedSums};
use lindstedt_coeff::{Polynomial, PolynomialRing};
use lindstedt_equation::{Condition, Expression, Problem};
use lindstedt_expand::{
    Binding, ClockExpansion, ExpandError, Expansion, OrderWork, Request, check_clock,
    clock_variable, compile, expand_clock,
};
use lindstedt_phase::Lobachevsky;
use lindstedt_phase::lobachevsky::Unfolding;
use point::Point;
use rug::Rational;
use std::sync::Arc;

pub use functions::ClockSolution;

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
        let own = ring.clone();
        let lift: Lift<Rational> = Arc::new(move |q| own.rational(q));
        return over(&Rationals, given, lift, question, observer);
    }
    // F^(j) has weight n + j at order n, and j goes to the order + 2.
    match PackedSums::new(order + 2, 2 * order + 8) {
        Some(packed) => {
            let own = packed.clone();
            let lift: Lift<PackedPolynomial> = Arc::new(move |c| own.unpack(c));
            over(&packed, &Packing(&packed, given), lift, question, observer)
        }
        None => over(ring, given, Arc::new(Polynomial::clone), question, observer),
    }
}

/// The same over the constants that the equation needs.
fn over<C: RationalAlgebra + Clone + Send + Sync + 'static>(
    constants: &C,
    binding: &dyn Binding<C>,
    lift: Lift<C::Element>,
    (problem, ring, condition, settings): (&Problem, &PolynomialRing, Condition, &Settings),
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Option<Found>, Error> {
    let stop = &settings.stop;
    let algebra = Lobachevsky::formal(constants.clone()).with_stop(stop.clone());
    let leading_amplitude = Rational::from(1);
    let request = Request { condition, order: settings.order, leading_amplitude };
    let mut on_order = |work: &OrderWork| observer(Progress::Order(work.order, work.terms));
    let compiled = compile(&algebra, &problem.equation, binding, settings.order);
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
    let interrupted = || ExpandError::Interrupted { order: still.order() };
    let rational = |list: &Vec<C::Element>| -> Option<Vec<Rational>> {
        list.iter().map(|c| constants.as_rational(c)).collect()
    };
    let rational: Option<Vec<_>> = numbers.iter().map(rational).collect();
    let variable = rational.and_then(|numbers| clock_variable(&numbers));
    let variable = variable.filter(|v| v.get(1).is_some_and(|leading| !leading.is_zero()));
    let p = &still.solution;
    let parts = Unfolding::new(constants, numbers, variable.as_deref(), p, stop);
    let parts = parts.ok_or_else(interrupted)?;
    let clockwork = Clockwork {
        constants,
        ring,
        lift: &lift,
        numbers,
        pace: &still.frequency_squared,
        variable: variable.as_deref(),
        parts: &parts,
        stop,
    };
    let (squared, powers) = clockwork.frequency(closes(problem))?;
    let point = Point::new();
    let counted = parts.terms(constants, point.ring(), &|c| point.image(&lift(c)), stop);
    if stop.asked() {
        return Err(interrupted().into());
    }
    observer(Progress::Checking);
    let checked_orders =
        proved(check_clock(&algebra, &equation, &found), || parts.judge(&algebra, numbers, p))?;
    let head: Expansion<Lobachevsky<PolynomialRing>> = Expansion {
        condition,
        stiffness: lift(&still.stiffness),
        frequency_squared: squared,
        amplitude: still.amplitude.iter().map(|c| lift(c)).collect(),
        solution: Vec::new(),
        work: still.work.clone(),
        certificates: Vec::new(),
    };
    let (amplitudes, stiffness) = (head.amplitude.clone(), head.stiffness.clone());
    let seen = (&still.frequency_squared[..], &numbers[..]);
    let solution =
        ClockSolution::new(parts, constants.clone(), lift.clone(), seen, (head, counted), stop);
    let solution = Solution::Clock(Box::new(solution.ok_or_else(interrupted)?));
    Ok(Some(Found { powers, amplitudes, stiffness, solution, checked_orders }))
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
