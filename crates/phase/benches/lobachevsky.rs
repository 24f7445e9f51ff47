//! The Lobachevsky function: digits, and a million doubles.

use divan::Bencher;
use lindstedt_number::ball::Balls;
use lindstedt_number::digits::certify;
use lindstedt_phase::lobachevsky_function::{LambdaTable, Point, lobachevsky, lobachevsky_f64};
use rug::Rational;

fn main() {
    divan::main();
}

/// Whether so many digits are certified.
fn value(x: &Point, digits: usize) -> bool {
    certify(digits, 1_000_000, |balls| Some(lobachevsky(x, balls))).is_ok()
}

/// At 3/4, near pi/4, where the series converge worst, and at 4/5 on the other side of it.
#[divan::bench(args = [100, 1000, 10_000], sample_count = 5, sample_size = 1)]
fn digits_below_pi_over_4(bencher: Bencher<'_, '_>, digits: usize) {
    let x = Point::Rational(Rational::from((3, 4)));
    bencher.bench(|| value(&x, digits));
}

#[divan::bench(args = [100, 1000, 10_000], sample_count = 5, sample_size = 1)]
fn digits_above_pi_over_4(bencher: Bencher<'_, '_>, digits: usize) {
    let x = Point::Rational(Rational::from((4, 5)));
    bencher.bench(|| value(&x, digits));
}

#[divan::bench(sample_count = 20, sample_size = 1)]
fn million_doubles(bencher: Bencher<'_, '_>) {
    let points: Vec<f64> = (0..1_000_000).map(|k| f64::from(k) * 1e-5 - 3.0).collect();
    bencher.bench(|| points.iter().map(|&x| lobachevsky_f64(x)).sum::<f64>());
}

/// Lambda_1, ..., Lambda_m at one point with 50 digits.
#[divan::bench(args = [10, 30], sample_count = 5)]
fn lambda_table(bencher: Bencher<'_, '_>, max_m: usize) {
    let table = LambdaTable::new(max_m, Balls::new(170));
    let x = Point::Rational(Rational::from((3, 4)));
    bencher.bench(|| table.values(&x).len());
}
