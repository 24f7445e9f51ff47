//! The residual at one phase: what is left of omega^2 d^2x/dpsi^2 + F when x, dx/dpsi and d^2x/dpsi^2 are numbers.
//!
//! A trigonometric polynomial of degree d has at most 2d zeros in z = e^(i psi), so one that is not zero survives at a
//! random z of a field of p numbers but for a chance of 2d/p. Series of numbers are multiplied, where the whole
//! residual multiplies series of functions.

use crate::compile::{Equation, Node};
use lindstedt_algebra::{PhaseAlgebra, RationalAlgebra, Ring};
use lindstedt_series::Series;

type Constant<A> = <<A as lindstedt_algebra::FunctionAlgebra>::Constants as Ring>::Element;

/// A solution at one phase, order by order.
pub struct AtPhase<C> {
    /// x_n, dx_n/dpsi and d^2x_n/dpsi^2 there.
    pub functions: [Vec<C>; 3],
    /// W_n.
    pub squared: Vec<C>,
    /// omega_n/sqrt(kappa).
    pub frequency: Vec<C>,
    /// kappa.
    pub stiffness: C,
}

/// The first order at which the residual of a polynomial equation does not vanish at a phase, nothing where all do;
/// an equation that is not polynomial fails at order 0.
///
/// Cost: N^2 products of numbers per node.
pub fn fails_at_phase<A: PhaseAlgebra>(
    constants: &A::Constants,
    equation: &Equation<A>,
    at: AtPhase<Constant<A>>,
) -> Option<usize> {
    let AtPhase { functions, squared, frequency, stiffness } = at;
    let Some(order) = squared.len().checked_sub(1) else { return Some(0) };
    let [x, slope, bend] = functions.map(Series::truncated);
    let times = |a: &Series<_>, b: &Series<_>| a.mul(constants, b, order);
    let velocity = times(&Series::truncated(frequency), &slope);
    let mut values: Vec<Series<Constant<A>>> = Vec::new();
    for node in &equation.nodes {
        let value = match node {
            Node::Constant(c) => Series::polynomial(vec![c.clone()]),
            Node::Small => Series::polynomial(vec![constants.zero(), constants.one()]),
            Node::Displacement => x.clone(),
            Node::Velocity => velocity.clone(),
            Node::Sum(terms) => terms.iter().fold(Series::polynomial(Vec::new()), |sum, (q, t)| {
                sum.add(constants, &values[*t].map(|c| constants.scale(c, q)))
            }),
            &Node::Product(a, b) => times(&values[a], &values[b]),
            _ => return Some(0),
        };
        values.push(value);
    }
    let inertia = times(&Series::truncated(squared), &bend);
    let Some(force) = values.get(equation.root()) else { return Some(0) };
    let residual = inertia.map(|c| constants.mul(c, &stiffness)).add(constants, force);
    (0..=order).find(|&n| residual.coefficients.get(n).is_none_or(|c| !constants.is_zero(c)))
}
