//! Hot paths: `cargo bench -p lindstedt`. Whole derivations with their residual checks, the
//! numeric tiers, averaging.

use divan::Bencher;
use lindstedt::unstable::derivation::averaging::{AveragingSettings, average};
use lindstedt::unstable::derivation::numeric::{self, Tier};
use lindstedt::{
    Exact, Route, unstable::derivation::Settings, unstable::derivation::derive, unstable::problems,
};

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

/// The collocation tier at 30 digits over the order, and at order 20 over the digits.
#[divan::bench(args = [10, 20, 40], sample_count = 3, sample_size = 1)]
fn collocation_at_30_digits(bencher: Bencher<'_, '_>, order: usize) {
    in_a_tier(bencher, order, Tier::Collocation { digits: 30 });
}

#[divan::bench(args = [25, 50, 100], sample_count = 3, sample_size = 1)]
fn collocation_to_order_20(bencher: Bencher<'_, '_>, digits: u32) {
    in_a_tier(bencher, 20, Tier::Collocation { digits });
}

#[divan::bench(args = [10, 20, 40], sample_count = 5)]
fn collocation_in_doubles(bencher: Bencher<'_, '_>, order: usize) {
    in_a_tier(bencher, order, Tier::Doubles);
}

#[divan::bench(args = [16, 64, 256], sample_count = 5)]
fn fourier_to_order_20(bencher: Bencher<'_, '_>, harmonics: usize) {
    in_a_tier(bencher, 20, Tier::Fourier { harmonics });
}

fn in_a_tier(bencher: Bencher<'_, '_>, order: usize, tier: Tier) {
    let problem = problems::find("power-law").expect("a built-in problem");
    let settings = Settings { order, ..Settings::default() };
    bencher.bench(|| numeric::derive(&problem, &settings, tier, &mut |_| true).map(|d| d.nodes));
}

/// The vibro-impact oscillator with its delay loop: every parameter a symbol.
#[divan::bench(args = [2, 4, 6], sample_count = 3, sample_size = 1)]
fn averaging_in_symbols(bencher: Bencher<'_, '_>, order: usize) {
    averaging(bencher, order, &[]);
}

/// The same with certified numbers of 30 digits.
#[divan::bench(args = [10, 50], sample_count = 3, sample_size = 1)]
fn averaging_in_numbers(bencher: Bencher<'_, '_>, order: usize) {
    let values = [
        ("alpha", "1"),
        ("omega", "3.3"),
        ("k", "1"),
        ("c", "0.05"),
        ("P0", "1"),
        ("A", "0.2"),
        ("B", "0.1"),
    ];
    averaging(bencher, order, &values);
}

fn averaging(bencher: Bencher<'_, '_>, order: usize, values: &[(&str, &str)]) {
    let problem = problems::find("vibro-impact").expect("a built-in problem");
    let value = |text: &str| Exact::parse(text).expect("a number");
    let parameters = values.iter().map(|(name, text)| ((*name).to_owned(), value(text))).collect();
    let settings = AveragingSettings { order, parameters, ..AveragingSettings::default() };
    average(&problem, &settings, &mut |_| true).expect("an expansion");
    bencher.bench(|| average(&problem, &settings, &mut |_| true).map(|a| a.order));
}
