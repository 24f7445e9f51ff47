//! Lowest terms over a denominator whose primes are known, without greatest common divisors.
//!
//! Of a number c and q = p_1^e_1 ... p_m^e_m r the greatest common divisor is prod p_i^min(e_i, v_i), v_i the exponent of
//! p_i in c, times gcd(c, r). What divides c is seen of one residue, modulo a product of powers of the p_i.

use rug::ops::Pow;
use rug::{Integer, Rational};

/// Bits of the factors by which a fraction is divided one after the other.
const FACTOR_BITS: u32 = 1024;

/// A positive number with its small primes.
#[derive(Clone, Debug)]
pub(crate) struct Denominator {
    number: Integer,
    powers: Vec<Power>,
    /// The product of the probes.
    probes: Integer,
    /// What the primes leave.
    rest: Integer,
}

#[derive(Clone, Debug)]
struct Power {
    prime: u32,
    exponent: u32,
    number: Integer,
    /// The highest power of the prime in 16 bits, or the prime.
    probe: u32,
}

impl Power {
    fn new(prime: u32, exponent: u32) -> Self {
        let powers = std::iter::successors(Some(prime), |power| power.checked_mul(prime));
        let probe = powers.take_while(|power| *power < 1 << 16).last().unwrap_or(prime);
        Self { prime, exponent, number: Integer::from(prime).pow(exponent), probe }
    }

    /// The same prime with another exponent.
    fn lower(&mut self, exponent: u32) {
        if exponent != self.exponent {
            (self.exponent, self.number) = (exponent, Integer::from(self.prime).pow(exponent));
        }
    }

    /// The exponent in c, or that in the denominator if it is smaller; from a residue of c modulo a multiple of the probe.
    fn common(&self, c: &Integer, residue: &Integer) -> u32 {
        if self.prime == 2 {
            return c.find_one(0).unwrap_or(0).min(self.exponent);
        }
        let (mut last, mut exponent) = (residue.mod_u(self.probe), 0);
        if last == 0 {
            if self.probe.ilog(self.prime) >= self.exponent {
                return self.exponent;
            }
            // The common power can be long, but no longer than the one in the denominator.
            let mut rest = Integer::from(c % &self.number);
            if rest.is_zero() {
                return self.exponent;
            }
            while last == 0 {
                rest.div_exact_u_mut(self.probe);
                exponent += self.probe.ilog(self.prime);
                last = rest.mod_u(self.probe);
            }
        }
        while last.is_multiple_of(self.prime) {
            last /= self.prime;
            exponent += 1;
        }
        exponent.min(self.exponent)
    }
}

fn probes(powers: &[Power]) -> Integer {
    powers.iter().map(|power| Integer::from(power.probe)).product()
}

/// The product of powers of primes.
fn product(powers: impl Iterator<Item = (u32, u32)>) -> Integer {
    powers.filter(|(_, exponent)| *exponent > 0).fold(
        Integer::from(1),
        |product, (prime, exponent)| match prime.checked_pow(exponent) {
            Some(small) => product * small,
            None => product * Integer::from(Integer::u_pow_u(prime, exponent)),
        },
    )
}

impl Denominator {
    /// `largest` bounds the primes that are looked for, by divisors in ascending order: what divides when its own divisors are
    /// taken out is a prime.
    pub(crate) fn new(number: Integer, largest: u32) -> Self {
        let (mut rest, mut powers) = (number.clone(), Vec::new());
        for d in 2..=largest {
            if rest.is_divisible_u(d) {
                powers.push(Power::new(d, rest.remove_factor_mut(&Integer::from(d))));
            }
        }
        Self { number, probes: probes(&powers), powers, rest }
    }

    pub(crate) fn number(&self) -> &Integer {
        &self.number
    }

    /// The greatest common divisor with c, which is not zero.
    fn common(&self, c: &Integer) -> Integer {
        let residue = Integer::from(c.modulo_ref(&self.probes));
        let exponents = self.powers.iter().map(|power| (power.prime, power.common(c, &residue)));
        let common = product(exponents);
        if self.rest == 1 { common } else { common * Integer::from(self.rest.gcd_ref(c)) }
    }

