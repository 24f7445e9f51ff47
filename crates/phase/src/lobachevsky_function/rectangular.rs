//! The integral of l alone: the two series of [`super::integrals`] for m = 1, by rectangular
//! splitting in fixed point.
//!
//! With b_n = binom(2n, n)/4^n and O_n = 1 + 1/3 + ... + 1/(2n-1),
//!
//!   int_0^x l dt = S sum_(n>=1) b_n O_n/(2n+1) S^(2n),                  S = sin x,
//!   int_0^y -ln sin v dv = -y ln C + C sum_(n>=0) b_n/(2n+1)^2 C^(2n),  C = sin y,
//!
//! the second because sum_n b_n C^(2n+1)/(2n+1) = arcsin C = y. Of N terms, those with the same n
//! modulo k are summed with the factor W^(k j), W = S^2, j = floor(n/k), carried along; so N/k + 2k
//! products of full length and N multiplications and divisions by machine words remain
//! (concurrent summation: D. M. Smith, Math. Comp. 52 (1989) 131).

use lindstedt_number::ball::{Ball, Balls};
use rug::float::Round;
use rug::{Float, Integer};

/// As in [`super::integrals`].
const LARGEST_RATIO: f64 = 0.6;
/// Bits beyond those asked for: the error is below (7 N + 20) units, N < bits.
const GUARD_BITS: u32 = 12;

/// int_0^x l dt for 0 < x <= pi/4, known by its sine.
pub(super) fn from_zero(sine: &Ball, balls: Balls) -> Ball {
    // W S sum_(n>=0) b_(n+1) O_(n+1)/(2n+3) W^n: the first factor keeps the relative accuracy.
    let ratio = balls.square(sine);
    match sum(&ratio, balls, Coefficients::OddHarmonic) {
        Some(sum) => balls.mul(&balls.mul(&sum, &ratio), sine),
        None => balls.indeterminate(),
    }
}

/// int_0^y -ln sin v dv for 0 < y <= pi/4 and its sine.
pub(super) fn from_pole(y: &Ball, sine: &Ball, balls: Balls) -> Ball {
    let sum = sum(&balls.square(sine), balls, Coefficients::InverseSquare);
    let (Some(sum), Some(log)) = (sum, balls.ln(sine)) else { return balls.indeterminate() };
    balls.sub(&balls.mul(&sum, sine), &balls.mul(y, &log))
}

/// The coefficients c_n, all positive and at most 1.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Coefficients {
    /// b_(n+1) O_(n+1)/(2n+3).
    OddHarmonic,
    /// b_n/(2n+1)^2.
    InverseSquare,
}

/// sum_(n>=0) c_n W^n, for 0 < W < 0.6.
///
/// In units of 2^-p, with w = floor(W 2^p): carried are t = b W^(k j) and u = b O W^(k j), the
/// sequences of the coefficients without their denominators. A step rounds t and u once and a
/// new row once more, with a power of w that is wrong by at most 1/(1 - W) <= 2.5 units; factors
/// are at most 1. So t and u are wrong by less than 6 (n + 1) units, their quotients by 2n + 1 or
/// more by less than 7, all sums together by 7 N, and Horner's rule adds 2.5. The ball of W counts
/// with the derivative, at most 1/(1 - W)^2 <= 6.25; the terms from N on are at most
/// W^N/(1 - W).
fn sum(ratio: &Ball, balls: Balls, coefficients: Coefficients) -> Option<Ball> {
    let largest = ratio.abs_upper();
    if !ratio.is_positive() || largest > LARGEST_RATIO {
        return None;
    }
    let bits = balls.bits() + GUARD_BITS + balls.bits().ilog2();
    let (mantissa, exponent) = largest.to_f64_exp();
    let per_term = -(mantissa.log2() + f64::from(exponent)) * (1.0 - 1e-12);
    let terms = (f64::from(bits) / per_term).ceil() as u32 + 2;
    let w = fixed(ratio.midpoint(), bits)?;
    // A unit for the rounding of w, one for that of the radius.
    let spread = fixed(ratio.radius(), bits)? + 2u32;
    let width = f64::from(terms).sqrt().ceil() as u32;
    let one = Integer::from(1) << bits;
    let mut power = one.clone();
    for _ in 0..width {
        power *= &w;
        power >>= bits;
    }
    let odd_harmonic = coefficients == Coefficients::OddHarmonic;
    // b_0 = 1; b_1 = 1/2, O_1 = 1.
    let mut t = if odd_harmonic { Integer::from(&one >> 1u32) } else { one };
    let mut u = if odd_harmonic { t.clone() } else { Integer::new() };
    let mut columns = vec![Integer::new(); width as usize];
    let mut n = 0u32;
    let mut term = Integer::new();
    while n < terms {
        for column in &mut columns {
            if odd_harmonic {
                // b_(k+1) = b_k (2k+1)/(2k+2), O_(k+1) = O_k + 1/(2k+1); k = n + 1.
                rug::Assign::assign(&mut term, &u / (2 * n + 3));
                *column += &term;
                u *= 2 * n + 3;
                u += &t;
                u /= 2 * n + 4;
                t *= 2 * n + 3;
                t /= 2 * n + 4;
            } else {
                rug::Assign::assign(&mut term, &t / (2 * n + 1));
                term /= 2 * n + 1;
                *column += &term;
                t *= 2 * n + 1;
                t /= 2 * n + 2;
            }
            n += 1;
        }
        t *= &power;
        t >>= bits;
        if odd_harmonic {
            u *= &power;
            u >>= bits;
        }
    }
    let mut sum = Integer::new();
    for column in columns.iter().rev() {
        sum *= &w;
        sum >>= bits;
        sum += column;
    }
    // n >= terms terms were summed.
    let error = Integer::from(7u32) * n + 20u32 + spread * 7u32;
    let coarse = Balls::new(53);
    let tail = coarse.powi(ratio, i64::from(n))?.abs_upper() * 3u32;
    let scale = |x: &Integer, bits: u32, round| Float::with_val_round(bits, x, round).0;
    let shift = i32::try_from(bits).ok()?;
    let middle = scale(&sum, bits + 8, Round::Nearest) >> shift;
    let radius = (scale(&error, 53, Round::Up) >> shift) + tail * 1.000_001f64;
    Some(balls.from_parts(&middle, &(radius * 1.000_001f64)))
}

