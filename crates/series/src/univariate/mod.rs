//! Polynomials in one variable over Q, as lists of coefficients from the constant on: their real roots by
//! Sturm's theorem, and the ring `Q[r]/m` of numbers that are polynomials in a root of m.
//!
//! No root is ever taken for rational, simple or positive because a floating-point number says so.

mod residues;

pub use residues::Residues;

use rug::{Integer, Rational};

/// Without leading zeros.
#[must_use]
pub fn trim(mut polynomial: Vec<Rational>) -> Vec<Rational> {
    while polynomial.last().is_some_and(Rational::is_zero) {
        polynomial.pop();
    }
    polynomial
}

/// p(x), by Horner's rule.
#[must_use]
pub fn value(polynomial: &[Rational], x: &Rational) -> Rational {
    polynomial.iter().rev().fold(Rational::new(), |sum, c| sum * x + c)
}

/// p'.
#[must_use]
pub fn derivative(polynomial: &[Rational]) -> Vec<Rational> {
    (1u32..).zip(polynomial.iter().skip(1)).map(|(k, c)| Rational::from(c * k)).collect()
}

/// q p.
#[must_use]
pub fn scaled(polynomial: &[Rational], q: &Rational) -> Vec<Rational> {
    trim(polynomial.iter().map(|c| Rational::from(c * q)).collect())
}

/// a + b.
#[must_use]
pub fn plus(mut a: Vec<Rational>, b: &[Rational]) -> Vec<Rational> {
    a.resize(a.len().max(b.len()), Rational::new());
    a.iter_mut().zip(b).for_each(|(x, y)| *x += y);
    trim(a)
}

/// a b; of degree n and m in O(n m) operations.
#[must_use]
pub fn product(a: &[Rational], b: &[Rational]) -> Vec<Rational> {
    let mut all = vec![Rational::new(); (a.len() + b.len()).saturating_sub(1)];
    for (i, x) in a.iter().enumerate().filter(|(_, x)| !x.is_zero()) {
        for (j, y) in b.iter().enumerate() {
            all[i + j] += Rational::from(x * y);
        }
    }
    trim(all)
}

/// Quotient and remainder of the division by b; of a itself by the zero polynomial, 0 and a.
#[must_use]
pub fn divided(a: &[Rational], b: &[Rational]) -> [Vec<Rational>; 2] {
    let mut rest = trim(a.to_vec());
    let mut quotient = vec![Rational::new(); (rest.len() + 1).saturating_sub(b.len())];
    while rest.len() >= b.len() {
        let (Some(top), Some(lead)) = (rest.last(), b.last()) else { break };
        let factor = Rational::from(top / lead);
        let shift = rest.len() - b.len();
        for (k, c) in b.iter().enumerate() {
            rest[shift + k] -= Rational::from(c * &factor);
        }
        rest.pop();
        rest = trim(rest);
        quotient[shift] = factor;
    }
    [quotient, rest]
}

/// The monic greatest common divisor.
#[must_use]
pub fn common_divisor(a: &[Rational], b: &[Rational]) -> Vec<Rational> {
    let (mut a, mut b) = (trim(a.to_vec()), trim(b.to_vec()));
    while !b.is_empty() {
        let [_, rest] = divided(&a, &b);
        // Monic remainders: their coefficients do not grow with the factors of the division.
        a = std::mem::replace(&mut b, monic(rest));
    }
    monic(a)
}

/// p divided by its leading coefficient.
#[must_use]
pub fn monic(mut polynomial: Vec<Rational>) -> Vec<Rational> {
    if let Some(lead) = polynomial.last().cloned() {
        polynomial.iter_mut().for_each(|c| *c /= &lead);
    }
    polynomial
}

/// The monic products of (x - root) over the simple and over the multiple roots.
#[must_use]
pub fn simple_and_multiple(polynomial: &[Rational]) -> [Vec<Rational>; 2] {
    let repeated = common_divisor(polynomial, &derivative(polynomial));
    let [all, _] = divided(polynomial, &repeated);
    let multiple = common_divisor(&all, &repeated);
    let [simple, _] = divided(&all, &multiple);
    [monic(simple), multiple]
}

/// Sturm's chain of a polynomial.
fn chain(polynomial: &[Rational]) -> Vec<Vec<Rational>> {
    let mut chain = vec![polynomial.to_vec(), trim(derivative(polynomial))];
    while let [.., a, b] = &chain[..]
        && !b.is_empty()
    {
        let [_, rest] = divided(a, b);
        chain.push(rest.into_iter().map(|c| -c).collect());
    }
    chain
}

fn variations<'a>(values: impl Iterator<Item = Option<&'a Rational>>) -> usize {
    let signs: Vec<bool> =
        values.flatten().filter(|c| !c.is_zero()).map(Rational::is_positive).collect();
    signs.windows(2).filter(|w| w[0] != w[1]).count()
}

