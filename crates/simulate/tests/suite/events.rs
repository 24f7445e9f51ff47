//! Events that are easy to get wrong: two roots in one step, touching, starts on surfaces,
//! sliding in general systems, and what is refused by name.

use lindstedt_equation::{Crossing, Expression, Function, Impact};
use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Outcome, Parameters, Places, Quantity, Real,
    Report, Settings, SimulateError, Surface,
};
use rug::Rational;
use std::ops::ControlFlow;

fn number(p: i64, q: i64) -> Expression {
    Expression::Number(Rational::from((p, q)))
}

fn oscillator() -> Model {
    Model::second_order(&(Expression::ACCELERATION + Expression::DISPLACEMENT)).unwrap()
}

fn wall(position: Expression, restitution: Expression, crossing: Crossing) -> Impact {
    Impact { position, crossing, restitution }
}

type Log = Vec<(EventKind, f64)>;

fn run(model: &Model, start: &[f64], end: f64) -> Result<(Log, Vec<f64>), SimulateError> {
    let system = model.compile(Doubles, &Parameters::new())?;
    let settings = Settings { most_impacts: 1000, ..Settings::for_digits(16) };
    let mut flow = Integrator::new(&system, &0.0, start, settings)?;
    let mut log = Vec::new();
    flow.advance(&end, &mut |report| {
        if let Report::Event(event) = report {
            log.push((event.kind, *event.time));
        }
        ControlFlow::Continue(())
    })?;
    Ok((log, flow.state().to_vec()))
}

/// Beyond the wall for a time of 2 sqrt(2 delta) only: both ends of the step lie before it.
#[test]
fn a_wall_crossed_and_left_inside_one_step() {
    for exponent in 2..12 {
        let delta = Rational::from((1, 10i64.pow(exponent)));
        let position = Expression::Number(Rational::from(1) - delta.clone());
        let model = oscillator().with_wall(wall(position, number(1, 2), Crossing::Rising));
        let (log, _) = run(&model, &[-1.0, 0.0], 4.0).unwrap();
        let exact = std::f64::consts::PI - (1.0 - delta.to_f64()).acos();
        assert_eq!(log[0].0, EventKind::Impact { wall: 0 }, "{exponent}");
        // d(acos)/dx = 1e8 sqrt(..): the time of a nearly grazing impact is ill-conditioned.
        let condition = (2.0 * delta.to_f64()).sqrt().recip();
        assert!((log[0].1 - exact).abs() < 4e-15 * condition, "{exponent}");
    }
}

#[test]
fn grazing_is_refused_and_a_near_miss_is_none() {
    let at = |position: Expression| {
        run(
            &oscillator().with_wall(wall(position, number(1, 2), Crossing::Rising)),
            &[-1.0, 0.0],
            4.0,
        )
    };
    let Err(SimulateError::Grazing { surface, time }) = at(Expression::integer(1)) else {
        panic!()
    };
    assert_eq!(surface, Surface::Wall(0));
    assert!((time - std::f64::consts::PI).abs() < 1e-5);
    assert!(at(number(1_000_001, 1_000_000)).unwrap().0.is_empty());
}

/// Every zero of x' and of x - cos t, with its direction, and none at the start.
#[test]
fn sections_in_order() {
    let model = oscillator()
        .with_section(Expression::VELOCITY)
        .with_section(Expression::DISPLACEMENT - number(1, 2));
    let (log, _) = run(&model, &[1.0, 0.0], 20.0).unwrap();
    let pi = std::f64::consts::PI;
    let turning: Vec<_> = log
        .iter()
        .filter(|(kind, _)| matches!(kind, EventKind::Section { section: 0, .. }))
        .collect();
    assert_eq!(turning.len(), 6);
    for (n, (kind, time)) in (1..).zip(turning) {
        assert!((time - f64::from(n) * pi).abs() < 1e-14);
        assert_eq!(*kind, EventKind::Section { section: 0, rising: n % 2 == 1 });
    }
    let half: Vec<f64> = log
        .iter()
        .filter(|(kind, _)| *kind == EventKind::Section { section: 1, rising: true })
        .map(|(_, time)| *time)
        .collect();
    assert_eq!(half.len(), 3);
    for (n, time) in (0..).zip(half) {
        assert!((time - (f64::from(n) + 5.0 / 6.0) * 2.0 * pi + 0.0).abs() < 1e-13);
    }
}

