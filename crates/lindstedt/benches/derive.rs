//! Hot paths: `cargo bench -p lindstedt`. Whole derivations with their residual checks, and the
//! Lobachevsky function.

use divan::Bencher;
use lindstedt::phase::lobachevsky_function::{Point, lobachevsky_digits, lobachevsky_f64};
use lindstedt::{Route, Settings, derive, problems};
use rug::Rational;

fn main() {
    divan::main();
}

fn derivation(bencher: Bencher<'_, '_>, name: &str, order: usize, route: Route) {
    let problem = problems::find(name).expect("a built-in problem");
    let settings = Settings { order, route, ..Settings::default() };
    bencher.bench(|| derive(&problem, &settings, &mut |_| true).map(|d| d.order));
}

#[divan::bench(args = [25, 50, 100], sample_count = 5)]
fn duffing(bencher: Bencher<'_, '_>, order: usize) {
    derivation(bencher, "duffing", order, Route::Driver);
}

#[divan::bench(args = [20, 40, 80], sample_count = 5)]
fn van_der_pol(bencher: Bencher<'_, '_>, order: usize) {
    derivation(bencher, "van-der-pol", order, Route::Driver);
}

#[divan::bench(args = [4, 8, 12], sample_count = 5)]
fn power_law(bencher: Bencher<'_, '_>, order: usize) {
    derivation(bencher, "power-law", order, Route::Driver);
}

#[divan::bench(args = [10, 20, 30], sample_count = 5)]
fn power_law_by_the_energy_integral(bencher: Bencher<'_, '_>, order: usize) {
    derivation(bencher, "power-law", order, Route::EnergyIntegral);
}

#[divan::bench(args = [4, 8], sample_count = 5)]
fn pendulum(bencher: Bencher<'_, '_>, order: usize) {
    derivation(bencher, "pendulum", order, Route::Driver);
}

#[divan::bench(args = [100, 1000])]
fn lobachevsky_function(bencher: Bencher<'_, '_>, digits: usize) {
    let x = Point::Rational(Rational::from((3, 4)));
    bencher.bench(|| lobachevsky_digits(&x, digits).is_ok());
}

#[divan::bench]
fn lobachevsky_function_in_doubles() -> f64 {
    lobachevsky_f64(divan::black_box(0.75))
}
