//! Reading the oracles and comparing with them.

use lindstedt::Exact;
use lindstedt::unstable::number::ball::Ball;
use lindstedt_melnikov::StickSlip;
use lindstedt_tests::Random;
use rug::{Rational, ops::Pow};
use serde_json::Value;

/// A file of `tests/data/stick-slip`.
pub fn oracle(name: &str) -> Value {
    let path = format!("{}/data/stick-slip/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// The exact value of a decimal.
pub fn decimal(text: &str) -> Rational {
    Exact::parse(text).unwrap().as_rational().unwrap().clone()
}

/// A field of an object, as an exact parameter.
pub fn real(row: &Value, name: &str) -> Exact {
    Exact::Rational(number(row, name))
}

/// A field of an object, as an exact number.
pub fn number(row: &Value, name: &str) -> Rational {
    decimal(row[name].as_str().unwrap_or_else(|| panic!("{name} in {row}")))
}

/// Significant digits in a printed number.
fn printed_digits(text: &str) -> i32 {
    let mantissa = text.split('e').next().unwrap();
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    digits.trim_start_matches('0').len() as i32
}

/// The ball agrees with the printed number to `digits` digits, or as many as are printed, and is
/// itself that narrow.
pub fn assert_agrees(ball: &Ball, expected: &Value, digits: i32, what: &str) {
    let text = expected.as_str().unwrap();
    let expected = decimal(text);
    let digits = digits.min(printed_digits(text) - 1).max(1);
    let scale = if expected.is_zero() { Rational::from(1) } else { expected.clone().abs() };
    // An oracle 0.0 is an exact zero: compared absolutely, to the digits asked for.
    let digits = if expected.is_zero() { 25 } else { digits };
    let tolerance = scale * Rational::from(10).pow(-digits);
    assert!(ball.is_finite(), "{what}: nothing known");
    let middle = ball.midpoint().to_rational().unwrap();
    let radius = ball.radius().to_rational().unwrap();
    let error = Rational::from(&middle - &expected).abs() + radius;
    assert!(
        error <= tolerance,
        "{what}: {} instead of {text}, error {}",
        ball.midpoint(),
        error.to_f64()
    );
}

/// The oscillator of a row with a, b, T0, alpha, beta, omega, vstar (omega may be missing).
pub fn stick_slip(row: &Value) -> StickSlip {
    let omega = if row["omega"].is_null() { Exact::from(1) } else { real(row, "omega") };
    StickSlip {
        a: real(row, "a"),
        b: real(row, "b"),
        dry: real(row, "T0"),
        alpha: real(row, "alpha"),
        beta: real(row, "beta"),
        omega,
        belt_speed: if row["vstar"].is_null() { Exact::from(0) } else { real(row, "vstar") },
    }
}

/// A number in (low, high) with three decimals, exactly.
pub fn decimals(random: &mut Random, low: f64, high: f64) -> Rational {
    Rational::from(((random.between(low, high) * 1000.0).round() as i64, 1000))
}
