//! Integrals of powers of l = -ln|cos t| over [0, x] and of -ln sin v over [0, y].
//!
//! Both follow from a substitution that turns all powers into one hypergeometric series with
//! positive terms and rational coefficients, cheap for all m <= M at once. No zeta values, no
//! products of power series.
//!
//! # From 0: w = sin^2 t
//!
//! cos^-s t = (1 - w)^(-s/2) generates the powers, cos^-s = sum_m s^m l^m / m!. With u = sin t,
//! dt = du (1 - u^2)^(-1/2) and the binomial series,
//!
//!   int_0^x cos^-s t dt = sum_n A_n(s) S^(2n+1) / (2n+1),   S = sin x,
//!   A_n(s) = ((1+s)/2)_n / n!,   A_(n+1) = A_n (2n+1+s) / (2n+2).
//!
//! The coefficient of s^m is the integral of l^m/m!. All coefficients of A_n are at least 0 and
//! their sum is A_n(1) = 1, so each is at most 1 and the terms from N on are together at most
//! S^(2N+1) / ((2N+1)(1 - S^2)). The series for l^m begins at n = m.
//!
//! # From the pole: c = sin v
//!
//! With c = sin v, C = sin y and B_n = binom(2n, n)/4^n <= 1,
//!
//!   int_0^y (-ln sin v)^m / m! dv = sum_n B_n int_0^C c^(2n) (-ln c)^m / m! dc
//!                                 = sum_(r=0)^m (-ln C)^r / r!  D_(m-r+1),
//!   D_q = sum_n B_n C^(2n+1) / (2n+1)^q,
//!
//! and the terms of D_q from N on are together at most C^(2N+1) / (1 - C^2).
//!
//! For |x| <= pi/4 and y <= pi/4 the ratio of both series is at most 1/2.

use lindstedt_number::ball::{Ball, Balls};
use rug::Float;

/// Ratios above this mean that the reduced argument is not known well enough to sum the series.
const LARGEST_RATIO: f64 = 0.6;
/// Bits of a truncation bound.
const COARSE_BITS: u32 = 53;
/// Terms that have become small are computed to no fewer bits than this.
const LEAST_BITS: u32 = 32;

/// int_0^x l^m/m! dt for m = 0..=max_m, where 0 < x <= pi/4 is known by its sine.
///
/// Error: rounding about 4 N ulp of the first terms, truncation as above, both in the radius.
/// Cost: N = (bits / -log2 sin^2 x) steps with max_m + 1 products each.
pub(super) fn from_zero(sine: &Ball, max_m: usize, balls: Balls) -> Vec<Ball> {
    let Some(series) = Series::new(sine, max_m, balls) else {
        return vec![balls.indeterminate(); max_m + 1];
    };
    let mut sums = vec![balls.zero(); max_m + 1];
    // power[m] = [s^m] A_n(s) S^(2n+1).
    let mut power = vec![balls.zero(); max_m + 1];
    if let Some(first) = power.first_mut() {
        *first = sine.clone();
    }
    for n in 0..series.terms {
        let work = series.context(n);
        let ratio = work.round(&series.ratio);
        let odd = 2 * n + 1;
        let mut before = work.zero();
        for (sum, entry) in sums.iter_mut().zip(&mut power) {
            if let Some(term) = work.div_i64(entry, odd) {
                *sum = balls.add(sum, &term);
            }
            let grown = work.add(&work.mul_i64(entry, odd), &before);
            let next = work.div_i64(&work.mul(&grown, &ratio), odd + 1);
            before = std::mem::replace(entry, next.unwrap_or_else(|| work.indeterminate()));
        }
    }
    sums.iter().map(|sum| balls.add_error(sum, &series.tail)).collect()
}

