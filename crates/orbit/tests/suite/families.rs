//! All values between two proved orbits, and orbits told apart.

use crate::common::{duffing, field, guess, proved, q, x, y};
use lindstedt_equation::{Expression, Function, Problem};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_orbit::{
    Cover, Failure, Field, Kind, Proof, Request, Start, cover, family, guesses, guesses_all, prove,
};
use rug::Rational;
use std::collections::BTreeMap;

type Values = BTreeMap<String, Rational>;

fn at(name: &str, value: &Rational) -> Values {
    Values::from([(name.to_owned(), value.clone())])
}

/// The proofs at both ends and in the middle, and what is proved between.
fn between(
    problem: &Problem,
    kind: &Kind,
    name: &str,
    ends: &[Rational; 2],
    start: &Start,
) -> (Vec<Proof>, Cover) {
    let middle = Rational::from(&ends[0] + &ends[1]) / 2;
    let proofs: Vec<Proof> = [&ends[0], &middle, &ends[1]]
        .map(|value| {
            let field = Field::of_problem(problem, &at(name, value)).unwrap();
            prove(&field, kind, start, &Request::default()).unwrap()
        })
        .into();
    let part = |part: &[Rational; 2]| {
        Ok((Field::between(problem, &at(name, &ends[0]), name, part)?, kind.clone()))
    };
    let found = cover(ends, [&proofs[0], &proofs[2]], part, &Request::default());
    (proofs, found)
}

fn inside(outer: &Ball, inner: &Ball) -> bool {
    outer.lower() <= inner.lower() && inner.upper() <= outer.upper()
}

/// Van der Pol from 1/2 to 1 in steps of 1/10 and the rest, without a gap.
#[test]
fn all_cycles_between_two_are_one_family() {
    let damping = Expression::Small * (x().pow(2) - 1) * y();
    let equation = Expression::ACCELERATION + x() + damping;
    let problem = Problem::new("cycle", equation);
    let start = Start { frequency: 0.98, cosines: vec![0.0, 2.0], sines: vec![] };
    for ends in [[q2(1, 2), q2(3, 5)], [q2(1, 1), q2(9, 10)]] {
        let (proofs, found) = between(&problem, &Kind::LimitCycle, "eps", &ends, &start);
        println!("{} parts", found.parts);
        assert!(found.failure.is_none() && found.until == ends[1], "{:?}", found.failure);
        let frequencies = found.frequency.unwrap();
        assert!(proofs.iter().all(|proof| inside(&frequencies, &proof.frequency)));
        // Not much wider than what the ends need.
        let apart =
            proofs[0].frequency.midpoint().to_f64() - proofs[2].frequency.midpoint().to_f64();
        let width = 2.0 * frequencies.radius().to_f64();
        assert!(width < 1.2 * apart.abs(), "{width} {apart}");
    }
}

fn q2(n: i64, d: i64) -> Rational {
    Rational::from((n, d))
}

/// x'' + x'/10 + x + x^3/2 = (3/10) cos(w t): the unit of time varies with w.
fn response() -> Problem {
    let angle = Expression::parameter("w") * Expression::Time;
    let spring = x() + q(1, 2) * x().pow(3);
    let equation =
        Expression::ACCELERATION + q(1, 10) * y() + spring - q(3, 10) * angle.apply(Function::Cos);
    Problem::new("response", equation)
}

#[test]
fn responses_between_two_frequencies_are_proved_and_branches_are_not_mixed() {
    let (problem, kind) = (response(), Kind::Forced(1));
    let ends = [q2(13, 10), q2(131, 100)];
    let field = |w: &Rational| Field::of_problem(&problem, &at("w", w)).unwrap();
    let starts = guesses(&field(&ends[0]), &kind, &Default::default()).unwrap();
    let (proofs, found) = between(&problem, &kind, "w", &ends, &starts[0]);
    assert!(found.failure.is_none(), "{:?}", found.failure);
    println!("{} parts", found.parts);
    // The large one and the unstable one between.
    for start in &starts[1..] {
        let clock = std::time::Instant::now();
        let (_, found) = between(&problem, &kind, "w", &ends, start);
        println!("{} parts, {:?}", found.parts, clock.elapsed());
        assert!(found.failure.is_none(), "{:?}", found.failure);
    }
    // From the small response at one end to the large one at the other nothing is proved.
    let other = prove(&field(&ends[1]), &kind, &starts[2], &Request::default()).unwrap();
    let part = |part: &[Rational; 2]| {
        Ok((Field::between(&problem, &at("w", &ends[0]), "w", part)?, kind.clone()))
    };
    let mixed = cover(&ends, [&proofs[0], &other], part, &Request::default());
    assert!(mixed.failure.is_some());
}

