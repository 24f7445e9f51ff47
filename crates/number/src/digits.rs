//! Decimal digits of balls: what is printed is known.
//!
//! A decimal with D significant digits has a last place 10^(E-D+1), where E is the exponent of its
//! first digit. [`decimal`] prints only if |printed - x| < 10^(E-D+1) follows from the ball;
//! [`certify`] raises the precision of a computation until that happens.

use crate::NumberError;
use crate::ball::{Ball, Balls};
use rug::Float;
use rug::float::Round;
use rug::ops::Pow;

/// More digits than this are refused: GMP aborts where memory ends.
const MAX_DIGITS: usize = 10_000_000;
/// Guard bits of the first attempt: with them the printed digits are correctly rounded except
/// with a chance of about 2^-30 times the loss of the computation.
const GUARD_BITS: u32 = 32;
/// Exponents E with this or more are printed in scientific notation, and those below the second.
const PLAIN_BELOW: i64 = 21;
const PLAIN_FROM: i64 = -7;

/// The number in the ball with `digits` significant digits (at least 1).
///
/// The string s satisfies |s - x| < one unit of its last place, for every x of the ball: it is the
/// midpoint correctly rounded (error <= 1/2 unit), and it is returned only for a radius below
/// 1/2 unit. So s is x correctly rounded wherever both ends of the ball round alike, and otherwise
/// one of the two neighbours of x.
///
/// Plain notation for 1e-7 <= |x| < 1e21 as far as all printed digits are significant (123456 with
/// three digits is `1.23e5`), scientific otherwise; the exact 0 is `0`.
/// `None` where the radius is too large, or for more than 10^7 digits.
///
/// ```
/// use lindstedt_number::{ball::Balls, digits::decimal};
///
/// let pi = Balls::new(64).pi();
/// assert_eq!(decimal(&pi, 10).as_deref(), Some("3.141592654"));
/// assert_eq!(decimal(&pi, 30), None);
/// ```
#[must_use]
pub fn decimal(ball: &Ball, digits: usize) -> Option<String> {
    if ball.is_exact() && ball.midpoint().is_zero() {
        return Some("0".to_owned());
    }
    let digits = digits.max(1);
    if digits > MAX_DIGITS || ball.contains_zero() {
        return None;
    }
    let text = Scientific::round(ball.midpoint(), digits, Round::Nearest)?;
    let last_place = i32::try_from(text.exponent - i64::try_from(digits).ok()? + 1).ok()?;
    let ten = Float::with_val(8, 10);
    let (unit, _) = Float::with_val_round(53, (&ten).pow(last_place), Round::Down);
    (*ball.radius() < unit / 2u32).then(|| text.format())
}

/// An upper bound of |printed - x| over the ball as a short decimal, like `3.1e-41`.
///
/// The two digits are rounded up. `inf` if `printed` is not a decimal number or nothing is known.
#[must_use]
pub fn error_string(ball: &Ball, printed: &str) -> String {
    let inf = || "inf".to_owned();
    let Ok(parsed) = Float::parse(printed) else {
        return inf();
    };
    // Four bits per character hold every digit, so the rounding of the decimal is negligible.
    let length = u32::try_from(printed.len()).unwrap_or(u32::MAX).saturating_mul(4);
    let balls = Balls::new(length.max(ball.midpoint().prec())).with_guard(64);
    let printed = balls.enclose(parsed, Float::new(53));
    short_bound(&balls.sub(&printed, ball).abs_upper()).unwrap_or_else(inf)
}

