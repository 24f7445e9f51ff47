//! The staircase [0/0], [1/0], [1/1], [2/1], ... of approximants as the convergents of one continued fraction
//!
//!   c_0 + a_1 x/(1 + a_2 x/(1 + a_3 x/(1 + ...)))
//!
//! P_k = P_(k-1) + a_k x P_(k-2), Q_k = Q_(k-1) + a_k x Q_(k-2), from P_-1 = 1, P_0 = c_0, Q_-1 = 0, Q_0 = 1. The remainders
//! R_k = f Q_k - P_k = r_k x^(k+1) + ... follow the same rule, so that a_k = -r_(k-1)/r_(k-2): all approximants together
//! take O(N^2) products, where each alone takes O(N^3) by elimination. No r_k vanishes unless the table has a block; where
//! one does, or cancels so far that it may, there is nothing, and elimination tells what is there.

use super::pade::{Pade, scale_exponent};
use lindstedt_algebra::Stop;
use rug::Float;

/// Bits beyond those of the coefficients: so many, and so many per order.
const GUARD: [usize; 2] = [64, 4];

/// P_k, Q_k and the remainder from x^(k+1) on.
struct Convergent {
    numerator: Vec<Float>,
    denominator: Vec<Float>,
    rest: Vec<Float>,
}

/// list + a x other.
fn next(list: &[Float], a: &Float, other: &[Float]) -> Vec<Float> {
    let zero = Float::new(a.prec());
    let length = list.len().max(other.len() + 1);
    let shifted = std::iter::once(&zero).chain(other).chain(std::iter::repeat(&zero));
    let own = list.iter().chain(std::iter::repeat(&zero));
    let sum = |(x, y): (&Float, &Float)| x + Float::with_val(a.prec(), a * y);
    own.zip(shifted).take(length).map(sum).collect()
}

/// The convergents k = first .. N of the series c_0 .. c_N with their numbers; nothing where the table has a block, where a
/// coefficient is not finite, and once `stop` said so.
pub(super) fn convergents(
    c: &[Float],
    first: usize,
    bits: u32,
    stop: &Stop,
) -> Option<Vec<(usize, Pade)>> {
    if !c.iter().all(Float::is_finite) {
        return None;
    }
    let order = c.len().checked_sub(1)?;
    let work = bits.checked_add(u32::try_from(GUARD[0] + GUARD[1] * order).ok()?)?;
    let exponent = scale_exponent(c);
    let scaled = c.iter().zip(0i32..);
    let scaled: Vec<Float> =
        scaled.map(|(x, n)| Float::with_val(work, x) << exponent.saturating_mul(n)).collect();
    let one = || Float::with_val(work, 1);
    let (head, tail) = scaled.split_first()?;
    let mut before =
        Convergent { numerator: vec![one()], denominator: Vec::new(), rest: vec![-one()] };
    let mut now =
        Convergent { numerator: vec![head.clone()], denominator: vec![one()], rest: tail.to_vec() };
    let pade = |k: usize, found: &Convergent| {
        (k, Pade::of_parts(&found.numerator, &found.denominator, exponent, bits))
    };
    let mut list = Vec::from_iter((first == 0).then(|| pade(0, &now)));
    for k in 1..=order {
        if stop.asked() {
            return None;
        }
        let a = Float::with_val(work, now.rest.first()? / before.rest.first()?);
        let a = -a;
        // The terms in x^k cancel; those of 1 that begins the remainders have no others.
        let own = now.rest.iter().skip(1);
        let zero = Float::new(work);
        let others = before.rest.iter().skip(1).chain(std::iter::repeat(&zero));
        let rest: Vec<Float> =
            own.zip(others).map(|(x, y)| x + Float::with_val(work, &a * y)).collect();
        if let (Some(r), Some(x), Some(y)) = (rest.first(), now.rest.get(1), before.rest.get(1)) {
            let size = Float::with_val(53, x.abs_ref()) + Float::with_val(53, &a * y).abs();
            if Float::with_val(53, r.abs_ref()) <= size >> (bits / 2) {
                return None;
            }
        }
        if a.is_zero() || !a.is_finite() {
            return None;
        }
        let found = Convergent {
            numerator: next(&now.numerator, &a, &before.numerator),
            denominator: next(&now.denominator, &a, &before.denominator),
            rest,
        };
        if k >= first {
            list.push(pade(k, &found));
        }
        (before, now) = (now, found);
    }
    Some(list)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(order: u32, bits: u32) -> Vec<Float> {
        (0..=order).map(|n| Float::with_val(bits, 1) / (n + 1) * (-1i32).pow(n)).collect()
    }

    /// The same approximants by elimination, at a point.
    #[test]
    fn convergents_are_the_approximants_of_elimination() {
        let (c, x) = (log(24, 300), Float::with_val(300, 3) / 2u32);
        let list = convergents(&c, 0, 300, &Stop::default()).unwrap();
        assert_eq!(list.len(), 25);
        for (k, found) in list {
            let pade = Pade::new(&c, k - k / 2, k / 2, 300, &Stop::default()).unwrap();
            assert_eq!(found.degrees(), pade.degrees());
            let gap = found.value(&x).unwrap() - pade.value(&x).unwrap();
            assert!(gap.abs() < 1e-50, "{k}");
        }
    }

    /// 1/(1 - x) has a block after [0/1], 1 + x^2 one before [2/0].
    #[test]
    fn blocks_are_left_to_elimination() {
        let float = |x: i32| Float::with_val(200, x);
        let geometric: Vec<Float> = (0..12).map(|_| float(1)).collect();
        let even: Vec<Float> = (0..12).map(|n| float(i32::from(n == 0 || n == 2))).collect();
        for c in [geometric, even] {
            assert!(convergents(&c, 2, 200, &Stop::default()).is_none());
        }
    }
}
