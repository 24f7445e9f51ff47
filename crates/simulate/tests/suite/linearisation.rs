//! Saltation, monodromy and multipliers: against the exact impact map, and against differences of
//! nonlinear solutions at high precision.

use lindstedt_equation::{Crossing, Expression, Function, Impact};
use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Parameters, Places, Quantity, Real, Report,
    Settings, SimulateError, System, go_on, monodromy,
};
use rug::{Float, Rational};
use serde_json::Value;
use std::ops::ControlFlow;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/vibro-impact/");

/// tests/data/vibro-impact/uncontrolled.json: the multipliers of the orbit from (16), 30 digits.
#[test]
fn multipliers_of_the_uncontrolled_impact_orbit() {
    let text = std::fs::read_to_string(format!("{DATA}uncontrolled.json")).unwrap();
    let data: Value = serde_json::from_str(&text).unwrap();
    let quantity = |value: &Value| Quantity::parse(value.as_str().unwrap()).unwrap();
    let mut parameters = Parameters::new().with("eps", 1).with("T", 1);
    for name in ["alpha", "omega", "R_r", "s", "c", "P0", "A", "B"] {
        parameters.set(name, quantity(&data["params"][name]));
    }
    let orbit = &data["orbit_uncontrolled"];
    let get = |value: &Value| quantity(value).float(200);
    let angle = Float::with_val(200, get(&orbit["phi"]) + get(&data["forced"]["phase_lag"]));
    // Start half a period after the impact: t0 such that the impact has the phase `angle`.
    let omega = get(&data["params"]["omega"]);
    let impact = Float::with_val(200, &angle / &omega);
    let period = get(&orbit["T"]);
    let problem = lindstedt_problems::vibro_impact::problem();
    let model = Model::of_problem(&problem).unwrap().linearised();
    let real = Digits::for_digits(30);
    let system = model.compile(real, &parameters).unwrap();
    let start = real.float(&impact);
    let rebound = get(&orbit["vplus_check"]);
    let state = [real.float(&get(&data["params"]["s"])), real.float(&rebound)];
    let settings = Settings::for_digits(30);
    // The impact at the end of the period decides: stop just behind it, and come from there.
    let middle = real.float(&Float::with_val(200, &impact + period.clone() / 2u32));
    let mut flow = Integrator::new(&system, &start, &state, settings).unwrap();
    flow.advance(&middle, &mut |_| ControlFlow::Continue(())).unwrap();
    let halfway = flow.state()[..2].to_vec();
    let end = real.float(&Float::with_val(200, &middle + &period));
    let result = monodromy(&system, (&middle, &end), &halfway, settings, &go_on).unwrap();
    let closing = Float::with_val(200, &result.end[0] - &halfway[0]).abs().to_f64();
    assert!(closing < 1e-25, "{closing:e}");
    let gamma = &data["stability_uncontrolled"]["gamma1"];
    let trace = get(&gamma["re"]) * 2u32;
    let error = Float::with_val(200, result.trace(&real) - trace).abs().to_f64();
    assert!(error < 1e-25, "{error:e}");
    let (re, im) = result.multipliers(&real).unwrap()[0];
    assert!((re - get(&gamma["re"]).to_f64()).abs() < 1e-14);
    assert!((im.abs() - get(&gamma["im"]).to_f64()).abs() < 1e-14);
}

fn stick_slip(gamma: &str) -> (Model, Parameters) {
    (crate::common::stick_slip(), crate::common::parameters(&[("gamma", gamma)]))
}

