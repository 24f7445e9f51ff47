//! The classical oscillators: proved to thirty digits, against closed forms and against the
//! integrator.

use crate::common::{digits, duffing, equation, field, guess, integrate, q, van_der_pol, x, y};
use lindstedt_equation::{Expression, Function};
use lindstedt_number::ball::Balls;
use lindstedt_orbit::{Field, Kind, Proof, Request, Sine, Stability, Start, family, prove};
use rug::float::Constant;
use rug::{Float, Rational};
use std::collections::BTreeMap;

const BITS: u32 = 300;

fn show(name: &str, proof: &Proof, seconds: f64) {
    println!(
        "{name}: {seconds:.3} s, N = {}, M = {}, nu - 1 = {:.1e}, r = {:.1e}, unique {:.1e}, Y0 {:.1e} Z0 {:.1e} Z1 {:.3} Z2 {:.1e}, T = {:.20} ({:.1} digits), max {:.12} ({:.1}), min {:.12} ({:.1}), exponent {:.8}",
        proof.modes,
        proof.solution_modes,
        proof.weight - 1.0,
        proof.radius.to_f64(),
        proof.unique_within.to_f64(),
        proof.bounds.y0.to_f64(),
        proof.bounds.z0,
        proof.bounds.z1,
        proof.bounds.z2,
        proof.period.midpoint(),
        digits(&proof.period),
        proof.motion.maximum.midpoint().to_f64(),
        digits(&proof.motion.maximum),
        proof.motion.minimum.midpoint().to_f64(),
        digits(&proof.motion.minimum),
        proof.exponent.midpoint().to_f64(),
    );
}

/// Proves with 30 digits, checks what every proof must say, and returns it.
fn thirty(name: &str, equation: &Expression, kind: &Kind, start: &Start) -> Proof {
    thirty_of(name, &field(equation), kind, start)
}

fn thirty_of(name: &str, field: &Field, kind: &Kind, start: &Start) -> Proof {
    let clock = std::time::Instant::now();
    let request = Request { digits: 30, ..Request::default() };
    let proof = prove(field, kind, start, &request).unwrap_or_else(|e| panic!("{name}: {e}"));
    show(name, &proof, clock.elapsed().as_secs_f64());
    assert!(digits(&proof.period) >= 30.0 && digits(&proof.motion.maximum) >= 30.0, "{name}");
    assert!(proof.bounds.z0 + proof.bounds.z1 < 1.0 && proof.unique_within > proof.radius);
    assert!(proof.least_period, "{name}");
    proof
}

fn contains(ball: &lindstedt_number::ball::Ball, value: &Float) -> bool {
    ball.contains(&value.to_rational().unwrap())
}

/// The period of x'' + p x + e x^3 = 0 with x(0) = a: 2 pi/(w agm(1, sqrt(1 - m))) with
/// w^2 = p + e a^2 and m = e a^2/(2 w^2) (Gradshteyn, Ryzhik 8.112, 8.129).
fn cubic_period(p: &Rational, e: &Rational, a: &Rational) -> Float {
    let square = Rational::from(e * a) * a;
    let w = Rational::from(p + &square);
    let m = square / &w / 2;
    let root = Float::with_val(BITS, Rational::from(1) - m).sqrt();
    let mean = Float::with_val(BITS, 1).agm(&root);
    Float::with_val(BITS, Constant::Pi) * 2u32 / (mean * Float::with_val(BITS, w).sqrt())
}

#[test]
fn duffing_periods_lie_in_their_balls() {
    for (n, d) in [(1, 2), (10, 1), (-9, 10), (-99, 100)] {
        let eps = Rational::from((n, d));
        let equation = duffing(q(n, d));
        let start = guess(&equation, [1.0, 0.0], 0.0).unwrap();
        let kind = Kind::InitialAmplitude(1.into());
        let proof = thirty(&format!("Duffing {eps}"), &equation, &kind, &start);
        let period = cubic_period(&1.into(), &eps, &1.into());
        assert!(contains(&proof.period, &period), "{eps}");
        assert!(
            proof.motion.maximum.contains(&1.into()) && proof.motion.minimum.contains(&(-1).into())
        );
        assert!(
            proof.motion.displacement.contains(&1.into())
                && proof.motion.velocity.contains(&0.into())
        );
    }
}

/// T = 2 pi/agm(1, cos(a/2)) for x'' + sin x = 0 with x(0) = a (Gradshteyn, Ryzhik 8.129).
#[test]
fn swinging_pendulums_lie_in_their_balls() {
    let pendulum = equation(x().apply(Function::Sin));
    let sine = Sine::of(&pendulum, "eps", &Default::default()).unwrap();
    for a in [(1, 1), (3, 1), (157, 50), (6283, 2000)] {
        let a = Rational::from(a);
        let (field, kind) = sine.field(&a, 30).unwrap();
        let proof = thirty_of(&format!("pendulum, a = {a}"), &field, &kind, &sine.start(&a));
        let half = Float::with_val(BITS, &a) / 2u32;
        let mean = Float::with_val(BITS, 1).agm(&Float::with_val(BITS, half.cos_ref()));
        let turn = Float::with_val(BITS, Constant::Pi) * 2u32;
        assert!(contains(&proof.period, &(turn / mean)), "{a}");
        assert!(contains(&proof.motion.maximum, &half.sin()), "{a}");
    }
}

