//! Elementary functions and constants of certified balls, by digits.

use divan::Bencher;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

fn main() {
    divan::main();
}

/// A context with these digits and a point in it that is no short fraction.
fn point(digits: u32) -> (Balls, Ball) {
    let balls = Balls::new(digits * 10 / 3);
    let x = balls.from_rational(&Rational::from((355, 339)));
    (balls, x)
}

const DIGITS: [u32; 4] = [16, 100, 1000, 10_000];

macro_rules! one_argument {
    ($($name:ident),*) => {$(
        #[divan::bench(args = DIGITS, sample_count = 20)]
        fn $name(bencher: Bencher<'_, '_>, digits: u32) {
            let (balls, x) = point(digits);
            bencher.bench(|| balls.$name(&x));
        }
    )*};
}

one_argument!(square, sqrt, exp, ln, sin, atan);

#[divan::bench(args = DIGITS, sample_count = 20)]
fn mul(bencher: Bencher<'_, '_>, digits: u32) {
    let (balls, x) = point(digits);
    bencher.bench(|| balls.mul(&x, &x));
}

#[divan::bench(args = DIGITS, sample_count = 20)]
fn div(bencher: Bencher<'_, '_>, digits: u32) {
    let (balls, x) = point(digits);
    bencher.bench(|| balls.div(&balls.one(), &x));
}

#[divan::bench(args = [16, 100, 1000], sample_count = 10)]
fn zeta_of_5(bencher: Bencher<'_, '_>, digits: u32) {
    let (balls, _) = point(digits);
    bencher.bench(|| balls.zeta(5));
}
