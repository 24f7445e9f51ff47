//! Doubles rounded away from the truth: upper bounds of nonnegative numbers.
//!
//! Every operation rounds up: the nearest double is followed by the next one. Long sums of
//! nonnegative terms are formed in any order and raised once ([`raised`]).

use rug::float::Round;
use rug::{Float, Rational};
use std::iter::Sum;
use std::ops::{Add, Mul};

/// Half the distance from 1 to the next double: the relative error of one rounded operation.
pub(crate) const UNIT: f64 = f64::EPSILON / 2.0;

/// An upper bound of a nonnegative number.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(crate) struct Up(pub(crate) f64);

impl Up {
    pub(crate) const ZERO: Self = Self(0.0);
    pub(crate) const ONE: Self = Self(1.0);

    /// |q| rounded up.
    pub(crate) fn of(q: &Rational) -> Self {
        // `to_f64` truncates.
        let size = q.to_f64().abs();
        if *q == size || *q == -size { Self(size) } else { Self(size.next_up()) }
    }

    /// |x| rounded up.
    pub(crate) fn of_float(x: &Float) -> Self {
        Self(x.to_f64_round(Round::AwayZero).abs())
    }

    pub(crate) fn max(self, other: Self) -> Self {
        // NaN must not be lost.
        if self.0 > other.0 || self.0.is_nan() { self } else { other }
    }

    /// self / d for a lower bound d > 0 of the denominator.
    pub(crate) fn over(self, lower: f64) -> Self {
        Self((self.0 / lower).next_up())
    }

    /// e^self - 1.
    pub(crate) fn exponential_less_one(self) -> Self {
        Self::of_float(
            &Float::with_val_round(53, Float::with_val(53, self.0).exp_m1_ref(), Round::Up).0,
        )
    }

    pub(crate) fn powi(self, n: u32) -> Self {
        (0..n).fold(Self::ONE, |power, _| power * self)
    }
}

impl Add for Up {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let exact = self.0 == 0.0 || other.0 == 0.0;
        let sum = self.0 + other.0;
        Self(if exact { sum } else { sum.next_up() })
    }
}

impl Mul for Up {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.0 == 0.0 || other.0 == 0.0 {
            // 0 times an infinite bound is an infinite bound.
            return Self(if self.0 + other.0 < f64::INFINITY { 0.0 } else { f64::NAN });
        }
        let exact = self.0 == 1.0 || other.0 == 1.0;
        let product = self.0 * other.0;
        Self(if exact { product } else { product.next_up() })
    }
}

impl Sum for Up {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::ZERO, |a, b| a + b)
    }
}

/// gamma_n = n u/(1 - n u), rounded up: a sum of n products formed in doubles, in any order, with
/// or without fused operations, differs from the truth by at most gamma_n times the sum of the
/// absolute values of the products (Higham, Accuracy and Stability of Numerical Algorithms, 3.1).
pub(crate) fn gamma(n: usize) -> Up {
    let nu = n as f64 * UNIT;
    Up((nu / (1.0 - nu)).next_up().next_up())
}

/// An upper bound of a sum of at most `terms` nonnegative products, from its value in doubles.
/// What underflows is below the second summand.
pub(crate) fn raised(sum: f64, terms: usize) -> Up {
    Up(sum) * (Up::ONE + gamma(terms + 2)) + Up(f64::MIN_POSITIVE) * Up(terms as f64)
}