/// A coefficient known to three digits gives an orbit known to three digits, around both ends.
#[test]
fn uncertain_coefficients_are_covered() {
    let equation = equation(x() + Expression::parameter("e") * x().pow(3));
    let balls = Balls::new(64);
    let middle = balls.from_rational(&Rational::from((1, 2)));
    let error = Rational::from((1, 1000));
    let ball = balls.add_error(&middle, &Float::with_val(53, &error));
    let values = BTreeMap::from([("e".to_owned(), ball)]);
    let field = Field::within(&equation, "eps", &values, 64).unwrap();
    let start = guess(&duffing(q(1, 2)), [1.0, 0.0], 0.0).unwrap();
    let kind = Kind::InitialAmplitude(1.into());
    let proof = prove(&field, &kind, &start, &Request::default()).unwrap();
    for sign in [-1, 1] {
        let eps = Rational::from((1, 2)) + error.clone() * sign;
        let period = cubic_period(&1.into(), &eps, &1.into());
        assert!(contains(&proof.period, &period));
    }
    assert!(digits(&proof.period) > 1.5 && digits(&proof.period) < 4.0);
    // An uncertain damping: the sum of the exponents is its negative.
    let force = Expression::Time.apply(Function::Cos);
    let damped = crate::common::equation(2 * x() + Expression::parameter("e") * y() - force);
    let field = Field::within(&damped, "eps", &values, 64).unwrap();
    let start = Start { frequency: 1.0, cosines: vec![0.0, 1.0], sines: vec![] };
    let proof = prove(&field, &Kind::Forced(1), &start, &Request::default()).unwrap();
    for sign in [-1, 1] {
        let end = Rational::from((-1, 2)) + error.clone() * sign;
        assert!(proof.exponent.contains(&end));
    }
}

/// Integrates over the proved period: the end must be the start as far as the digits go.
fn closes(equation: &Expression, proof: &Proof, slack: f64) {
    let state = [proof.motion.displacement.midpoint(), proof.motion.velocity.midpoint()];
    let state = state.map(|v| Float::with_val(BITS, v));
    let end = integrate(equation, &state, proof.period.midpoint(), 45);
    for (a, b) in end.iter().zip(&state) {
        let error = Float::with_val(BITS, a - b).abs();
        assert!(error < slack, "{error}");
    }
}

#[test]
fn van_der_pol_cycles_close() {
    // The periods by harmonic balance in doubles (numpy, 60 to 900 modes), 13 digits of them.
    let periods = [
        (1, 2, "6.3806758"),
        (1, 1, "6.663286859323"),
        (2, 1, "7.629874479674"),
        (5, 1, "11.61223066771"),
    ];
    for (n, d, period) in periods {
        let equation = van_der_pol(q(n, d));
        let start = guess(&equation, [2.0, 0.0], 60.0).unwrap();
        let proof = thirty(&format!("van der Pol {n}/{d}"), &equation, &Kind::LimitCycle, &start);
        assert!(
            proof.period.midpoint().to_string().starts_with(period),
            "{}",
            proof.period.midpoint()
        );
        assert_eq!(proof.stability, Stability::Stable);
        closes(&equation, &proof, 1e-28);
    }
}

#[test]
fn other_cycles_and_families_close() {
    // Rayleigh: x'' + x + (x'^3/3 - x') = 0.
    let rayleigh = equation(x() + q(1, 3) * y().pow(3) - y());
    let start = guess(&rayleigh, [2.0, 0.0], 60.0).unwrap();
    let proof = thirty("Rayleigh 1", &rayleigh, &Kind::LimitCycle, &start);
    closes(&rayleigh, &proof, 1e-28);
    // The derivative of Rayleigh's cycle is van der Pol's: the same period.
    assert!(proof.period.midpoint().to_string().starts_with("6.663286859323130"));
    let helmholtz = equation(x() + x().pow(2));
    let quintic = equation(x() + x().pow(5) * 3);
    let mixed = equation(x() + x().pow(2) * q(1, 3) + x() * y().pow(2) * q(1, 2));
    for (name, equation, a) in [
        ("Helmholtz", helmholtz, (2, 5)),
        ("quintic", quintic, (1, 1)),
        ("inertial", mixed, (3, 5)),
    ] {
        let a = Rational::from(a);
        let start = guess(&equation, [a.to_f64(), 0.0], 0.0).unwrap();
        let proof = thirty(name, &equation, &Kind::InitialAmplitude(a), &start);
        closes(&equation, &proof, 1e-28);
    }
}

