//! What a period of the stick-slip oscillator costs, in f64 and at 30 digits.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lindstedt_simulate::{
    Digits, Doubles, Integrator, Model, Parameters, Quantity, Real, Settings, System,
};
use std::ops::ControlFlow;

fn main() {
    divan::main();
}

fn system<R: Real>(real: R, linearised: bool) -> System<R> {
    let model = Model::second_order(&lindstedt_problems::stick_slip::equation()).unwrap();
    let mut parameters = Parameters::new();
    for (name, value) in [
        ("a", "1"),
        ("b", "1"),
        ("T0", "0.3"),
        ("alpha", "0.3"),
        ("beta", "0.3"),
        ("omega", "2"),
        ("vstar", "0.4"),
        ("eps", "1"),
        ("gamma", "0.65"),
    ] {
        parameters.set(name, Quantity::parse(value).unwrap());
    }
    let model = model.with_small("eps");
    let model = if linearised { model.linearised() } else { model };
    model.compile(real, &parameters).unwrap()
}

fn periods<R: Real>(system: &System<R>, digits: u32, count: u32) -> u64 {
    let real = system.real();
    let start = [real.double(0.5), real.double(0.1)];
    let settings = Settings::for_digits(digits);
    let mut flow = Integrator::new(system, &real.zero(), &start, settings).unwrap();
    for n in 1..=count {
        let mut time = real.pi();
        real.times_integer(&mut time, n as i32);
        flow.advance(&time, &mut |_| ControlFlow::Continue(())).unwrap();
    }
    flow.work().steps
}

/// 600 periods: one column of the bifurcation diagram.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn stick_slip_600_periods(bencher: divan::Bencher) {
    let system = system(Doubles, false);
    bencher.bench(|| periods(&system, 16, 600));
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn stick_slip_600_periods_linearised(bencher: divan::Bencher) {
    let system = system(Doubles, true);
    bencher.bench(|| periods(&system, 16, 600));
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn stick_slip_6_periods_at_30_digits(bencher: divan::Bencher) {
    let system = system(Digits::for_digits(30), false);
    bencher.bench(|| periods(&system, 30, 6));
}
