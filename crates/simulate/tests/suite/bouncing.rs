//! Impacts: the bouncing oscillator against its exact impact times, and chattering against the
//! exact geometric series.

use lindstedt_equation::{Crossing, Expression, Impact};
use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Parameters, Places, Real, Report, Settings,
    System,
};
use rug::float::Constant;
use rug::{Float, Rational};
use std::ops::ControlFlow;

fn rational(p: i64, q: i64) -> Expression {
    Expression::Number(Rational::from((p, q)))
}

fn wall(position: Expression, restitution: Expression, crossing: Crossing) -> Impact {
    Impact { position, crossing, restitution }
}

fn bouncing() -> Model {
    let equation = Expression::ACCELERATION + Expression::DISPLACEMENT;
    let wall = wall(rational(-1, 2), rational(999, 1000), Crossing::Falling);
    Model::second_order(&equation).unwrap().with_wall(wall)
}

/// The largest error of time and speed of `impacts` impacts, in f64, against exact values at 300
/// bits: t_1 = 2 pi/3, speeds R^n sin(2 pi/3), flights 2 atan2(v_n, -1/2).
fn largest_error<R: Real>(system: &System<R>, settings: Settings, impacts: usize) -> f64 {
    let real = system.real().clone();
    let start = [real.double(1.0), real.zero()];
    let mut flow = Integrator::new(system, &real.zero(), &start, settings).unwrap();
    let bits = 300;
    let mut time = Float::with_val(bits, Constant::Pi) * 2u32 / 3u32;
    let mut speed = time.clone().sin();
    let restitution = Float::with_val(bits, Rational::from((999, 1000)));
    let (mut count, mut worst) = (0, 0f64);
    let end = real.double(1e6);
    flow.advance(&end, &mut |report| {
        let Report::Event(event) = report else { return ControlFlow::Continue(()) };
        assert_eq!(event.kind, EventKind::Impact { wall: 0 });
        let error = Float::with_val(bits, real.to_float(event.time) - &time).abs();
        let other = Float::with_val(bits, real.to_float(&event.before[1]) + &speed).abs();
        worst = worst.max(error.to_f64()).max(other.to_f64());
        speed *= &restitution;
        time += Float::with_val(bits, speed.atan2_ref(&Float::with_val(bits, -0.5))) * 2u32;
        count += 1;
        if count == impacts { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
    .unwrap();
    assert_eq!(count, impacts);
    worst
}

#[test]
fn thousand_impacts_in_f64() {
    let system = bouncing().compile(Doubles, &Parameters::new()).unwrap();
    let error = largest_error(&system, Settings::for_digits(16), 1000);
    println!("{error:e}");
    assert!(error < 1e-9);
}

#[test]
fn thousand_impacts_to_forty_digits() {
    let system = bouncing().compile(Digits::for_digits(50), &Parameters::new()).unwrap();
    let error = largest_error(&system, Settings::for_digits(50), 1000);
    println!("{error:e}");
    assert!(error < 1e-40 * 4662.0);
}

/// x'' = -1 above a floor with R = 1/2 from height 1: t_1 = sqrt 2, v_1 = sqrt 2, and the impacts
/// accumulate at sqrt 2 (1 + 2 (R + R^2 + ...)) = 3 sqrt 2. All are told whose velocity is above the
/// tolerance, sqrt 2 R^n > 10^-41.
#[test]
fn chattering_under_constant_force() {
    let equation = Expression::ACCELERATION + 1;
    let floor = wall(Expression::integer(0), rational(1, 2), Crossing::Falling);
    let model = Model::second_order(&equation).unwrap().with_wall(floor);
    let real = Digits::for_digits(40);
    let system = model.compile(real, &Parameters::new()).unwrap();
    let start = [real.double(1.0), real.zero()];
    let settings = Settings::for_digits(40);
    let mut flow = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    let mut kinds = Vec::new();
    let end = real.double(10.0);
    flow.advance(&end, &mut |report| {
        if let Report::Event(event) = report {
            kinds.push((event.kind, event.time.clone()));
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    let root = Float::with_val(200, 2).sqrt();
    let error =
        |time: &Float, factor: &Float| (Float::with_val(200, &root * factor) - time).abs().to_f64();
    let (last, impacts) = kinds.split_last().unwrap();
    for (impact, n) in impacts.iter().zip(0i32..) {
        assert_eq!(impact.0, EventKind::Impact { wall: 0 });
        let factor = 3 - Float::with_val(200, Float::i_exp(1, 1 - n));
        assert!(error(&impact.1, &factor) < 1e-40, "{n}");
    }
    assert!((136..140).contains(&impacts.len()), "{}", impacts.len());
    assert_eq!(last.0, EventKind::Accumulation { wall: 0 });
    assert!(error(&last.1, &Float::with_val(200, 3)) < 1e-40);
    assert_eq!(flow.contact(), Some(0));
    assert!(flow.state().iter().all(Float::is_zero));
}

/// The force varies, so the impacts are followed until the rest is geometric to the tolerance:
/// x'' = -(1 + t/10) from rest at height 1. f64 against 40 digits, where the jump comes later.
#[test]
fn chattering_under_a_varying_force_and_departure() {
    let slope = rational(1, 10) * Expression::Time;
    let equation = Expression::ACCELERATION
        + (slope * 10).apply(lindstedt_equation::Function::Cos) * rational(1, 2)
        + rational(1, 4);
    let floor = wall(Expression::integer(0), rational(1, 2), Crossing::Falling);
    let model = Model::second_order(&equation).unwrap().with_wall(floor);
    let fast = events(&model, Doubles, 16);
    let exact = events(&model, Digits::for_digits(40), 40);
    let find = |list: &[(EventKind, f64)], kind| list.iter().find(|e| e.0 == kind).map(|e| e.1);
    for kind in [EventKind::Accumulation { wall: 0 }, EventKind::Departure { wall: 0 }] {
        let (a, b) = (find(&fast, kind).unwrap(), find(&exact, kind).unwrap());
        assert!((a - b).abs() < 1e-13 * b, "{kind:?} {a} {b}");
    }
    // The force cos(t)/2 + 1/4 pulls away once cos t < -1/2.
    let departure = find(&exact, EventKind::Departure { wall: 0 }).unwrap();
    let angle = 2.0 * std::f64::consts::PI / 3.0;
    assert!((departure - angle).abs() < 1e-14, "{departure} {angle}");
}

fn events<R: Real>(model: &Model, real: R, digits: u32) -> Vec<(EventKind, f64)> {
    let system = model.compile(real.clone(), &Parameters::new()).unwrap();
    let start = [real.double(0.03125), real.zero()];
    let settings = Settings::for_digits(digits);
    let mut flow = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    let mut list = Vec::new();
    flow.advance(&real.double(3.0), &mut |report| {
        if let Report::Event(event) = report {
            list.push((event.kind, real.to_f64(event.time)));
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    list
}
