//! Zeros of the signed threshold in a parameter.

use super::subject::{Range, Subject};
use crate::refusal::Refused;
use crate::{Error, Exact, Number, Status};
use lindstedt_melnikov::Class;
use lindstedt_number::ball::Balls;
use lindstedt_number::certified;
use lindstedt_recognise::Unperturbed;
use rug::Rational;

/// Cells in which a change of sign is looked for.
const CELLS: i64 = 128;
/// Bits that decide how many zeros there are.
const COUNTING_BITS: u32 = 400;

/// The zeros, and whether there are provably no others: of the closed form in a parameter of its
/// own by its equation, else by changes of sign on a grid, enclosed by bisection.
pub(super) fn list(subject: &Subject<'_>, range: &Range) -> Result<(Vec<Number>, bool), Error> {
    let (Some(low), Some(high)) = (range.axis.values.first(), range.axis.values.last()) else {
        return Ok((Vec::new(), false));
    };
    let digits = subject.work.printed_digits();
    let (Some(point), Some(axis)) = (&subject.point, range.known) else {
        return Ok((changes_of_sign(subject, range, (low, high), digits)?, false));
    };
    let found = point.zeros_in(Balls::new(COUNTING_BITS), axis, low, high)?;
    let nth = |n: usize| {
        let zero = |balls| point.zeros_in(balls, axis, low, high).ok()?.zeros.get(n).cloned();
        Ok(certified(None, digits, zero)?)
    };
    let zeros: Result<_, Error> = (0..found.zeros.len()).map(nth).collect();
    Ok((zeros?, found.complete))
}

fn changes_of_sign(
    subject: &Subject<'_>,
    range: &Range,
    (low, high): (&Exact, &Exact),
    digits: usize,
) -> Result<Vec<Number>, Error> {
    let numeric = matches!(subject.found.unperturbed, Unperturbed::Numeric(_));
    let (Some(low), Some(high), false) = (low.as_rational(), high.as_rational(), numeric) else {
        let message = if numeric {
            "zeros are enclosed on orbits in closed form, and this one is numeric"
        } else {
            "zeros are enclosed between rational ends"
        };
        let hint = "--sweep shows where the sign changes";
        return Err(Refused::no_answer("no-answer", message, hint).into());
    };
    let bits = (digits as f64 * 3.33) as u32 + 64;
    let sign = |q: &Rational| -> Option<bool> {
        let value = Exact::Rational(q.clone());
        let ball = subject.signed(Balls::new(bits), &[(range, &value)]).ok()?;
        (!ball.contains_zero()).then(|| ball.is_positive())
    };
    let width = Rational::from(high - low);
    // No round fractions: zeros like to be there.
    let at = |n: i64| match n {
        CELLS => high.clone(),
        n => &width * Rational::from((1009 * n, 1009 * CELLS + 1)) + low,
    };
    let mut found = Vec::new();
    for n in 0..CELLS {
        if subject.work.stop.asked() {
            return Err(Refused::stopped("stopped before all zeros were found", "").into());
        }
        let (mut a, mut b) = (at(n), at(n + 1));
        let (Some(left), Some(right)) = (sign(&a), sign(&b)) else { continue };
        if left == right {
            continue;
        }
        for _ in 0..bits {
            let middle = Rational::from(&a + &b) / 2u32;
            match sign(&middle) {
                Some(side) if side == left => a = middle,
                Some(_) => b = middle,
                None => break,
            }
        }
        let balls = Balls::new(bits + 32);
        let ends = balls.hull(&balls.from_rational(&a), &balls.from_rational(&b));
        let Some(number) = Number::of_ball(&ends, digits) else { continue };
        found.push(match subject.found.class() {
            Class::Estimated => number.weaken(Status::Estimated),
            Class::Certified => number,
        });
    }
    Ok(found)
}
