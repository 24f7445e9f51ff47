//! The leading amplitude of a limit cycle.
//!
//! With x_0 = a cos psi the secular term of order 1 in sin psi is a polynomial S(a). It is
//! found by evaluating it at integers and interpolating; its positive roots are counted by
//! Sturm's theorem, and the one that is needed must be rational.

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::evaluator::Evaluator;
use lindstedt_algebra::{PhaseAlgebra, RationalAlgebra};
use rug::{Integer, Rational};

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

fn trim(mut polynomial: Vec<Rational>) -> Vec<Rational> {
    while polynomial.last().is_some_and(Rational::is_zero) {
        polynomial.pop();
    }
    polynomial
}

/// The number of distinct positive roots of a polynomial without root at zero (Sturm's theorem
/// on (0, infinity)).
fn count_positive_roots(polynomial: &[Rational]) -> usize {
    let derivative: Vec<Rational> =
        (1u32..).zip(polynomial.iter().skip(1)).map(|(k, c)| Rational::from(c * k)).collect();
    let mut chain = vec![polynomial.to_vec(), trim(derivative)];
    while let [.., a, b] = &chain[..]
        && !b.is_empty()
    {
        let remainder = remainder(a, b).into_iter().map(|c| -c).collect();
        chain.push(trim(remainder));
    }
    let variations = |end: fn(&[Rational]) -> Option<&Rational>| {
        let signs: Vec<bool> = chain
            .iter()
            .filter_map(|p| end(p))
            .filter(|c| !c.is_zero())
            .map(Rational::is_positive)
            .collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    };
    variations(<[Rational]>::first).saturating_sub(variations(<[Rational]>::last))
}

/// The remainder of the division of polynomials, b not empty.
fn remainder(a: &[Rational], b: &[Rational]) -> Vec<Rational> {
    let mut rest = a.to_vec();
    while rest.len() >= b.len() {
        let (Some(top), Some(lead)) = (rest.last(), b.last()) else { break };
        let factor = Rational::from(top / lead);
        let shift = rest.len() - b.len();
        for (k, c) in b.iter().enumerate() {
            rest[shift + k] -= Rational::from(c * &factor);
        }
        rest.pop();
        rest = trim(rest);
    }
    rest
}

/// The positive rational root, by the rational root theorem; candidates are divisors found by
/// trial division up to 10^6, beyond which a root is treated as irrational.
fn rational_root(polynomial: &[Rational]) -> Option<Rational> {
    let mut denominator = Integer::from(1);
    for c in polynomial {
        denominator.lcm_mut(c.denom());
    }
    let integral = |c: &Rational| Rational::from(c * &denominator).numer().clone().abs();
    let numerators = divisors(&integral(polynomial.first()?));
    let denominators = divisors(&integral(polynomial.last()?));
    let value = |a: &Rational| polynomial.iter().rev().fold(Rational::new(), |sum, c| sum * a + c);
    let candidates = numerators
        .iter()
        .flat_map(|p| denominators.iter().map(move |q| Rational::from((p.clone(), q.clone()))));
    candidates.into_iter().find(|a| value(a).is_zero())
}

fn divisors(n: &Integer) -> Vec<Integer> {
    let mut list = Vec::new();
    for d in 1u32..=1_000_000 {
        if Integer::from(d) * d > *n {
            break;
        }
        if n.is_divisible_u(d) {
            list.push(Integer::from(d));
            list.push(Integer::from(n / d));
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i32]) -> Vec<Rational> {
        coefficients.iter().map(|&c| Rational::from(c)).collect()
    }

    #[test]
    fn positive_roots_are_counted_and_found() {
        // (z - 2/3)(z + 5)(z^2 + 1), scaled by 3.
        let one = polynomial(&[-10, 13, -7, 13, 3]);
        assert_eq!(count_positive_roots(&one), 1);
        assert_eq!(rational_root(&one), Some(Rational::from((2, 3))));
        let two = polynomial(&[6, -5, 1]);
        assert_eq!(count_positive_roots(&two), 2);
        let irrational = polynomial(&[-2, 0, 1]);
        assert_eq!(count_positive_roots(&irrational), 1);
        assert_eq!(rational_root(&irrational), None);
        assert_eq!(count_positive_roots(&polynomial(&[1, 0, 1])), 0);
        assert_eq!(count_positive_roots(&[]), 0);
    }

    #[test]
    fn interpolation_reproduces() {
        let values: Vec<Rational> = (0..4).map(|a| Rational::from(a * a * a - 2 * a + 7)).collect();
        assert_eq!(interpolate(&values), polynomial(&[7, -2, 0, 1]));
    }
}
