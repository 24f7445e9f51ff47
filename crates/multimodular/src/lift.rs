//! From images modulo primes to numbers over Q.

use crate::denominator::{Denominator, over};
use crate::image::Image;
use crate::place::Place;
use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_expand::OrderNumbers;
use rayon::prelude::*;
use rug::Integer;

/// A candidate is accepted when it is shorter than the modulus by so many bits, which happens by chance
/// once in 2^80. It is proved afterwards.
pub(crate) const MARGIN: u32 = 80;

/// Pairs of primes of a group: its numbers are too short for fast multiplication.
const GROUP: usize = 16;

/// The Chinese remainder theorem for the primes of a list of images: sum_i d_i M/m_i, the d_i below the m_i, by a tree of products,
///
/// ```text
/// sum over A and B = M_B (sum over A) + M_A (sum over B),
/// ```
///
/// whose long products GMP multiplies fast: a sum over the m_i one by one is quadratic in their number.
pub(crate) struct Remaindering {
    modulus: Integer,
    /// The inverses of M/m_i modulo m_i, products of two primes.
    inverses: Vec<u64>,
    /// M_A/m_i for the m_i of every group A.
    cofactors: Vec<Integer>,
    /// The M_A of the groups, of pairs of groups, and so on but for M itself.
    levels: Vec<Vec<Integer>>,
}

impl Remaindering {
    pub(crate) fn new(images: &[Image]) -> Self {
        let moduli: Vec<u64> = images.iter().map(|image| image.ring.modulus()).collect();
        let product = |list: &[u64]| list.iter().map(|m| Integer::from(*m)).product::<Integer>();
        let groups: Vec<Integer> = moduli.chunks(GROUP).map(product).collect();
        let without = |m: &u64, all: &Integer| Integer::from(all.div_exact_ref(&Integer::from(*m)));
        let own = moduli.chunks(GROUP).zip(&groups);
        let cofactors = own.flat_map(|(list, all)| list.iter().map(|m| without(m, all))).collect();
        let mut levels = vec![groups];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            levels.push(last.chunks(2).map(|two| two.iter().product()).collect());
        }
        let modulus = levels.pop().and_then(|mut top| top.pop()).unwrap_or_else(|| 1.into());
        let inverse = |(image, m): (&Image, &u64)| {
            let cofactor = image.ring.integer(&without(m, &modulus));
            image.ring.reciprocal(&cofactor).unwrap_or(0)
        };
        let inverses = images.par_iter().zip(&moduli).map(inverse).collect();
        Self { modulus, inverses, cofactors, levels }
    }

    /// How many primes.
    pub(crate) fn primes(&self) -> usize {
        2 * self.inverses.len()
    }

    /// M >= 2^this.
    pub(crate) fn bits(&self) -> u64 {
        u64::from(self.modulus.significant_bits()) - 1
    }

    /// The numbers of order n, whose common denominator is guessed; nothing when the primes do not suffice,
    /// or when stopped.
    pub(crate) fn lift(
        &self,
        images: &[Image],
        n: usize,
        guess: &Integer,
        stop: &Stop,
    ) -> Option<OrderNumbers> {
        let places = images.first()?.places(n);
        let factors = self.factors(images, guess);
        let numerator =
            |index: usize| (!stop.asked()).then(|| self.combined(images, n, index, &factors));
        // One number decides whether the others are worth their while.
        let probe = places.len().saturating_sub(1).min(3);
        let mut growing = Growing { modulus: &self.modulus, factor: Integer::from(1) };
        growing.fit(&numerator(probe)?)?;
        let numerators: Vec<Option<Integer>> =
            (0..places.len()).into_par_iter().map(numerator).collect();
        let mut fitted = Vec::with_capacity(numerators.len());
        for numerator in numerators {
            let numerator = growing.fit(&numerator?)?;
            fitted.push((numerator, growing.factor.clone()));
        }
        let rescaled = fitted.into_iter().map(|(numerator, factor)| {
            if factor == growing.factor {
                return numerator;
            }
            numerator * Integer::from(growing.factor.div_exact_ref(&factor))
        });
        let denominator = Integer::from(guess * &growing.factor);
        // Numerators over a multiple of p say nothing modulo p.
        if images.iter().any(|image| image.ring.integer(&denominator) == 0) {
            return None;
        }
        Some(lowest_terms(places.iter().copied().zip(rescaled).collect(), denominator))
    }

    /// The inverses of the cofactors times a number.
    fn factors(&self, images: &[Image], number: &Integer) -> Vec<u64> {
        let pairs = images.iter().zip(&self.inverses);
        let factor =
            |(image, inverse): (&Image, &u64)| image.ring.mul(inverse, &image.ring.integer(number));
        pairs.map(factor).collect()
    }

    /// The representative of the smallest absolute value of a number times its denominator.
    pub(crate) fn numerator(
        &self,
        images: &[Image],
        n: usize,
        index: usize,
        denominator: &Integer,
    ) -> Integer {
        self.combined(images, n, index, &self.factors(images, denominator))
    }

    fn combined(&self, images: &[Image], n: usize, index: usize, factors: &[u64]) -> Integer {
        let digit = |(image, factor): (&Image, &u64)| {
            let digit = image.ring.mul(factor, &image.values(n)[index]);
            image.ring.representative(digit)
        };
        let digits: Vec<u64> = images.iter().zip(factors).map(digit).collect();
        let group = |(cofactors, digits): (&[Integer], &[u64])| {
            let mut sum = Integer::with_capacity(64 * (GROUP + 1));
            cofactors.iter().zip(digits).for_each(|(cofactor, digit)| sum += cofactor * digit);
            sum
        };
        let groups = self.cofactors.chunks(GROUP).zip(digits.chunks(GROUP));
        let mut sums: Vec<Integer> = groups.map(group).collect();
        for level in &self.levels {
            let pairs = sums.chunks(2).zip(level.chunks(2));
            let sum = |pair: (&[Integer], &[Integer])| match pair {
                ([a, b], [of_a, of_b]) => Integer::from(a * of_b) + b * of_a,
                (rest, _) => rest.iter().sum(),
            };
            sums = pairs.map(sum).collect();
        }
        let sum = sums.pop().unwrap_or_default();
        centred(sum, &self.modulus)
    }
}

