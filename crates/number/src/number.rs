//! Numbers as they leave the program, with their class.

use crate::NumberError;
use crate::ball::{Ball, Balls};
use crate::digits::{certify, decimal, error_string};
use rug::{Float, Rational};
use serde::{Serialize, Serializer};
use std::fmt;

/// Precision is escalated up to this before "not enough bits" is answered: 10 000 digits and a
/// generous cancellation.
const MOST_BITS: u32 = 1 << 18;
/// The digits of a number whose error nothing is known of: more would look as if they were.
const SHOWN: usize = 4;
/// Stands for the decimal of what is no number.
pub const UNDEFINED: &str = "undefined";
/// Digits beyond those that a measured error leaves.
const BEYOND: usize = 2;

/// What is known about a number; the class only ever weakens, from the first to the last.
///
/// ```
/// use lindstedt_number::Status;
/// assert!(Status::Exact < Status::Certified && Status::Proved < Status::Estimated);
/// assert_eq!(Status::NoEstimate.to_string(), "no-estimate");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Known in closed form.
    Exact,
    /// Enclosed rigorously: the number is defined by what was evaluated.
    Certified,
    /// Enclosed by a proof that it exists: a zero of an equation and a radius around the
    /// approximation.
    Proved,
    /// Estimated; how is said beside it.
    Estimated,
    /// Computed, but nothing is known of its error: too few orders, or terms that do not decrease.
    NoEstimate,
}

impl Status {
    /// Its name in results: `exact`, `certified`, `proved`, `estimated`, `no-estimate`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Certified => "certified",
            Self::Proved => "proved",
            Self::Estimated => "estimated",
            Self::NoEstimate => "no-estimate",
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A number as it leaves the program. |decimal - true value| <= error where the status is exact,
/// certified or proved; the decimal has the digits asked for, or fewer where the error of an
/// estimate says so, and a few only where there is no estimate.
///
/// As data it is `{"exact": null, "decimal": "3.14", "error": "1.6e-3", "status": "certified"}`.
///
/// ```
/// use lindstedt_number::{Number, Status, ball::Balls};
///
/// let pi = Number::of_ball(&Balls::new(64).pi(), 10).ok_or("no digit")?;
/// assert_eq!((pi.decimal.as_str(), pi.status), ("3.141592654", Status::Certified));
/// assert_eq!(pi.weaken(Status::Estimated).to_string(), "3.141592654 +- 4.2e-10 (estimated)");
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Number {
    /// The closed form, if there is one.
    pub exact: Option<String>,
    /// Its decimal value; "undefined" where the computation gave none (null as data).
    #[serde(serialize_with = "defined")]
    pub decimal: String,
    /// A bound on |decimal - true value|, or its estimate; nothing when they are equal, and without
    /// an estimate.
    pub error: Option<String>,
    /// The class.
    pub status: Status,
}

impl Number {
    /// What is no number: overflow, 0/0, a ball that knows nothing.
    #[must_use]
    pub fn undefined() -> Self {
        let decimal = UNDEFINED.to_owned();
        Self { exact: None, decimal, error: None, status: Status::NoEstimate }
    }

    /// A double whose rounding errors were not tracked, in the fewest digits that tell it apart;
    /// [`Number::undefined`] for infinities and NaN.
    #[must_use]
    pub fn double(x: f64) -> Self {
        if !x.is_finite() {
            return Self::undefined();
        }
        // 0, not -0.
        let decimal = format!("{:e}", x + 0.0);
        Self { exact: None, decimal, error: None, status: Status::Estimated }
    }

    /// As many of the digits asked for as are certain; an enclosure of zero is 0 with its radius,
    /// a ball of radius 0 that a decimal of so many digits is, is exact. Nothing where the ball is no bounded set: it
    /// says nothing about a number.
    #[must_use]
    pub fn of_ball(ball: &Ball, digits: usize) -> Option<Self> {
        if !ball.is_finite() || !ball.midpoint().is_finite() {
            return None;
        }
        let known = ball.relative_accuracy_bits().max(0) as f64 * std::f64::consts::LOG10_2;
        let certain = if ball.is_exact() { digits } else { digits.min((known as usize).max(1)) };
        // The bits count one digit more than a ball with a large first digit has.
        let decimal = (1..=certain).rev().find_map(|digits| decimal(ball, digits)).or_else(|| {
            let centre = Balls::new(64).from_parts(ball.midpoint(), &Float::new(53));
            decimal(&centre, 1).filter(|_| !ball.contains_zero())
        });
        let decimal = decimal.unwrap_or_else(|| "0".to_owned());
        let number = Self::enclosed_as(ball, decimal);
        if ball.is_exact() && number.error.is_none() {
            let exact = Some(number.decimal.clone());
            return Some(Self { exact, status: Status::Exact, ..number });
        }
        Some(number)
    }

