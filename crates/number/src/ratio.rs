//! Exact numbers as `num_rational` has them, for programs that compute with those.
//!
//! The conversions copy the digits, O(length); both forms are in lowest terms with a positive
//! denominator.

use crate::Exact;
use num_bigint::{BigInt, Sign};
use num_rational::Ratio;
use rug::integer::Order;
use rug::{Integer, Rational};

/// The number as a fraction of `num_rational`.
///
/// ```
/// use lindstedt_number::{from_ratio, to_ratio};
/// use num_bigint::BigInt;
/// use num_rational::Ratio;
/// use rug::Rational;
///
/// let third = to_ratio(&Rational::from((-1, 3)));
/// assert_eq!(third, Ratio::new(BigInt::from(-1), BigInt::from(3)));
/// assert_eq!(from_ratio(&(third.clone() * third)), Rational::from((1, 9)));
/// ```
#[must_use]
pub fn to_ratio(q: &Rational) -> Ratio<BigInt> {
    Ratio::new_raw(to_big(q.numer()), to_big(q.denom()))
}

/// The number of a fraction of `num_rational`; a denominator of 0, which only
/// [`Ratio::new_raw`] makes, is read as 1.
#[must_use]
pub fn from_ratio(ratio: &Ratio<BigInt>) -> Rational {
    let (numerator, denominator) = (from_big(ratio.numer()), from_big(ratio.denom()));
    if denominator.is_zero() {
        Rational::from(numerator)
    } else {
        Rational::from((numerator, denominator))
    }
}

fn to_big(n: &Integer) -> BigInt {
    let sign = if n.is_negative() { Sign::Minus } else { Sign::Plus };
    BigInt::from_slice(sign, &n.to_digits::<u32>(Order::Lsf))
}

fn from_big(n: &BigInt) -> Integer {
    let (sign, digits) = n.to_u32_digits();
    let size = Integer::from_digits(&digits, Order::Lsf);
    if sign == Sign::Minus { -size } else { size }
}

impl From<Ratio<BigInt>> for Exact {
    fn from(ratio: Ratio<BigInt>) -> Self {
        Self::Rational(from_ratio(&ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::ops::Pow;

    /// Against the decimal text that either library writes, over signs and lengths of digits.
    #[test]
    fn there_and_back() {
        for power in [0u32, 1, 31, 32, 33, 63, 64, 65, 1000] {
            for (above, below) in [(-1, 3), (1, 1), (0, 7), (-5, 2), (1, 1_000_003)] {
                let size = Integer::from(2).pow(power);
                let q = Rational::from((size * above + above, below));
                let ratio = to_ratio(&q);
                assert_eq!(ratio.to_string(), q.to_string());
                assert_eq!(ratio, Ratio::new(ratio.numer().clone(), ratio.denom().clone()));
                assert_eq!(from_ratio(&ratio), q);
                assert_eq!(Exact::from(ratio), Exact::from(q));
            }
        }
        assert_eq!(from_ratio(&Ratio::new_raw(BigInt::from(2), BigInt::from(0))), 2);
    }
}
