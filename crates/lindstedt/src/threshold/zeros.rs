//! Zeros of the signed threshold in a parameter.

use super::subject::{Range, Subject};
use crate::refusal::Refused;
use crate::{Error, Exact, Number, Status};
use lindstedt_algebra::Stop;
use lindstedt_melnikov::Class;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::certified;
use lindstedt_recognise::Unperturbed;
use rug::Rational;

/// Cells in which a change of sign is looked for.
const CELLS: i64 = 128;
/// So many nodes on zeros may be chance: the ends of the range and one between.
const ISOLATED: usize = 3;
/// Bits that decide how many zeros there are.
const COUNTING_BITS: u32 = 400;

/// What was found.
pub(super) struct Zeros {
    pub list: Vec<Number>,
    /// Whole intervals of zeros.
    pub intervals: Vec<[Number; 2]>,
    /// Whether there are provably no others.
    pub complete: bool,
}

/// The zeros, and whether there are provably no others: of the closed form in a parameter of its
/// own by its equation, else by changes of sign on a grid, enclosed by bisection.
pub(super) fn list(subject: &Subject<'_>, range: &Range) -> Result<Zeros, Error> {
    let none = Zeros { list: Vec::new(), intervals: Vec::new(), complete: false };
    let (Some(low), Some(high)) = (range.axis.values.first(), range.axis.values.last()) else {
        return Ok(none);
    };
    let digits = subject.work.printed_digits();
    let (Some(point), Some(axis)) = (&subject.point, range.known) else {
        return Ok(Zeros { list: changes_of_sign(subject, range, (low, high), digits)?, ..none });
    };
    let zeros = |balls| point.zeros_in(balls, axis, low, high).ok();
    let found = point.zeros_in(Balls::new(COUNTING_BITS), axis, low, high)?;
    let number = |of: &dyn Fn(Balls) -> Option<Ball>| Ok(certified(None, digits, of)?);
    let nth = |n: usize| number(&|balls| zeros(balls)?.zeros.get(n).cloned());
    let end =
        |n: usize, side: usize| number(&|balls| zeros(balls)?.intervals.get(n)?.get(side).cloned());
    let interval = |n: usize| Ok([end(n, 0)?, end(n, 1)?]);
    Ok(Zeros {
        list: (0..found.zeros.len()).map(nth).collect::<Result<_, Error>>()?,
        intervals: (0..found.intervals.len()).map(interval).collect::<Result<_, Error>>()?,
        complete: found.complete,
    })
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
    let side = |q: &Rational| -> Side {
        let value = Exact::Rational(q.clone());
        match subject.signed(Balls::new(bits), &[(range, &value)]) {
            Ok(ball) if !ball.contains_zero() => Side::Known(ball.is_positive()),
            Ok(ball) if ball.is_exact() => Side::Zero,
            Ok(_) => Side::Unknown,
            Err(_) => Side::Nothing,
        }
    };
    let width = Rational::from(high - low);
    // No round fractions: zeros like to be there.
    let at = |n: i64| match n {
        CELLS => high.clone(),
        n => &width * Rational::from((1009 * n, 1009 * CELLS + 1)) + low,
    };
    let class = subject.found.class();
    let number = |[a, b]: [Rational; 2]| {
        let balls = Balls::new(bits + 32);
        let ball = balls.hull(&balls.from_rational(&a), &balls.from_rational(&b));
        let number = Number::of_ball(&ball, digits).unwrap_or_else(Number::undefined);
        match class {
            Class::Estimated => number.weaken(Status::Estimated),
            Class::Certified => number,
        }
    };
    let stop = &subject.work.stop;
    let found = crossings(&at, &side, bits, stop).ok_or_else(|| {
        let hint = "raise --limit-seconds, or ask for fewer --digits";
        Refused::stopped("stopped before all zeros were found", hint)
    })?;
    let vanishing = found.iter().filter(|[a, b]| a == b).count();
    if vanishing > ISOLATED {
        let (name, all) = (&range.axis.name, CELLS + 1);
        let message =
            format!("the signed threshold is zero at {vanishing} of {all} values of {name}");
        return Err(
            Refused::no_answer("no-answer", message, "--sweep shows where it is not").into()
        );
    }
    Ok(found.into_iter().map(number).collect())
}

/// The ends between which the sign changes, one after the other; nothing where the work was stopped.
fn crossings(
    at: &dyn Fn(i64) -> Rational,
    side: &dyn Fn(&Rational) -> Side,
    bits: u32,
    stop: &Stop,
) -> Option<Vec<[Rational; 2]>> {
    let mut found = Vec::new();
    // The last node whose sign is known; nothing behind a zero.
    let mut before: Option<(Rational, bool)> = None;
    for n in 0..=CELLS {
        if stop.asked() {
            return None;
        }
        let node = at(n);
        match side(&node) {
            Side::Unknown => {}
            Side::Nothing => before = None,
            Side::Zero => {
                found.push([node.clone(), node]);
                before = None;
            }
            Side::Known(here) => {
                if let Some((from, there)) = before.filter(|(_, there)| *there != here) {
                    found.push(halved(side, [from, node.clone()], there, bits));
                }
                before = Some((node, here));
            }
        }
    }
    Some(found)
}

/// The signed threshold at a value.
enum Side {
    /// Not zero, and whether it is positive.
    Known(bool),
    /// Zero exactly.
    Zero,
    /// Not told from zero.
    Unknown,
    /// No threshold.
    Nothing,
}

/// The ends between which the sign changes, halved as long as it is decided; both the zero where one
/// is met.
fn halved(
    side: &dyn Fn(&Rational) -> Side,
    [mut a, mut b]: [Rational; 2],
    left: bool,
    bits: u32,
) -> [Rational; 2] {
    for _ in 0..bits {
        let middle = Rational::from(&a + &b) / 2u32;
        match side(&middle) {
            Side::Known(here) if here == left => a = middle,
            Side::Known(_) => b = middle,
            Side::Zero => return [middle.clone(), middle],
            Side::Unknown | Side::Nothing => break,
        }
    }
    [a, b]
}
