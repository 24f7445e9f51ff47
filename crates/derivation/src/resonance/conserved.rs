//! Whether equations x_j'' + f_j = 0 conserve an energy H = x' N x'/2 + V(x), N symmetric and regular, of any signature:
//!
//!   x' N f = sum_i x_i' dV/dx_i.
//!
//! That is linear in N: the terms of the left side that are not linear in the velocities vanish (a gyroscopic term does no
//! work), and the others, sum_i x_i' g_i(x), are a differential, dg_i/dx_l = dg_l/dx_i, of each power of eps. The coefficients
//! are polynomials in the parameters, and N is one in the kernel of the matrix that they form: diagonal where it can be,
//! which H is to be in the squares of the velocities of modes, else with the products of velocities. N does not depend on eps.
//! By Euler a term of g_i gives V one with x_i, over its degree.

use super::modes::{Matrix, orthogonal};
use super::parametric::{as_parameter_free, kernel, rank};
use lindstedt_equation::monomials::{Monomial, Monomials, Terms, add, expand, product};
use lindstedt_equation::{Expression, Unknown};
use rug::Rational;
use std::collections::BTreeMap;

/// H, multiplied by parameters that weights are divided by; nothing where there is none, or forces or other functions than
/// polynomials occur.
pub(super) fn conserved_energy(equations: &[Expression]) -> Option<Expression> {
    let mut forces = all_forces(equations)?;
    let unknowns = 0..forces.len();
    let mut energy = Terms::new();
    for (pair, weight) in &metric(&forces)? {
        let [j, k] = *pair;
        let own = Rational::from((1, if j == k { 2 } else { 1 }));
        let square = power(&velocity(j), 1).times(&power(&velocity(k), 1))?;
        sum(&mut energy, &product(weight, &Terms::from([(square, own)]))?);
        for (moving, force) in work(*pair) {
            for (m, q) in &product(weight, &forces[force].terms)? {
                // g of x_i' g, i being the one that moves: what moves otherwise was found to cancel.
                if m.parameters.keys().any(|name| name.starts_with("'v")) {
                    continue;
                }
                let potential = m.times(&power(&place(moving), 1))?;
                let degree: i32 = unknowns.clone().map(|l| exponent(&potential, &place(l))).sum();
                add(&mut energy, potential, &Rational::from(q / degree));
            }
        }
    }
    let mut named = forces.pop()?;
    forces.into_iter().for_each(|force| named.atoms.extend(force.atoms));
    let tree = |(m, q): (&Monomial, &Rational)| {
        named.tree(m, q).map(&|e| match e {
            Expression::Parameter(name) => unknown(name),
            _ => None,
        })
    };
    Some(Expression::Sum(energy.iter().map(tree).collect()))
}

/// Vectors, as rows, in whose coefficients as unknowns N is diagonal; nothing where it is that or is none, and where it depends on
/// parameters.
pub(super) fn axes(equations: &[Expression]) -> Option<Matrix> {
    let metric = metric(&all_forces(equations)?)?;
    if metric.iter().all(|([j, k], _)| j == k) {
        return None;
    }
    let mut matrix = vec![vec![Rational::new(); equations.len()]; equations.len()];
    for ([j, k], entry) in &metric {
        let number = entry.get(&Monomial::default()).filter(|_| entry.len() == 1)?;
        matrix[*j][*k].clone_from(number);
        matrix[*k][*j].clone_from(number);
    }
    Some(orthogonal(&matrix))
}

/// Combinations of what is conserved that are looked at.
const TRIED: usize = 8;

/// The place of an entry of N, j <= k.
type Pair = [usize; 2];

// No name of a parameter begins like these.
fn place(j: usize) -> String {
    format!("'x{j}")
}

fn velocity(j: usize) -> String {
    format!("'v{j}")
}

fn unknown(name: &str) -> Option<Expression> {
    let of = |prefix, derivative| {
        Some(Expression::unknown(name.strip_prefix(prefix)?.parse().ok()?, derivative))
    };
    of("'x", 0).or_else(|| of("'v", 1))
}

/// The equation without x_j'', in parameters for the unknowns and their velocities.
fn force(j: usize, equation: &Expression) -> Option<Monomials> {
    let acceleration = Expression::unknown(j, 2);
    let rest: Vec<_> = equation.terms().iter().filter(|e| **e != acceleration).cloned().collect();
    let named = Expression::Sum(rest).map(&|e| match e {
        Expression::Unknown(Unknown { index, derivative: 0, delay: None }) => {
            Some(Expression::parameter(&place(*index)))
        }
        Expression::Unknown(Unknown { index, derivative: 1, delay: None }) => {
            Some(Expression::parameter(&velocity(*index)))
        }
        _ => None,
    });
    let all = expand(&named.canonical())?;
    // Of 1/x the work is a logarithm.
    let divides = |(name, n): (&String, &i32)| *n < 0 && unknown(name).is_some();
    let plain = |m: &Monomial| m.is_power(0, 0) && !m.parameters.iter().any(divides);
    all.terms.keys().all(plain).then_some(all)
}