/// x'' + x'/10 + x + x^3/2 = (3/10) cos(13 t/10): the three responses of the first harmonic.
#[test]
fn forced_responses_on_all_branches() {
    let angle = q(13, 10) * Expression::Time;
    let force = q(3, 10) * angle.apply(Function::Cos);
    let equation = equation(q(1, 10) * y() + x() + q(1, 2) * x().pow(3) - force);
    let (damping, rate, push) = (0.1 * 1.3, 1.3f64, 0.3);
    let detuning = |a: f64| 1.0 - rate * rate + 0.375 * a * a;
    let miss = |a: f64| a * a * (detuning(a).powi(2) + damping * damping) - push * push;
    let grid = (0..4000).map(|i| f64::from(i) * 1e-3);
    let roots: Vec<f64> = grid.filter(|a| miss(*a) * miss(*a + 1e-3) < 0.0).collect();
    assert_eq!(roots.len(), 3);
    let mut proofs: Vec<Proof> = Vec::new();
    for a in roots {
        let size = push / a;
        let start = Start {
            frequency: 0.0,
            cosines: vec![0.0, a * detuning(a) / size],
            sines: vec![0.0, a * damping / size],
        };
        let proof = thirty(&format!("forced Duffing, {a:.3}"), &equation, &Kind::Forced(1), &start);
        closes(&equation, &proof, 1e-28);
        assert!(proofs.iter().all(|other| other.is_separate_from(&proof)));
        // Liouville: the divergence is -1/10.
        assert!(proof.exponent.contains(&Rational::from((-1, 10))));
        proofs.push(proof);
    }
}

#[test]
fn van_der_pol_at_ten() {
    let equation = van_der_pol(q(10, 1));
    let start = guess(&equation, [2.0, 0.0], 60.0).unwrap();
    let proof = thirty("van der Pol 10", &equation, &Kind::LimitCycle, &start);
    closes(&equation, &proof, 1e-28);
}

#[test]
fn a_proof_in_the_precision_of_doubles_is_quick() {
    let equation = van_der_pol(q(1, 1));
    let start = guess(&equation, [2.0, 0.0], 60.0).unwrap();
    let field = field(&equation);
    let clock = std::time::Instant::now();
    let proof = prove(&field, &Kind::LimitCycle, &start, &Request::default()).unwrap();
    show("van der Pol 1, 15 digits", &proof, clock.elapsed().as_secs_f64());
    assert!(digits(&proof.period) >= 15.0);
}

/// Van der Pol from eps = 1/2 to 4, from two points to where Newton's steps must be halved; and a
/// family that ends: x'' + x - x^3 = 0 has no oscillation with x(0) > 1.
#[test]
fn families_are_followed_and_end_where_they_end() {
    let van_der_pol = |eps: &Rational| {
        Ok((field(&van_der_pol(Expression::Number(eps.clone()))), Kind::LimitCycle))
    };
    let start = Start { frequency: 0.98, cosines: vec![0.0, 2.0], sines: vec![] };
    let values = [(1, 2), (1, 1), (4, 1)].map(Rational::from);
    let members = family(&values, van_der_pol, &[start], &Request::default()).unwrap();
    let periods: Vec<f64> =
        members.iter().map(|m| m.proof.as_ref().unwrap().period.midpoint().to_f64()).collect();
    assert!((periods[0] - 6.380_675_801_773).abs() < 1e-11, "{periods:?}");
    assert!(periods.windows(2).all(|p| p[0] < p[1]) && periods[2] < 11.6, "{periods:?}");
    let soft = |a: &Rational| Ok((field(&duffing(q(-1, 1))), Kind::InitialAmplitude(a.clone())));
    let start = Start { frequency: 0.9, cosines: vec![0.0, 0.5], sines: vec![] };
    let values = [(1, 2), (9, 10), (11, 10), (6, 5)].map(Rational::from);
    let request = Request { modes_limit: 60, ..Request::default() };
    let members = family(&values, soft, &[start], &request).unwrap();
    let proved: Vec<bool> = members.iter().map(|m| m.proof.is_ok()).collect();
    assert_eq!(proved, [true, true, false]);
}

/// A proof as data.
#[test]
fn a_proof_is_written_with_its_class() {
    let start = Start { frequency: 1.17, cosines: vec![0.0, 1.0], sines: vec![] };
    let kind = Kind::InitialAmplitude(1.into());
    let proof = prove(&field(&duffing(q(1, 2))), &kind, &start, &Request::default()).unwrap();
    let data = serde_json::to_value(&proof).unwrap();
    assert_eq!(data["status"], "proved");
    assert_eq!(data["parity"]["even"], true);
    let period = data["period"]["midpoint"].as_str().unwrap();
    assert!(period.starts_with("5.366659355191767"), "{period}");
    let radius: f64 = data["period"]["radius"].as_str().unwrap().parse().unwrap();
    assert!(radius >= proof.period.radius().to_f64() && radius < 1e-15);
}
