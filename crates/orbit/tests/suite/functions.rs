//! Sines, exponentials and roots: closed forms lie inside, integration over the proved period closes.

use crate::common::{cosine, digits, equation, field, guess, integrate, q, x, y};
use lindstedt_equation::{Expression, Function};
use lindstedt_orbit::{Failure, Field, Kind, Proof, Request, Start, prove};
use rug::float::Constant;
use rug::{Float, Rational};

const BITS: u32 = 200;

fn request() -> Request {
    Request { digits: 30, ..Request::default() }
}

fn exp(e: Expression) -> Expression {
    e.apply(Function::Exp)
}

fn sin(e: Expression) -> Expression {
    e.apply(Function::Sin)
}

/// Proves the orbit from x(0) = a at rest with 30 digits.
fn from_rest(equation: &Expression, a: (i64, i64)) -> Proof {
    let a = Rational::from(a);
    let start = guess(equation, [a.to_f64(), 0.0], 0.0).unwrap();
    let clock = std::time::Instant::now();
    let proof = prove(&field(equation), &Kind::InitialAmplitude(a), &start, &request()).unwrap();
    println!(
        "{:.3} s, N = {}, r = {:.1e}, Z1 = {:.3}, Z2 = {:.1e}, T = {:.25}",
        clock.elapsed().as_secs_f64(),
        proof.modes,
        proof.radius.to_f64(),
        proof.bounds.z1,
        proof.bounds.z2,
        proof.period.midpoint()
    );
    assert!(digits(&proof.period) >= 30.0 && proof.unique_within > proof.radius);
    proof
}

/// Integrates over the proved period: the end must be the start as far as the digits go.
fn closes(equation: &Expression, proof: &Proof) {
    let state = [proof.motion.displacement.midpoint(), proof.motion.velocity.midpoint()];
    let state = state.map(|v| Float::with_val(BITS, v));
    let end = integrate(equation, &state, proof.period.midpoint(), 40);
    for (a, b) in end.iter().zip(&state) {
        let error = Float::with_val(BITS, a - b).abs();
        assert!(error < 1e-27, "{error}");
    }
}

fn contains(proof: &Proof, period: &Float) -> bool {
    proof.period.contains(&period.to_rational().unwrap())
}

/// Morse's potential (1 - e^-x)^2/2: T = 2 pi/sqrt(1 - (1 - e^-a)^2).
#[test]
fn periods_in_morse_potential() {
    let morse = equation(exp(-x()) - exp(-2 * x()));
    let proof = from_rest(&morse, (1, 1));
    let depth = Float::with_val(BITS, 1 - Float::with_val(BITS, -1).exp());
    let period = Float::with_val(BITS, Constant::Pi) * 2u32
        / Float::with_val(BITS, 1 - depth.square()).sqrt();
    assert!(contains(&proof, &period), "{period}");
}

/// x'' + sin x = 0 itself, without u = sin(x/2): T = 2 pi/agm(1, cos(a/2)).
#[test]
fn pendulums_as_they_stand() {
    let pendulum = equation(sin(x()));
    for a in [1, 3] {
        let proof = from_rest(&pendulum, (a, 1));
        let half = Float::with_val(BITS, a) / 2u32;
        let mean = Float::with_val(BITS, 1).agm(&half.cos());
        assert!(contains(&proof, &(Float::with_val(BITS, Constant::Pi) * 2u32 / mean)), "{a}");
    }
}

#[test]
fn exponentials_quotients_and_roots_close() {
    let toda = equation(exp(x()) - 1);
    let quotient = equation(x() * (x().pow(2) + 1).pow(-1));
    let relativistic = equation(x() * (q(1, 1) - y().pow(2)).pow(q(3, 2)));
    let radial = equation(x().pow(-2) - x().pow(-3));
    let nested = equation(exp(sin(x())) - 1);
    for (equation, a) in [
        (toda, (1, 1)),
        (quotient, (3, 2)),
        (relativistic, (1, 1)),
        (radial, (5, 4)),
        (nested, (1, 2)),
    ] {
        let proof = from_rest(&equation, a);
        closes(&equation, &proof);
    }
}

/// The driven, damped pendulum: the three responses that swing about x = 0.
#[test]
fn responses_of_the_driven_pendulum_close() {
    let angle = q(2, 3) * Expression::Time;
    let driven = equation(q(1, 10) * y() + sin(x()) - q(1, 5) * cosine(angle));
    let mut proofs: Vec<Proof> = Vec::new();
    for (cosine, sine) in [(0.36, 0.0), (1.8, 1.6), (-1.5, 1.6)] {
        let start = Start { frequency: 0.0, cosines: vec![0.0, cosine], sines: vec![0.0, sine] };
        let proof = prove(&field(&driven), &Kind::Forced(1), &start, &request()).unwrap();
        println!("N = {}, max {:.12}", proof.modes, proof.motion.maximum.midpoint().to_f64());
        assert!(proofs.iter().all(|other| other.is_separate_from(&proof)));
        closes(&driven, &proof);
        assert!(proof.exponent.contains(&Rational::from((-1, 10))));
        proofs.push(proof);
    }
}

/// A phase in the force, and a wave that travels with x.
#[test]
fn phases_and_travelling_waves() {
    let force = cosine(2 * Expression::Time + q(1, 3)) + q(1, 2) * sin(x() - 2 * Expression::Time);
    let driven = equation(q(1, 5) * y() + x() - force);
    let start = Start { frequency: 2.0, cosines: vec![0.0, -0.3], sines: vec![] };
    let proof = prove(&field(&driven), &Kind::Forced(1), &start, &request()).unwrap();
    closes(&driven, &proof);
}

/// What is not smooth where the orbit passes, and what no function here is.
#[test]
fn what_leaves_the_classes_is_refused() {
    let of = |rest: Expression| Field::new(&equation(rest), "eps", &Default::default());
    let size = || x().apply(Function::Abs);
    for rest in [x() * size(), size().pow(3), x().pow(q(1, 3)), x() * x().pow(2).pow(q(1, 2))] {
        assert!(matches!(of(rest), Err(Failure::NotSmooth(_))));
    }
    let logarithm = of(x() + (x().pow(2) + 1).apply(Function::Ln));
    assert!(matches!(logarithm, Err(Failure::NotPolynomial(_))));
    let drifting = of(x() + Expression::Time * x());
    assert!(matches!(drifting, Err(Failure::NotPolynomial(_))));
    // Quotients are taken, so many of them are not.
    let quotients =
        |count: i64| (1..=count).fold(x(), |sum, k| sum + x() * (x().pow(2) + k).pow(-1));
    assert!(of(quotients(20)).is_ok());
    assert_eq!(of(quotients(50)).err(), Some(Failure::TooManyTerms));
    // 1/x on an orbit that passes 0.
    let start = Start { frequency: 1.0, cosines: vec![0.0, 1.0], sines: vec![] };
    let pole = of(x() + q(1, 10) * x().pow(-1)).unwrap();
    let few = Request { modes_limit: 20, ..request() };
    let failed = prove(&pole, &Kind::InitialAmplitude(1.into()), &start, &few);
    assert!(failed.is_err(), "{failed:?}");
}