fn exponent(m: &Monomial, name: &str) -> i32 {
    m.parameters.get(name).copied().unwrap_or(0)
}

fn power(name: &str, n: i32) -> Monomial {
    Monomial { parameters: BTreeMap::from([(name.to_owned(), n)]), ..Monomial::default() }
}

fn sum(all: &mut Terms, terms: &Terms) {
    terms.iter().for_each(|(m, q)| add(all, m.clone(), q));
}

/// What an entry of N multiplies: the velocities and forces whose products are its work.
fn work([j, k]: Pair) -> Vec<(usize, usize)> {
    if j == k { vec![(j, j)] } else { vec![(j, k), (k, j)] }
}

fn all_forces(equations: &[Expression]) -> Option<Vec<Monomials>> {
    equations.iter().enumerate().map(|(j, e)| force(j, e)).collect()
}

/// The entries of a regular N that are not zero, of a diagonal one where there is one.
fn metric(forces: &[Monomials]) -> Option<Vec<(Pair, Terms)>> {
    let unknowns = 0..forces.len();
    let squares = unknowns.clone().map(|j| [j, j]).collect();
    let all = || unknowns.clone().flat_map(|j| (j..forces.len()).map(move |k| [j, k])).collect();
    metric_among(forces, squares).or_else(|| metric_among(forces, all()))
}

fn metric_among(forces: &[Monomials], pairs: Vec<Pair>) -> Option<Vec<(Pair, Terms)>> {
    let basis = kernel(conditions(forces, &pairs)?, pairs.len())?;
    // Of unknowns that nothing ties together every combination is conserved: the sum, or one by numbers without a pattern, for
    // those at which a polynomial, the determinant, vanishes are few.
    let combination = |patterned: bool, seed: &mut u32| -> Option<Vec<Terms>> {
        let mut all = vec![Terms::new(); pairs.len()];
        for vector in &basis {
            *seed = seed.wrapping_mul(69_069).wrapping_add(1);
            let scale = if patterned { 1 } else { 1 + (*seed >> 26) };
            for (entry, own) in all.iter_mut().zip(vector) {
                sum(entry, &product(own, &as_parameter_free(&scale.into()))?);
            }
        }
        Some(all)
    };
    let regular = |entries: &Vec<Terms>| {
        let mut rows = vec![vec![Terms::new(); forces.len()]; forces.len()];
        for ([j, k], entry) in pairs.iter().zip(entries) {
            rows[*j][*k].clone_from(entry);
            rows[*k][*j].clone_from(entry);
        }
        rank(rows) == Some(forces.len())
    };
    let mut seed = 1;
    let mut tried = (0..TRIED).filter_map(|t| combination(t == 0, &mut seed));
    let entries = tried.find(regular)?;
    Some(pairs.into_iter().zip(entries).filter(|(_, entry)| !entry.is_empty()).collect())
}

/// The rows of what vanishes, linear in the entries of N.
fn conditions(forces: &[Monomials], pairs: &[Pair]) -> Option<Vec<Vec<Terms>>> {
    let mut rows: BTreeMap<(Option<Pair>, Monomial), Vec<Terms>> = BTreeMap::new();
    for (column, pair) in pairs.iter().enumerate() {
        let mut at = |key, factor: &Monomial, q: &Rational| {
            let row = rows.entry(key).or_insert_with(|| vec![Terms::new(); pairs.len()]);
            add(&mut row[column], factor.clone(), q);
        };
        for (moving, force) in work(*pair) {
            for (m, q) in &forces[force].terms {
                let (mut word, mut factor) = (m.clone(), Monomial::default());
                word.parameters.retain(|name, _| unknown(name).is_some());
                factor.parameters.clone_from(&m.parameters);
                factor.parameters.retain(|name, _| unknown(name).is_none());
                if word.parameters.keys().any(|name| name.starts_with("'v")) {
                    at((None, word.times(&power(&velocity(moving), 1))?), &factor, q);
                    continue;
                }
                for other in (0..forces.len()).filter(|other| *other != moving) {
                    let n = exponent(&word, &place(other));
                    if n == 0 {
                        continue;
                    }
                    let slope = word.times(&power(&place(other), -1))?;
                    let sign = if moving < other { n } else { -n };
                    let both = [moving.min(other), moving.max(other)];
                    at((Some(both), slope), &factor, &Rational::from(q * sign));
                }
            }
        }
    }
    Some(rows.into_values().collect())
}
