//! The second exact route to the frequency: the energy integral, without any expansion of x(t).
//!
//! For x'' + x F(delta ln x^2) = 0, F(z) = sum_n F_n z^n/n!, x(0) = 1, x'(0) = 0 energy gives
//!
//!   T sqrt(F_0)/(2 pi) = < (1 + sum_{j>=1} (F_j/F_0) delta^j w_j/sin^2)^(-1/2) >,  x = cos theta,
//!   w_j = (2^(j+1)/j!) I_j,   I_j = int_x^1 y ln^j y dy = -x^2 ln^j x/2 - (j/2) I_{j-1},
//!
//! so w_j/sin^2 is a polynomial in K = cot^2 theta and l = -ln|cos theta|. Its powers have the
//! mean values (finite parts; only regular combinations occur)
//!
//!   <K^i l^m>/m! = [z^m] prod_{r<i} -(1 + 2r - z)/(1 + 2r) * sum_m mu_m z^m,
//!
//! from B((1 - z)/2 + i, 1/2 - i) = B((1 - z)/2, 1/2) ((1 - z)/2)_i (-1)^i/(1/2)_i. The period is
//! linear in the mu_m at every order.

use lindstedt_algebra::{RationalAlgebra, Rationals, Ring, Stop};
use lindstedt_coeff::sparse::Sparse;
use lindstedt_coeff::{Polynomial, PolynomialRing, PowerProduct, Symbol};
use lindstedt_series::Series;
use rug::{Integer, Rational};
use std::collections::BTreeMap;

/// K and l as formal parameters; the constants of the caller must not use these.
const COTANGENT_SQUARED: Symbol = Symbol::Parameter(u16::MAX - 1);
const LOG_SECANT: Symbol = Symbol::Parameter(u16::MAX);

/// T sqrt(F_0)/(2 pi) to the given order, for the Taylor coefficients F_0, F_1, ... (at least
/// `order + 1` of them, F_0 a single term). Nothing when F_0 is not invertible, and once `stop`
/// said so.
pub fn period_over_2pi(
    ring: &PolynomialRing,
    sums: &[Polynomial],
    order: usize,
    stop: &Stop,
) -> Option<Vec<Polynomial>> {
    let inverse = ring.reciprocal(sums.first()?)?;
    let (k, l) = (ring.symbol(COTANGENT_SQUARED), ring.symbol(LOG_SECANT));
    // I_j/sin^2, starting from I_0/sin^2 = 1/2; ln x = -l.
    let mut integral = ring.rational(&Rational::from((1, 2)));
    let mut log_power = ring.one();
    let mut factor = Rational::from(2);
    let mut radicand = vec![ring.one()];
    for (j, sum) in sums.iter().enumerate().take(order + 1).skip(1) {
        log_power = ring.neg(&ring.mul(&log_power, &l));
        let boundary = ring.scale(&ring.mul(&k, &log_power), &Rational::from((-1, 2)));
        let previous = ring.scale(&integral, &Rational::from((-(j as i64), 2)));
        integral = ring.add(&boundary, &previous);
        factor *= Rational::from((2, j));
        let ratio = ring.mul(sum, &inverse);
        radicand.push(ring.mul(&ratio, &ring.scale(&integral, &factor)));
    }
    let go_on = || !stop.asked();
    let half = Rational::from((-1, 2));
    let root = Series::truncated(radicand).power_while(ring, &half, &go_on)?;
    root.coefficients.iter().map(|p| mean(ring, p, stop)).collect()
}

/// The mean of a polynomial in K and l; nothing when stopped.
fn mean(ring: &PolynomialRing, p: &Polynomial, stop: &Stop) -> Option<Polynomial> {
    // Many monomials share their powers of K and l, and the sum is long: merged once, at the end.
    let mut means = BTreeMap::new();
    let mut terms = Vec::new();
    for (monomial, coefficient) in p.terms() {
        if stop.asked() {
            return None;
        }
        let (mut i, mut m) = (0, 0);
        let mut rest = ring.rational(coefficient);
        for &(symbol, exponent) in monomial.factors() {
            match symbol {
                COTANGENT_SQUARED => i = exponent.unsigned_abs(),
                LOG_SECANT => m = exponent.unsigned_abs(),
                _ => rest = ring.mul(&rest, &ring.power(symbol, exponent)),
            }
        }
        let mean = means.entry((i, m)).or_insert_with(|| mean_of_powers(i, m));
        terms.extend_from_slice(ring.mul(&rest, mean).terms());
    }
    Some(Sparse::collect(&Rationals, terms))
}

/// <K^i l^m>.
fn mean_of_powers(i: u16, m: u16) -> Polynomial {
    // The product over r as a polynomial in z, truncated after z^m.
    let mut product = vec![Rational::new(); usize::from(m) + 1];
    product[0] += 1;
    for r in 0..i {
        let scale = Rational::from((-1, 1 + 2 * i32::from(r)));
        let constant = Rational::from(1 + 2 * i32::from(r));
        for index in (0..product.len()).rev() {
            let mut value = Rational::from(&product[index] * &constant);
            if index > 0 {
                value -= &product[index - 1];
            }
            product[index] = value * &scale;
        }
    }
    let factorial = Rational::from(Integer::from(Integer::factorial(m.into())));
    let terms = (0..=m).zip(&product).map(|(j, c)| {
        let mu = if j == m {
            PowerProduct::default()
        } else {
            PowerProduct::power(Symbol::Moment(m - j), 1)
        };
        (mu, Rational::from(c * &factorial))
    });
    Sparse::collect(&Rationals, terms)
}

/// A power of the frequency of the power law x'' + x (x^2)^delta = 0 to the given order, from the
/// same energy integral in closed form: x = cos^(1/(1 + delta)) theta gives
///
///   omega^p = (1 + delta)^(p/2) M(u)^(-p),  M(u) = sum_m mu_m u^m,  u = delta/(1 + delta).
///
/// p = 2 is omega^2, p = -1 is T/2pi (linear in the mu_m). Cost: about 10^4 products at order
/// 30, where omega^2 has 28 627 terms. Nothing once `stop` said so.
pub fn power_law_frequency(
    ring: &PolynomialRing,
    power: i32,
    order: u16,
    stop: &Stop,
) -> Option<Vec<Polynomial>> {
    let moment = |m: u16| if m == 0 { ring.one() } else { ring.symbol(Symbol::Moment(m)) };
    let moments = Series::truncated((0..=order).map(moment).collect());
    let of_u = moments.power_while(ring, &Rational::from(-power), &|| !stop.asked())?;
    let half = Rational::from((power, 2));
    let coefficient = |n: usize| {
        // [delta^n] (1 + delta)^(p/2) u^j = binomial(p/2 - j, n - j).
        let mut sum = ring.zero();
        for (j, y) in of_u.coefficients.iter().enumerate().take(n + 1) {
            if stop.asked() {
                return None;
            }
            let top = &half - Rational::from(j);
            ring.add_assign(&mut sum, &ring.scale(y, &binomial(&top, n - j)));
        }
        Some(sum)
    };
    (0..=usize::from(order)).map(coefficient).collect()
}

/// binomial(top, k) = top (top - 1) ... (top - k + 1)/k!.
fn binomial(top: &Rational, k: usize) -> Rational {
    (0..k).fold(Rational::from(1), |product, i| {
        product * (top - Rational::from(i)) / Rational::from(i + 1)
    })
}
