//! Points of the real line, given exactly, and their reduction modulo pi.

use lindstedt_number::ball::{Ball, Balls};
use rug::float::Round;
use rug::{Float, Integer, Rational};

/// Guard bits of the reduction: one division, one product and two differences are rounded.
const GUARD_BITS: u32 = 16;

/// A real number that is known exactly.
///
/// The second form exists because points near pi/2 matter and pi/2 - 10^-50 is not rational.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Point {
    /// The rational number q.
    Rational(Rational),
    /// pi q for a rational number q.
    PiTimes(Rational),
}

impl Point {
    /// The rational number that x is; `None` for NaN and infinities.
    #[must_use]
    pub fn from_f64(x: f64) -> Option<Self> {
        Rational::from_f64(x).map(Self::Rational)
    }
}

/// x = turns pi + offset, |offset| <= pi/2, complement = pi/2 - |offset|.
///
/// Both the offset and the complement have full relative accuracy, whichever is small. Exact
/// zeros are exact balls.
#[derive(Clone, Debug)]
pub(super) struct Reduced {
    pub turns: Integer,
    pub offset: Ball,
    pub complement: Ball,
}

impl Reduced {
    pub fn new(x: &Point, balls: Balls) -> Self {
        match x {
            Point::PiTimes(q) => reduce_turns(q, balls),
            Point::Rational(q) => reduce_rational(q, balls),
        }
    }
    /// Whether x is nearer to a multiple of pi than to a zero of the cosine.
    pub fn is_near_zero(&self) -> bool {
        self.offset.midpoint().cmp_abs(self.complement.midpoint())
            != Some(std::cmp::Ordering::Greater)
    }
    /// Whether x is an exact multiple of pi.
    pub fn is_zero(&self) -> bool {
        self.offset.is_exact() && self.offset.midpoint().is_zero()
    }
    /// Whether x is an exact odd multiple of pi/2.
    pub fn is_pole(&self) -> bool {
        self.complement.is_exact() && self.complement.midpoint().is_zero()
    }
    pub fn is_negative(&self) -> bool {
        self.offset.midpoint().is_sign_negative()
    }
    /// |cos x|, with full relative accuracy.
    pub fn abs_cosine(&self, balls: Balls) -> Ball {
        if self.is_near_zero() { balls.cos(&self.offset) } else { balls.sin(&self.complement) }
    }
}

/// pi q: the fractional part of q is exact, so nothing cancels.
fn reduce_turns(q: &Rational, balls: Balls) -> Reduced {
    let turns = Integer::from(q.round_ref());
    let offset = Rational::from(q - &turns);
    let complement = Rational::from((1, 2)) - Rational::from(offset.abs_ref());
    let pi = balls.pi();
    let times_pi = |f: &Rational| {
        if f.is_zero() { balls.zero() } else { balls.mul_rational(&pi, f) }
    };
    Reduced { offset: times_pi(&offset), complement: times_pi(&complement), turns }
}

/// q - n pi. The integer part costs as many bits as it has, and a point near a multiple of pi/2
/// costs the bits that cancel; both are found by looking at the accuracy of the result. A rational
/// q != 0 is never a multiple of pi/2, so the loop ends; the largest precision of [`Balls`] bounds
/// it anyway, and what comes out is then a wide but correct ball.
fn reduce_rational(q: &Rational, balls: Balls) -> Reduced {
    let zero = Reduced {
        turns: Integer::new(),
        offset: balls.zero(),
        complement: balls.mul_power_of_two(&balls.pi(), -1),
    };
    if q.is_zero() {
        return zero;
    }
    let size = q.numer().significant_bits().saturating_sub(q.denom().significant_bits());
    let mut work = balls.with_guard(GUARD_BITS.saturating_add(size));
    loop {
        let x = work.from_rational(q);
        let pi = work.pi();
        let Some(turns) = work.div(&x, &pi).and_then(|ratio| nearest(ratio.midpoint())) else {
            return zero_knowledge(balls);
        };
        let offset = work.sub(&x, &work.mul(&pi, &work.from_integer(&turns)));
        let half_pi = work.mul_power_of_two(&pi, -1);
        let complement = work.sub(&half_pi, &work.abs(&offset));
        let accuracy = offset.relative_accuracy_bits().min(complement.relative_accuracy_bits());
        let missing = i64::from(balls.bits()).saturating_add(2).saturating_sub(accuracy);
        let wider = work.with_guard(if accuracy <= 0 {
            work.bits()
        } else {
            u32::try_from(missing).unwrap_or(0).saturating_add(GUARD_BITS)
        });
        if missing <= 0 || wider == work {
            return Reduced { turns, offset, complement };
        }
        work = wider;
    }
}

fn nearest(x: &Float) -> Option<Integer> {
    x.to_integer_round(Round::Nearest).map(|(n, _)| n)
}

/// Reached only if a quotient by pi is not finite, that is beyond MPFR's exponents.
fn zero_knowledge(balls: Balls) -> Reduced {
    let nothing = balls.indeterminate();
    Reduced { turns: Integer::new(), offset: nothing.clone(), complement: nothing }
}

/// cos x, correct to about the precision of `balls` relative to |cos x|; exactly 0, 1 or -1 at
/// exact multiples of pi/2. Cost: the reduction (bits of pi as many as |x| has) and one sine.
#[must_use]
pub fn cosine(x: &Point, balls: Balls) -> Ball {
    let reduced = Reduced::new(x, balls);
    let value = reduced.abs_cosine(balls);
    if reduced.turns.is_odd() { balls.neg(&value) } else { balls.round(&value) }
}

/// sin x, with the same properties as [`cosine`].
#[must_use]
pub fn sine(x: &Point, balls: Balls) -> Ball {
    let reduced = Reduced::new(x, balls);
    let value = if reduced.is_near_zero() {
        balls.sin(&reduced.offset)
    } else {
        balls.cos(&reduced.complement)
    };
    let from_complement_negative = !reduced.is_near_zero() && reduced.is_negative();
    if reduced.turns.is_odd() != from_complement_negative {
        balls.neg(&value)
    } else {
        balls.round(&value)
    }
}

/// ln |cos x|, correct to about the precision of `balls` relative to its value; `None` at the
/// exact poles pi/2 + n pi.
#[must_use]
pub fn log_cosine(x: &Point, balls: Balls) -> Option<Ball> {
    let work = balls.with_guard(GUARD_BITS);
    let reduced = Reduced::new(x, work);
    let value = if reduced.is_near_zero() {
        // ln cos t = ln(1 - sin^2 t) / 2 keeps the digits of a small t.
        let square = work.square(&work.sin(&reduced.offset));
        work.mul_power_of_two(&work.ln_1p(&work.neg(&square))?, -1)
    } else {
        work.ln(&work.sin(&reduced.complement))?
    };
    Some(balls.round(&value))
}