/// floor(x 2^bits) for 0 <= x < 1.
fn fixed(x: &Float, bits: u32) -> Option<Integer> {
    let shift = i32::try_from(bits).ok()?;
    let scaled = Float::with_val(x.prec(), x << shift);
    scaled.to_integer_round(Round::Down).map(|(integer, _)| integer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobachevsky_function::integrals;
    use rug::Rational;

    /// The series in balls, term by term, on arguments from tiny to pi/4 and at all sizes.
    #[test]
    fn both_ways_to_sum_agree() {
        for bits in [24u32, 64, 100, 333, 1000, 4000] {
            let balls = Balls::new(bits);
            for (p, q) in [(1, 3), (7, 10), (1, 1000), (78, 100), (785, 1000), (1, i32::MAX)] {
                let y = balls.from_rational(&Rational::from((p, q)));
                let sine = balls.sin(&y);
                let pairs = [
                    (from_zero(&sine, balls), integrals::from_zero(&sine, 1, balls)),
                    (from_pole(&y, &sine, balls), integrals::from_pole(&sine, 1, balls)),
                ];
                for (fast, slow) in pairs {
                    let slow = &slow[1];
                    assert!(fast.overlaps(slow), "{bits} {p}/{q}: {fast:?} {slow:?}");
                    let accuracy = fast.relative_accuracy_bits();
                    assert!(accuracy >= i64::from(bits) - 8, "{bits} {p}/{q}: {accuracy}");
                }
            }
        }
    }

    /// At low precision the ball contains the value of a high one.
    #[test]
    fn values_are_enclosed() {
        let fine = Balls::new(700);
        for bits in 20..120 {
            let balls = Balls::new(bits);
            let x = Rational::from((bits * 785, 120_000));
            let enclosed = |coarse: Ball, truth: Ball| {
                let low = coarse.lower() <= truth.upper();
                assert!(low && coarse.upper() >= truth.lower(), "{bits}: {coarse:?}");
            };
            let (y, exact) = (balls.from_rational(&x), fine.from_rational(&x));
            let slow = |m: Vec<Ball>| m[1].clone();
            let sine = fine.sin(&exact);
            enclosed(from_zero(&balls.sin(&y), balls), slow(integrals::from_zero(&sine, 1, fine)));
            enclosed(
                from_pole(&y, &balls.sin(&y), balls),
                slow(integrals::from_pole(&sine, 1, fine)),
            );
        }
    }

    #[test]
    fn arguments_outside_have_no_digits() {
        let balls = Balls::new(100);
        assert!(!from_zero(&balls.one(), balls).is_finite());
        assert!(!from_zero(&balls.zero(), balls).is_finite());
        assert!(!from_zero(&balls.indeterminate(), balls).is_finite());
    }
}
