//! Periods against closed forms, and the linearisation against differences.

use lindstedt_equation::{Expression, Function};
use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Parameters, Places, Quantity, Real, Report,
    Settings, SimulateError, Trajectory,
};
use rug::float::Constant;
use rug::{Float, Rational};
use std::ops::ControlFlow;

const BITS: u32 = 300;

/// The time of the second turning point x' = 0 after the start at rest.
fn period<R: Real>(
    model: &Model,
    (real, digits): (R, u32),
    parameters: &Parameters,
    amplitude: &Quantity,
) -> Result<R::Element, SimulateError> {
    let model = model.clone().with_section(Expression::VELOCITY);
    let system = model.compile(real.clone(), parameters)?;
    let start = [real.float(&amplitude.float(BITS)), real.zero()];
    let mut flow = Integrator::new(&system, &real.zero(), &start, Settings::for_digits(digits))?;
    let mut found = None;
    flow.advance(&real.double(1e3), &mut |report| match report {
        Report::Event(event)
            if event.kind == (EventKind::Section { section: 0, rising: false }) =>
        {
            found = Some(event.time.clone());
            ControlFlow::Break(())
        }
        _ => ControlFlow::Continue(()),
    })?;
    println!("{:?}", flow.work());
    Ok(found.unwrap())
}

/// `condition`: what the period makes of an error in the amplitude.
fn check(
    model: &Model,
    parameters: &Parameters,
    amplitude: &Quantity,
    (exact, condition): (&Float, f64),
) {
    let digits = Digits::for_digits(40);
    let value = period(model, (digits, 40), parameters, amplitude).unwrap();
    let error = Float::with_val(BITS, value - exact).abs().to_f64();
    assert!(error < 1e-30, "{error:e}");
    let value = period(model, (Doubles, 16), parameters, amplitude).unwrap();
    let relative = (value / exact.to_f64() - 1.0).abs();
    println!("{error:e} {relative:e}");
    assert!(relative < 1e-14 * condition, "{relative:e}");
}

/// T = 4 sqrt(pi/(2 (n+1))) Gamma(1/(n+1))/Gamma(1/(n+1) + 1/2) for x'' + x |x|^(n-1) = 0 and
/// amplitude 1.
#[test]
fn power_law() {
    let x = || Expression::DISPLACEMENT;
    let stiffness = x().pow(2).pow(Expression::Small);
    let model = Model::second_order(&(Expression::ACCELERATION + x() * stiffness)).unwrap();
    let model = model.with_small("delta");
    for n in [1i64, 2, 3, 5, 9, 101] {
        let delta = Rational::from((n - 1, 2));
        let parameters = Parameters::new().with("delta", delta);
        let share = Float::with_val(BITS, Rational::from((1, n + 1)));
        let root = (Float::with_val(BITS, Constant::Pi) * &share / 2u32).sqrt();
        let half = Float::with_val(BITS, &share + 0.5f64);
        let exact = root * 4u32 * share.gamma() / half.gamma();
        println!("n = {n}");
        check(&model, &parameters, &Quantity::from(1), (&exact, 1.0));
    }
}

/// T = 2 pi/agm(1, cos(a/2)).
#[test]
fn pendulum() {
    let x = Expression::DISPLACEMENT;
    let equation = Expression::ACCELERATION + x.apply(Function::Sin);
    let model = Model::second_order(&equation).unwrap();
    for amplitude in ["0.001", "1", "3", "3.1", "3.1415"] {
        let amplitude = Quantity::parse(amplitude).unwrap();
        let modulus = (amplitude.float(BITS) / 2u32).cos();
        let condition = modulus.to_f64().powi(-2);
        let mean = modulus.agm(&Float::with_val(BITS, 1));
        let exact = Float::with_val(BITS, Constant::Pi) * 2u32 / mean;
        check(&model, &Parameters::new(), &amplitude, (&exact, condition));
    }
}

/// The built-in pendulum in its own form y'' + y sin(a |y|^delta)/(a |y|^delta) = 0 at delta = 1,
/// where the quotient at y = 0 is removable.
#[test]
fn pendulum_of_the_small_delta_method() {
    let problem = lindstedt_problems::find("pendulum").unwrap();
    let model = Model::of_problem(&problem).unwrap();
    for amplitude in ["1", "3", "3.1415"] {
        let quantity = Quantity::parse(amplitude).unwrap();
        let half = (quantity.float(BITS) / 2u32).cos();
        let condition = half.to_f64().powi(-2);
        let mean = half.agm(&Float::with_val(BITS, 1));
        let exact = Float::with_val(BITS, Constant::Pi) * 2u32 / mean;
        let parameters = Parameters::new().with("delta", 1).with("amplitude", quantity);
        assert_eq!(model.compile(Doubles, &parameters).unwrap().switches(), 0);
        check(&model, &parameters, &Quantity::from(1), (&exact, condition));
    }
}

