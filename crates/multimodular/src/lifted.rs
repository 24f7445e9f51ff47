//! What is proved of one order.

use crate::place::Place;
use lindstedt_algebra::Ring;
use lindstedt_expand::OrderNumbers;
use lindstedt_phase::modular::{PrimeFields, Residues};
use lindstedt_phase::trigonometric::TrigonometricPolynomial;
use rayon::prelude::*;
use rug::{Integer, Rational};

/// Bits of the factors by which numerators are divided one after the other.
const FACTOR_BITS: u32 = 1024;

/// The numbers of one order over their common denominator, and what its numerators belong to.
pub(crate) struct Lifted {
    pub numbers: OrderNumbers,
    places: Vec<Place>,
}

/// One order in lowest terms.
pub(crate) struct Order {
    /// W_n, omega_n, T_n.
    pub series: [Rational; 3],
    pub amplitude: Rational,
    pub solution: TrigonometricPolynomial<Rational>,
}

impl Lifted {
    pub(crate) fn new(numbers: OrderNumbers, places: &[Place]) -> Self {
        let harmonics = places.iter().filter(|place| place.harmonic().is_some());
        Self { numbers, places: harmonics.copied().collect() }
    }

    /// W_n and the amplitudes of cosines and sines modulo eight primes; nothing where one divides a denominator.
    pub(crate) fn modulo(&self, field: &PrimeFields) -> Option<(Residues, [Vec<Residues>; 2])> {
        let OrderNumbers { denominator, numerators, squared, .. } = &self.numbers;
        let series = [denominator, squared.denom(), squared.numer()];
        let all = series.into_iter().chain(numerators.iter().map(|(_, c)| c));
        let residues = field.integers(all);
        let ([denominator, of_square, square], numerators) = residues.split_first_chunk()?;
        let inverses = field.reciprocals(&[*denominator, *of_square])?;
        let mut harmonics = [Vec::new(), Vec::new()];
        for (place, c) in self.places.iter().zip(numerators) {
            let (list, k) = match *place {
                Place::Cosine(k) => (&mut harmonics[0], k),
                Place::Sine(k) => (&mut harmonics[1], k),
                Place::Squared | Place::Frequency | Place::Period => continue,
            };
            list.resize(k, field.zero());
            list.push(field.mul(c, &inverses[0]));
        }
        Some((field.mul(square, &inverses[1]), harmonics))
    }

    /// In lowest terms; `largest` bounds the primes that denominators are likely to have.
    pub(crate) fn order(self, largest: u32) -> Order {
        let Self { numbers, places } = self;
        let OrderNumbers { denominator, numerators, squared, frequency, period } = numbers;
        let sums = places.iter().zip(&numerators);
        let cosines = sums.filter(|(place, _)| matches!(place, Place::Cosine(_)));
        let amplitude: Integer = cosines.map(|(_, (_, c))| c).sum();
        let factors = coprime_factors(&denominator, largest);
        let reduce = |(_, c): (usize, Integer)| over(c, &factors);
        let values: Vec<Rational> = numerators.into_par_iter().map(reduce).collect();
        let mut solution = TrigonometricPolynomial { cos: Vec::new(), sin: Vec::new() };
        for (place, value) in places.into_iter().zip(values) {
            let (list, k) = match place {
                Place::Cosine(k) => (&mut solution.cos, k),
                Place::Sine(k) => (&mut solution.sin, k),
                Place::Squared | Place::Frequency | Place::Period => continue,
            };
            list.resize_with(k, Rational::new);
            list.push(value);
        }
        let series = [squared, frequency, period];
        Order { series, amplitude: over(amplitude, &factors), solution }
    }
}

/// Coprime factors of a number, each of some words: powers of the primes up to `largest`, and what is left.
fn coprime_factors(number: &Integer, largest: u32) -> Vec<Integer> {
    let (mut rest, mut factors, mut last) = (number.clone(), Vec::new(), Integer::from(1));
    for d in 2..=largest {
        // What divides when its divisors are taken out is a prime.
        if !rest.is_divisible_u(d) {
            continue;
        }
        let prime = Integer::from(d);
        let exponent = rest.remove_factor_mut(&prime);
        last *= Integer::from(rug::ops::Pow::pow(&prime, exponent));
        if last.significant_bits() > FACTOR_BITS {
            factors.push(std::mem::replace(&mut last, Integer::from(1)));
        }
    }
    factors.extend([last, rest]);
    factors
}

/// c over a product of coprime factors, in lowest terms. A divisor common with a short factor costs a division; with
/// a number as long as c it costs many.
fn over(c: Integer, factors: &[Integer]) -> Rational {
    factors.iter().filter(|factor| **factor != 1).fold(Rational::from(c), |value, q| value / q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_in_lowest_terms() {
        let denominator = Integer::from(Integer::u_pow_u(2, 3000))
            * Integer::from(Integer::u_pow_u(6, 40))
            * Integer::from(Integer::u_pow_u(1_000_003, 3));
        for largest in [2, 3, 60] {
            let factors = coprime_factors(&denominator, largest);
            assert_eq!(factors.iter().product::<Integer>(), denominator);
            for c in [0, -1, 12, 1_000_003 * 18, 5] {
                let expected = Rational::from((Integer::from(c), denominator.clone()));
                assert_eq!(over(Integer::from(c), &factors), expected, "{largest} {c}");
            }
        }
    }
}