    /// All the digits asked for, or 0 for an enclosure of zero to twice the digits; nothing where
    /// the ball does not know them.
    #[must_use]
    pub fn of_all_digits(ball: &Ball, digits: usize) -> Option<Self> {
        let size = ball.abs_upper().get_exp();
        let small =
            ball.contains_zero() && size.is_none_or(|e| f64::from(-e) > 6.66 * digits as f64 + 8.0);
        if small && !ball.is_exact() {
            return Some(Self::enclosed_as(ball, "0".to_owned()));
        }
        let needed = (digits as f64 * std::f64::consts::LOG2_10).ceil() as i64 + 2;
        let enough = ball.is_exact() || ball.relative_accuracy_bits() >= needed;
        let decimal = decimal(ball, digits).filter(|_| enough)?;
        Some(Self::enclosed_as(ball, decimal))
    }

    /// A value that lies in the ball.
    fn enclosed_as(ball: &Ball, decimal: String) -> Self {
        let error = error_string(ball, &decimal);
        let error = (error != "0").then_some(error);
        Self { exact: None, decimal, error, status: Status::Certified }
    }

    /// The midpoint of a ball whose radius is an estimate, with the digits that the radius leaves,
    /// at most `digits`; nothing where it leaves none.
    #[must_use]
    pub fn estimated(ball: &Ball, digits: usize) -> Option<Self> {
        let known = ball.relative_accuracy_bits().clamp(0, 40_000) * 302 / 1000 + 2;
        let most = usize::try_from(known).unwrap_or(1).min(digits).max(1);
        let decimal = (1..=most).rev().find_map(|d| decimal(ball, d))?;
        let error = Some(error_string(ball, &decimal));
        Some(Self { exact: None, decimal, error, status: Status::Estimated })
    }

    /// The value with two digits more than its estimated error leaves, at most `digits`: an
    /// estimate is rarely as bad as it says. Nothing where the error is infinite.
    #[must_use]
    pub fn with_error(value: &Float, error: &Float, digits: usize) -> Option<Self> {
        if !error.is_finite() {
            return None;
        }
        let balls = Balls::new(value.prec().max(64));
        let sure = match (value.get_exp(), error.get_exp()) {
            (Some(v), Some(e)) => (f64::from(v - e) * 2f64.log10()).max(0.0) as usize + BEYOND,
            _ => digits,
        };
        let centre = balls.from_parts(value, &Float::new(53));
        let decimal = decimal(&centre, digits.min(sure).max(1))?;
        let error = Some(error_string(&balls.from_parts(value, error), &decimal));
        Some(Self { exact: None, decimal, error, status: Status::Estimated })
    }

    /// The midpoint of a ball whose radius was measured, with two digits more than it leaves and at
    /// least four.
    #[must_use]
    pub fn measured(ball: &Ball, digits: usize) -> Option<Self> {
        let known = ball.relative_accuracy_bits().clamp(0, 400_000) * 301 / 1000;
        let most = usize::try_from(known).map_or(digits, |known| known + BEYOND).max(SHOWN);
        let decimal = centre(ball, digits.min(most))?;
        let error = Some(error_string(ball, &decimal));
        Some(Self { exact: None, decimal, error, status: Status::Estimated })
    }

    /// The midpoint of a ball of whose error nothing is known, with four digits.
    #[must_use]
    pub fn without_estimate(ball: &Ball, digits: usize) -> Option<Self> {
        let decimal = centre(ball, digits.min(SHOWN))?;
        Some(Self { exact: None, decimal, error: None, status: Status::NoEstimate })
    }

