//! Whether equations derive from a potential: weights mu_j > 0 and V with mu_j f_j = dV/dx_j for x_j'' + f_j(x) = 0.
//!
//! A term c x^a of f_i that contains x_j is the derivative of one of V by x_i, so that f_j has
//! c' x^a x_i/x_j with mu_i c/(a_i + 1) = mu_j c'/a_j: that fixes the weights one after the other. By Euler V is the sum of
//! mu_j x_j c x^a/(|a| + 1); its derivatives are then compared with the f_j, term by term.

use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Unknown};
use rug::Rational;
use std::collections::BTreeMap;

/// The weights and V; nothing where there is none, or velocities, forces or other functions than polynomials occur.
pub(super) fn potential(equations: &[Expression]) -> Option<(Vec<Rational>, Expression)> {
    let forces: Vec<Monomials> =
        equations.iter().enumerate().map(|(j, e)| force(j, e)).collect::<Option<_>>()?;
    let weights = weights(&forces)?;
    let mut sum = Terms::new();
    for (j, (force, weight)) in forces.iter().zip(&weights).enumerate() {
        for (m, q) in &force.terms {
            let degree = 1 + (0..forces.len()).map(|k| exponent(m, k)).sum::<i32>();
            *sum.entry(times(m, j, 1)).or_default() += Rational::from(q * weight) / degree;
        }
    }
    for (j, (force, weight)) in forces.iter().zip(&weights).enumerate() {
        let mut slope = Terms::new();
        for (m, q) in sum.iter().filter(|(m, _)| exponent(m, j) > 0) {
            *slope.entry(times(m, j, -1)).or_default() += Rational::from(q * exponent(m, j));
        }
        for (m, q) in &force.terms {
            *slope.entry(m.clone()).or_default() -= Rational::from(q * weight);
        }
        if slope.values().any(|q| !q.is_zero()) {
            return None;
        }
    }
    let tree = |(m, q): (&Monomial, &Rational)| {
        let named = forces.first().map(|force| force.tree(m, q))?;
        Some(named.map(&|e| match e {
            Expression::Parameter(name) => Some(Expression::unknown(unknown(name)?, 0)),
            _ => None,
        }))
    };
    Some((weights, Expression::Sum(sum.iter().map(tree).collect::<Option<_>>()?)))
}

type Terms = BTreeMap<Monomial, Rational>;

const UNKNOWN: &str = "'x";

fn unknown(name: &str) -> Option<usize> {
    name.strip_prefix(UNKNOWN)?.parse().ok()
}

/// The equation without x_j'', in parameters for the unknowns.
fn force(j: usize, equation: &Expression) -> Option<Monomials> {
    let acceleration = Expression::unknown(j, 2);
    let rest: Vec<_> = equation.terms().iter().filter(|e| **e != acceleration).cloned().collect();
    let named = Expression::Sum(rest).map(&|e| match e {
        Expression::Unknown(Unknown { index, derivative: 0, delay: None }) => {
            Some(Expression::parameter(&format!("{UNKNOWN}{index}")))
        }
        _ => None,
    });
    let all = expand(&named.canonical())?;
    let plain = |m: &Monomial| m.x == 0 && m.velocity == 0 && m.atoms.is_empty();
    all.terms.keys().all(plain).then_some(all)
}

fn exponent(m: &Monomial, j: usize) -> i32 {
    m.parameters.get(&format!("{UNKNOWN}{j}")).copied().unwrap_or(0)
}

/// m x_j^n.
fn times(m: &Monomial, j: usize, n: i32) -> Monomial {
    let mut product = m.clone();
    let e = exponent(m, j) + n;
    let name = format!("{UNKNOWN}{j}");
    product.parameters.remove(&name);
    if e != 0 {
        product.parameters.insert(name, e);
    }
    product
}

/// mu_1 = 1 and the others, 1 for unknowns that nothing ties to those before.
fn weights(forces: &[Monomials]) -> Option<Vec<Rational>> {
    let mut weights: Vec<Option<Rational>> = vec![None; forces.len()];
    let ratio = |i: usize, j: usize| {
        let tie = forces[i].terms.iter().find(|(m, _)| exponent(m, j) > 0)?;
        let (m, c) = tie;
        let partner = forces[j].terms.get(&times(&times(m, i, 1), j, -1))?;
        Some(Rational::from(c * exponent(m, j)) / (exponent(m, i) + 1) / partner)
    };
    while let Some(start) = weights.iter().position(Option::is_none) {
        weights[start] = Some(1.into());
        let mut open = vec![start];
        while let Some(i) = open.pop() {
            for j in 0..forces.len() {
                if weights[j].is_none()
                    && let Some(ratio) = ratio(i, j)
                {
                    weights[j] = weights[i].as_ref().map(|weight| ratio * weight);
                    open.push(j);
                }
            }
        }
    }
    let weights: Vec<Rational> = weights.into_iter().flatten().collect();
    weights.iter().all(|weight| *weight > 0).then_some(weights)
}