fn centred(n: Integer, modulus: &Integer) -> Integer {
    let residue = n.modulo(modulus);
    if Integer::from(&residue << 1) > *modulus { residue - modulus } else { residue }
}

/// A factor of the denominator that grows where the guess was too small.
struct Growing<'a> {
    modulus: &'a Integer,
    factor: Integer,
}

impl Growing<'_> {
    /// A residue times the factor, short.
    fn fit(&mut self, residue: &Integer) -> Option<Integer> {
        let limit = self.modulus.significant_bits().checked_sub(MARGIN)?;
        let is_short = |n: &Integer| n.significant_bits() <= limit;
        let numerator = if self.factor == 1 {
            residue.clone()
        } else {
            centred(Integer::from(residue * &self.factor), self.modulus)
        };
        if is_short(&numerator) {
            return Some(numerator);
        }
        let missing = self.missing(&numerator)?;
        self.factor *= &missing;
        Some(centred(numerator * missing, self.modulus)).filter(is_short)
    }

    /// q with q r = small modulo M, by Euclid's algorithm on (M, r): the convergent before a
    /// quotient of more than 80 bits (M. Monagan, ISSAC 2004).
    fn missing(&self, residue: &Integer) -> Option<Integer> {
        let (mut a, mut b) = (self.modulus.clone(), residue.clone());
        let (mut before, mut cofactor) = (Integer::new(), Integer::from(1));
        while !b.is_zero() {
            let (quotient, remainder) = a.div_rem_ref(&b).into();
            let _: &Integer = &quotient;
            if quotient.significant_bits() > MARGIN {
                return Some(cofactor.abs());
            }
            let next = before - Integer::from(&quotient * &cofactor);
            before = std::mem::replace(&mut cofactor, next);
            a = std::mem::replace(&mut b, remainder);
        }
        None
    }
}

/// Divides by what the denominator and all numerators have in common.
fn lowest_terms(mut numerators: Vec<(Place, Integer)>, denominator: Integer) -> OrderNumbers {
    // Denominators come from the divisors 1 - k^2.
    let harmonics = numerators.iter().filter_map(|(place, _)| place.harmonic());
    let largest = harmonics.max().map_or(2, |k| k as u32 + 1);
    let mut denominator = Denominator::new(denominator, largest);
    denominator.divide_by_common(numerators.iter_mut().map(|(_, c)| c));
    let factors = denominator.factors();
    let [mut squared, mut frequency, mut period] = [const { None }; 3];
    let over = |numerator: Integer| Some(over(numerator, &factors));
    let mut coefficients = Vec::with_capacity(numerators.len());
    for (place, numerator) in numerators {
        match place {
            Place::Squared => squared = over(numerator),
            Place::Frequency => frequency = over(numerator),
            Place::Period => period = over(numerator),
            Place::Cosine(k) | Place::Sine(k) => coefficients.push((k, numerator)),
        }
    }
    let [squared, frequency, period] = [squared, frequency, period].map(Option::unwrap_or_default);
    let denominator = denominator.number().clone();
    OrderNumbers { denominator, numerators: coefficients, squared, frequency, period }
}

/// The bits of the longest numerator over the common denominator.
pub(crate) fn longest(numbers: &OrderNumbers) -> u32 {
    let own = numbers.numerators.iter().map(|(_, c)| c.significant_bits());
    let series = [&numbers.squared, &numbers.frequency, &numbers.period].map(|q| {
        let more = numbers.denominator.significant_bits() + 1
            - q.denom().significant_bits().min(numbers.denominator.significant_bits());
        q.numer().significant_bits() + more
    });
    own.chain(series).max().unwrap_or(1)
}
