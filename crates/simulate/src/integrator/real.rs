//! The real numbers of an integration: f64 or MPFR floats, behind one trait.
//!
//! The context value owns the precision; elements are bare. Operations write to a place that
//! exists already, so that the inner loops allocate nothing.

use super::{Integrator, Observer, Together};
use crate::error::SimulateError;
use crate::outcome::Outcome;
use rug::float::Constant;
use rug::{Float, Rational};
use std::fmt::Debug;

/// The operations of the recurrences: on the numbers of one integration, and on those of several side by side. They write
/// to a place that exists already.
pub trait Places {
    /// A number, or one for each.
    type Element: Clone + Debug;

    /// Zero.
    fn zero(&self) -> Self::Element;
    /// A number of 53 bits, rounded if the precision is less.
    fn double(&self, x: f64) -> Self::Element;
    /// -a.
    #[inline(always)]
    fn negative(&self, a: &Self::Element) -> Self::Element {
        let mut to = a.clone();
        self.times_integer(&mut to, -1);
        to
    }

    /// to = x.
    fn set(&self, to: &mut Self::Element, x: &Self::Element);
    /// to = 0.
    fn set_zero(&self, to: &mut Self::Element);
    /// to = a + b.
    fn add(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    /// to = a - b.
    fn subtract(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    /// to = a b.
    fn multiply(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    /// to = a/b.
    fn divide(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    /// to = to + a.
    fn increase(&self, to: &mut Self::Element, a: &Self::Element);
    /// to = to + a b.
    fn accumulate(&self, to: &mut Self::Element, a: &Self::Element, b: &Self::Element);
    /// to = to a.
    fn scale(&self, to: &mut Self::Element, a: &Self::Element);
    /// to = to n.
    fn times_integer(&self, to: &mut Self::Element, n: i32);
    /// to = to/n, n > 0.
    fn over_integer(&self, to: &mut Self::Element, n: u32);
    /// to = exp x.
    fn exp(&self, to: &mut Self::Element, x: &Self::Element);
    /// to = ln x.
    fn ln(&self, to: &mut Self::Element, x: &Self::Element);
    /// to = sin x.
    fn sin(&self, to: &mut Self::Element, x: &Self::Element);
    /// to = cos x.
    fn cos(&self, to: &mut Self::Element, x: &Self::Element);
    /// to = x^p for x > 0.
    fn power(&self, to: &mut Self::Element, x: &Self::Element, p: &Self::Element);

    /// to = sum_{j=0}^{n} a_j b_{n-j}, both slices of n + 1 numbers.
    fn convolve(&self, to: &mut Self::Element, a: &[Self::Element], b: &[Self::Element]) {
        self.set_zero(to);
        for (x, y) in a.iter().zip(b.iter().rev()) {
            self.accumulate(to, x, y);
        }
    }

    /// to = sum_{j=1}^{n} j a_j b_{n-j}; `a` has n + 1 numbers, `b` at least n.
    #[inline(always)]
    fn convolve_derivative(
        &self,
        to: &mut Self::Element,
        scratch: &mut Self::Element,
        a: &[Self::Element],
        b: &[Self::Element],
    ) {
        self.set_zero(to);
        let n = a.len().saturating_sub(1);
        for (j, (x, y)) in (1i32..).zip(a.iter().skip(1).zip(b.iter().take(n).rev())) {
            self.multiply(scratch, x, y);
            self.times_integer(scratch, j);
            self.increase(to, scratch);
        }
    }
}

/// Arithmetic at one precision. Every operation is correctly rounded or, for sums of products,
/// a chain of correctly rounded operations.
pub trait Real:
    Places<Element: PartialEq + PartialOrd + Send + Sync> + Clone + Debug + Send + Sync + Sized
{
    /// The precision in bits.
    fn bits(&self) -> u32;
    /// A rational, rounded to nearest.
    fn rational(&self, q: &Rational) -> Self::Element;
    /// A float of any precision, rounded to nearest.
    fn float(&self, x: &Float) -> Self::Element;
    /// The nearest f64.
    fn to_f64(&self, x: &Self::Element) -> f64;
    /// The number as a float of `bits()` bits; exact.
    fn to_float(&self, x: &Self::Element) -> Float;
    /// -1, 0 or 1; 0 for NaN.
    fn sign(&self, x: &Self::Element) -> i8;
    /// log2 |x| to about 1e-10, minus infinity at zero, NaN for what is not finite.
    fn log2(&self, x: &Self::Element) -> f64;

    /// [`Self::log2`] of the largest |x|; minus infinity of none, NaN where one of them is not finite.
    fn log2_of_largest<'e>(&self, list: impl Iterator<Item = &'e Self::Element>) -> f64
    where
        Self::Element: 'e,
    {
        let larger = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
        list.map(|x| self.log2(x)).fold(f64::NEG_INFINITY, larger)
    }

    /// a + b.
    fn sum(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
        let mut to = self.zero();
        self.add(&mut to, a, b);
        to
    }
    /// a - b.
    fn difference(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
        let mut to = self.zero();
        self.subtract(&mut to, a, b);
        to
    }
    /// a b.
    fn product(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
        let mut to = self.zero();
        self.multiply(&mut to, a, b);
        to
    }
    /// a/b.
    fn quotient(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
        let mut to = self.zero();
        self.divide(&mut to, a, b);
        to
    }
    /// |a|.
    fn absolute(&self, a: &Self::Element) -> Self::Element {
        if self.sign(a) < 0 { self.negative(a) } else { a.clone() }
    }
    /// pi.
    fn pi(&self) -> Self::Element {
        self.float(&Float::with_val(self.bits() + 8, Constant::Pi))
    }

    /// [`Integrator::advance`], compiled once for each arithmetic and not wherever one integrates.
    ///
    /// # Errors
    /// As there.
    fn advance(
        flow: &mut Integrator<'_, Self>,
        target: &Self::Element,
        observer: &mut Observer<'_, Self>,
    ) -> Result<Outcome, SimulateError>;

    /// The first step of [`Integrator::new`], likewise.
    ///
    /// # Errors
    /// As there.
    fn begin(flow: &mut Integrator<'_, Self>) -> Result<(), SimulateError>;

    /// So many integrations this arithmetic takes side by side.
    const LANES: usize = 1;

    /// Some integrations side by side, with the numbers that each has alone; nothing where they cannot be.
    fn together(_: &[&Integrator<'_, Self>]) -> Option<Box<dyn Together<Self>>> {
        None
    }
}

/// The arithmetic of f64.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Doubles;

impl Places for Doubles {
    type Element = f64;

    fn zero(&self) -> f64 {
        0.0
    }
    fn double(&self, x: f64) -> f64 {
        x
    }
    #[inline]
    fn set(&self, to: &mut f64, x: &f64) {
        *to = *x;
    }
    #[inline]
    fn set_zero(&self, to: &mut f64) {
        *to = 0.0;
    }
    #[inline]
    fn add(&self, to: &mut f64, a: &f64, b: &f64) {
        *to = a + b;
    }
    #[inline]
    fn subtract(&self, to: &mut f64, a: &f64, b: &f64) {
        *to = a - b;
    }
    #[inline]
    fn multiply(&self, to: &mut f64, a: &f64, b: &f64) {
        *to = a * b;
    }
    #[inline]
    fn divide(&self, to: &mut f64, a: &f64, b: &f64) {
        *to = a / b;
    }
    #[inline]
    fn increase(&self, to: &mut f64, a: &f64) {
        *to += a;
    }
    #[inline]
    fn accumulate(&self, to: &mut f64, a: &f64, b: &f64) {
        *to += a * b;
    }
    #[inline]
    fn scale(&self, to: &mut f64, a: &f64) {
        *to *= a;
    }
    #[inline]
    fn times_integer(&self, to: &mut f64, n: i32) {
        *to *= f64::from(n);
    }
    #[inline]
    fn over_integer(&self, to: &mut f64, n: u32) {
        *to /= f64::from(n);
    }
    fn exp(&self, to: &mut f64, x: &f64) {
        *to = x.exp();
    }
    fn ln(&self, to: &mut f64, x: &f64) {
        *to = x.ln();
    }
    fn sin(&self, to: &mut f64, x: &f64) {
        *to = x.sin();
    }
    fn cos(&self, to: &mut f64, x: &f64) {
        *to = x.cos();
    }
    fn power(&self, to: &mut f64, x: &f64, p: &f64) {
        *to = x.powf(*p);
    }
    /// Four partial sums: one chain of additions would wait for each result.
    #[inline]
    fn convolve(&self, to: &mut f64, a: &[f64], b: &[f64]) {
        let mut sums = [0.0; 4];
        let mut left = a.chunks_exact(4);
        let mut right = b.rchunks_exact(4);
        for (x, y) in left.by_ref().zip(right.by_ref()) {
            if let ([x0, x1, x2, x3], [y3, y2, y1, y0]) = (x, y) {
                sums[0] += x0 * y0;
                sums[1] += x1 * y1;
                sums[2] += x2 * y2;
                sums[3] += x3 * y3;
            }
        }
        let rest = left.remainder().iter().zip(right.remainder().iter().rev());
        let rest: f64 = rest.map(|(x, y)| x * y).sum();
        *to = (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest;
    }
}

impl Real for Doubles {
    fn advance(
        flow: &mut Integrator<'_, Self>,
        target: &f64,
        observer: &mut Observer<'_, Self>,
    ) -> Result<Outcome, SimulateError> {
        flow.advance_here(target, observer)
    }
    fn begin(flow: &mut Integrator<'_, Self>) -> Result<(), SimulateError> {
        flow.begin_here()
    }
    const LANES: usize = 8;
    fn together(flows: &[&Integrator<'_, Self>]) -> Option<Box<dyn Together<Self>>> {
        Integrator::side_by_side(flows)
    }

    fn bits(&self) -> u32 {
        53
    }
    fn rational(&self, q: &Rational) -> f64 {
        // to_f64 of a rational truncates.
        Float::with_val(53, q).to_f64()
    }
    fn float(&self, x: &Float) -> f64 {
        x.to_f64()
    }
    fn to_f64(&self, x: &f64) -> f64 {
        *x
    }
    fn to_float(&self, x: &f64) -> Float {
        Float::with_val(53, *x)
    }
    #[inline]
    fn sign(&self, x: &f64) -> i8 {
        i8::from(*x > 0.0) - i8::from(*x < 0.0)
    }
    #[inline]
    fn log2(&self, x: &f64) -> f64 {
        if x.is_infinite() { f64::NAN } else { x.abs().log2() }
    }
    /// One logarithm.
    #[inline]
    fn log2_of_largest<'e>(&self, list: impl Iterator<Item = &'e f64>) -> f64 {
        let larger =
            |a: f64, b: &f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b.abs()) };
        self.log2(&list.fold(0.0, larger))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digits::Digits;

    /// f64 and floats of 53 bits agree to rounding on sums of products of every length.
    #[test]
    fn convolutions() {
        let digits = Digits::with_bits(200);
        for n in 1..30 {
            let a: Vec<f64> = (0..n).map(|k| f64::from(k * k % 11) - 3.5).collect();
            let b: Vec<f64> = (0..n).map(|k| f64::from(k * 7 % 13) / 3.0).collect();
            let (mut fast, mut exact, mut scratch) = (0.0, digits.zero(), digits.zero());
            let lift = |v: &[f64]| v.iter().map(|x| digits.double(*x)).collect::<Vec<_>>();
            Doubles.convolve(&mut fast, &a, &b);
            digits.convolve(&mut exact, &lift(&a), &lift(&b));
            assert!((fast - exact.to_f64()).abs() < 1e-11);
            let direct: f64 = (0..n as usize).map(|j| a[j] * b[n as usize - 1 - j]).sum();
            assert!((fast - direct).abs() < 1e-11);
            Doubles.convolve_derivative(&mut fast, &mut 0.0, &a, &b);
            digits.convolve_derivative(&mut exact, &mut scratch, &lift(&a), &lift(&b));
            assert!((fast - exact.to_f64()).abs() < 1e-10);
        }
    }

    #[test]
    fn logarithms_of_any_size() {
        let digits = Digits::for_digits(50);
        let tiny = Float::with_val(digits.bits(), Float::i_exp(3, -100_000));
        assert!((digits.log2(&tiny) - (3f64.log2() - 100_000.0)).abs() < 1e-9);
        assert_eq!(digits.log2(&digits.zero()), f64::NEG_INFINITY);
        assert!((Doubles.log2(&0.375) - 0.375f64.log2()).abs() < 1e-15);
        // The largest of doubles is that of the same numbers as floats.
        let lists: [&[f64]; 6] = [
            &[],
            &[0.0, -0.0],
            &[1.0, -3.0, 2.5],
            &[f64::NAN, 1.0],
            &[1.0, f64::NAN],
            &[f64::NEG_INFINITY, 1.0],
        ];
        for list in lists {
            let floats: Vec<_> = list.iter().map(|x| digits.double(*x)).collect();
            let [fast, slow] =
                [Doubles.log2_of_largest(list.iter()), digits.log2_of_largest(floats.iter())];
            assert!(fast == slow || (fast - slow).abs() < 1e-15 || fast.is_nan() && slow.is_nan());
        }
    }
}
