//! The f64 path against the balls: random points, the extremes, the surface.

use super::support::{decimal, oracle};
use lindstedt::Exact;
use lindstedt::unstable::number::ball::Balls;
use lindstedt_melnikov::{Axis, FastPoint, MelnikovError, StickSlip, surface};
use lindstedt_tests::Random;
use rug::Float;

fn exact(p: &FastPoint) -> StickSlip {
    p.map(|x| Exact::from_f64(*x).unwrap())
}

/// The largest relative error of `count` random points whose terms of G cancel at most fivefold.
fn worst_error(count: usize, seed: u64) -> f64 {
    let mut random = Random(seed);
    let balls = Balls::new(120);
    let mut worst = 0.0f64;
    let mut used = 0;
    while used < count {
        let a = random.between(-3.0, 3.0).exp();
        let b = random.between(-3.0, 3.0).exp();
        let speed = a / (2.0 * b).sqrt();
        // Half of the points close to |v*| = V, down to the last bits.
        let near = random.between(0.0, 1.0) < 0.5;
        let distance = random.between(-36.0, 0.0).exp();
        let ratio = if near { 1.0 - distance } else { random.between(-1.6, 1.6) };
        let omega = random.between(-4.0, 6.0).exp();
        let p = FastPoint {
            a,
            b,
            dry: random.between(-1.0, 1.0),
            alpha: random.between(-1.0, 1.0),
            beta: random.between(-1.0, 1.0),
            omega,
            belt_speed: ratio * speed,
        };
        let threshold = p.threshold().unwrap();
        if threshold.error > 5.0 * 8.0 * f64::EPSILON * threshold.signed.abs()
            || !threshold.signed.is_finite()
        {
            continue;
        }
        used += 1;
        let reference = exact(&p).signed_threshold(balls).unwrap();
        let difference = Float::with_val(160, threshold.signed) - reference.midpoint();
        let relative = (difference / reference.midpoint()).to_f64().abs();
        worst = worst.max(relative);
        assert!(relative < 4e-15, "{p:?}: {relative:e}");
        let ln = Float::with_val(160, reference.midpoint().abs_ref()).ln();
        let difference = (ln.clone() - threshold.ln_abs).to_f64().abs();
        assert!(
            difference <= 4e-15 + 4.0 * f64::EPSILON * ln.to_f64().abs(),
            "{p:?}: ln {difference:e}"
        );
    }
    worst
}

#[test]
fn random_points() {
    assert!(worst_error(20_000, 5) < 4e-15);
}

/// The full figure of the issue; run with `--ignored`.
#[test]
#[ignore = "a million points against the ball path: a minute"]
fn a_million_random_points() {
    assert!(worst_error(1_000_000, 6) < 4e-15);
}

fn hexadecimal(text: &str) -> f64 {
    let (negative, text) = text.strip_prefix('-').map_or((false, text), |rest| (true, rest));
    let (mantissa, exponent) = text.strip_prefix("0x").unwrap().split_once('p').unwrap();
    let (whole, fraction) = mantissa.split_once('.').unwrap();
    let digits = u64::from_str_radix(&format!("{whole}{fraction}"), 16).unwrap() as f64;
    let exponent = exponent.parse::<i32>().unwrap() - 4 * fraction.len() as i32;
    // Two steps: 2^exponent alone may leave the range.
    let value = digits * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
    if negative { -value } else { value }
}

#[test]
fn extremes() {
    for row in oracle("extremes.json").as_array().unwrap() {
        let mut arguments =
            row["args_hex"].as_array().unwrap().iter().map(|x| hexadecimal(x.as_str().unwrap()));
        let mut next = || arguments.next().unwrap();
        let p = FastPoint {
            a: next(),
            b: next(),
            dry: next(),
            alpha: next(),
            beta: next(),
            omega: next(),
            belt_speed: next(),
        };
        let what = row["case"].as_str().unwrap();
        let threshold = p.threshold().unwrap();
        // The ball path agrees with the oracle to its 30 digits.
        let ball = exact(&p).signed_threshold(Balls::new(320)).unwrap();
        super::support::assert_agrees(&ball, &row["gamma_signed"], 28, what);
        let expected = Float::with_val(160, decimal(row["gamma_signed"].as_str().unwrap()));
        let ln = decimal(row["ln_abs"].as_str().unwrap()).to_f64();
        if what.starts_with("near zero") {
            // Intrinsic: eps times the terms; the absolute error is bounded by the error field.
            let error = (Float::with_val(160, threshold.signed) - &expected).to_f64().abs();
            assert!(error <= threshold.error.max(2e-16), "{what}: {error:e} {:e}", threshold.error);
            continue;
        }
        assert!(
            (threshold.ln_abs - ln).abs() <= 4e-16 * ln.abs().max(4.0),
            "{what}: {} {ln}",
            threshold.ln_abs
        );
        if expected.to_f64().is_infinite() || expected > 1.7e308 {
            assert_eq!(threshold.signed, f64::INFINITY, "{what}");
        } else {
            let relative =
                ((Float::with_val(160, threshold.signed) - &expected) / &expected).to_f64().abs();
            assert!(relative < 2e-15, "{what}: {relative:e}");
        }
    }
}