fn variations_at(chain: &[Vec<Rational>], x: &Rational) -> usize {
    let values: Vec<Rational> = chain.iter().map(|p| value(p, x)).collect();
    variations(values.iter().map(Some))
}

/// The number of distinct positive roots of a polynomial without root at zero (Sturm's theorem
/// on (0, infinity)).
#[must_use]
pub fn count_positive_roots(polynomial: &[Rational]) -> usize {
    let chain = chain(polynomial);
    let at_zero = variations(chain.iter().map(|p| p.first()));
    let at_infinity = variations(chain.iter().map(|p| p.last()));
    at_zero.saturating_sub(at_infinity)
}

/// Intervals low < root <= high with one positive root of the polynomial each, increasing; all of them. The
/// polynomial has only simple roots, and none at zero.
#[must_use]
pub fn positive_roots(polynomial: &[Rational]) -> Vec<[Rational; 2]> {
    let Some(lead) = polynomial.last() else { return Vec::new() };
    // Cauchy: no root is beyond 1 + max |c_k/c_n|.
    let largest = polynomial.iter().map(|c| Rational::from(c / lead).abs()).max();
    let bound = largest.unwrap_or_default() + 1u32;
    let chain = chain(polynomial);
    let mut open = vec![[Rational::new(), bound]];
    let mut found = Vec::new();
    while let Some([low, high]) = open.pop() {
        let count = variations_at(&chain, &low).saturating_sub(variations_at(&chain, &high));
        match count {
            0 => {}
            // Low > 0 tells its sign from that at zero.
            1 if !low.is_zero() => found.push([low, high]),
            _ => {
                let middle = Rational::from(&low + &high) / 2u32;
                open.push([middle.clone(), high]);
                open.push([low, middle]);
            }
        }
    }
    found
}

/// The interval of a simple root, halved until it is narrower than 2^-bits times the root; that of a linear
/// polynomial itself.
#[must_use]
pub fn refined(polynomial: &[Rational], [low, high]: &[Rational; 2], bits: u32) -> [Rational; 2] {
    if let [constant, slope] = polynomial {
        let root = -Rational::from(constant / slope);
        return [root.clone(), root];
    }
    let (mut low, mut high) = (low.clone(), high.clone());
    let above = value(polynomial, &high);
    if above.is_zero() {
        return [high.clone(), high];
    }
    let width = Rational::from(&low) >> bits;
    while Rational::from(&high - &low) > width {
        let middle = Rational::from(&low + &high) / 2u32;
        let here = value(polynomial, &middle);
        if here.is_zero() {
            return [middle.clone(), middle];
        }
        if here.is_positive() == above.is_positive() { high = middle } else { low = middle }
    }
    [low, high]
}

/// A positive rational root, by the rational root theorem; candidates are divisors found by
/// trial division up to 10^6, beyond which a root is treated as irrational.
#[must_use]
pub fn rational_root(polynomial: &[Rational]) -> Option<Rational> {
    let mut denominator = Integer::from(1);
    for c in polynomial {
        denominator.lcm_mut(c.denom());
    }
    let integral = |c: &Rational| Rational::from(c * &denominator).numer().clone().abs();
    let numerators = divisors(&integral(polynomial.first()?));
    let denominators = divisors(&integral(polynomial.last()?));
    let candidates = numerators
        .iter()
        .flat_map(|p| denominators.iter().map(move |q| Rational::from((p.clone(), q.clone()))));
    candidates.into_iter().find(|a| value(polynomial, a).is_zero())
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
    fn roots_are_isolated_and_told_from_multiple_ones() {
        // (z^2 - 2)(z - 1)^2 (z + 3).
        let all = polynomial(&[-6, 10, 1, -7, 1, 1]);
        let [simple, multiple] = simple_and_multiple(&all);
        assert_eq!((multiple, &simple), (polynomial(&[-1, 1]), &polynomial(&[-6, -2, 3, 1])));
        let [root] = &positive_roots(&simple)[..] else { panic!("one positive root") };
        let [low, high] = refined(&simple, root, 40);
        assert!(Rational::from(low.square_ref()) < 2 && Rational::from(high.square_ref()) > 2);
        // (z - 2)(z - 17/8): the ends of intervals may be roots.
        let two = positive_roots(&[34, -33, 8].map(Rational::from));
        assert_eq!(two.len(), 2);
        let ends = two.iter().map(|root| refined(&[34, -33, 8].map(Rational::from), root, 30));
        let inside = |([low, high], q): ([Rational; 2], Rational)| low <= q && q <= high;
        assert!(ends.zip([(2, 1), (17, 8)].map(Rational::from)).all(inside));
    }
}
