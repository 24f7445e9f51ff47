//! Primes below 2^30 and roots of unity modulo them.

/// Every prime is above this.
pub(super) const SMALLEST: u64 = 1 << 28;
/// Bases that decide the primality of any number below 4 759 123 141 (G. Jaeschke, Math. Comp. 61 (1993) 915).
const BASES: [u64; 3] = [2, 7, 61];

/// The primes below 2^30 that are 1 modulo `modulus`, descending.
pub(super) fn one_modulo(modulus: u64) -> impl Iterator<Item = u32> {
    let start = ((1 << 30) - 2) / modulus * modulus + 1;
    let candidates = (SMALLEST..=start).rev().step_by(modulus as usize);
    let odd = candidates.filter(|n| n % 2 == 1 && n % 3 != 0 && n % 5 != 0 && n % 7 != 0);
    odd.map(|n| n as u32).filter(|&n| is_prime(n))
}

/// a^n mod p.
pub(super) fn power(p: u32, a: u64, mut n: u64) -> u64 {
    let p = u64::from(p);
    let (mut result, mut square) = (1, a % p);
    while n > 0 {
        if n & 1 == 1 {
            result = result * square % p;
        }
        square = square * square % p;
        n >>= 1;
    }
    result
}

/// Whether an odd number above 61 is prime: the strong test to bases that no composite number of 32 bits passes.
fn is_prime(n: u32) -> bool {
    let top = u64::from(n) - 1;
    let twos = top.trailing_zeros();
    BASES.iter().all(|&base| {
        let mut value = power(n, base, top >> twos);
        let mut passes = value == 1 || value == top;
        for _ in 1..twos {
            value = value * value % u64::from(n);
            passes |= value == top;
        }
        passes
    })
}

/// A number of exact multiplicative order n modulo p, for n that divides p - 1.
pub(super) fn root_of_unity(p: u32, n: u64) -> Option<u32> {
    let divisors = (2..=n).filter(|q| n.is_multiple_of(*q));
    let prime_factors: Vec<u64> =
        divisors.filter(|q| (2..*q).take_while(|r| r * r <= *q).all(|r| q % r != 0)).collect();
    (2u64..1000)
        .map(|base| power(p, base, (u64::from(p) - 1) / n))
        .find(|&root| prime_factors.iter().all(|q| power(p, root, n / q) != 1))
        .map(|root| root as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::Integer;

    /// Against a test that shares nothing with this one.
    #[test]
    fn primes_are_prime_and_none_is_left_out() {
        let (modulus, count) = (8 * 21, 40);
        let start = (1u64 << 30) / modulus * modulus + 1;
        let expected = (SMALLEST..=start)
            .rev()
            .step_by(modulus as usize)
            .filter(|&n| Integer::from(n).is_probably_prime(40) != rug::integer::IsPrime::No);
        let found = one_modulo(modulus).map(u64::from);
        assert!(found.take(count).eq(expected.take(count)));
        // Strong pseudoprimes to the bases 2 and 7, 2 and 61, and the first three primes.
        for n in [314_821, 1_082_401, 25_326_001] {
            assert!(!is_prime(n), "{n}");
        }
    }
}