/// The digits and the error bound of the number that `evaluate` encloses.
///
/// The first attempt has about `digits` log2(10) + 32 bits; then as many more as the radius says
/// are missing, or twice as many where it says nothing, never more than `max_bits`. Returns
/// [`decimal`] and [`error_string`] of the first ball that is small enough. An `evaluate` that
/// answers `None` (say, a divisor that still contains 0) is asked again with more bits.
///
/// # Errors
/// [`NumberError::NotEnoughBits`] with the last enclosure (at once for more than 10^7
/// digits), or [`NumberError::Undefined`] if the last answer was `None`.
///
/// ```
/// use lindstedt_number::digits::certify;
///
/// let (digits, error) = certify(20, 1000, |balls| balls.zeta(3))?;
/// assert_eq!(digits, "1.2020569031595942854");
/// assert_eq!(error, "2.7e-22");
/// # Ok::<(), lindstedt_number::NumberError>(())
/// ```
pub fn certify(
    digits: usize,
    max_bits: u32,
    evaluate: impl Fn(Balls) -> Option<Ball>,
) -> Result<(String, String), NumberError> {
    if digits > MAX_DIGITS {
        return Err(NumberError::NotEnoughBits { bits: 0, best: None });
    }
    let wanted = bits_for(digits);
    let max_bits = Balls::new(max_bits).bits();
    let mut bits = wanted.saturating_add(GUARD_BITS).min(max_bits);
    loop {
        let ball = evaluate(Balls::new(bits));
        if let Some(ball) = &ball
            && let Some(text) = decimal(ball, digits)
        {
            let error = error_string(ball, &text);
            return Ok((text, error));
        }
        if bits >= max_bits {
            let Some(ball) = ball else {
                return Err(NumberError::Undefined);
            };
            return Err(NumberError::NotEnoughBits { bits, best: enclosure(&ball, digits) });
        }
        let known = ball.map_or(0, |ball| ball.relative_accuracy_bits());
        // A quarter more at least, so that the number of attempts stays logarithmic.
        // Of a ball around 0 or without an end nothing is known: the least integer there is.
        let more = match known {
            1.. => i64::from(wanted) - known + i64::from(GUARD_BITS),
            _ => i64::from(bits),
        };
        let more = u32::try_from(more.max(0)).unwrap_or(u32::MAX).max(bits / 4 + 1);
        bits = bits.saturating_add(more).min(max_bits);
    }
}

/// D log2(10) rounded up, from 3.3220 > log2(10).
fn bits_for(digits: usize) -> u32 {
    let digits = u64::try_from(digits).unwrap_or(u64::MAX);
    u32::try_from(digits.saturating_mul(33_220) / 10_000 + 1).unwrap_or(u32::MAX)
}

/// `digits +/- error` with as many digits (at most `most`) as the ball knows.
fn enclosure(ball: &Ball, most: usize) -> Option<String> {
    // 0.301 < log10(2): never more digits than known.
    let known = ball.relative_accuracy_bits().clamp(0, i64::from(u32::MAX)) * 301 / 1000;
    let digits = usize::try_from(known).unwrap_or(0).clamp(1, most.max(1));
    let text = decimal(ball, digits).or_else(|| ball.contains_zero().then(|| "0".to_owned()))?;
    let error = error_string(ball, &text);
    (error != "inf").then(|| format!("{text} +/- {error}"))
}

/// Two digits, rounded up.
fn short_bound(bound: &Float) -> Option<String> {
    if bound.is_zero() {
        return Some("0".to_owned());
    }
    Some(Scientific::round(bound, 2, Round::Up)?.scientific())
}

/// +-d.ddd 10^exponent.
struct Scientific {
    negative: bool,
    digits: String,
    exponent: i64,
}