/// x = -cos t touches the sections x = 1 and x = -1 for ever: they only look on, and a section that
/// is crossed meanwhile misses nothing.
#[test]
fn a_touched_section_does_not_end_the_run() {
    let model = oscillator()
        .with_section(Expression::DISPLACEMENT - Expression::integer(1))
        .with_section(Expression::DISPLACEMENT + Expression::integer(1))
        .with_section(Expression::DISPLACEMENT);
    let (log, state) = run(&model, &[-1.0, 0.0], 100.0).unwrap();
    assert!((state[0] + 100f64.cos()).abs() < 1e-13);
    let of = |wanted: usize| -> Vec<f64> {
        let is = |kind: &EventKind| matches!(kind, EventKind::Section { section, .. } if *section == wanted);
        log.iter().filter(|(kind, _)| is(kind)).map(|(_, time)| *time).collect()
    };
    let crossings = of(2);
    assert_eq!(crossings.len(), 32);
    for (n, time) in (0..).zip(&crossings) {
        assert!((time - (f64::from(n) + 0.5) * std::f64::consts::PI).abs() < 1e-13);
    }
    // In rounding errors it may be passed out and back.
    for (section, phase) in [(0, 1.0), (1, 0.0)] {
        let touched = of(section);
        assert!(touched.len() % 2 == 0, "{touched:?}");
        for time in touched {
            let turns = (time / std::f64::consts::PI - phase) / 2.0;
            assert!((turns - turns.round()).abs() < 1e-6, "{section} {time}");
        }
    }
}

#[test]
fn starts_at_a_wall() {
    let floor = |restitution| wall(Expression::integer(0), restitution, Crossing::Falling);
    let heavy = Model::second_order(&(Expression::ACCELERATION + 1)).unwrap();
    let model = heavy.clone().with_wall(floor(number(1, 2)));
    // At rest, pushed down.
    let (log, state) = run(&model, &[0.0, 0.0], 5.0).unwrap();
    assert_eq!(log, [(EventKind::Rest { wall: 0 }, 0.0)]);
    assert_eq!(state, [0.0, 0.0]);
    // On the way in: the impact is now. On the way out: a flight of 2 v.
    let (log, _) = run(&model, &[0.0, -1.0], 0.5).unwrap();
    assert_eq!(log, [(EventKind::Impact { wall: 0 }, 0.0)]);
    let (log, _) = run(&model, &[0.0, 1.0], 2.5).unwrap();
    assert_eq!(log.len(), 1);
    assert!((log[0].1 - 2.0).abs() < 1e-15);
    // Behind.
    let outcome = run(&model, &[-0.1, 0.0], 1.0);
    assert_eq!(outcome.err(), Some(SimulateError::BehindWall { wall: 0, position: 0.0 }));
    // No rebound at all: rest at once.
    let (log, _) =
        run(&heavy.clone().with_wall(floor(Expression::integer(0))), &[1.0, 0.0], 5.0).unwrap();
    assert_eq!(log.len(), 1);
    assert_eq!(log[0].0, EventKind::Rest { wall: 0 });
    // Elastic: no accumulation, flights of 2 sqrt 2 for ever.
    let (log, _) =
        run(&heavy.with_wall(floor(Expression::integer(1))), &[1.0, 0.0], 200.0).unwrap();
    assert_eq!(log.len(), 71);
    let exact = 2f64.sqrt() * 141.0;
    assert!((log[70].1 - exact).abs() < 1e-12);
}

