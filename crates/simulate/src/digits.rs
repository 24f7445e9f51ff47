//! MPFR floats as real numbers.

use crate::error::SimulateError;
use crate::integrator::real::{Places, Real};
use crate::integrator::{Integrator, Observer};
use crate::outcome::Outcome;
use rug::{Float, Rational};

/// The arithmetic of MPFR floats with a fixed number of bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits {
    bits: u32,
}

impl Digits {
    /// Floats of `bits` bits (at least 2).
    #[must_use]
    pub fn with_bits(bits: u32) -> Self {
        Self { bits: bits.max(2) }
    }

    /// Floats for a result of `digits` decimal digits: 40 guard bits take the rounding errors of
    /// about 10^12 operations.
    #[must_use]
    pub fn for_digits(digits: u32) -> Self {
        Self::with_bits((f64::from(digits) * std::f64::consts::LOG2_10).ceil() as u32 + 40)
    }
}

impl Places for Digits {
    type Element = Float;

    fn zero(&self) -> Float {
        Float::new(self.bits)
    }
    fn double(&self, x: f64) -> Float {
        Float::with_val(self.bits, x)
    }
    fn set(&self, to: &mut Float, x: &Float) {
        to.clone_from(x);
    }
    fn set_zero(&self, to: &mut Float) {
        rug::Assign::assign(to, 0);
    }
    fn add(&self, to: &mut Float, a: &Float, b: &Float) {
        rug::Assign::assign(to, a + b);
    }
    fn subtract(&self, to: &mut Float, a: &Float, b: &Float) {
        rug::Assign::assign(to, a - b);
    }
    fn multiply(&self, to: &mut Float, a: &Float, b: &Float) {
        rug::Assign::assign(to, a * b);
    }
    fn divide(&self, to: &mut Float, a: &Float, b: &Float) {
        rug::Assign::assign(to, a / b);
    }
    fn increase(&self, to: &mut Float, a: &Float) {
        *to += a;
    }
    fn accumulate(&self, to: &mut Float, a: &Float, b: &Float) {
        *to += a * b;
    }
    fn scale(&self, to: &mut Float, a: &Float) {
        *to *= a;
    }
    fn times_integer(&self, to: &mut Float, n: i32) {
        *to *= n;
    }
    fn over_integer(&self, to: &mut Float, n: u32) {
        *to /= n;
    }
    fn exp(&self, to: &mut Float, x: &Float) {
        rug::Assign::assign(to, x.exp_ref());
    }
    fn ln(&self, to: &mut Float, x: &Float) {
        rug::Assign::assign(to, x.ln_ref());
    }
    fn sin(&self, to: &mut Float, x: &Float) {
        rug::Assign::assign(to, x.sin_ref());
    }
    fn cos(&self, to: &mut Float, x: &Float) {
        rug::Assign::assign(to, x.cos_ref());
    }
    fn power(&self, to: &mut Float, x: &Float, p: &Float) {
        rug::Assign::assign(to, rug::ops::Pow::pow(x, p));
    }
}

impl Real for Digits {
    fn advance(
        flow: &mut Integrator<'_, Self>,
        target: &Float,
        observer: &mut Observer<'_, Self>,
    ) -> Result<Outcome, SimulateError> {
        flow.advance_here(target, observer)
    }
    fn begin(flow: &mut Integrator<'_, Self>) -> Result<(), SimulateError> {
        flow.begin_here()
    }

    fn bits(&self) -> u32 {
        self.bits
    }
    fn rational(&self, q: &Rational) -> Float {
        Float::with_val(self.bits, q)
    }
    fn float(&self, x: &Float) -> Float {
        Float::with_val(self.bits, x)
    }
    fn to_f64(&self, x: &Float) -> f64 {
        x.to_f64()
    }
    fn to_float(&self, x: &Float) -> Float {
        x.clone()
    }
    fn sign(&self, x: &Float) -> i8 {
        x.cmp0().map_or(0, |order| order as i8)
    }
    fn log2(&self, x: &Float) -> f64 {
        if x.is_zero() {
            return f64::NEG_INFINITY;
        }
        // |x| = m 2^e with 1/2 <= m < 1; the exponent may be far outside of f64.
        x.get_exp().map_or(f64::NAN, |e| {
            let (mantissa, _) = x.to_f64_exp();
            mantissa.abs().log2() + f64::from(e)
        })
    }
}