    /// The number in a class that is not stronger than `status`; only an exact one has a closed
    /// form.
    #[must_use]
    pub fn weaken(mut self, status: Status) -> Self {
        self.status = self.status.max(status);
        if self.status > Status::Exact {
            self.exact = None;
        }
        self
    }
}

/// A decimal as data.
fn defined<S: Serializer>(decimal: &str, to: S) -> Result<S::Ok, S::Error> {
    if decimal == UNDEFINED { to.serialize_none() } else { to.serialize_str(decimal) }
}

/// The digits of the midpoint.
fn centre(ball: &Ball, digits: usize) -> Option<String> {
    let balls = Balls::new(ball.midpoint().prec());
    decimal(&balls.from_parts(ball.midpoint(), &Float::new(53)), digits)
}

impl fmt::Display for Number {
    /// The decimal, with its error where that is an estimate.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.error, self.status) {
            _ if self.decimal == UNDEFINED => f.write_str(UNDEFINED),
            (Some(error), Status::Estimated) => {
                write!(f, "{} +- {error} (estimated)", self.decimal)
            }
            (_, Status::NoEstimate) => write!(f, "{} (no estimate)", self.decimal),
            _ => f.write_str(&self.decimal),
        }
    }
}

/// A number by certified evaluation; exact if it has a closed form.
///
/// # Errors
/// [`NumberError::NotEnoughBits`] when the digits cannot be reached, [`NumberError::Undefined`] when
/// the value does not exist.
pub fn certified(
    exact: Option<String>,
    digits: usize,
    evaluate: impl Fn(Balls) -> Option<Ball>,
) -> Result<Number, NumberError> {
    let status = if exact.is_some() { Status::Exact } else { Status::Certified };
    let (decimal, error) = certify(digits, MOST_BITS, evaluate)?;
    let error = (error != "0").then_some(error);
    Ok(Number { exact, decimal, error, status })
}

