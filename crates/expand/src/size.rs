//! Bounds of rational numbers by a denominator and a norm.
//!
//! A trigonometric polynomial f = sum_k f_k z^k, z = e^(i psi), is measured by a common
//! denominator of the f_k and by the norm sum |f_k|; sums and products respect both: the
//! denominator of a product divides the product, of a sum the least common multiple, and the
//! norm is submultiplicative. Denominators are powers of pairwise coprime generators, so common factors are
//! neither lost nor counted twice.

use rug::float::Round;
use rug::ops::{AddAssignRound, DivAssignRound, MulAssignRound};
use rug::{Float, Integer, Rational};

/// Bits of a norm, which is rounded up.
const BITS: u32 = 64;

/// A denominator as exponents of generators, and a norm.
#[derive(Clone, Debug)]
pub(crate) struct Size {
    pub(crate) exponents: Vec<u32>,
    pub(crate) norm: Float,
}

/// Sizes of the coefficients of a series; nothing where they vanish or are not known.
pub(crate) type List = Vec<Option<Size>>;

/// Pairwise coprime numbers; every denominator that is measured is a product of their powers. The first
/// is 2.
#[derive(Clone, Debug)]
pub(crate) struct Generators {
    numbers: Vec<Integer>,
    /// Their binary logarithms, rounded up.
    logarithms: Vec<Float>,
}

impl Generators {
    /// The primes up to `largest`, and a coprime basis of what is left of some denominators.
    pub(crate) fn new<'a>(largest: usize, denominators: impl Iterator<Item = &'a Integer>) -> Self {
        let prime = |n: &u32| (2..).take_while(|d| d * d <= *n).all(|d| !n.is_multiple_of(d));
        let mut numbers: Vec<Integer> =
            (2..=largest.max(2) as u32).filter(prime).map(Integer::from).collect();
        let mut rests = Vec::new();
        for denominator in denominators {
            let mut rest = denominator.clone();
            for generator in &numbers {
                rest.remove_factor_mut(generator);
            }
            refine(&mut rests, rest);
        }
        numbers.extend(rests);
        let logarithm = |n: &Integer| {
            Float::with_val_round(
                BITS,
                Float::with_val_round(BITS, n, Round::Up).0.log2_ref(),
                Round::Up,
            )
            .0
        };
        Self { logarithms: numbers.iter().map(logarithm).collect(), numbers }
    }

    pub(crate) fn len(&self) -> usize {
        self.numbers.len()
    }

    /// The exponents of a denominator; nothing if it is no product of generators.
    pub(crate) fn exponents(&self, denominator: &Integer) -> Option<Vec<u32>> {
        let mut rest = denominator.clone();
        let exponents = self.numbers.iter().map(|generator| {
            let divides = rest.is_divisible(generator);
            if divides { rest.remove_factor_mut(generator) } else { 0 }
        });
        let exponents = exponents.collect();
        (rest == 1).then_some(exponents)
    }

    /// The product of powers.
    pub(crate) fn product(&self, exponents: &[u32]) -> Integer {
        let used = self.numbers.iter().zip(exponents).filter(|(_, e)| **e > 0);
        let mut factors: Vec<Integer> =
            used.map(|(generator, &e)| rug::ops::Pow::pow(generator, e).into()).collect();
        // Factors of like length, pair by pair.
        while factors.len() > 1 {
            factors = factors.chunks(2).map(|pair| pair.iter().product()).collect();
        }
        factors.pop().unwrap_or_else(|| Integer::from(1))
    }

    /// The exponent of generator number `index` in a number that is not zero.
    pub(crate) fn valuation(&self, index: usize, number: u64) -> u32 {
        let (mut number, mut exponent) = (number, 0);
        let Some(generator) = self.numbers[index].to_u64() else { return 0 };
        while number.is_multiple_of(generator) {
            number /= generator;
            exponent += 1;
        }
        exponent
    }

    /// A number; nothing if it vanishes or has another denominator.
    pub(crate) fn number(&self, q: &Rational) -> Option<Size> {
        if q.is_zero() {
            return None;
        }
        let norm = Float::with_val_round(BITS, &*q.as_abs(), Round::Up).0;
        Some(Size { exponents: self.exponents(q.denom())?, norm })
    }

    /// More bits than denominator times norm have.
    pub(crate) fn bits(&self, size: &Size) -> u64 {
        let mut bits = Float::with_val_round(BITS, size.norm.log2_ref(), Round::Up).0;
        for (logarithm, &exponent) in self.logarithms.iter().zip(&size.exponents) {
            let power = Float::with_val_round(BITS, logarithm * exponent, Round::Up).0;
            bits.add_assign_round(&power, Round::Up);
        }
        bits.ceil_mut();
        bits.to_integer()
            .and_then(|bits| (bits.max(Integer::new()) + 1u32).to_u64())
            .unwrap_or(u64::MAX)
    }
}

