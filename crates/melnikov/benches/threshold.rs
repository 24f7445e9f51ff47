//! Thresholds: a surface in doubles, certified ones by digits, zeros, a subharmonic.

#![allow(clippy::expect_used)]

use divan::Bencher;
use lindstedt_melnikov::{
    Axis, FastPoint, PolynomialFriction, Region, StickSlip, subharmonic, surface,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;

fn main() {
    divan::main();
}

/// 2000 x 2000 thresholds over omega and the speed of the belt.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn surface_four_million(bencher: Bencher<'_, '_>) {
    let point =
        FastPoint { a: 1.0, b: 1.0, dry: 0.3, alpha: 0.3, beta: 0.3, omega: 2.0, belt_speed: 0.4 };
    let axis = |low: f64| (0..2000u32).map(|k| low + f64::from(k) / 1000.0).collect::<Vec<_>>();
    let (rows, columns) = (axis(0.5), axis(-1.0));
    let mut table = vec![0.0; rows.len() * columns.len()];
    bencher.bench_local(|| {
        surface(&point, (Axis::Omega, &rows), (Axis::BeltSpeed, &columns), &mut table)
    });
}

fn stick_slip() -> StickSlip {
    StickSlip {
        a: Exact::from(1),
        b: Exact::from(1),
        dry: Exact::from((3, 10)),
        alpha: Exact::from((3, 10)),
        beta: Exact::from((3, 10)),
        omega: Exact::from(2),
        belt_speed: Exact::from((2, 5)),
    }
}

fn balls(digits: u32) -> Balls {
    Balls::new(digits * 10 / 3 + 40)
}

#[divan::bench(args = [40, 1000, 10_000], sample_count = 10)]
fn certified(bencher: Bencher<'_, '_>, digits: u32) {
    let paper = stick_slip();
    bencher.bench(|| paper.signed_threshold(balls(digits)).expect("a threshold"));
}

/// The complete list of zeros in 0 <= v* <= 1.
#[divan::bench(args = [40, 1000], sample_count = 5)]
fn zeros(bencher: Bencher<'_, '_>, digits: u32) {
    let soft = StickSlip { b: Exact::from(5), ..stick_slip() };
    let (low, high) = (Exact::from(0), Exact::from(1));
    bencher.bench(|| {
        soft.zeros_in(balls(digits), Axis::BeltSpeed, &low, &high).expect("the zeros").zeros.len()
    });
}

/// Period 2 inside one well: the orbit by bisection, then elliptic functions.
#[divan::bench(args = [40, 200], sample_count = 5)]
fn resonance(bencher: Bencher<'_, '_>, digits: u32) {
    let p = stick_slip();
    let friction = PolynomialFriction::cubic(p.dry.clone(), &p.alpha, p.beta.clone());
    bencher.bench(|| period_two(balls(digits), &p, &friction));
}

fn period_two(balls: Balls, p: &StickSlip, friction: &PolynomialFriction) -> bool {
    let region = Region::Inside;
    subharmonic(balls, &p.a, &p.b, &p.omega, friction, &p.belt_speed, region, 2).is_ok()
}