/// y' = 1/2 - sign(y): slides at zero; y' = 1/2 + sign(y) has no unique future there; with
/// y' = t/2 - sign y the sliding ends at t = 2, upwards.
#[test]
fn sliding_in_one_dimension() {
    let sign = || Expression::DISPLACEMENT.apply(Function::Sign);
    let model = |right| Model::first_order(&["y"], &[right]).unwrap();
    let switching = |from, to| EventKind::Switching { switch: 0, from, to };
    let (log, state) = run(&model(number(1, 2) - sign()), &[1.0], 5.0).unwrap();
    assert_eq!(log, [(switching(1, 0), 2.0)]);
    assert!(state[0].abs() < 1e-15);
    let outcome = run(&model(number(1, 2) + sign()), &[0.0], 5.0);
    assert!(matches!(outcome, Err(SimulateError::NotUnique { switch: 0, .. })));
    let (log, state) = run(&model(Expression::Time * number(1, 2) - sign()), &[0.0], 4.0).unwrap();
    assert_eq!(log.len(), 1);
    assert_eq!(log[0].0, switching(0, 1));
    assert!((log[0].1 - 2.0).abs() < 1e-14);
    assert!((state[0] - 1.0).abs() < 1e-14);
    // The limit is touched and not exceeded: u = sin t. No release; touching is not decided.
    let touching = Expression::Time.apply(Function::Sin) - sign();
    let outcome = run(&model(touching), &[0.0], 4.0);
    assert!(matches!(outcome, Err(SimulateError::Grazing { surface: Surface::Limit(0), .. })));
    // The square of a sign is not affine.
    let squared = number(1, 2) - sign() - sign() * sign() * number(1, 4);
    let outcome = run(&model(squared), &[1.0], 5.0);
    assert_eq!(outcome.err(), Some(SimulateError::NotAffine { switch: 0 }));
    // At rest in x = 0 of x'' = -sign x the sign is not in the rate x' of x.
    let model = Model::second_order(&(Expression::ACCELERATION + sign())).unwrap();
    let outcome = run(&model, &[0.0, 0.0], 1.0);
    assert!(matches!(outcome, Err(SimulateError::HigherSliding { switch: 0, .. })), "{outcome:?}");
}

#[test]
fn simultaneous_switches_are_refused() {
    let (x, y) = (Expression::parameter("x"), Expression::parameter("y"));
    let right = [-x.apply(Function::Sign), -y.apply(Function::Sign)];
    let model = Model::first_order(&["x", "y"], &right).unwrap();
    let outcome = run(&model, &[1.0, 1.0], 5.0);
    assert!(matches!(outcome, Err(SimulateError::SimultaneousSwitches { .. })), "{outcome:?}");
    // One after the other both slide.
    let outcome = run(&model, &[1.0, 2.0], 5.0);
    assert!(matches!(outcome, Err(SimulateError::SimultaneousSwitches { .. })), "{outcome:?}");
}

#[test]
fn dry_friction_stops_an_oscillator() {
    // x'' + x + sign(x')/4 = 0 from x = 1: amplitude falls by 1/2 per half period, then sticks.
    let friction = Expression::VELOCITY.apply(Function::Sign) * number(1, 4);
    let equation = Expression::ACCELERATION + Expression::DISPLACEMENT + friction;
    let model = Model::second_order(&equation).unwrap();
    let (log, state) = run(&model, &[1.125, 0.0], 20.0).unwrap();
    let pi = std::f64::consts::PI;
    assert_eq!(log.len(), 2);
    assert!((log[0].1 - pi).abs() < 1e-14 && (log[1].1 - 2.0 * pi).abs() < 1e-14);
    assert_eq!(log[1].0, EventKind::Switching { switch: 0, from: 1, to: 0 });
    assert!((state[0] - 0.125).abs() < 1e-14 && state[1].abs() < 1e-15);
}

