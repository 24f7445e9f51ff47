//! Periods of section 4 against closed forms, and the linearisation against differences.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lindstedt_equation::{Expression, Function};
use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Parameters, Quantity, Real, Report, Settings,
    SimulateError,
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
    let model = model.clone().with_section(Expression::Velocity);
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
    let x = || Expression::Displacement;
    let stiffness = x().pow(2).pow(Expression::Small);
    let model = Model::second_order(&(Expression::Acceleration + x() * stiffness)).unwrap();
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
    let x = Expression::Displacement;
    let equation = Expression::Acceleration + x.apply(Function::Sin);
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
    let x = || Expression::Displacement;
    let stiffness = x().pow(2).pow(Expression::Small);
    let model = Model::second_order(&(Expression::Acceleration + x() * stiffness)).unwrap();
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
    let x = || Expression::Displacement;
    let stiffness = x().pow(2).pow(Expression::Small);
    let model = Model::second_order(&(Expression::Acceleration + x() * stiffness)).unwrap();
    let model = model.with_small("delta");
    for (p, q) in [(-3, 5), (-2, 5), (-1, 4), (-1, 10), (0, 1), (1, 8), (1, 5), (1, 4), (31, 100)] {
        let n = Rational::from((p, q));
        let delta = (n.clone() - 1i32) / 2i32;
        let parameters = Parameters::new().with("delta", delta);
        let share = Float::with_val(BITS, (n + 1i32).recip());
        let root = (Float::with_val(BITS, Constant::Pi) * &share / 2u32).sqrt();
        let half = Float::with_val(BITS, &share + 0.5f64);
        let exact = root * 4u32 * share.clone().gamma() / half.gamma();
        for digits in [10, 25, 60] {
            let value = period(
                &model,
                (Digits::for_digits(digits), digits),
                &parameters,
                &Quantity::from(1),
            );
            let value = value.unwrap();
            let error = Float::with_val(BITS, value - &exact).abs().to_f64();
            println!("n = {p}/{q}, {digits} digits: {error:e}");
            assert!(error < 10f64.powi(-(digits as i32)), "{p}/{q} {digits} {error:e}");
        }
        let value = period(&model, (Doubles, 16), &parameters, &Quantity::from(1)).unwrap();
        let error = (value / exact.to_f64() - 1.0).abs();
        println!("n = {p}/{q}, f64: {error:e}");
        assert!(error < 2e-15, "{p}/{q} {error:e}");
    }
}
