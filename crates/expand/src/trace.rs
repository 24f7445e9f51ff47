//! The frequency with all that is formed on the way to it, and a judge of that which forms no product of series anew.
//!
//! A product of series, c_n = sum_k a_k b_(n-k), is held against its factors at a number e in the place of eps: with
//! B_m = sum_(l<=m) b_l e^l
//!
//!   sum_(n<=N) c_n e^n = sum_k a_k e^k B_(N-k),
//!
//! N products of functions instead of N^2/2. Both sides are polynomials in e of degree N: where they differ, they agree
//! for at most N of the p numbers of a field.

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::driver::{Driver, Request, run};
use crate::expansion::OrderWork;
use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, Ring};
use lindstedt_equation::Condition;

type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

/// An expansion and the nodes of its equation.
#[derive(Clone, Debug)]
pub struct Trace<A: PhaseAlgebra> {
    /// x_n; that of the last order of a limit cycle without its amplitude.
    pub solution: Vec<A::Element>,
    /// W_n.
    pub squared: Vec<Constant<A>>,
    /// omega_n/sqrt(kappa).
    pub frequency: Vec<Constant<A>>,
    /// The coefficients of every node of the equation, as many as enter the order of the expansion.
    pub nodes: Vec<Vec<A::Element>>,
}

/// Derives the frequency of a polynomial equation.
///
/// A limit cycle starts at the phase at which x has no first harmonic in sin psi: its frequency is that of any other
/// phase. So nothing but the initial amplitude asks for all harmonics of an order at once.
///
/// # Errors
/// Those of [`crate::expand`]; [`ExpandError::Interrupted`] where the observer says so.
pub fn trace<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    request: &Request,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<Trace<A>, ExpandError> {
    let mut driver = Driver::start(algebra, equation, request)?;
    driver.by_first_harmonic = request.condition != Condition::InitialAmplitude;
    let order = request.order;
    if run(&mut driver, 1..=order, observer)?.len() < order {
        return Err(ExpandError::Interrupted { order });
    }
    let mut nodes = Vec::new();
    for (node, length) in needed(equation, order).into_iter().enumerate() {
        let coefficients = (0..length).map(|n| driver.evaluator.coefficient(node, n));
        nodes.push(coefficients.collect::<Result<Vec<_>, _>>()?);
    }
    Ok(Trace {
        solution: driver.x,
        squared: driver.frequency_squared,
        frequency: driver.frequency,
        nodes,
    })
}

/// How many coefficients of every node enter those of the root up to an order.
fn needed<A: FunctionAlgebra>(equation: &Equation<A>, order: usize) -> Vec<usize> {
    let nodes = &equation.nodes;
    let mut needed = vec![0; nodes.len()];
    needed[equation.root()] = order + 1;
    for (id, node) in nodes.iter().enumerate().rev() {
        let own = needed[id];
        let mut ask = |operand: usize, length: usize| needed[operand] = length.max(needed[operand]);
        match node {
            Node::Sum(terms) => terms.iter().for_each(|(_, term)| ask(*term, own)),
            &Node::Product(a, b) => {
                let factor =
                    |other: usize| own - usize::from(own > 0 && nodes[other] == Node::Small);
                ask(a, factor(b));
                ask(b, factor(a));
            }
            _ => {}
        }
    }
    needed
}

impl<A: PhaseAlgebra> Trace<A> {
    /// F_n of the equation, as far as the expansion goes.
    pub fn force(&self, equation: &Equation<A>) -> &[A::Element] {
        self.nodes.get(equation.root()).map_or(&[], Vec::as_slice)
    }

    /// Whether x_0 is a_0 cos psi and every other x_n is what the condition asks for.
    pub fn is_normalised(&self, algebra: &A, request: &Request) -> bool {
        let constants = algebra.constants();
        let vanishes = |c: Option<Constant<A>>| c.is_some_and(|c| constants.is_zero(&c));
        let Some((first, rest)) = self.solution.split_first() else { return false };
        let leading = algebra.scale(&algebra.cosine(), &request.leading_amplitude);
        let holds = |x: &A::Element| {
            let (cos, sin) = algebra.first_harmonic(x).ok().unzip();
            match request.condition {
                Condition::InitialAmplitude => {
                    vanishes(algebra.at_zero(x))
                        && vanishes(algebra.at_zero(&algebra.derivative(x)))
                }
                Condition::LimitCycle => vanishes(sin),
                Condition::FundamentalAmplitude | Condition::FreeAmplitude => {
                    vanishes(cos) && vanishes(sin)
                }
            }
        };
        *first == leading && rest.iter().all(holds)
    }

