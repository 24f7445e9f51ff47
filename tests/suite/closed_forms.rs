//! Certified closed forms of periods against Gamma functions and elliptic integrals in doubles by
//! the crate `special`, which shares no code with ours.

use lindstedt::{Evaluate, Oscillator, Work};
use special::{Elliptic, Gamma};
use std::f64::consts::PI;

/// Relative errors of `special` (Gamma 9e-16, K 1.6e-15 against 50 digits), summed over a formula.
const DOUBLES: f64 = 2e-14;

fn certified(name: &str, parameter: &str, value: &str) -> f64 {
    let case = Oscillator::builtin(name).unwrap().set(parameter, value).unwrap();
    let question = Evaluate { order: Some(2), ..Evaluate::default() };
    let work = Work { digits: 20, ..Work::default() };
    let period = case.evaluate(&question, &work).unwrap().value.exact_period;
    period.unwrap().decimal.parse().unwrap()
}

fn agree(found: f64, expected: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < DOUBLES, "{what}: {found} against {expected}");
}

/// x'' + x^n = 0 (odd continuation), x(0) = 1: with p = n + 1 the energy integral is
/// T = 4 sqrt(pi/(2 p)) Gamma(1/p)/Gamma(1/p + 1/2).
#[test]
fn power_law_by_gamma() {
    for (n, value) in [("1/10", 0.1), ("1/2", 0.5), ("2", 2.0), ("3", 3.0), ("101", 101.0)] {
        let q = 1.0 / (1.0 + value);
        let expected = 4.0 * (PI * q / 2.0).sqrt() * Gamma::gamma(q) / Gamma::gamma(q + 0.5);
        agree(certified("power-law", "n", n), expected, n);
    }
}

/// x'' + sin x = 0: T = 4 K(sin^2(a/2)); x'' + x + eps x^3 = 0, x(0) = 1:
/// T = 4 K(m)/sqrt(1 + eps), m = eps/(2 (1 + eps)).
#[test]
fn pendulum_and_duffing_by_elliptic_integrals() {
    for (amplitude, value) in [("1/10", 0.1f64), ("1", 1.0), ("2", 2.0), ("3", 3.0)] {
        let expected = 4.0 * (value / 2.0).sin().powi(2).elliptic_k();
        agree(certified("pendulum", "amplitude", amplitude), expected, amplitude);
    }
    for (eps, value) in [("1/10", 0.1), ("1", 1.0), ("100", 100.0), ("-9/10", -0.9)] {
        let stiffness: f64 = 1.0 + value;
        let parameter = value / (2.0 * stiffness);
        let expected = 4.0 * parameter.elliptic_k() / stiffness.sqrt();
        agree(certified("duffing", "eps", eps), expected, eps);
    }
}