/// A rational number.
///
/// # Errors
/// As [`certified`].
pub fn rational(q: &Rational, digits: usize) -> Result<Number, NumberError> {
    certified(Some(q.to_string()), digits, |balls| Some(balls.from_rational(q)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is exact has no error; a decimal that was cut has one.
    #[test]
    fn certified_numbers_say_what_they_are_wrong_by() {
        let two = certified(Some("2".to_owned()), 5, |balls| Some(balls.mul_i64(&balls.one(), 2)));
        let two = two.unwrap();
        assert_eq!((&*two.decimal, two.error, two.status), ("2.0000", None, Status::Exact));
        let pi = certified(None, 5, |balls| Some(balls.pi())).unwrap();
        assert_eq!((&*pi.decimal, pi.status), ("3.1416", Status::Certified));
        assert!(pi.error.unwrap().parse::<f64>().unwrap() >= 7.3e-6);
    }

    /// pi with nothing known of its error, with one of 1e-3, and with that as an estimate.
    #[test]
    fn digits_shown() {
        let balls = Balls::new(200);
        let pi = balls.pi();
        let unknown = Number::without_estimate(&pi, 30).unwrap();
        assert_eq!((&*unknown.decimal, unknown.status), ("3.142", Status::NoEstimate));
        assert_eq!(Number::without_estimate(&pi, 1).unwrap().decimal, "3");
        let wide = balls.add_error(&pi, &Float::with_val(53, 1e-3));
        let measured = Number::measured(&wide, 30).unwrap();
        assert_eq!((&*measured.decimal, measured.status), ("3.1416", Status::Estimated));
        assert!(measured.error.unwrap().parse::<f64>().unwrap() >= 1e-3);
        assert_eq!(Number::estimated(&wide, 30).unwrap().decimal, "3.14");
        let error = Float::with_val(53, 1e-3);
        let value = Float::with_val(200, rug::float::Constant::Pi);
        assert_eq!(Number::with_error(&value, &error, 30).unwrap().decimal, "3.1416");
        assert_eq!(Number::of_ball(&wide, 30).unwrap().decimal, "3.14");
        // Bits for twelve digits, of which the last is not certain; and for one that is not.
        let within = |x: f64, radius: f64| {
            let centre = balls.enclose(Float::with_val(200, x), Float::new(53));
            Number::of_ball(&balls.add_error(&centre, &Float::with_val(53, radius)), 12).unwrap()
        };
        assert_eq!(within(-0.0700621330698, 6e-14).decimal, "-0.070062133070");
        let wide_six = within(0.6, 0.1);
        assert_eq!((&*wide_six.decimal, wide_six.error.as_deref()), ("0.6", Some("1.1e-1")));
        assert_eq!(within(0.6, 0.7).decimal, "0");
        let nowhere = balls.add_error(&pi, &Float::with_val(53, f64::INFINITY));
        assert_eq!(Number::of_ball(&nowhere, 30), None);
        assert_eq!(Number::of_all_digits(&wide, 30), None);
        assert_eq!(Number::of_all_digits(&pi, 5).unwrap().decimal, "3.1416");
        let zero = balls.sub(&pi, &pi);
        assert_eq!(Number::of_all_digits(&zero, 5).unwrap().decimal, "0");
        assert_eq!(Number::double(-0.0).decimal, "0e0");
        let nothing = Number::double(f64::NAN);
        assert_eq!((nothing.to_string(), nothing.error), (UNDEFINED.to_owned(), None));
    }

    #[test]
    fn classes_only_weaken() {
        let classes = [
            Status::Exact,
            Status::Certified,
            Status::Proved,
            Status::Estimated,
            Status::NoEstimate,
        ];
        let third = rational(&Rational::from((1, 3)), 3).unwrap();
        assert_eq!((third.exact.as_deref(), third.decimal.as_str()), (Some("1/3"), "0.333"));
        for from in classes {
            for to in classes {
                let number = third.clone().weaken(from).weaken(to);
                assert!(number.status >= from && number.status >= to);
                assert_eq!(number.exact.is_some(), number.status == Status::Exact);
            }
        }
    }

    #[test]
    fn words_and_data() {
        let names = [Status::Exact, Status::Certified, Status::Proved].map(|s| s.to_string());
        assert_eq!(names, ["exact", "certified", "proved"]);
        let rest = [Status::Estimated, Status::NoEstimate].map(Status::name);
        assert_eq!(rest, ["estimated", "no-estimate"]);
        let pi = Balls::new(100).pi();
        let wide = Balls::new(100).add_error(&pi, &Float::with_val(53, 1e-3));
        let shown = Number::estimated(&wide, 30).unwrap().to_string();
        assert!(shown.starts_with("3.14 +- ") && shown.ends_with(" (estimated)"), "{shown}");
        let unknown = Number::without_estimate(&pi, 4).unwrap().to_string();
        assert_eq!(unknown, "3.142 (no estimate)");
        assert_eq!(Number::of_ball(&pi, 4).unwrap().to_string(), "3.142");
    }

    #[test]
    fn as_many_digits_as_are_known() {
        let balls = Balls::new(200);
        let of = |ball: &Ball, digits| {
            let number = Number::of_ball(ball, digits).unwrap();
            (number.exact, number.decimal, number.error.is_some(), number.status)
        };
        let half = balls.from_rational(&Rational::from((1, 2)));
        assert_eq!(of(&half, 3), (Some("0.500".into()), "0.500".into(), false, Status::Exact));
        // More digits than were asked for.
        let eighth = balls.from_rational(&Rational::from((1, 8)));
        assert_eq!(of(&eighth, 2), (None, "0.12".into(), true, Status::Certified));
        // 67 bits are 20 digits and two bits, no fewer.
        let bits = |bits| Balls::new(bits).pi();
        assert!(Number::of_all_digits(&bits(70), 20).is_some());
        assert!(Number::of_all_digits(&bits(66), 20).is_none());
        // An enclosure of zero counts as zero where it is smaller than twice the digits.
        let around = |exponent| {
            balls.from_parts(&Float::new(60), &Float::with_val(53, Float::i_exp(1, exponent)))
        };
        assert!(Number::of_all_digits(&around(-80), 10).is_some());
        assert!(Number::of_all_digits(&around(-70), 10).is_none());
        assert!(Number::of_all_digits(&bits(200), 10).is_some_and(|n| n.decimal == "3.141592654"));
        let zero = Number::of_all_digits(&balls.zero(), 10).unwrap();
        assert_eq!((zero.decimal.as_str(), zero.error), ("0", None));
        // 302/1000 of the bits and two more digits are tried.
        let known = balls.add_error(&balls.pi(), &Float::with_val(53, 4e-11));
        assert_eq!(Number::estimated(&known, 30).unwrap().decimal, "3.1415926536");
        assert_eq!(Number::estimated(&known, 4).unwrap().decimal, "3.142");
    }
}
