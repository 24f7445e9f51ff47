//! The leading amplitude of a limit cycle.
//!
//! With x_0 = a cos psi the secular term of order 1 in sin psi is a polynomial S(a). It is
//! found by evaluating it at integers and interpolating; its positive roots are counted by
//! Sturm's theorem, and the one that is needed must be rational.

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::evaluator::Evaluator;
use lindstedt_algebra::{PhaseAlgebra, RationalAlgebra};
use lindstedt_series::univariate::{
    count_positive_roots, rational_root, simple_and_multiple, trim,
};
use rug::Rational;

/// The positive root of S.
pub(crate) fn leading_amplitude<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
) -> Result<Rational, ExpandError> {
    let degree = degree_in_amplitude(equation)?;
    let mut samples = Vec::new();
    for a in 0..=degree {
        samples.push(secular_term(algebra, equation, &Rational::from(a))?);
    }
    let mut polynomial = interpolate(&samples);
    while polynomial.first().is_some_and(Rational::is_zero) {
        polynomial.remove(0);
    }
    if polynomial.is_empty() {
        return Err(ExpandError::AmplitudeOfHigherOrder);
    }
    // A multiple root, rational or not, is no cycle that this order decides.
    let [_, multiple] = simple_and_multiple(&polynomial);
    if count_positive_roots(&multiple) > 0 {
        return Err(ExpandError::DegenerateLimitCycle);
    }
    match count_positive_roots(&polynomial) {
        0 => Err(ExpandError::NoLimitCycle),
        1 => rational_root(&polynomial).ok_or(ExpandError::IrrationalAmplitude),
        count => Err(ExpandError::SeveralLimitCycles { count }),
    }
}

/// A bound on the degree of the equation in x and x'.
fn degree_in_amplitude<A: PhaseAlgebra>(equation: &Equation<A>) -> Result<usize, ExpandError> {
    let mut degrees: Vec<usize> = Vec::new();
    for node in &equation.nodes {
        degrees.push(match node {
            Node::Constant(_) | Node::Small => 0,
            Node::Displacement | Node::Velocity => 1,
            Node::Sum(terms) => terms.iter().map(|(_, t)| degrees[*t]).max().unwrap_or(0),
            Node::Product(a, b) => degrees[*a] + degrees[*b],
            _ => return Err(ExpandError::CycleNotPolynomial),
        });
    }
    Ok(degrees[equation.root()])
}

/// S(a), a rational number.
fn secular_term<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    amplitude: &Rational,
) -> Result<Rational, ExpandError> {
    let mut evaluator = Evaluator::new(algebra, equation);
    let x0 = algebra.scale(&algebra.cosine(), amplitude);
    evaluator.assign(&Node::Velocity, 0, algebra.derivative(&x0));
    evaluator.assign(&Node::Displacement, 0, x0);
    let force = evaluator.coefficient(equation.root(), 1)?;
    let (_, sine) =
        algebra.first_harmonic(&force).map_err(|source| ExpandError::Phase { order: 1, source })?;
    algebra.constants().as_rational(&sine).ok_or(ExpandError::IrrationalAmplitude)
}

/// The coefficients of the polynomial with the given values at 0, 1, 2, ... (Newton's form).
fn interpolate(values: &[Rational]) -> Vec<Rational> {
    let mut differences = values.to_vec();
    let mut coefficients = vec![Rational::new(); values.len()];
    let mut basis = vec![Rational::from(1)];
    for (step, _) in values.iter().enumerate() {
        for (c, b) in coefficients.iter_mut().zip(&basis) {
            *c += Rational::from(b * &differences[0]);
        }
        // basis <- basis (z - step)/(step + 1).
        let mut next = vec![Rational::new(); basis.len() + 1];
        for (k, b) in basis.iter().enumerate() {
            next[k + 1] += b;
            next[k] -= b * Rational::from(step);
        }
        basis = next.into_iter().map(|b| b / Rational::from(step + 1)).collect();
        differences = differences.windows(2).map(|w| Rational::from(&w[1] - &w[0])).collect();
    }
    trim(coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i32]) -> Vec<Rational> {
        coefficients.iter().map(|&c| Rational::from(c)).collect()
    }

    #[test]
    fn interpolation_reproduces() {
        let values: Vec<Rational> = (0..4).map(|a| Rational::from(a * a * a - 2 * a + 7)).collect();
        assert_eq!(interpolate(&values), polynomial(&[7, -2, 0, 1]));
    }
}