    /// Whether every node of a polynomial equation is what its operands make of it, with numbers e, whose powers are
    /// given, in the place of eps.
    ///
    /// Cost: N products of functions for every number and product of series.
    pub fn nodes_hold_at(
        &self,
        algebra: &A,
        equation: &Equation<A>,
        powers: &[Vec<Constant<A>>],
    ) -> bool {
        let nodes = self.nodes.iter().zip(&equation.nodes);
        nodes.filter(|(list, _)| !list.is_empty()).all(|(list, node)| {
            let expected = self.expected(algebra, equation, (node, list.len()), powers);
            expected.is_some_and(|expected| sums(algebra, list, powers) == expected)
        })
    }

    /// What a node is at every e, from `length` coefficients of its operands; nothing where they are not there.
    fn expected(
        &self,
        algebra: &A,
        equation: &Equation<A>,
        (node, length): (&Node<Constant<A>>, usize),
        powers: &[Vec<Constant<A>>],
    ) -> Option<Vec<A::Element>> {
        let constants = algebra.constants();
        let of = |id: usize, length: usize| self.nodes[id].get(..length);
        let once_more = |id: usize| {
            let powers: Vec<_> = powers.iter().map(|powers| powers[1..].to_vec()).collect();
            Some(sums(algebra, of(id, length - 1)?, &powers))
        };
        let solution = || self.solution.get(..length);
        Some(match node {
            Node::Constant(c) => vec![algebra.embed(c); powers.len()],
            Node::Small => {
                let power = |powers: &Vec<_>| powers.get(1).filter(|_| length > 1).cloned();
                let small = |powers| power(powers).map_or(algebra.zero(), |e| algebra.embed(&e));
                powers.iter().map(small).collect()
            }
            Node::Displacement => sums(algebra, solution()?, powers),
            // sum_l x_l' e^l Omega_(N-l), Omega_m = sum_(j<=m) omega_j e^j.
            Node::Velocity => {
                let frequency = self.frequency.get(..length)?;
                let factors = |powers: &Vec<_>| {
                    let partial = partial_sums(constants, frequency, powers);
                    powers
                        .iter()
                        .zip(partial.iter().rev())
                        .map(|(a, b)| constants.mul(a, b))
                        .collect()
                };
                let factors: Vec<Vec<_>> = powers.iter().map(factors).collect();
                let sums = sums(algebra, solution()?, &factors);
                sums.iter().map(|sum| algebra.derivative(sum)).collect()
            }
            Node::Sum(terms) => {
                let mut totals = vec![algebra.zero(); powers.len()];
                for (q, term) in terms {
                    for (total, value) in
                        totals.iter_mut().zip(sums(algebra, of(*term, length)?, powers))
                    {
                        algebra.add_assign(total, &algebra.scale(&value, q));
                    }
                }
                totals
            }
            &Node::Product(a, b) if equation.nodes[a] == Node::Small => once_more(b)?,
            &Node::Product(a, b) if equation.nodes[b] == Node::Small => once_more(a)?,
            &Node::Product(a, b) => products(algebra, [of(a, length)?, of(b, length)?], powers),
            _ => return None,
        })
    }
}

/// sum_n f_n c_n for some series c.
fn sums<A: FunctionAlgebra>(
    algebra: &A,
    f: &[A::Element],
    c: &[Vec<Constant<A>>],
) -> Vec<A::Element> {
    let lists: Vec<Vec<_>> = c.iter().map(|c| f.iter().zip(c).collect()).collect();
    algebra.linear_combinations(&lists)
}

/// sum_(l<=m) c_l e^l for every m.
pub fn partial_sums<C: Ring>(
    constants: &C,
    c: &[C::Element],
    powers: &[C::Element],
) -> Vec<C::Element> {
    let mut total = constants.zero();
    let next = |(c, power)| {
        constants.add_assign(&mut total, &constants.mul(c, power));
        total.clone()
    };
    c.iter().zip(powers).map(next).collect()
}

/// The truncated product of two series at every e: (...(a_N B_0 e + a_(N-1) B_1) e + ...) + a_0 B_N.
fn products<A: FunctionAlgebra>(
    algebra: &A,
    [a, b]: [&[A::Element]; 2],
    powers: &[Vec<Constant<A>>],
) -> Vec<A::Element> {
    let one = algebra.constants().one();
    let mut partial = vec![algebra.zero(); powers.len()];
    let mut totals = partial.clone();
    for (n, (a, b)) in a.iter().rev().zip(b).enumerate() {
        for ((partial, total), powers) in partial.iter_mut().zip(&mut totals).zip(powers) {
            *partial = algebra.linear_combination(&[(&*partial, &one), (b, &powers[n])]);
            let product = algebra.mul(a, partial);
            let e = powers.get(1).unwrap_or(&one);
            *total = algebra.linear_combination(&[(&*total, e), (&product, &one)]);
        }
    }
    totals
}
