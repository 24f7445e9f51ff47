//! The stick-slip oscillator of section 3 against event-by-event solutions at 28 digits
//! (tests/data/stick-slip/trajectories.json: an independent 45-digit event code).

use lindstedt_simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Parameters, Quantity, Real, Report, Settings,
};
use rug::Float;
use serde_json::Value;
use std::ops::ControlFlow;

const DATA: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/stick-slip/trajectories.json");

fn float<R: Real>(real: &R, text: &Value) -> R::Element {
    real.float(&Quantity::parse(text.as_str().unwrap()).unwrap().float(200))
}

/// The largest difference of event times and places and of the final state.
fn compare<R: Real>(case: &Value, real: R, digits: u32) -> f64 {
    let mut parameters = Parameters::new();
    for (name, value) in case["params"].as_object().unwrap() {
        parameters.set(name, Quantity::parse(value.as_str().unwrap()).unwrap());
    }
    let model = Model::second_order(&lindstedt_problems::stick_slip::equation()).unwrap();
    let system = model.with_small("eps").compile(real.clone(), &parameters).unwrap();
    let start = [float(&real, &case["x0"]), float(&real, &case["v0"])];
    let settings = Settings::for_digits(digits);
    let mut flow = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    let (mut events, mut worst) = (case["events"].as_array().unwrap().iter(), 0f64);
    let mut check = |value: &R::Element, text: &Value| {
        let known = Quantity::parse(text.as_str().unwrap()).unwrap().float(200);
        let error = Float::with_val(200, real.to_float(value) - known).abs().to_f64();
        worst = worst.max(error);
    };
    flow.advance(&float(&real, &case["t_end"]), &mut |report| {
        if let Report::Event(event) = report {
            let known = events.next().expect("an event too many");
            let EventKind::Switching { from, to, .. } = event.kind else { panic!() };
            assert_eq!(known["mode_before"], from);
            assert_eq!(known["mode_after"], to);
            check(event.time, &known["t"]);
            check(&event.after[0], &known["x"]);
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(events.next().is_none(), "an event missing");
    check(&flow.state()[0], &case["final"]["x"]);
    check(&flow.state()[1], &case["final"]["v"]);
    assert_eq!(case["final"]["mode"], flow.modes()[0]);
    println!("{worst:e} {:?}", flow.work());
    worst
}

fn cases() -> Vec<Value> {
    let text = std::fs::read_to_string(DATA).unwrap();
    let data: Value = serde_json::from_str(&text).unwrap();
    data["trajectories"].as_array().unwrap().clone()
}

#[test]
fn trajectories_to_25_digits() {
    for case in cases() {
        assert!(compare(&case, Digits::for_digits(40), 40) < 1e-25);
    }
}

/// Two periodic attractors to 1e-12; the chaotic one amplifies rounding errors by some 10^4.
#[test]
fn trajectories_in_f64() {
    for (case, bound) in cases().iter().zip([1e-12, 1e-12, 1e-11]) {
        assert!(compare(case, Doubles, 16) < bound);
    }
}