/// Exponents that are no odd integers and no 2: the solution has a branch point at every zero.
#[test]
fn fractional_powers_have_branch_points() {
    let x = || Expression::DISPLACEMENT;
    let stiffness = x().pow(2).pow(Expression::Small);
    let model = Model::second_order(&(Expression::ACCELERATION + x() * stiffness)).unwrap();
    let model = model.with_small("delta");
    for (p, q) in [(3, 2), (1, 2), (5, 2), (17, 5)] {
        let n = Rational::from((p, q));
        let delta = (n.clone() - 1i32) / 2i32;
        let parameters = Parameters::new().with("delta", delta);
        let share = Float::with_val(BITS, (n + 1i32).recip());
        let root = (Float::with_val(BITS, Constant::Pi) * &share / 2u32).sqrt();
        let half = Float::with_val(BITS, &share + 0.5f64);
        let exact = root * 4u32 * share.gamma() / half.gamma();
        println!("n = {p}/{q}");
        check(&model, &parameters, &Quantity::from(1), (&exact, 1.0));
    }
    // From x = 0: half a period to the next zero of x.
    let parameters = Parameters::new().with("delta", Rational::from((1, 4)));
    let system = model.with_section(x()).compile(Doubles, &parameters).unwrap();
    let settings = Settings::for_digits(16);
    let mut flow = Integrator::new(&system, &0.0, &[0.0, 0.9f64.sqrt()], settings).unwrap();
    flow.advance(&1.0, &mut |_| ControlFlow::Continue(())).unwrap();
    // Energy v^2/2 + x^(5/2)/(5/2).
    let [x, v] = [flow.state()[0], flow.state()[1]];
    assert!((v * v / 2.0 + x.powf(2.5) / 2.5 - 0.45).abs() < 1e-14);
}

/// T = 4 sqrt(pi/(2 (n+1))) Gamma(1/(n+1))/Gamma(1/(n+1) + 1/2) where the force is singular (n < 0),
/// a sign (n = 0: parabolas, T = 4 sqrt 2) or has an infinite slope at x = 0.
#[test]
fn singular_forces() {
    let x = || Expression::DISPLACEMENT;
    let stiffness = x().pow(2).pow(Expression::Small);
    let model = Model::second_order(&(Expression::ACCELERATION + x() * stiffness)).unwrap();
    let model = model.with_small("delta");
    for (p, q) in [(-3, 5), (-2, 5), (-1, 4), (-1, 10), (0, 1), (1, 8), (1, 5), (1, 4), (31, 100)] {
        let n = Rational::from((p, q));
        let delta = (n.clone() - 1i32) / 2i32;
        let parameters = Parameters::new().with("delta", delta);
        let share = Float::with_val(BITS, (n + 1i32).recip());
        let root = (Float::with_val(BITS, Constant::Pi) * &share / 2u32).sqrt();
        let half = Float::with_val(BITS, &share + 0.5f64);
        let exact = root * 4u32 * share.clone().gamma() / half.gamma();
        // Many digits at both ends: next to the strongest singularity and beyond the weakest.
        let ends = [(-3, 5), (31, 100)].contains(&(p, q));
        for digits in if ends { &[10, 60][..] } else { &[25] } {
            let digits = *digits;
            let value = period(
                &model,
                (Digits::for_digits(digits), digits),
                &parameters,
                &Quantity::from(1),
            );
            let value = value.unwrap();
            let error = Float::with_val(BITS, value - &exact).abs().to_f64();
            println!("n = {p}/{q}, {digits} digits: {error:e}");
            assert!(error < 10f64.powi(2 - digits as i32), "{p}/{q} {digits} {error:e}");
        }
        let value = period(&model, (Doubles, 16), &parameters, &Quantity::from(1)).unwrap();
        let error = (value / exact.to_f64() - 1.0).abs();
        println!("n = {p}/{q}, f64: {error:e}");
        assert!(error < 2e-15, "{p}/{q} {error:e}");
    }
}

