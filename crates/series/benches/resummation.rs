//! Hot paths: `cargo bench -p lindstedt-series`. Sums of Euler's series sum (-1)^n n! x^n at 1/10, at
//! the bits that 30 digits need.

use divan::Bencher;
use lindstedt_series::resummation::{Method, Pade, Sample, resum};
use rug::Float;

fn main() {
    divan::main();
}

fn sample(order: u32, bits: u32) -> Sample {
    let term = |n: u32| Float::with_val(bits, Float::factorial(n)) * (-1i32).pow(n);
    Sample {
        coefficients: (0..=order).map(term).collect(),
        point: Float::with_val(bits, 1) / 10u32,
        map: None,
        radius: Some(0.0),
        bits,
    }
}

/// One diagonal approximant: O(m^3) products.
#[divan::bench(args = [10, 20, 40], sample_count = 10)]
fn diagonal_pade(bencher: Bencher<'_, '_>, order: u32) {
    let half = order as usize / 2;
    let c = sample(order, 300).coefficients;
    bencher.bench(|| Pade::new(&c, half, half, 300, &Default::default()));
}

#[divan::bench(args = [10, 20, 40], sample_count = 5)]
fn sum_by_pade(bencher: Bencher<'_, '_>, order: u32) {
    bencher.bench(|| {
        resum(&|bits| Some(sample(order, bits)), Some(Method::Pade), 100, &Default::default())
    });
}

#[divan::bench(args = [10, 20, 40], sample_count = 3, sample_size = 1)]
fn sum_by_the_best_method(bencher: Bencher<'_, '_>, order: u32) {
    bencher.bench(|| resum(&|bits| Some(sample(order, bits)), None, 100, &Default::default()));
}
