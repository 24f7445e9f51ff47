//! How much larger the radius is than the true distance: in the norm of the proof, against a proof
//! with many more digits (which the integrator judges elsewhere).

use crate::common::{duffing, equation, guess, proved, q, van_der_pol, x, y};
use lindstedt_equation::Expression;
use lindstedt_orbit::{Kind, Proof};
use rug::Float;

/// s |delta omega| + |x_0| + sum k nu^k (|a_k| + |b_k|) between the numerical solutions.
fn distance(rough: &Proof, fine: &Proof) -> Float {
    let bits = 400;
    let between = |a: &lindstedt_number::ball::Ball, b: &lindstedt_number::ball::Ball| {
        Float::with_val(bits, a.midpoint() - b.midpoint()).abs()
    };
    let mut sum = between(&rough.frequency, &fine.frequency) * rough.frequency_weight;
    let mut power = Float::with_val(bits, 1);
    for k in 0..=rough.solution_modes.max(fine.solution_modes) {
        let ((a, b), (c, d)) = (rough.harmonic(k), fine.harmonic(k));
        sum += (between(&a, &c) + between(&b, &d)) * k.max(1) as u32 * &power;
        power *= rough.weight;
    }
    sum
}

#[test]
fn radii_are_sharp_and_never_too_small() {
    let cycles: Vec<Expression> = vec![
        van_der_pol(q(1, 2)),
        van_der_pol(q(1, 1)),
        van_der_pol(q(2, 1)),
        equation(x() + q(1, 3) * y().pow(3) - y()),
        equation(x() + (x().pow(2) + q(1, 2) * x() - 1) * y()),
    ];
    let families =
        [duffing(q(1, 2)), duffing(q(10, 1)), duffing(q(-9, 10)), equation(x() + x().pow(5))];
    let cycles = cycles.into_iter().map(|e| (e, Kind::LimitCycle, [2.0, 0.0], 60.0));
    let families =
        families.into_iter().map(|e| (e, Kind::InitialAmplitude(1.into()), [1.0, 0.0], 0.0));
    let mut ratios = Vec::new();
    for (equation, kind, state, settle) in cycles.chain(families) {
        let start = guess(&equation, state, settle).unwrap();
        let fine = proved(&equation, &kind, &start, 60).unwrap();
        for digits in [12, 25] {
            let rough = proved(&equation, &kind, &start, digits).unwrap();
            let truth = distance(&rough, &fine);
            assert!(truth <= Float::with_val(400, &rough.radius + &fine.radius), "{equation:?}");
            ratios.push((rough.radius.clone() / truth).to_f64());
        }
    }
    ratios.sort_by(f64::total_cmp);
    println!("radius over distance: {ratios:.3?}");
    assert!(ratios[ratios.len() / 2] < 100.0);
}
