//! The judge of a still part and its clock.
//!
//! What must vanish, order by order and identically, is kappa nu D^2 p + F(p) with D = (1/g) d/dpsi, multiplied by
//! g^3 so that nothing is divided:
//!
//!   kappa nu (p'' g - p' g') + g^3 F(p) = 0.
//!
//! Together with p_0 = cos, p_n(0) = p_n'(0) = 0 this determines P (`clock/mod.rs`). Series are multiplied in full,
//! logarithms and exponentials are recognised by their differential equations, as in [`crate::check`]; on still
//! functions the derivation of the algebra is d/dpsi with the Lambda_m held fixed.

use super::ClockExpansion;
use crate::ExpandError;
use crate::compile::Equation;
use crate::residual::{Judge, check_normalisation};
use lindstedt_algebra::{ClockAlgebra, Ring};
use lindstedt_series::Series;

/// Substitutes the still part into its equation; every order must vanish identically, the normalisation must hold,
/// and every function must be still. Returns the number of the highest order checked.
///
/// # Errors
/// [`ExpandError::Residual`] or [`ExpandError::Normalisation`] with the first order that fails;
/// [`ExpandError::NotOneClock`] where a function is not still; [`ExpandError::Interrupted`] where the algebra was
/// interrupted and nothing is known.
pub fn check_clock<A: ClockAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    clock: &ClockExpansion<A>,
) -> Result<usize, ExpandError> {
    let result = substitute(algebra, equation, clock);
    if algebra.interrupted() {
        return Err(ExpandError::Interrupted { order: clock.order() });
    }
    result
}

fn substitute<A: ClockAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    clock: &ClockExpansion<A>,
) -> Result<usize, ExpandError> {
    let (constants, expansion) = (algebra.constants(), &clock.still);
    let order = clock.order();
    check_normalisation(algebra, expansion)?;
    let is_still = |f: &A::Element| algebra.split_clock(f).is_some_and(|(_, c)| c.is_empty());
    let functions = expansion.solution.iter().chain(expansion.certificates.iter().flatten());
    // The clock of order zero is the phase itself.
    if equation.has_velocity()
        || !functions.into_iter().all(is_still)
        || clock.numbers.first().is_none_or(|numbers| !numbers.is_empty())
        || expansion.amplitude.first() != Some(&constants.one())
    {
        return Err(ExpandError::NotOneClock { order: 0 });
    }
    let judge = Judge::new(algebra, equation, expansion, order);
    let values = judge.values();
    judge.transcendental_nodes(&values)?;
    let mut pace: Vec<A::Element> = clock.numbers.iter().map(|c| algebra.pace(c)).collect();
    if let Some(first) = pace.first_mut() {
        *first = algebra.one();
    }
    let g = Series::truncated(pace);
    let slope = |s: &Series<A::Element>| s.map(|f| algebra.derivative(f));
    let product = |a: &Series<A::Element>, b: &Series<A::Element>| a.mul(algebra, b, order);
    let p1 = slope(&judge.solution);
    let minus = product(&p1, &slope(&g)).map(|f| algebra.neg(f));
    let acceleration = product(&slope(&p1), &g).add(algebra, &minus);
    let inertia = judge.over_frequency(
        &judge.squared.map(|nu| constants.mul(nu, &expansion.stiffness)),
        &acceleration,
        0,
    );
    let cube = product(&product(&g, &g), &g);
    let residual = inertia.add(algebra, &product(&cube, &values[equation.root()]));
    judge.must_vanish(&residual, order + 1)?;
    Ok(order)
}