/// |numerator|/denominator, rounded up.
pub(crate) fn norm(numerator: &Integer, denominator: &Integer) -> Float {
    let mut norm = Float::with_val_round(BITS, &*numerator.as_abs(), Round::Up).0;
    let denominator = Float::with_val_round(BITS, denominator, Round::Down).0;
    norm.div_assign_round(&denominator, Round::Up);
    norm
}

impl Size {
    /// Makes room for a summand.
    pub(crate) fn absorb(&mut self, other: &Self) {
        for (e, f) in self.exponents.iter_mut().zip(&other.exponents) {
            *e = (*e).max(*f);
        }
        self.norm.add_assign_round(&other.norm, Round::Up);
    }

    fn absorb_product(&mut self, a: &Self, b: &Self) {
        for ((e, f), g) in self.exponents.iter_mut().zip(&a.exponents).zip(&b.exponents) {
            *e = (*e).max(f + g);
        }
        let product = Float::with_val_round(BITS, &a.norm * &b.norm, Round::Up).0;
        self.norm.add_assign_round(&product, Round::Up);
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let exponents = self.exponents.iter().zip(&other.exponents).map(|(a, b)| a + b).collect();
        let mut norm = self.norm.clone();
        norm.mul_assign_round(&other.norm, Round::Up);
        Self { exponents, norm }
    }
}

/// sum of what is there.
pub(crate) fn sum(sizes: impl IntoIterator<Item = Option<Size>>) -> Option<Size> {
    sizes.into_iter().flatten().reduce(|mut a, b| {
        a.absorb(&b);
        a
    })
}

/// sum_k a_k b_(n-k) over a range.
pub(crate) fn convolution(
    a: &List,
    b: &List,
    range: impl Iterator<Item = usize>,
    n: usize,
) -> Option<Size> {
    let mut sum: Option<Size> = None;
    for k in range {
        let (Some(Some(x)), Some(Some(y))) = (a.get(k), b.get(n - k)) else { continue };
        match &mut sum {
            None => sum = Some(x.times(y)),
            Some(sum) => sum.absorb_product(x, y),
        }
    }
    sum
}

/// Adds a number to a basis of pairwise coprime numbers, splitting at common factors, so that it
/// becomes a product of powers of members.
fn refine(basis: &mut Vec<Integer>, number: Integer) {
    let mut pending = vec![number];
    while let Some(n) = pending.pop() {
        if n == 1 || basis.contains(&n) {
            continue;
        }
        let shares = |b: &Integer| Integer::from(b.gcd_ref(&n)) != 1;
        match basis.iter().position(shares) {
            None => basis.push(n),
            Some(index) => {
                let member = basis.swap_remove(index);
                let common = Integer::from(member.gcd_ref(&n));
                pending.push(Integer::from(member.div_exact_ref(&common)));
                pending.push(Integer::from(n.div_exact_ref(&common)));
                pending.push(common);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn denominators_that_share_large_factors_are_not_lost() {
        // lcm(pq, qr) = pqr is a product of powers of the generators only if pq and qr are split.
        let [p, q, r] = [1_000_003, 1_000_033, 1_000_037].map(Integer::from);
        let numbers = [Integer::from(&p * &q), Integer::from(&q * &r)];
        let generators = Generators::new(7, numbers.iter());
        let [a, b] = numbers.map(|n| generators.number(&Rational::from((Integer::from(1), n))));
        let both = sum([a, b]).unwrap();
        assert_eq!(generators.product(&both.exponents), p * q * r);
        // Two numbers of 2^-40: the bits of a product of three primes of 20 bits, over 2^39.
        assert!((20..=23).contains(&generators.bits(&both)), "{}", generators.bits(&both));
        // A denominator unknown to the generators gives no bound.
        assert!(generators.number(&Rational::from((1, 2_000_003))).is_none());
    }

    #[test]
    fn a_cosine_has_denominator_two_in_powers_of_z() {
        // cos^2 psi = (z^2 + 2 + z^-2)/4: denominator 4, norm 1.
        let generators = Generators::new(2, std::iter::empty());
        let cosine = Size { exponents: vec![1], norm: Float::with_val(BITS, 1) };
        let square =
            convolution(&vec![Some(cosine.clone())], &vec![Some(cosine)], 0..1, 0).unwrap();
        assert_eq!((square.exponents[0], square.norm.to_f64()), (2, 1.0));
        assert_eq!(generators.bits(&square), 3);
        assert_eq!(norm(&Integer::from(-3), &Integer::from(4)), 0.75);
    }
}
