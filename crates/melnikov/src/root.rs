//! Enclosures of roots by signs.

use lindstedt_number::ball::{Ball, Balls};
use rug::Float;

/// A ball that contains a root of the continuous function f in [low, high], proved by the
/// intermediate value theorem; `None` unless f has decided, opposite signs at the ends.
///
/// Bisection until the sign at the midpoint is not decided at this precision or the interval is
/// two neighbouring numbers or 2^-2p of its first width: about p steps, each one evaluation.
pub fn enclose_root(
    balls: Balls,
    low: &Float,
    high: &Float,
    f: impl Fn(Balls, &Ball) -> Option<Ball>,
) -> Option<Ball> {
    let exact = |x: &Float| balls.from_parts(x, &Float::new(53));
    let sign = |x: &Float| {
        let value = f(balls, &exact(x))?;
        match (value.is_positive(), value.is_negative()) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    };
    let at_low = sign(low)?;
    if sign(high)? == at_low {
        return None;
    }
    let (mut low, mut high) =
        (Float::with_val(balls.bits(), low), Float::with_val(balls.bits(), high));
    // A root at 0 itself would be approached through all exponents: 2^-2p of the interval is enough.
    for _ in 0..balls.bits().saturating_mul(2).saturating_add(256) {
        let middle = Float::with_val(balls.bits(), &low + &high) / 2u32;
        if middle <= low || middle >= high {
            break;
        }
        match sign(&middle) {
            Some(positive) if positive == at_low => low = middle,
            Some(_) => high = middle,
            None => {
                // The root is in the interval; try the quarters before giving up on it.
                let quarter = Float::with_val(balls.bits(), &low + &middle) / 2u32;
                let three = Float::with_val(balls.bits(), &middle + &high) / 2u32;
                let mut narrowed = false;
                if quarter > low && sign(&quarter) == Some(at_low) {
                    low = quarter;
                    narrowed = true;
                }
                if three < high && sign(&three) == Some(!at_low) {
                    high = three;
                    narrowed = true;
                }
                if !narrowed {
                    break;
                }
            }
        }
    }
    Some(balls.hull(&exact(&low), &exact(&high)))
}

/// sqrt(max(x, 0)), monotone, so an x that contains 0 gives the ball of [0, sqrt(upper)].
pub(crate) fn sqrt_positive_part(balls: Balls, x: &Ball) -> Option<Ball> {
    if x.is_negative() {
        return Some(balls.zero());
    }
    if let Some(root) = balls.sqrt(x)
        && (x.is_positive() || x.is_exact())
    {
        return Some(root);
    }
    if !x.is_finite() {
        return None;
    }
    let upper = balls.sqrt(&balls.from_parts(&x.abs_upper(), &Float::new(53)))?;
    Some(balls.hull(&balls.zero(), &upper))
}