    /// Divides both by what the denominator and all of the numbers have in common.
    pub(crate) fn divide_by_common<'a>(&mut self, numbers: impl Iterator<Item = &'a mut Integer>) {
        let numbers: Vec<&mut Integer> = numbers.collect();
        let (mut left, mut rest) = (self.powers.clone(), self.rest.clone());
        let mut known = self.probes.clone();
        for c in numbers.iter().filter(|c| !c.is_zero()) {
            let (residue, count) = (Integer::from(c.modulo_ref(&known)), left.len());
            left.iter_mut().for_each(|power| power.lower(power.common(c, &residue)));
            left.retain(|power| power.exponent > 0);
            if left.len() < count {
                known = probes(&left);
            }
            if rest != 1 {
                rest.gcd_mut(c);
            }
            if left.is_empty() && rest == 1 {
                return;
            }
        }
        let common = product(left.iter().map(|power| (power.prime, power.exponent))) * &rest;
        numbers.into_iter().for_each(|c| c.div_exact_mut(&common));
        self.number.div_exact_mut(&common);
        self.rest.div_exact_mut(&rest);
        for power in &mut self.powers {
            let shared = left.iter().find(|other| other.prime == power.prime);
            power.lower(power.exponent - shared.map_or(0, |shared| shared.exponent));
        }
        self.powers.retain(|power| power.exponent > 0);
        self.probes = probes(&self.powers);
    }

    /// c over the number as numerator and denominator in lowest terms; nothing for zero.
    pub(crate) fn lowest(&self, c: Integer) -> Option<(Integer, Integer)> {
        if c.is_zero() {
            return None;
        }
        let common = self.common(&c);
        if common == 1 {
            return Some((c, self.number.clone()));
        }
        Some((c.div_exact(&common), Integer::from(self.number.div_exact_ref(&common))))
    }

    /// Coprime factors of the number, each of some words, and what is left.
    pub(crate) fn factors(&self) -> Vec<Integer> {
        let (mut factors, mut last) = (Vec::new(), Integer::from(1));
        for power in &self.powers {
            last *= &power.number;
            if last.significant_bits() > FACTOR_BITS {
                factors.push(std::mem::replace(&mut last, Integer::from(1)));
            }
        }
        factors.extend([last, self.rest.clone()]);
        factors.retain(|factor| *factor != 1);
        factors
    }
}

/// c over a product of coprime factors. A divisor common with a short factor costs a division; with a number as long as
/// c it costs many.
pub(crate) fn over(c: Integer, factors: &[Integer]) -> Rational {
    factors.iter().fold(Rational::from(c), |value, q| value / q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_in_lowest_terms() {
        let number = Integer::from(Integer::u_pow_u(2, 3000))
            * Integer::from(Integer::u_pow_u(6, 40))
            * Integer::from(Integer::u_pow_u(1_000_003, 3));
        for largest in [2, 3, 60] {
            let denominator = Denominator::new(number.clone(), largest);
            let factors = denominator.factors();
            assert_eq!(factors.iter().product::<Integer>(), number);
            for c in [0, -1, 12, 1_000_003 * 18, 5, -(1i64 << 40), 59_049, 3i64.pow(25)] {
                let c = Integer::from(c);
                let expected = Rational::from((c.clone(), number.clone()));
                assert_eq!(over(c.clone(), &factors), expected, "{largest} {c}");
                let lowest = denominator.lowest(c.clone());
                let expected = (!c.is_zero()).then(|| expected.into_numer_denom());
                assert_eq!(lowest, expected, "{largest} {c}");
            }
        }
    }

    /// 3^10 and 5^6 are the probes: a power as long as that, and one factor more or less in either number.
    #[test]
    fn powers_beside_their_probes() {
        for (p, probe) in [(3, 10), (5, 6)] {
            for (own, other) in (probe - 1..=probe + 2).flat_map(|k| [(k, probe), (k, probe + 1)]) {
                let [number, c] = [own, other].map(|k| Integer::from(Integer::u_pow_u(p, k)));
                let lowest = Denominator::new(number.clone(), 5).lowest(c.clone());
                let expected = Rational::from((c, number)).into_numer_denom();
                assert_eq!(lowest, Some(expected), "{p}^{other}/{p}^{own}");
            }
        }
    }

    #[test]
    fn what_all_have_in_common_is_divided_out() {
        let number = Integer::from(36 * 1_000_003);
        for (numbers, common) in [
            (vec![0, 24, -36], 12),
            (vec![9, 4], 1),
            (vec![2 * 1_000_003, 0, 1_000_003 * 1_000_003], 1_000_003),
            (vec![0], 36 * 1_000_003),
        ] {
            let numbers: Vec<Integer> =
                numbers.into_iter().map(|n: i64| Integer::from(n)).collect();
            let mut denominator = Denominator::new(number.clone(), 5);
            let mut divided = numbers.clone();
            denominator.divide_by_common(divided.iter_mut());
            assert_eq!(denominator.number().clone() * common, number);
            assert_eq!(denominator.factors().iter().product::<Integer>(), *denominator.number());
            for (small, large) in divided.iter().zip(&numbers) {
                assert_eq!(Integer::from(small * common), *large);
                let lowest = denominator.lowest(small.clone()).map(Rational::from);
                let expected = Rational::from((large, &number));
                assert_eq!(lowest.unwrap_or_default(), expected);
            }
        }
    }
}