#[test]
fn omega_over_three_hundred_decades() {
    let balls = Balls::new(200);
    let paper =
        FastPoint { a: 1.0, b: 1.0, dry: 0.3, alpha: 0.3, beta: 0.3, omega: 2.0, belt_speed: 0.4 };
    for omega in
        [1e-300, 1e-290, 1e-100, 1e-8, 1.0, 222.0, 223.0, 444.0, 451.0, 452.5, 460.0, 1e3, 1e4, 1e6]
    {
        let p = FastPoint { omega, ..paper };
        let threshold = p.threshold().unwrap();
        let reference = exact(&p).signed_threshold(balls).unwrap();
        let ln = Float::with_val(200, reference.midpoint().ln_ref()).to_f64();
        assert!((threshold.ln_abs / ln - 1.0).abs() < 1e-15, "ln at omega = {omega}");
        let expected = reference.midpoint().to_f64();
        if expected.is_finite() {
            assert!(
                (threshold.signed / expected - 1.0).abs() < 2e-15,
                "omega = {omega}: {} {expected}",
                threshold.signed
            );
        } else {
            assert_eq!(threshold.signed, f64::INFINITY);
        }
    }
}

#[test]
fn scales_over_the_whole_range() {
    let balls = Balls::new(200);
    let base =
        FastPoint { a: 1.0, b: 1.0, dry: 0.3, alpha: 0.3, beta: 0.3, omega: 2.0, belt_speed: 0.4 };
    let mut cases = Vec::new();
    for (a, b) in [
        (1e80, 1.0),
        (1e160, 1e10),
        (1.0, 1e-205),
        (1.0, 1e-300),
        (1e-80, 1e-100),
        (1e200, 1e200),
        (1e-3, 1e300),
    ] {
        for ratio in [0.0f64, 0.4, 0.999_999, 1.3] {
            let belt_speed = ratio * (a / (2.0f64 * b).sqrt());
            cases.push(FastPoint { a, b, belt_speed, omega: 2.0 * a.sqrt(), ..base });
        }
    }
    cases.push(FastPoint { belt_speed: 1e-200, ..base });
    cases.push(FastPoint { belt_speed: f64::MAX, ..base });
    cases.push(FastPoint { belt_speed: 5e-324, ..base });
    for p in cases {
        let threshold = p.threshold().unwrap();
        let reference = exact(&p).signed_threshold(balls).unwrap();
        let ln =
            Float::with_val(200, Float::with_val(200, reference.midpoint().abs_ref()).ln_ref())
                .to_f64();
        assert!(
            (threshold.ln_abs - ln).abs() <= 4e-16 * ln.abs().max(8.0),
            "{p:?}: {} {ln}",
            threshold.ln_abs
        );
        let expected = reference.midpoint().to_f64();
        if expected.is_finite() && expected.abs() > f64::MIN_POSITIVE {
            assert!(
                (threshold.signed / expected - 1.0).abs() < 4e-15,
                "{p:?}: {} {expected}",
                threshold.signed
            );
        }
    }
}

#[test]
fn refusals() {
    let base =
        FastPoint { a: 1.0, b: 1.0, dry: 0.3, alpha: 0.3, beta: 0.3, omega: 2.0, belt_speed: 0.4 };
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0, -f64::MAX] {
        for axis in [Axis::A, Axis::B, Axis::Omega] {
            assert!(base.with(axis, bad).threshold().is_err());
        }
        let _ = base.with(Axis::BeltSpeed, bad).threshold();
    }
    assert!(matches!(
        base.with(Axis::Dry, f64::NAN).threshold(),
        Err(MelnikovError::NotFinite { name: "T0" })
    ));
    let mut small = [0.0; 3];
    assert!(
        surface(&base, (Axis::B, &[1.0, 2.0]), (Axis::BeltSpeed, &[0.1, 0.2]), &mut small).is_err()
    );
    let mut table = [0.0; 4];
    surface(&base, (Axis::Omega, &[-1.0, 2.0]), (Axis::BeltSpeed, &[0.1, 0.4]), &mut table)
        .unwrap();
    assert!(table[0].is_nan() && table[1].is_nan());
    assert_eq!(table[3], base.threshold().unwrap().signed);
}
