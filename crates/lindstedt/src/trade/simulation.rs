//! The competitor: the period from the equation in the time domain.

use super::found::Found;
use crate::Error;
use crate::evaluate::turn::TimeDomain;
use lindstedt_algebra::Stop;
use lindstedt_simulate::{Digits, Doubles, Real};
use rug::Float;

/// The second run, which tells the error of the first, has so many digits less.
const LESS: u32 = 3;

pub(super) fn in_doubles(
    motion: &TimeDomain<'_>,
    digits: u32,
    stop: &Stop,
) -> Result<Found, Error> {
    both(motion, (Doubles, Doubles), digits, stop)
}

pub(super) fn in_digits(motion: &TimeDomain<'_>, digits: u32, stop: &Stop) -> Result<Found, Error> {
    let less = Digits::for_digits(digits.saturating_sub(LESS).max(4));
    both(motion, (Digits::for_digits(digits), less), digits, stop)
}

/// Two runs: the result of the finer, four times the difference as its error (which is that of
/// the coarser one), and the rounding errors of some hundred steps.
fn both<R: Real>(
    motion: &TimeDomain<'_>,
    (fine, coarse): (R, R),
    digits: u32,
    stop: &Stop,
) -> Result<Found, Error> {
    let bits = fine.bits();
    let period = motion.turn(&fine, digits, stop)?.period;
    let other = motion.turn(&coarse, digits.saturating_sub(LESS).max(4), stop)?.period;
    let difference = Float::with_val(53, &period - &other).abs() * 4u32;
    let rounding = (Float::with_val(53, period.abs_ref()) * 64u32) >> (bits - 1);
    let step = Float::with_val(53, period.abs_ref())
        * Float::with_val(53, Float::i_pow_u(10, digits)).recip();
    // Two states and some ten operations of the equation, each a Taylor polynomial.
    let order = 1.15 * f64::from(digits) + 4.0;
    let value = if bits <= 53 { 8 } else { bits / 8 + 32 };
    let bytes = (order * 12.0) as u64 * u64::from(value);
    let (summation, seconds, again) = (None, 0.0, 0.0);
    Ok(Found { summation, seconds, again, bytes, period, error: difference + rounding + step })
}