#[test]
fn a_pole_and_missing_values_are_named() {
    // y' = y^2 from 1 has a pole at t = 1.
    let y = Expression::DISPLACEMENT;
    let model = Model::first_order(&["y"], &[y.clone().pow(2)]).unwrap();
    let outcome = run(&model, &[1.0], 2.0);
    assert!(
        matches!(
            outcome,
            Err(SimulateError::StepTooSmall { .. }
                | SimulateError::Escape { .. }
                | SimulateError::NotFinite { .. })
        ),
        "{outcome:?}"
    );
    let model = Model::first_order(&["y"], &[y.clone() * Expression::parameter("k")]).unwrap();
    let missing = SimulateError::MissingParameter { name: "k".into() };
    assert_eq!(run(&model, &[1.0], 2.0).err(), Some(missing));
    let model = Model::first_order(&["y"], &[y.clone().delayed(1)]).unwrap();
    assert_eq!(run(&model, &[1.0], 2.0).err(), Some(SimulateError::MissingHistory));
    let model = Model::first_order(&["y"], &[y.clone().delayed(-1)]).unwrap();
    assert_eq!(run(&model, &[1.0], 2.0).err(), Some(SimulateError::BadDelay { delay: -1.0 }));
    assert_eq!(Model::second_order(&y).err(), Some(SimulateError::NotSecondOrder));
}

/// x'' = 2 x x' - x^2 (x' - x^2) from x = x' = 1 has the solution 1/(1 - t). The motion is stiff
/// there: the explicit steps shrink like (1 - t)^2, and none comes near to the pole.
#[test]
fn a_stiff_pole_is_called_one_in_few_steps() {
    let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let off = v.clone() - x.clone().pow(2);
    let right = number(2, 1) * x.clone() * v - x.pow(2) * off;
    let model = Model::second_order(&(Expression::ACCELERATION - right)).unwrap();
    let real = Digits::for_digits(8);
    let system = model.compile(real, &Parameters::new()).unwrap();
    let start = [real.double(1.0), real.double(1.0)];
    let settings = Settings::for_digits(8);
    let mut flow = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    let outcome = flow.advance(&real.double(2.0), &mut |_| ControlFlow::Continue(()));
    let Err(SimulateError::Escape { time, displacement }) = outcome else { panic!("{outcome:?}") };
    assert!((time - 1.0).abs() < 1e-6 && displacement > 1e4, "{time} {displacement}");
    assert!(flow.work().steps < 50_000, "{:?}", flow.work());
}

/// Growth without a pole is integrated to the end: x = exp(t^2), and an oscillation that is fed,
/// x'' - x' + x^3 = 0.
#[test]
fn growth_is_no_escape() {
    let (x, v, t) = (Expression::DISPLACEMENT, Expression::VELOCITY, Expression::Time);
    let gauss = (number(2, 1) + number(4, 1) * t.pow(2)) * x.clone();
    let fed = v - x.pow(3);
    for (right, start, end) in [(gauss, [1.0, 0.0], 5.0), (fed, [0.01, 0.01], 14.0)] {
        let model = Model::second_order(&(Expression::ACCELERATION - right)).unwrap();
        let system = model.compile(Doubles, &Parameters::new()).unwrap();
        let settings = Settings { order: Some(3), ..Settings::for_digits(8) };
        let mut flow = Integrator::new(&system, &0.0, &start, settings).unwrap();
        let outcome = flow.advance(&end, &mut |_| ControlFlow::Continue(()));
        assert_eq!(outcome, Ok(Outcome::Reached));
        let x = flow.state()[0].hypot(flow.state()[1]);
        assert!(x > 20.0 && flow.work().steps > 3000, "{x} {:?}", flow.work());
    }
}

/// The observer stops the integration in the middle; going on gives the same result.
#[test]
fn stopping_and_going_on() {
    let model = oscillator().with_wall(wall(number(-1, 2), number(9, 10), Crossing::Falling));
    let real = Digits::for_digits(30);
    let system = model.compile(real, &Parameters::new()).unwrap();
    let settings = Settings::for_digits(30);
    let start = [real.double(1.0), real.zero()];
    let end = real.float(&Quantity::parse("50").unwrap().float(200));
    let mut whole = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    whole.advance(&end, &mut |_| ControlFlow::Continue(())).unwrap();
    let mut parts = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    while parts.advance(&end, &mut |_| ControlFlow::Break(())).unwrap() == Outcome::Stopped {}
    assert_eq!(whole.state(), parts.state());
    assert_eq!(whole.work(), parts.work());
}
