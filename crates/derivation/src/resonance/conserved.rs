//! Whether equations x_j'' + f_j = 0 conserve an energy H = sum_j mu_j x_j'^2/2 + V(x), the mu_j not 0, of any sign:
//!
//!   sum_j mu_j x_j' f_j = sum_j x_j' dV/dx_j.
//!
//! A term c x^a of f_i that contains x_j is the derivative of one of V by x_i, so that f_j has
//! c' x^a x_i/x_j with mu_i c/(a_i + 1) = mu_j c'/a_j; a term c x^a x_j' does no work where f_j has c' x^a x_i' with
//! mu_i c = -mu_j c' (gyroscopic). That fixes the weights one after the other, where factors that the c have may be parameters. By
//! Euler a term of the left side, linear in the velocities, gives V one with x_j in the place of x_j', over its degree; then both
//! sides are compared, term by term.

use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Unknown};
use rug::Rational;
use std::collections::BTreeMap;

/// H, multiplied by parameters that weights are divided by; nothing where there is none, or forces or other functions than
/// polynomials occur.
pub(super) fn conserved_energy(equations: &[Expression]) -> Option<Expression> {
    let mut forces: Vec<Monomials> =
        equations.iter().enumerate().map(|(j, e)| force(j, e)).collect::<Option<_>>()?;
    let mut power = Terms::new();
    let mut energy = Terms::new();
    for (j, (mass, weight)) in weights(&forces)?.iter().enumerate() {
        let square = times(mass, &velocity(j), 2);
        *energy.entry(square).or_default() += Rational::from(weight / 2);
        for (m, q) in &forces[j].terms {
            let mut product = times(m, &velocity(j), 1);
            for (name, e) in &mass.parameters {
                product = times(&product, name, *e);
            }
            *power.entry(product).or_default() += Rational::from(q * weight);
        }
    }
    let unknowns = 0..forces.len();
    let mut potential = Terms::new();
    for (m, q) in &power {
        let moving = unknowns.clone().filter(|j| exponent(m, &velocity(*j)) != 0);
        if let [j] = moving.collect::<Vec<_>>()[..]
            && exponent(m, &velocity(j)) == 1
        {
            let still = times(&times(m, &velocity(j), -1), &place(j), 1);
            let degree: i32 = unknowns.clone().map(|k| exponent(&still, &place(k))).sum();
            *potential.entry(still).or_default() += Rational::from(q / degree);
        }
    }
    for (m, q) in &potential {
        for j in unknowns.clone().filter(|j| exponent(m, &place(*j)) != 0) {
            let slope = times(&times(m, &place(j), -1), &velocity(j), 1);
            *power.entry(slope).or_default() -= Rational::from(q * exponent(m, &place(j)));
        }
    }
    if power.values().any(|q| !q.is_zero()) {
        return None;
    }
    energy.extend(potential);
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

type Terms = BTreeMap<Monomial, Rational>;

/// mu_j: a product of parameters and a number.
type Weight = (Monomial, Rational);

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
    let plain = |m: &Monomial| m.x == 0 && m.velocity == 0 && m.atoms.is_empty();
    all.terms.keys().all(plain).then_some(all)
}

fn exponent(m: &Monomial, name: &str) -> i32 {
    m.parameters.get(name).copied().unwrap_or(0)
}

/// m name^n.
fn times(m: &Monomial, name: &str, n: i32) -> Monomial {
    let mut product = m.clone();
    let e = exponent(m, name) + n;
    product.parameters.remove(name);
    if e != 0 {
        product.parameters.insert(name.to_owned(), e);
    }
    product
}

/// mu_j/mu_i, by the first term that says it.
fn ratio(forces: &[Monomials], i: usize, j: usize) -> Option<Weight> {
    let (x, v) = ([i, j].map(place), [i, j].map(velocity));
    // That of equal factors, or else the first.
    let partner = |m: &Monomial| {
        let moves = |m: &Monomial| {
            let own = m.parameters.iter().filter(|(name, _)| unknown(name).is_some());
            (m.order, own.map(|(name, e)| (name.clone(), *e)).collect::<Vec<_>>())
        };
        let terms = &forces[j].terms;
        terms.get_key_value(m).or_else(|| terms.iter().find(|(other, _)| moves(other) == moves(m)))
    };
    forces[i].terms.iter().find_map(|(m, c)| {
        let (tied, factor) = match (exponent(m, &v[1]), exponent(m, &x[1])) {
            (0, 0) => return None,
            (0, a) => {
                let factor = Rational::from((a, exponent(m, &x[0]) + 1));
                (times(&times(m, &x[0], 1), &x[1], -1), factor)
            }
            _ => (times(&times(m, &v[0], 1), &v[1], -1), Rational::from(-1)),
        };
        let (own, other) = partner(&tied)?;
        let mut product = Monomial::default();
        for (sign, m) in [(1, &tied), (-1, own)] {
            for (name, e) in &m.parameters {
                product = times(&product, name, sign * e);
            }
        }
        Some((product, factor * Rational::from(c / other)))
    })
}

/// The weights, 1 for unknowns that nothing ties to those before; without parameters below.
fn weights(forces: &[Monomials]) -> Option<Vec<Weight>> {
    let mut weights: Vec<Option<Weight>> = vec![None; forces.len()];
    while let Some(start) = weights.iter().position(Option::is_none) {
        weights[start] = Some((Monomial::default(), 1.into()));
        let mut open = vec![start];
        while let Some(i) = open.pop() {
            let Some((mass, weight)) = weights[i].clone() else { continue };
            for (j, own) in weights.iter_mut().enumerate().filter(|(_, own)| own.is_none()) {
                if let Some((factor, q)) = ratio(forces, i, j) {
                    let all = factor.parameters.iter();
                    let mass = all.fold(mass.clone(), |m, (name, e)| times(&m, name, *e));
                    *own = Some((mass, q * &weight));
                    open.push(j);
                }
            }
        }
    }
    let mut weights: Vec<Weight> = weights.into_iter().flatten().collect();
    let below = |(mass, _): &Weight| {
        let below = mass.parameters.iter().find(|(_, e)| **e < 0);
        below.map(|(name, e)| (name.clone(), -e))
    };
    while let Some((name, e)) = weights.iter().find_map(below) {
        weights.iter_mut().for_each(|(mass, _)| *mass = times(mass, &name, e));
    }
    weights.iter().all(|(_, weight)| !weight.is_zero()).then_some(weights)
}