/// int_0^y (-ln sin v)^m/m! dv for m = 0..=max_m, where 0 < y <= pi/4 is known by its sine.
///
/// Error as for [`from_zero`]. Cost: N steps with one product and max_m + 1 divisions by small
/// integers each.
pub(super) fn from_pole(sine: &Ball, max_m: usize, balls: Balls) -> Vec<Ball> {
    let (Some(series), Some(log)) = (Series::new(sine, 0, balls), balls.ln(sine)) else {
        return vec![balls.indeterminate(); max_m + 1];
    };
    // weights[q - 1] = D_q.
    let mut weights = vec![balls.zero(); max_m + 1];
    let mut power = sine.clone();
    for n in 0..series.terms {
        let work = series.context(n);
        let odd = 2 * n + 1;
        let mut term = work.round(&power);
        for weight in &mut weights {
            term = work.div_i64(&term, odd).unwrap_or_else(|| work.indeterminate());
            *weight = balls.add(weight, &term);
        }
        let grown = work.mul_i64(&work.mul(&power, &work.round(&series.ratio)), odd);
        power = work.div_i64(&grown, odd + 1).unwrap_or_else(|| work.indeterminate());
    }
    let weights: Vec<Ball> = weights.iter().map(|d| balls.add_error(d, &series.tail)).collect();
    combine(&weights, &balls.neg(&log), balls)
}

/// I_m = sum_(r=0)^m l^r/r! D_(m-r+1), by I_m = D_(m+1) + shifted sum, for all m.
fn combine(weights: &[Ball], log: &Ball, balls: Balls) -> Vec<Ball> {
    // powers[r] = l^r / r!.
    let mut powers = vec![balls.one()];
    for r in 1..weights.len() {
        let next = powers.last().map(|last| balls.mul(last, log));
        let divisor = i64::try_from(r).unwrap_or(i64::MAX);
        powers.extend(next.and_then(|next| balls.div_i64(&next, divisor)));
    }
    (1..=weights.len())
        .map(|count| {
            let pairs = powers.iter().zip(weights.iter().take(count).rev());
            pairs.fold(balls.zero(), |sum, (l, d)| balls.add(&sum, &balls.mul(l, d)))
        })
        .collect()
}

/// The common part of both series: ratio W = S^2, number of terms, precision of each, truncation.
struct Series {
    ratio: Ball,
    terms: i64,
    /// Bits gained per term: at most -log2 W.
    bits_per_term: f64,
    /// Terms before the first that counts; they are computed to full precision.
    leading: i64,
    tail: Float,
    balls: Balls,
}

impl Series {
    /// `None` if the argument is not known to be positive and small enough.
    fn new(sine: &Ball, leading: usize, balls: Balls) -> Option<Self> {
        let ratio = balls.square(sine);
        let largest = ratio.abs_upper();
        if !sine.is_positive() || largest > LARGEST_RATIO {
            return None;
        }
        // log2 in two parts: an f64 alone would underflow for tiny arguments.
        let (mantissa, exponent) = largest.to_f64_exp();
        let bits_per_term = -(mantissa.log2() + f64::from(exponent)) * (1.0 - 1e-12);
        let leading = i64::try_from(leading).ok()?;
        let needed = (f64::from(balls.bits()) / bits_per_term).ceil() + 2.0;
        let terms = (needed as i64).checked_add(leading)?;
        // S W^N / (1 - W), a bound for both tails; W < 0.6.
        let coarse = Balls::new(COARSE_BITS);
        let power = coarse.mul(&coarse.powi(&ratio, terms)?, sine);
        let tail = coarse.div(&power, &coarse.sub(&coarse.one(), &ratio))?.abs_upper();
        Some(Self { ratio, terms, bits_per_term, leading, tail, balls })
    }
    /// The term n is W^(n - leading) times smaller than the sum: it needs that many bits less.
    fn context(&self, n: i64) -> Balls {
        let gained = (n - self.leading).max(0) as f64 * self.bits_per_term;
        let needed = f64::from(self.balls.bits()) - gained;
        Balls::new((needed.max(0.0) as u32).saturating_add(LEAST_BITS))
    }
}