/// x'' + (x' + sin x)/10 + x |x|^(-1/2) - x^2/5 = 0 from (1, 0): x and x' at t = 10, computed by
/// leaps without the terms in |x|, 1e-19 long, instead of series about the branch points.
#[test]
fn a_damped_oscillator_with_branch_points() {
    let known = ["0.377377533061643312011680988646", "0.459180560540425612074347657976"];
    let (x, small) = (|| Expression::DISPLACEMENT, || Expression::Number(Rational::from((1, 10))));
    let root = x().pow(2).pow(Expression::Number(Rational::from((-1, 4))));
    let square = Expression::Number(Rational::from((-1, 5))) * x().pow(2);
    let damping = small() * Expression::VELOCITY + small() * x().apply(Function::Sin);
    let equation = Expression::ACCELERATION + damping + x() * root + square;
    let model = Model::second_order(&equation).unwrap();
    let real = Digits::for_digits(33);
    let system = model.compile(real, &Parameters::new()).unwrap();
    let start = [real.double(1.0), real.zero()];
    let settings = Settings::for_digits(33);
    let mut flow = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    flow.advance(&real.double(10.0), &mut |_| ControlFlow::Continue(())).unwrap();
    for (value, text) in flow.state().iter().zip(known) {
        let text = Float::with_val(BITS, Float::parse(text).unwrap());
        assert!(Float::with_val(BITS, value - text).abs() < 1e-29);
    }
}

/// Sections, dense output and targets inside of the series about a branch point: n = 1/4.
#[test]
fn what_happens_next_to_a_branch_point() {
    type Kept<R> = (Trajectory<R>, Vec<(EventKind, f64)>, [<R as Places>::Element; 2]);
    fn run<R: Real>(real: R, digits: u32) -> Kept<R> {
        let x = || Expression::DISPLACEMENT;
        let stiffness = x().pow(2).pow(Expression::Number(Rational::from((-3, 8))));
        let shifted = x() + Expression::Number(Rational::from((1, 1000)));
        let equation = Expression::ACCELERATION + x() * stiffness;
        let model = Model::second_order(&equation).unwrap();
        let model = model.with_section(x()).with_section(shifted);
        let system = model.compile(real.clone(), &Parameters::new()).unwrap();
        let start = [real.double(1.0), real.zero()];
        let settings = Settings::for_digits(digits);
        let mut flow = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
        let (mut kept, mut events) = (Trajectory::new(real.clone()), Vec::new());
        let mut record = |report: &Report<'_, R>| {
            if let Report::Event(event) = report {
                events.push((event.kind, real.to_f64(event.time)));
            }
            kept.record(report)
        };
        // Just before the first zero, just behind it, and on.
        for target in [1.4541, 1.4543, 6.0] {
            flow.advance(&real.double(target), &mut record).unwrap();
            assert_eq!(*flow.time(), real.double(target));
        }
        let state = [flow.state()[0].clone(), flow.state()[1].clone()];
        (kept, events, state)
    }
    let (rough, fine) = (run(Doubles, 16), run(Digits::for_digits(40), 40));
    let quarter = 5.816_789_202_060_242 / 4.0;
    let times = |kinds: &[(EventKind, f64)], section: usize| -> Vec<f64> {
        let wanted =
            |k: &EventKind| matches!(k, EventKind::Section { section: s, .. } if *s == section);
        kinds.iter().filter(|(k, _)| wanted(k)).map(|(_, t)| *t).collect()
    };
    for section in [0, 1] {
        let (a, b) = (times(&rough.1, section), times(&fine.1, section));
        assert_eq!((a.len(), b.len()), (2, 2), "{section}");
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-14), "{a:?} {b:?}");
    }
    let zeros = times(&rough.1, 0);
    assert!((zeros[0] - quarter).abs() + (zeros[1] - 3.0 * quarter).abs() < 1e-14);
    for offset in [-3e-3, -1e-4, -1e-9, 0.0, 1e-9, 1e-4, 3e-3] {
        let time = quarter + offset;
        for state in [0, 1] {
            let a = rough.0.value(state, &time).unwrap();
            let b = fine.0.value(state, &Digits::for_digits(40).double(time)).unwrap();
            assert!((a - b.to_f64()).abs() < 1e-14, "{offset} {state} {a} {b}");
        }
    }
    assert!((rough.2[0] - fine.2[0].to_f64()).abs() < 1e-14);
}
