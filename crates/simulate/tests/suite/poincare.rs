//! Poincare sections at events, and the largest exponent, against closed forms.

use crate::common::{parameters, stick_slip};
use lindstedt_equation::{Crossing, Expression, Impact};
use lindstedt_simulate::{
    Doubles, LyapunovSettings, Model, Parameters, PoincareMap, Section, Settings, SimulateError,
    Surface, go_on, largest_lyapunov_exponent, largest_lyapunov_exponents,
};
use rug::Rational;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// x'' = -x over a wall at 0, x' -> -x'/2: an impact every pi, everything halves.
fn bouncing() -> Model {
    let half = Expression::Number(Rational::from((1, 2)));
    let wall = Impact {
        position: Expression::Number(Rational::new()),
        crossing: Crossing::Falling,
        restitution: half,
    };
    let equation = Expression::ACCELERATION + Expression::DISPLACEMENT;
    Model::second_order(&equation).unwrap().with_wall(wall)
}

#[test]
fn impacts() {
    let system = bouncing().compile(Doubles, &Parameters::new()).unwrap();
    let section = Section::Events { surface: Surface::Wall(0), rising: None, patience: 4.0 };
    let settings = Settings::for_digits(16);
    let mut map = PoincareMap::new(&system, &0.0, &[1.0, 0.0], section, settings).unwrap();
    for n in 0..20 {
        let point = map.next_point(&go_on).unwrap().unwrap();
        assert!((point.time - PI * (f64::from(n) + 0.5)).abs() < 1e-13);
        assert!((point.state[1] * f64::from(n + 1).exp2() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn patience_ends() {
    let system = bouncing().compile(Doubles, &Parameters::new()).unwrap();
    let section = Section::Events { surface: Surface::Wall(0), rising: None, patience: 1.0 };
    let settings = Settings::for_digits(16);
    let mut map = PoincareMap::new(&system, &0.0, &[1.0, 0.0], section, settings).unwrap();
    assert_eq!(map.next_point(&go_on), Ok(None));
    // The next call waits on from there.
    assert!(map.next_point(&go_on).unwrap().is_some());
}

/// Entries into sticking and releases alternate; only at entries the point is stuck.
#[test]
fn switchings_of_the_stick_slip_orbit() {
    let system = stick_slip().compile(Doubles, &parameters(&[("gamma", "0.6")])).unwrap();
    let section = Section::Events { surface: Surface::Switch(0), rising: None, patience: 20.0 };
    let settings = Settings::for_digits(16);
    let mut map = PoincareMap::new(&system, &0.0, &[0.11, 0.05], section, settings).unwrap();
    let (mut stuck, mut free) = (0, 0);
    for _ in 0..100 {
        let point = map.next_point(&go_on).unwrap().unwrap();
        assert!((point.state[1] - 0.4).abs() < 1e-14);
        assert_eq!(point.modes, map.flow().modes());
        if point.stuck() { stuck += 1 } else { free += 1 }
    }
    assert!(stuck >= 20 && free >= 20, "{stuck} {free}");
}

#[test]
fn the_exponent_of_the_bouncing_oscillator() {
    let system = bouncing().linearised().compile(Doubles, &Parameters::new()).unwrap();
    let integration = Settings::for_digits(16);
    let settings = LyapunovSettings { interval: PI, transient: 5, averaged: 40, integration };
    let mut intervals = 0;
    let mut run = |most| {
        largest_lyapunov_exponent(&system, &0.0, &[1.0, 0.0], &settings, &mut |n| {
            intervals = n;
            if n < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })
    };
    let exponent = run(u32::MAX).unwrap().unwrap();
    assert!((exponent.value + 2f64.ln() / PI).abs() < 1e-12, "{exponent:?}");
    assert!(exponent.error < 1e-12);
    assert_eq!(run(7), Ok(None));
    assert_eq!(intervals, 7);
    let plain = bouncing().compile(Doubles, &Parameters::new()).unwrap();
    let outcome = largest_lyapunov_exponent(&plain, &0.0, &[1.0, 0.0], &settings, &mut |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(outcome, Err(SimulateError::WrongDimension { states: 2, given: 0 }));
}

/// The impacts at (n + 1/2) pi fall on the ends of the intervals, to rounding errors: on either
/// side of them.
#[test]
fn impacts_at_the_ends_of_the_intervals() {
    let linearised = bouncing().linearised().compile(Doubles, &Parameters::new()).unwrap();
    let integration = Settings::for_digits(16);
    let settings = LyapunovSettings { interval: PI, transient: 5, averaged: 400, integration };
    let exponent = |time: f64, state: [f64; 2]| {
        let go_on = &mut |_: u32| ControlFlow::Continue(());
        largest_lyapunov_exponent(&linearised, &time, &state, &settings, go_on).unwrap().unwrap()
    };
    let expected = -2f64.ln() / PI;
    assert!((exponent(0.0, [1.0, 0.0]).value - expected).abs() < 1e-12);
    // ln 2 more or less, once.
    let at_impacts = exponent(0.0, [0.0, 1.0]);
    assert!(
        (at_impacts.value - expected).abs() < 2f64.ln() / (400.0 * PI) + 1e-12,
        "{at_impacts:?}"
    );
    let system = bouncing().compile(Doubles, &Parameters::new()).unwrap();
    let start = [0.0, 1.0];
    let mut map =
        PoincareMap::new(&system, &0.0, &start, Section::Period(PI), integration).unwrap();
    for n in 1..=200 {
        let point = map.next_point(&go_on).unwrap().unwrap();
        let size = point.state[1].abs() * f64::from(n).exp2();
        assert!(point.state[0].abs() * f64::from(n).exp2() < 1e-10 && size > 0.99 && size < 2.01);
    }
    // Half a period later nothing happens.
    let section = Section::Strobe { first: PI / 2.0, period: PI };
    let mut map = PoincareMap::new(&system, &0.0, &start, section, integration).unwrap();
    for n in 0..200 {
        let point = map.next_point(&go_on).unwrap().unwrap();
        assert!((point.time - (f64::from(n) + 0.5) * PI).abs() < 1e-12 * point.time);
        assert!((point.state[0] * f64::from(n).exp2() - 1.0).abs() < 1e-10);
    }
}

/// No exponent is not a number.
#[test]
fn exponents_are_numbers_or_errors() {
    let go_on = &mut |_: u32| ControlFlow::Continue(());
    let growth = |rate: i64| {
        let equation =
            Expression::ACCELERATION - Expression::integer(rate) * Expression::DISPLACEMENT;
        let model = Model::second_order(&equation).unwrap().linearised();
        model.compile(Doubles, &Parameters::new()).unwrap()
    };
    let integration = Settings::for_digits(16);
    let settings =
        |interval, averaged| LyapunovSettings { interval, transient: 0, averaged, integration };
    let slow = growth(1);
    let mut run =
        |system, settings| largest_lyapunov_exponent(system, &0.0, &[0.0, 0.0], &settings, go_on);
    assert_eq!(run(&slow, settings(1.0, 0)), Ok(None));
    let once = run(&slow, settings(1.0, 1)).unwrap().unwrap();
    assert!(once.value.is_finite() && once.error == f64::INFINITY);
    let outcome = run(&slow, settings(0.0, 10));
    assert!(matches!(outcome, Err(SimulateError::NotFinite { .. })), "{outcome:?}");
    // e^1000 and e^-1000 are no doubles: directions are bounded within an interval. The first one turns to the fast direction.
    let fast = run(&growth(1_000_000), settings(1.0, 10)).unwrap().unwrap();
    assert!((fast.value - 1000.0).abs() < 1.01 * fast.error && fast.error < 1.0, "{fast:?}");
}

/// One that escapes, and orbits that stick, that double their period and that visit both wells, in lanes and by
/// themselves; what cannot be followed at all is told so.
#[test]
fn exponents_side_by_side_are_those_alone() {
    let model = stick_slip().linearised();
    let system = |(b, gamma)| {
        let given = parameters(&[("a", "1.1"), ("b", b), ("beta", "0"), ("gamma", gamma)]);
        model.compile(Doubles, &given).unwrap()
    };
    let values = [("-0.9", "2"), ("0.9", "0.6"), ("0.9", "0.615"), ("0.9", "1.2")];
    let systems = values.map(system);
    let plain = stick_slip().compile(Doubles, &parameters(&[("gamma", "0.6")])).unwrap();
    let integration = Settings::for_digits(12);
    let settings = LyapunovSettings { interval: PI, transient: 3, averaged: 20, integration };
    let start = [0.11, 0.05];
    let go_on = &mut |_| ControlFlow::Continue(());
    let list: Vec<_> = systems.iter().chain([&plain]).collect();
    let found = largest_lyapunov_exponents(&list, &0.0, &start, &settings, go_on);
    assert!(matches!(found[0], Err(SimulateError::Escape { .. })), "{:?}", found[0]);
    assert!(matches!(found[4], Err(SimulateError::WrongDimension { .. })));
    for (system, found) in systems.iter().zip(found) {
        let alone = largest_lyapunov_exponent(system, &0.0, &start, &settings, go_on);
        assert_eq!(found, alone);
    }
}

/// More systems than fit side by side, broken off among the last: what was found stands, intervals are counted on, and
/// nobody is asked of one that ended.
#[test]
fn exponents_found_before_a_stop_stand() {
    let model = stick_slip().linearised();
    let given = parameters(&[("a", "1.1"), ("b", "0.9"), ("beta", "0"), ("gamma", "0.6")]);
    let system = model.compile(Doubles, &given).unwrap();
    let escaping = parameters(&[("a", "1.1"), ("b", "-0.9"), ("beta", "0"), ("gamma", "2")]);
    let escaping = model.compile(Doubles, &escaping).unwrap();
    let integration = Settings::for_digits(12);
    let settings = LyapunovSettings { interval: PI, transient: 1, averaged: 3, integration };
    let start = [0.11, 0.05];
    let mut told = Vec::new();
    let observer = &mut |interval| {
        told.push(interval);
        if interval < 6 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let found = largest_lyapunov_exponents(&[&system; 10], &0.0, &start, &settings, observer);
    assert!(found[..8].iter().all(|one| matches!(one, Ok(Some(_)))), "{found:?}");
    assert_eq!(found[8..], [Ok(None), Ok(None)]);
    assert_eq!(told, [1, 2, 3, 4, 5, 6]);

    let settings = LyapunovSettings { transient: 1000, ..settings };
    let mut asked = 0;
    let observer = &mut |interval| {
        asked = interval;
        ControlFlow::Continue(())
    };
    let alone = largest_lyapunov_exponent(&escaping, &0.0, &start, &settings, observer);
    let Err(SimulateError::Escape { time, .. }) = alone else { panic!("{alone:?}") };
    assert_eq!(f64::from(asked), (time / PI).floor());
}
