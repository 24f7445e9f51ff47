//! |w|^p with p near -1: the powers of the series at w = 0 are too close together.

use lindstedt_equation::Expression;
use lindstedt_simulate::{
    Digits, Integrator, Model, Outcome, Parameters, Report, Settings, SimulateError, System,
};
use rug::Rational;
use std::ops::ControlFlow;

/// x'' = -sign(x) |x|^p with 20 digits.
fn power_law(p: (i64, i64)) -> System<Digits> {
    let x = Expression::DISPLACEMENT;
    let delta = (Rational::from(p) - 1u32) / 2u32;
    let force = x.clone() * x.pow(2).pow(Expression::Number(delta));
    let model = Model::second_order(&(Expression::ACCELERATION + force)).unwrap();
    model.compile(Digits::for_digits(20), &Parameters::new()).unwrap()
}

fn run(
    p: (i64, i64),
    observer: &mut dyn FnMut(&Report<'_, Digits>) -> ControlFlow<()>,
) -> Result<(Outcome, f64), SimulateError> {
    let system = power_law(p);
    let [zero, one, end] = [0.0, 1.0, 2.0].map(|x| rug::Float::with_val(200, x));
    let settings = Settings::for_digits(20);
    let mut flow = Integrator::new(&system, &zero, &[one, zero.clone()], settings)?;
    let outcome = flow.advance(&end, observer)?;
    Ok((outcome, flow.time().to_f64()))
}

#[test]
fn a_power_too_near_minus_one_is_refused() {
    let outcome = run((-999, 1000), &mut |_| ControlFlow::Continue(()));
    let Err(SimulateError::DenseBranchPoint { switch: 0, time, terms }) = outcome else {
        panic!("{outcome:?}")
    };
    // A quarter of the period of x'' = -1/x.
    assert!((time - (std::f64::consts::PI / 2.0).sqrt()).abs() < 1e-3 && terms >= 1000);
}

/// One crossing takes hundreds of sweeps: the observer is asked in between.
#[test]
fn a_crossing_can_be_broken_off() {
    let mut busy = 0;
    let (outcome, end) = run((-4, 5), &mut |report| {
        busy += u32::from(matches!(report, Report::Busy));
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!((outcome, end), (Outcome::Reached, 2.0));
    assert!(busy > 50, "{busy}");
    let (outcome, end) = run((-4, 5), &mut |report| match report {
        Report::Busy => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    })
    .unwrap();
    // The state is that before the crossing.
    assert!(outcome == Outcome::Stopped && end > 1.0 && end < 1.5, "{end}");
}