impl Scientific {
    /// Correct rounding to `digits` digits by MPFR; `None` for 0 and what is not finite.
    fn round(x: &Float, digits: usize, round: Round) -> Option<Self> {
        let (negative, digits, exponent) = x.to_sign_string_exp_round(10, Some(digits), round);
        // MPFR's exponent belongs to 0.ddd, ours to d.dd.
        let exponent = i64::from(exponent?) - 1;
        Some(Self { negative, digits, exponent })
    }
    fn scientific(&self) -> String {
        let sign = if self.negative { "-" } else { "" };
        let (first, rest) = self.digits.split_at_checked(1).unwrap_or((&self.digits, ""));
        let point = if rest.is_empty() { "" } else { "." };
        format!("{sign}{first}{point}{rest}e{}", self.exponent)
    }
    /// Plain notation where the exponent is moderate and no zeros must be filled in on the right.
    fn format(&self) -> String {
        let length = i64::try_from(self.digits.len()).unwrap_or(i64::MAX);
        if self.exponent < PLAIN_FROM || self.exponent >= length.min(PLAIN_BELOW) {
            return self.scientific();
        }
        let sign = if self.negative { "-" } else { "" };
        let Ok(whole) = usize::try_from(self.exponent + 1) else {
            let zeros = usize::try_from(-1 - self.exponent).unwrap_or(0);
            return format!("{sign}0.{}{}", "0".repeat(zeros), self.digits);
        };
        let (before, after) = self.digits.split_at_checked(whole).unwrap_or((&self.digits, ""));
        let before = if before.is_empty() { "0" } else { before };
        let point = if after.is_empty() { "" } else { "." };
        format!("{sign}{before}{point}{after}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::{Integer, Rational};

    fn rational(text: &str) -> Rational {
        let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let numerator: Integer = format!("{whole}{fraction}").parse().unwrap();
        let shift = exponent.parse::<i32>().unwrap() - fraction.len() as i32;
        Rational::from(numerator) * Rational::from(10).pow(shift)
    }

    fn ball(text: &str, error: f64) -> Ball {
        let balls = Balls::new(200);
        balls.add_error(&balls.from_rational(&rational(text)), &Float::with_val(53, error))
    }

    #[test]
    fn notation() {
        let table = [
            ("1.5", 2, "1.5"),
            ("-1.5", 4, "-1.500"),
            ("0.000000123456", 3, "0.000000123"),
            ("0.0000000123456", 3, "1.23e-8"),
            ("-1234e-303", 4, "-1.234e-300"),
            ("123456", 3, "1.23e5"),
            ("123456", 6, "123456"),
            ("123456", 8, "123456.00"),
            ("999.96", 4, "1000"),
            ("123456789012345678901", 21, "123456789012345678901"),
            ("1234567890123456789012", 22, "1.234567890123456789012e21"),
            ("7", 1, "7"),
            ("70", 1, "7e1"),
            ("0.3", 1, "0.3"),
        ];
        for (value, digits, expected) in table {
            assert_eq!(decimal(&ball(value, 0.0), digits).as_deref(), Some(expected));
        }
        assert_eq!(decimal(&Balls::new(60).zero(), 5).as_deref(), Some("0"));
    }

    /// Whatever is printed, both ends of the ball are less than one unit away, and error_string
    /// bounds them: exact rational arithmetic on the printed string.
    #[test]
    fn printed_digits_are_known() {
        let values =
            ["1.2345678901234567", "9.9999995", "-0.00099999949999", "2.5", "1e-300", "3e40"];
        let mut printed = 0;
        for value in values {
            for exponent in -30..1 {
                for digits in 1..12 {
                    let size = rational(value).to_f64().abs();
                    let ball = ball(value, size * 10f64.powi(exponent));
                    let Some(text) = decimal(&ball, digits) else {
                        continue;
                    };
                    printed += 1;
                    let shown = rational(&text);
                    let last =
                        text.split('e').next().unwrap().split_once('.').map_or(0, |p| p.1.len());
                    let power = text.split_once('e').map_or(0, |p| p.1.parse().unwrap());
                    let unit = Rational::from(10).pow(power - last as i32);
                    let bound = rational(&error_string(&ball, &text));
                    let exact = |x: &Float| x.to_rational().unwrap();
                    let (middle, radius) = (exact(ball.midpoint()), exact(ball.radius()));
                    for end in [Rational::from(&middle - &radius), middle + radius] {
                        let error = (end - &shown).abs();
                        assert!(error < unit, "{value} with {digits} digits: {text}");
                        assert!(error <= bound, "{value}: {text} +/- {bound}");
                    }
                }
            }
        }
        assert!(printed > 1000);
    }

    #[test]
    fn too_wide_is_refused() {
        assert_eq!(decimal(&ball("1.5", 0.04), 2).as_deref(), Some("1.5"));
        assert_eq!(decimal(&ball("1.5", 0.06), 2), None);
        assert_eq!(decimal(&ball("0", 1e-30), 1), None);
        assert_eq!(decimal(&ball("1e-30", 2e-30), 1), None);
        assert_eq!(decimal(&ball("1", 0.0), MAX_DIGITS + 1), None);
    }

    #[test]
    fn errors_round_up() {
        assert_eq!(error_string(&ball("2", 0.0), "2"), "0");
        assert_eq!(error_string(&ball("3.14159", 0.0), "3.14"), "1.6e-3");
        assert_eq!(error_string(&ball("3.14", 1e-3), "3.14"), "1.1e-3");
        assert_eq!(error_string(&ball("3.14", 1e-3), "pi"), "inf");
    }

    /// sqrt 2 = 1.41421356237309504880168872420969807856967187537694... (OEIS A002193).
    #[test]
    fn certification() {
        let root = |balls: Balls| balls.sqrt(&balls.from_i64(2));
        let (digits, error) = certify(30, 4000, root).unwrap();
        assert_eq!(digits, "1.41421356237309504880168872421");
        assert_eq!(error, "3.1e-31");
        let (digits, _) = certify(10_000, 40_000, root).unwrap();
        assert_eq!(digits.len(), 10_001);
        assert!(digits.starts_with("1.4142135623730950488016887242096980785696718753769"));
        // 40 digits cancel: the precision must be raised.
        let cancelling = |balls: Balls| {
            let tiny = balls.powi(&balls.from_i64(10), -40)?;
            Some(balls.sub(&balls.add(&balls.pi(), &tiny), &balls.pi()))
        };
        assert_eq!(certify(5, 4000, cancelling).unwrap().0, "1.0000e-40");
    }

    #[test]
    fn undecided_is_said() {
        let zero = |balls: Balls| Some(balls.sub(&balls.pi(), &balls.pi()));
        let undecided = certify(10, 1000, zero);
        assert!(matches!(
            undecided,
            Err(NumberError::NotEnoughBits { bits: 1000, best: Some(best) })
                if best.starts_with("0 +/- ") && best.ends_with("e-301")
        ));
        let coarse = certify(100, 64, |balls| Some(balls.pi()));
        let expected = NumberError::NotEnoughBits {
            bits: 64,
            best: Some("3.14159265358979324 +/- 1.6e-18".to_owned()),
        };
        assert_eq!(coarse, Err(expected));
        let negative = certify(10, 1000, |balls| balls.sqrt(&balls.from_i64(-2)));
        assert_eq!(negative, Err(NumberError::Undefined));
    }

    /// The precisions that are tried for 100 digits of a number that loses so many bits by cancellation.
    fn tried(lost: i32) -> Vec<u32> {
        let tried = std::cell::RefCell::new(Vec::new());
        let (text, _) = certify(100, 1 << 20, |balls| {
            tried.borrow_mut().push(balls.bits());
            let large = balls.mul_power_of_two(&balls.one(), lost);
            Some(balls.sub(&balls.add(&balls.pi(), &large), &large))
        })
        .unwrap();
        assert!(text.starts_with("3.14159") && text.ends_with("7068"));
        tried.into_inner()
    }

    #[test]
    fn missing_bits_are_added_at_once() {
        // ceil(100 log2(10)) = 333 and 32 more.
        assert_eq!(tried(0), [365]);
        // What is missing, but a quarter at least.
        assert_eq!(tried(60), [365, 365 + 92]);
        // 2^340 < x < 2^341 with 365 bits: within 2^-25, of pi at least 2^1, and a bit for the bound.
        assert_eq!(tried(340), [365, 365 + (333 - 25 + 32)]);
        // Twice as many where nothing is known.
        assert_eq!(tried(1000), [365, 730, 1460]);
    }

    #[test]
    fn limits_of_digits() {
        let bits = |digits| match certify(digits, 64, |balls| Some(balls.pi())) {
            Err(NumberError::NotEnoughBits { bits, .. }) => Some(bits),
            _ => None,
        };
        assert_eq!((bits(MAX_DIGITS), bits(MAX_DIGITS + 1)), (Some(64), Some(0)));
        // The last digit is known where the radius is below half of its unit.
        assert!(decimal(&ball("3", 0.499), 1).is_some() && decimal(&ball("3", 0.5), 1).is_none());
    }
}