#[test]
fn amplitudes_between_two_have_the_periods_between() {
    let field = field(&duffing(q(1, 1)));
    let start = guess(&duffing(q(1, 1)), [1.0, 0.0], 0.0).unwrap();
    let ends = [q2(1, 1), q2(21, 20)];
    for kind in [Kind::InitialAmplitude(1.into()), Kind::FundamentalAmplitude(1.into())] {
        let amplitude = |a: &Rational| match kind {
            Kind::InitialAmplitude(_) => Kind::InitialAmplitude(a.clone()),
            _ => Kind::FundamentalAmplitude(a.clone()),
        };
        let at = |a: &Rational| prove(&field, &amplitude(a), &start, &Request::default()).unwrap();
        let proofs = [at(&ends[0]), at(&ends[1])];
        let part =
            |part: &[Rational; 2]| Ok((field.clone(), kind.between(part).ok_or(Failure::NoStart)?));
        let found = cover(&ends, [&proofs[0], &proofs[1]], part, &Request::default());
        assert!(found.failure.is_none(), "{:?}", found.failure);
        assert!(inside(&found.frequency.unwrap(), &at(&q2(51, 50)).frequency));
    }
}

#[test]
fn the_ball_of_a_neighbour_excludes_an_orbit_and_its_own_holds_it() {
    let equation = duffing(q(1, 2));
    let start = guess(&equation, [1.0, 0.0], 0.0).unwrap();
    let at = |a: Rational, digits| {
        proved(&equation, &Kind::InitialAmplitude(a), &start, digits).unwrap()
    };
    let (one, fine) = (at(1.into(), 12), at(1.into(), 30));
    let neighbour = at(q2(1001, 1000), 12);
    assert!(neighbour.is_separate_from(&one) && !fine.is_separate_from(&one));
    assert!(fine.is_same_as(&one) && one.is_same_as(&fine));
    // The guess is within the ball of uniqueness, a far one is not.
    assert!(fine.distance_from(&one.start()) < fine.unique_within);
    let far = Start { cosines: vec![0.0, 3.0], ..one.start() };
    assert!(fine.distance_from(&far) > fine.unique_within);
    // Another amplitude is another question, however near it is.
    assert!(!neighbour.is_same_as(&one) && neighbour.distance_from(&one.start()) < 0.01);
}

/// The orbits of several unknowns at both ends and what is proved between; the first guess.
fn between_all(problem: &Problem, kind: &Kind, name: &str, ends: &[Rational; 2]) -> Cover {
    let of = |value: &Rational| Field::of_problem(problem, &at(name, value));
    let guesses = guesses_all(&of(&ends[0]).unwrap(), kind, &Default::default()).unwrap();
    let members =
        family(ends, |value| Ok((of(value)?, kind.clone())), &guesses[0], &Request::default());
    let proofs: Vec<Proof> = members.unwrap().into_iter().map(|m| m.proof.unwrap()).collect();
    let part = |part: &[Rational; 2]| {
        Ok((Field::between(problem, &Values::new(), name, part)?, kind.clone()))
    };
    let found = cover(ends, [&proofs[0], &proofs[1]], part, &Request::default());
    if let Some(frequencies) = &found.frequency {
        assert!(proofs.iter().all(|proof| inside(frequencies, &proof.frequency)));
    }
    found
}

