//! Several unknowns: closed forms lie inside, integration over the proved period closes.

use crate::common::{cosine, digits, q};
use lindstedt_equation::Expression;
use lindstedt_number::ball::Balls;
use lindstedt_orbit::{
    Failure, Field, Kind, Proof, Request, Stability, guesses_all, prove_all, prove_each,
};
use lindstedt_simulate::{Digits, Integrator, Model, Parameters, Real, Settings, go_on};
use rug::float::Constant;
use rug::{Float, Rational};

const BITS: u32 = 200;

fn x(k: usize) -> Expression {
    Expression::unknown(k, 0)
}

fn v(k: usize) -> Expression {
    Expression::unknown(k, 1)
}

/// x_k'' + rest_k = 0.
fn system(rests: &[Expression]) -> Field {
    let one = |(k, rest): (usize, &Expression)| Expression::unknown(k, 2) + rest.clone();
    let equations: Vec<_> = rests.iter().enumerate().map(one).collect();
    let list: Vec<_> = equations.iter().collect();
    Field::of_equations(&list, "eps", &Default::default()).unwrap()
}

/// The orbits that are proved with 30 digits from all guesses.
fn orbits(rests: &[Expression], kind: &Kind) -> Vec<Proof> {
    let field = system(rests);
    let request = Request { digits: 30, ..Request::default() };
    let prove = |starts: Vec<_>| {
        let proof = prove_all(&field, kind, &starts, &request).unwrap();
        assert!(digits(&proof.period) >= 30.0);
        closes(rests, &proof);
        proof
    };
    guesses_all(&field, kind, &Default::default()).unwrap().into_iter().map(prove).collect()
}

/// Taylor integration over the proved period: the end must be the start.
fn closes(rests: &[Expression], proof: &Proof) {
    let n = rests.len();
    let named = |e: &Expression| match e {
        Expression::Unknown(u) => {
            let letter = ["x", "v"][u.derivative as usize];
            Some(Expression::parameter(&format!("{letter}{}", u.index)))
        }
        _ => None,
    };
    let names: Vec<String> =
        ["x", "v"].iter().flat_map(|l| (0..n).map(move |k| format!("{l}{k}"))).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let velocities = (0..n).map(|k| Expression::parameter(&format!("v{k}")));
    let forces = rests.iter().map(|rest| -rest.map(&named));
    let right_sides: Vec<_> = velocities.chain(forces).collect();
    let real = Digits::for_digits(40);
    let model = Model::first_order(&names, &right_sides).unwrap();
    let system = model.compile(real, &Parameters::new()).unwrap();
    let states: Vec<_> =
        (0..n).map(|k| proof.unknown_at_phase(k, &Balls::new(BITS).zero()).unwrap()).collect();
    let start: Vec<Float> = states
        .iter()
        .map(|(x, _)| x)
        .chain(states.iter().map(|(_, v)| v))
        .map(|b| Float::with_val(BITS, b.midpoint()))
        .collect();
    let start: Vec<_> = start.iter().map(|x| real.float(x)).collect();
    let zero = real.float(&Float::new(53));
    let mut flow = Integrator::new(&system, &zero, &start, Settings::for_digits(40)).unwrap();
    flow.advance(&real.float(proof.period.midpoint()), &mut |_| go_on()).unwrap();
    for (a, b) in flow.state().iter().zip(&start) {
        let error = Float::with_val(BITS, a - b).abs();
        assert!(error < 1e-26, "{error}");
    }
}

/// Two equal Duffing oscillators with a spring between them: in phase x'' + x + x^3 = 0, against each other
/// x'' + (1 + 2 c) x + x^3 = 0, both with a period in closed form.
#[test]
fn symmetric_normal_modes_contain_their_closed_forms() {
    let rest = |i: usize| x(i) + x(i).pow(3) + q(1, 4) * (x(i) - x(1 - i));
    let proofs = orbits(&[rest(0), rest(1)], &Kind::InitialAmplitude(1.into()));
    assert_eq!(proofs.len(), 2);
    for (proof, stiffness) in proofs.iter().zip([1.0, 1.5]) {
        // 2 pi/(w agm(1, sqrt(1 - m))), w^2 = p + 1, m = 1/(2 w^2).
        let square = Float::with_val(BITS, stiffness + 1.0);
        let m = Float::with_val(BITS, 2 * &square).recip();
        let mean = Float::with_val(BITS, 1).agm(&Float::with_val(BITS, 1 - m).sqrt());
        let period = Float::with_val(BITS, Constant::Pi) * 2u32 / (mean * square.sqrt());
        assert!(proof.period.contains(&period.to_rational().unwrap()));
        assert!(proof.parity.odd && proof.parity.even);
    }
}