/// Runs to `end`; returns the end state and the switchings met.
fn end_of(system: &System<Digits>, state: &[Float], end: f64) -> (Vec<Float>, Vec<(i8, i8)>) {
    let real = *system.real();
    let mut flow = Integrator::new(system, &real.zero(), state, Settings::for_digits(50)).unwrap();
    let mut kinds = Vec::new();
    flow.advance(&real.double(end), &mut |report| {
        if let Report::Event(event) = report
            && let EventKind::Switching { from, to, .. } = event.kind
        {
            kinds.push((from, to));
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    (flow.state()[..2].to_vec(), kinds)
}

/// Central differences with a step of 1e-16 at 50 digits: errors of 1e-32.
fn check_differences(
    model: &Model,
    parameters: &Parameters,
    start: [f64; 2],
    end: f64,
) -> Vec<(i8, i8)> {
    let real = Digits::for_digits(50);
    let system = model.compile(real, parameters).unwrap();
    let linear = model.clone().linearised().compile(real, parameters).unwrap();
    let state = start.map(|x| real.double(x));
    let settings = Settings::for_digits(50);
    let times = (real.zero(), real.double(end));
    let result = monodromy(&linear, (&times.0, &times.1), &state, settings, &go_on).unwrap();
    let step = real.rational(&Quantity::parse("1e-16").unwrap().rational().unwrap());
    let (_, kinds) = end_of(&system, &state, end);
    for i in 0..2 {
        let shifted = |sign: i32| {
            let mut state = state.clone();
            state[i] += Float::with_val(real.bits(), &step * sign);
            end_of(&system, &state, end).0
        };
        let (plus, minus) = (shifted(1), shifted(-1));
        for k in 0..2 {
            let difference = Float::with_val(200, &plus[k] - &minus[k]) / &step / 2u32;
            let error = Float::with_val(200, &difference - &result.matrix[k][i]).to_f64().abs();
            let size = difference.to_f64().abs().max(1e-3);
            assert!(error < 1e-24 * size, "({k}, {i}) {error:e} {size:e}");
        }
    }
    kinds
}

/// Through crossings in both directions only, and through sticks.
#[test]
fn stick_slip_against_differences() {
    let (model, parameters) = stick_slip("1.2");
    let kinds = check_differences(&model, &parameters, [0.1, 0.0], 4.0);
    assert!(kinds.len() > 2 && kinds.iter().all(|(from, to)| from * to == -1), "{kinds:?}");
    let (model, parameters) = stick_slip("0.6");
    let kinds = check_differences(&model, &parameters, [0.5, 0.1], 12.0);
    assert!(kinds.iter().any(|(_, to)| *to == 0), "{kinds:?}");
    assert!(kinds.iter().any(|(from, _)| *from == 0), "{kinds:?}");
}

/// All smooth functions of the tape, an absolute value and a wall together.
#[test]
fn derivatives_of_every_function() {
    let (x, v) = (|| Expression::DISPLACEMENT, || Expression::VELOCITY);
    let number = |p, q| Expression::Number(Rational::from((p, q)));
    let force = x().apply(Function::Sin)
        + (x().pow(2) + 1).ln() * number(1, 5)
        + (x() * number(1, 3)).apply(Function::Exp) * v() * number(1, 10)
        + x() * x().apply(Function::Abs)
        + (v().pow(2) + 2).pow(number(1, 3)) * number(1, 7)
        - x().apply(Function::Cos) * (v().pow(4) + 3).pow(-1)
        - (Expression::Time * 2).apply(Function::Cos);
    let model = Model::second_order(&(Expression::ACCELERATION * 2 + force)).unwrap();
    let wall =
        Impact { position: number(3, 4), crossing: Crossing::Rising, restitution: number(2, 3) };
    let kinds = check_differences(&model.with_wall(wall), &Parameters::new(), [0.2, 0.9], 9.0);
    assert!(!kinds.is_empty());
}

#[test]
fn no_monodromy_with_a_delay() {
    let x = Expression::DISPLACEMENT;
    let model = Model::second_order(&(Expression::ACCELERATION + x.delayed(1))).unwrap();
    let outcome = model.linearised().compile(Doubles, &Parameters::new());
    assert_eq!(outcome.err(), Some(SimulateError::LinearisationWithDelay));
}