/// x'' + sin(k x) = 0: the parameter in the argument of a function; and a damped pendulum with a force, the
/// unit of time varying with its frequency.
#[test]
fn functions_between_two_values_are_proved() {
    let k = Expression::parameter("k");
    let swinging = Expression::ACCELERATION + (k * x()).apply(Function::Sin);
    let swinging = Problem::new("swinging", swinging);
    let kind = Kind::InitialAmplitude(1.into());
    let found = between_all(&swinging, &kind, "k", &[q2(1, 1), q2(1001, 1000)]);
    assert!(found.failure.is_none(), "{:?}", found.failure);
    let force = q(3, 10) * (Expression::parameter("w") * Expression::Time).apply(Function::Cos);
    let rest = q(1, 5) * y().apply(Function::Sin) + x().apply(Function::Sin) - force;
    let driven = Problem::new("driven", Expression::ACCELERATION + rest);
    let ends = [q2(13, 10), q2(13_001, 10_000)];
    let found = between_all(&driven, &Kind::Forced(1), "w", &ends);
    assert!(found.failure.is_none(), "{:?}", found.failure);
}

/// Two Duffing oscillators with a spring c between them, one of them driven with the frequency w.
#[test]
fn several_unknowns_between_two_values_are_proved() {
    let (c, u) = (Expression::parameter("c"), Expression::unknown(1, 0));
    let spring = |a: Expression, b: Expression| a.clone() + a.clone().pow(3) + c.clone() * (a - b);
    let other = Expression::unknown(1, 2) + spring(u.clone(), x());
    let mut free =
        Problem::new("free", Expression::ACCELERATION + spring(x(), u.clone()) + q(1, 9) * x());
    free.others = vec![other];
    let kind = Kind::InitialAmplitude(1.into());
    let found = between_all(&free, &kind, "c", &[q2(1, 2), q2(501, 1000)]);
    assert!(found.failure.is_none(), "{:?}", found.failure);
    let force = (Expression::parameter("w") * Expression::Time).apply(Function::Cos);
    let damped = |a: Expression, k: usize| q(1, 2) * Expression::unknown(k, 1) + a;
    let mut driven = Problem::new(
        "driven",
        Expression::ACCELERATION + damped(2 * x() - u.clone(), 0) - q(1, 5) * force,
    );
    driven.others = vec![2 * Expression::unknown(1, 2) + damped(2 * u.clone() + u.pow(3) - x(), 1)];
    let ends = [q2(2, 1), q2(2001, 1000)];
    let found = between_all(&driven, &Kind::Forced(1), "w", &ends);
    assert!(found.failure.is_none(), "{:?}", found.failure);
}

#[test]
fn frequencies_that_are_not_proportional_are_refused() {
    let wave = |angle: Expression| angle.apply(Function::Cos);
    let w = || Expression::parameter("w");
    let part = [q2(1, 1), q2(2, 1)];
    let of = |force: Expression| {
        let problem = Problem::new("p", Expression::ACCELERATION + x() - force);
        Field::between(&problem, &Values::new(), "w", &part)
    };
    let t = || Expression::Time;
    assert!(of(wave(w() * t()) + wave(2 * w() * t() + x() + w())).is_ok());
    for refused in [
        wave(w() * t()) + wave(t()),
        wave((w() + 1) * t()),
        wave(w() * w() * t()),
        wave(w() * t().pow(2)),
        wave(x() * wave(w() * t()) + t()),
    ] {
        assert!(matches!(of(refused), Err(Failure::NotPolynomial(_))));
    }
}

/// A coefficient around 0 has no symmetry that its middle alone has.
#[test]
fn what_is_uncertain_about_zero_breaks_symmetries() {
    let balls = Balls::new(128);
    let about_zero = balls.add_error(&balls.zero(), &rug::Float::with_val(53, 1e-6));
    let values = BTreeMap::from([("k".to_owned(), about_zero)]);
    let start = Start { frequency: 1.0, cosines: vec![0.0, 0.2], sines: vec![] };
    let k = Expression::parameter("k");
    let symmetric = |by: Expression| {
        let rest = 2 * x() + x().pow(3) - q(1, 5) * Expression::Time.apply(Function::Cos) + by;
        let equation = Expression::ACCELERATION + rest;
        let field = Field::within(&equation, "eps", &values, 128).unwrap();
        let proof =
            prove(&field, &Kind::Forced(1), &start, &Request { digits: 5, ..Request::default() });
        let parity = proof.unwrap().parity;
        (parity.odd, parity.even)
    };
    assert_eq!(symmetric(k.clone() * x()), (true, true));
    assert_eq!(symmetric(k.clone() * x().pow(2)), (false, true));
    assert_eq!(symmetric(k * Expression::Time.apply(Function::Sin)), (true, false));
}