/// Modes whose shape is no straight line, with masses that couple the accelerations.
#[test]
fn curved_normal_modes_close() {
    let rests = [
        x(0) + q(1, 2) * x(0).pow(3) + q(1, 4) * (x(0) - x(1)),
        2 * x(1) + q(1, 4) * (x(1) - x(0)),
    ];
    assert_eq!(orbits(&rests, &Kind::InitialAmplitude(1.into())).len(), 2);
    // Two equal Duffing oscillators apart: the second at rest.
    let rests = [x(0) + x(0).pow(3), x(1) + x(1).pow(3)];
    let proofs = orbits(&rests, &Kind::InitialAmplitude((1, 2).into()));
    assert_eq!(proofs.len(), 1);
    // x_1'' + x_2''/2 + x_1 = 0, x_1''/2 + x_2'' + 2 x_2 = 0, solved for the accelerations.
    let [a, b] = [0, 1].map(|k| Expression::unknown(k, 2));
    let coupled = [a.clone() + q(1, 2) * b.clone() + x(0), q(1, 2) * a + b + 2 * x(1)];
    let list: Vec<_> = coupled.iter().collect();
    let field = Field::of_equations(&list, "eps", &Default::default()).unwrap();
    let solved = system(&[q(4, 3) * (x(0) - x(1)), q(4, 3) * (2 * x(1) - q(1, 2) * x(0))]);
    let kind = Kind::InitialAmplitude(1.into());
    let periods = |field: &Field| -> Vec<f64> {
        let guesses = guesses_all(field, &kind, &Default::default()).unwrap();
        guesses.iter().map(|starts| starts[0].frequency).collect()
    };
    assert_eq!(periods(&field).len(), 2);
    assert!(periods(&field).iter().zip(periods(&solved)).all(|(a, b)| (a - b).abs() < 1e-9));
}

/// Two van der Pol oscillators that differ: they lock.
#[test]
fn coupled_cycles_close() {
    let rest = |i: usize, detuned: i64| {
        q(10 + detuned, 10) * x(i)
            + q(1, 2) * (x(i).pow(2) - 1) * v(i)
            + q(1, 2) * (v(i) - v(1 - i))
    };
    let rests = [rest(0, 0), rest(1, 2)];
    let proofs = orbits(&rests, &Kind::LimitCycle);
    assert!(!proofs.is_empty());
    assert!(proofs.iter().all(|p| p.exponent.is_negative() && p.stability == Stability::Undecided));
}

/// A pendulum on a spring at 1:2 with damping and a force on the spring: the spring has even harmonics
/// of half its frequency, the pendulum odd ones.
#[test]
fn forced_pendulum_on_a_spring_closes() {
    let force = q(1, 5) * cosine(2 * Expression::Time);
    let rests = [
        x(0) + q(1, 20) * v(0) - q(3, 1) * q(1, 10) * x(0) * x(1),
        4 * x(1) + q(1, 20) * v(1) - q(3, 2) * q(1, 10) * x(0).pow(2) - force,
    ];
    let proofs = orbits(&rests, &Kind::Forced(2));
    let swinging = proofs.iter().find(|p| p.motion.maximum.is_positive()).unwrap();
    assert!(swinging.parity.odd);
    assert!(swinging.exponent.contains(&Rational::from((-1, 10))));
}

/// Two equal Duffing oscillators with a spring between and one force on both: in phase they are one, with its
/// three responses, of which one is unstable.
#[test]
fn unstable_responses_of_two_unknowns_are_found() {
    let one = |i: usize| {
        let force = q(3, 10) * cosine(q(13, 10) * Expression::Time);
        let own = q(1, 10) * v(i) + x(i) + q(1, 2) * x(i).pow(3);
        own + 2 * (x(i) - x(1 - i)) - force
    };
    let (field, kind) = (system(&[one(0), one(1)]), Kind::Forced(1));
    let guesses = guesses_all(&field, &kind, &Default::default()).unwrap();
    let proofs = prove_each(&field, &kind, Vec::new(), &guesses, &Request::default()).unwrap();
    let maxima: Vec<f64> = proofs.iter().map(|p| p.motion.maximum.midpoint().to_f64()).collect();
    // Those of one oscillator.
    for known in [0.489_414, 1.096_356, 1.516_913] {
        assert!(maxima.iter().any(|m| (m - known).abs() < 1e-6), "{maxima:?}");
    }
}

#[test]
fn accelerations_that_do_not_stand_alone_are_refused() {
    let [a, b] = [0, 1].map(|k| Expression::unknown(k, 2));
    let of = |one: Expression, two: Expression| {
        Field::of_equations(&[&one, &two], "eps", &Default::default())
    };
    let equal = of(a.clone() + b.clone() + x(0), a.clone() + b.clone() + x(1));
    assert!(matches!(equal, Err(Failure::Acceleration(_))));
    let product = of(a.clone() * x(1) + x(0), b.clone() + x(1));
    assert!(matches!(product, Err(Failure::Acceleration(_))));
    let square = of(a.clone() * a + x(0), b + x(1));
    assert!(matches!(square, Err(Failure::Acceleration(_))));
}
