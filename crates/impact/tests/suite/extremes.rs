//! Every extreme of the parameters: its limit form or its named error.

use crate::collocation::orbit_by_exponential;
use crate::support::{Random, data, exact, parameters};
use lindstedt_algebra::Stop;
use lindstedt_impact::ImpactError;
use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::convergence::convergence;
use lindstedt_impact::equivalent::{Drive, equivalent_orbit};
use lindstedt_impact::flow::{Flow, rates};
use lindstedt_impact::map::{ImpactMap, Verdict};
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::{Branch, ExactParameters, Parameters};
use lindstedt_impact::prediction::{Variant, predict, predicted_flow, uncontrolled_map};
use lindstedt_impact::report::{Request, certified_stability, stability};
use lindstedt_impact::zeros::exact_verdict;
use lindstedt_number::Exact;
use lindstedt_number::real::Real;

fn base() -> Parameters<f64> {
    Parameters {
        alpha: 1.0,
        omega: 2.6,
        periods: 1,
        restitution: 0.8,
        wall: 0.0,
        damping: 0.05,
        force: 1.0,
        displacement_gain: 0.0,
        velocity_gain: 0.0,
        branch: Branch::Plus,
    }
}

fn base_exact() -> ExactParameters {
    ExactParameters {
        alpha: exact("1"),
        omega: exact("2.6"),
        periods: 1,
        restitution: exact("0.8"),
        wall: exact("0"),
        damping: exact("0.05"),
        force: exact("1"),
        displacement_gain: exact("0"),
        velocity_gain: exact("0"),
        branch: Branch::Plus,
    }
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs() / expected.abs().max(1e-300);
    assert!(error <= tolerance, "{found} instead of {expected}: {error:e}");
}

#[test]
fn elastic_impact_without_damping_is_neutral() {
    let p = Parameters { restitution: 1.0, damping: 0.0, ..base() };
    let found = orbit(&p).unwrap();
    let map = uncontrolled_map(&p, &found);
    assert_eq!(map.determinant, 1.0);
    assert!(map.trace.abs() < 2.0, "elliptic");
    assert_eq!(map.verdict(), Verdict::Neutral);
    let g = Characteristic::new(&p, &found, Kick::None);
    assert_eq!(exact_verdict(&g), (Verdict::Neutral, None));
    // Exactly, too: the determinant is the number 1.
    let p = ExactParameters { restitution: exact("1"), damping: exact("0"), ..base_exact() };
    let p = p.certified(128);
    let found = orbit(&p).unwrap();
    assert_eq!(uncontrolled_map(&p, &found).verdict(), Verdict::Neutral);
    assert_eq!(exact_verdict(&Characteristic::new(&p, &found, Kick::None)).0, Verdict::Neutral);
}

#[test]
fn plastic_impact_has_one_multiplier_or_sticks() {
    let p = Parameters { restitution: 0.0, ..base() };
    let found = orbit(&p).unwrap();
    let free = Flow::uncontrolled(&p).unwrap();
    let map = uncontrolled_map(&p, &found);
    let [first, second] = map.multipliers();
    assert_eq!(map.determinant, 0.0);
    assert_eq!(second.re, 0.0);
    let growth = (free.growth_rate * found.period).exp();
    let limit = growth * found.saltation * (free.frequency * found.period).sin() / free.frequency;
    near(first.re, limit, 1e-14);
    // Some orbits would stick: the spring or the force presses the mass to the wall.
    let mut random = Random(3);
    let mut sticking = 0;
    for _ in 0..2000 {
        let p = Parameters {
            alpha: random.between(0.3, 2.0),
            omega: random.between(0.3, 3.0),
            wall: random.between(-1.0, 1.0),
            ..p.clone()
        };
        match orbit(&p) {
            Err(ImpactError::Sticking { acceleration }) => {
                sticking += 1;
                let (v, sigma) = orbit_by_exponential(&p).unwrap();
                near(acceleration, sigma * v, 1e-9);
                assert!(acceleration >= 0.0);
            }
            Ok(found) => assert!(found.acceleration_after < 0.0),
            Err(_) => {}
        }
    }
    assert!(sticking > 10, "{sticking}");
    // Trace and determinant zero: no division by zero.
    let nothing = ImpactMap { trace: 0.0, determinant: 0.0 };
    assert_eq!(nothing.multipliers()[0].re, 0.0);
    assert_eq!(nothing.verdict(), Verdict::Stable);
}

#[test]
fn resonance_of_the_force_costs_the_regular_form_nothing() {
    let mut losses = Vec::new();
    for detuning in ["1e-2", "1e-4", "1e-6", "1e-8", "1e-10"] {
        let alpha = 2.6 * (1.0 + detuning.parse::<f64>().unwrap());
        let exact_alpha = rug::Rational::from_f64(alpha).unwrap();
        let p = ExactParameters {
            alpha: exact_alpha.into(),
            damping: exact("0"),
            wall: exact("0.125"),
            omega: rug::Rational::from_f64(2.6).unwrap().into(),
            restitution: exact("0.75"),
            ..base_exact()
        };
        let reference = orbit(&p.certified(256)).unwrap();
        let doubles = p.nearest();
        let found = orbit(&doubles).unwrap();
        near(found.velocity, reference.velocity.to_f64(), 2e-14);
        near(found.saltation, reference.saltation.to_f64(), 1e-13);
        let free = Flow::uncontrolled(&doubles).unwrap();
        let form = Drive::new(&doubles).and_then(|drive| equivalent_orbit(&free, &drive));
        let loss = form.map_or(f64::NAN, |form| {
            (form.velocity - reference.velocity.to_f64()).abs() / found.velocity
        });
        losses.push(loss);
    }
    println!("loss of the form (8) at detunings 1e-2 .. 1e-10: {losses:?}");
    // At the resonance itself: v = P0 T/(2 (1 + R_r)) for every wall, and the form (8) is refused.
    for wall in [0.0, 0.3, -0.7] {
        let p = Parameters { alpha: 2.6, damping: 0.0, wall, ..base() };
        let found = orbit(&p).unwrap();
        near(found.velocity, found.period / (2.0 * 1.8), 1e-14);
        assert_eq!(Drive::new(&p).unwrap_err(), ImpactError::Resonance);
        let report = stability(&p, &Request::default(), &Stop::default()).unwrap();
        assert_eq!(report.kbm.unwrap_err(), ImpactError::Resonance);
        assert!(report.orbit.unwrap().form.is_none());
        assert!(report.exact.is_some());
    }
    let p = ExactParameters { alpha: exact("2.6"), damping: exact("0"), ..base_exact() };
    let p = p.certified(128);
    assert!(orbit(&p).unwrap().velocity.is_positive());
    assert_eq!(Drive::new(&p).unwrap_err(), ImpactError::Resonance);
}

#[test]
fn a_sine_of_zero_is_no_singularity_and_the_multipliers_coincide() {
    // theta = pi: the printed D is 0/0.
    let p = Parameters { omega: 2.0, damping: 0.0, wall: 0.1, ..base() };
    let free = Flow::uncontrolled(&p).unwrap();
    let drive = Drive::new(&p).unwrap();
    let form = equivalent_orbit(&free, &drive).unwrap();
    near(form.velocity, orbit(&p).unwrap().velocity, 1e-14);
    near(form.sine, -1.8 * 2.0 * form.velocity / 4.0, 1e-14); // Delta = 4, 1/E - cos = 2
    let map = ImpactMap::from_saltation(&free, &drive, &form.saltation);
    for gamma in map.multipliers() {
        near(gamma.re, 0.8, 1e-7); // -R_r E cos(theta); a double root has half the digits
    }
    near(map.determinant.sqrt(), 0.8, 1e-15);
}

#[test]
fn a_periodic_free_flow_has_no_impact_orbit() {
    let p = Parameters { alpha: 2.0, omega: 1.0, damping: 0.0, ..base() };
    assert!(matches!(orbit(&p), Err(ImpactError::PeriodicFreeFlow { .. })));
    let free = Flow::uncontrolled(&p).unwrap();
    let refused = equivalent_orbit(&free, &Drive::new(&p).unwrap());
    assert!(matches!(refused, Err(ImpactError::PeriodicFreeFlow { .. })));
    let p = ExactParameters {
        alpha: exact("2"),
        omega: exact("1"),
        damping: exact("0"),
        ..base_exact()
    };
    assert!(matches!(orbit(&p.certified(128)), Err(ImpactError::PeriodicFreeFlow { .. })));
    // v falls linearly towards it.
    let at = |alpha: f64| {
        let p = Parameters { alpha, omega: 1.0, damping: 0.0, ..base() };
        orbit(&p).unwrap().velocity
    };
    near(at(2.0 + 2e-6) / at(2.0 + 1e-6), 2.0, 1e-4);
}

#[test]
fn an_impact_resonance_is_named() {
    let p = Parameters { omega: 2.0, restitution: 1.0, damping: 0.0, ..base() };
    assert!(matches!(orbit(&p), Err(ImpactError::ImpactResonance { .. })));
    let free = Flow::uncontrolled(&p).unwrap();
    let refused = equivalent_orbit(&free, &Drive::new(&p).unwrap());
    assert!(matches!(refused, Err(ImpactError::ImpactResonance { .. })));
    let p = ExactParameters {
        omega: exact("2"),
        restitution: exact("1"),
        damping: exact("0"),
        ..base_exact()
    };
    assert!(matches!(orbit(&p.certified(128)), Err(ImpactError::ImpactResonance { .. })));
}

#[test]
fn damping_from_zero_to_overdamped() {
    let none = orbit(&Parameters { damping: 0.0, ..base() }).unwrap().velocity;
    let little = orbit(&Parameters { damping: 1e-10, ..base() }).unwrap().velocity;
    near(little, none, 1e-9);
    for damping in [0.0, 1.9, 2.0, 2.0 + 1e-9, 2.1, 10.0] {
        for wall in [0.0, 0.02] {
            let p = Parameters { damping, wall, displacement_gain: 0.1, ..base() };
            let found = orbit(&p).unwrap();
            let (v, sigma) = orbit_by_exponential(&p).unwrap();
            near(found.velocity, v, 1e-11);
            near(found.saltation, sigma, 1e-11);
            let report = stability(&p, &Request::default(), &Stop::default()).unwrap();
            assert_ne!(report.exact.unwrap().verdict, Verdict::Neutral);
            let refused = matches!(report.kbm, Err(ImpactError::Overdamped { .. }));
            assert_eq!(refused, damping >= 2.0);
        }
    }
    // Exactly critical damping in balls: the flow is enclosed through its double root.
    let p = ExactParameters { damping: exact("2"), ..base_exact() }.certified(160);
    let found = orbit(&p).unwrap();
    assert!(found.velocity.ball().relative_accuracy_bits() > 130);
    assert!(matches!(Flow::uncontrolled(&p), Err(ImpactError::Overdamped { .. })));
}

#[test]
fn long_delays_neither_overflow_nor_pass_without_a_warning() {
    let p = Parameters { omega: 0.31, periods: 15, damping: 0.01, ..base() };
    let drive = Drive::new(&p).unwrap();
    for rate in [-4.0, 4.0] {
        // E = e^(+-1216)
        let flow = Flow { growth_rate: rate, frequency: 1.0 };
        let found = equivalent_orbit(&flow, &drive).unwrap();
        assert!(found.velocity.is_finite() && found.sine.is_finite());
        let map = ImpactMap::from_saltation(&flow, &drive, &found.saltation);
        let expected = if rate > 0.0 { Verdict::Unstable } else { Verdict::Stable };
        assert_eq!(map.verdict(), expected);
    }
    let p = Parameters { displacement_gain: 0.3, ..p };
    let series = rates(&p, 12);
    let terms: Vec<_> = series.terms.iter().map(|term| term.to_f64()).collect();
    let estimate = convergence(&p, &terms);
    assert!(estimate.diverges() && estimate.ratio > 1.0, "{estimate:?}");
    // T sqrt(A^2 + alpha^2 B^2) < 0.55 alpha is safe.
    let p = Parameters { displacement_gain: 0.15, ..base() };
    let series = rates(&p, 40);
    let terms: Vec<_> = series.terms.iter().map(|term| term.to_f64()).collect();
    let estimate = convergence(&p, &terms);
    assert!(!estimate.diverges() && estimate.ratio < 1.0, "{estimate:?}");
}

#[test]
fn radius_of_convergence_agrees_with_the_growth_of_the_terms() {
    for (a, b, c, omega) in [
        (0.3, 0.0, 0.05, 0.8),
        (0.1, 0.1, 0.05, 2.6),
        (0.0, -0.2, 0.0, 1.7),
        (-0.27, 0.1, 0.1, 2.0),
    ] {
        let p = Parameters { displacement_gain: a, velocity_gain: b, damping: c, omega, ..base() };
        let series = rates(&p, 150);
        let terms: Vec<_> = series.terms.iter().map(|term| term.to_f64()).collect();
        let estimate = convergence(&p, &terms);
        // |lambda_n| ~ n^(-3/2) radius^-n: a root test over the last terms.
        let root =
            |n: usize| (terms[n].norm_squared().sqrt() * (n as f64).powf(1.5)).ln() / n as f64;
        let tail = (130..=150).map(root).fold(f64::NEG_INFINITY, f64::max);
        near(estimate.radius, (-tail).exp(), 0.05);
    }
}

#[test]
fn a_flow_that_does_not_oscillate_is_refused() {
    let p = Parameters { displacement_gain: 3.0, omega: 2.0, ..base() };
    let refused = predicted_flow(&p, &rates(&p, 1), 1);
    assert!(matches!(refused, Err(ImpactError::NotApplicable { frequency }) if frequency <= 0.0));
    // Overflow of the second order is no flow either.
    let p = Parameters { displacement_gain: 1e200, ..p };
    let refused = predicted_flow(&p, &rates(&p, 2), 2);
    assert!(
        matches!(refused, Err(ImpactError::NotApplicable { frequency }) if !frequency.is_finite())
    );
    let p = base();
    assert_eq!(predicted_flow(&p, &rates(&p, 1), 0).unwrap_err(), ImpactError::OrderZero);
}

#[test]
fn grazing_diverges_as_predicted_and_is_refused_in_the_end() {
    let p = base();
    let amplitude = p.forced_amplitude();
    for (gap, tolerance) in [(1e-2, 0.05), (1e-4, 1e-3), (1e-6, 1e-4)] {
        let p = Parameters { wall: amplitude * (1.0 - gap), ..p.clone() };
        let found = orbit(&p).unwrap();
        let [first, second] = uncontrolled_map(&p, &found).multipliers();
        near(first.re * found.velocity, -1.3199, tolerance);
        near(first.re * second.re, uncontrolled_map(&p, &found).determinant, 1e-14);
    }
    let p = Parameters { wall: amplitude * (1.0 - 1e-10), ..p };
    assert!(matches!(orbit(&p), Err(ImpactError::Grazing { velocity, threshold })
        if velocity < threshold));
}

#[test]
fn two_orbits_merge_in_the_fold() {
    let mut p = parameters(&data("O8_saddle")).nearest();
    // Bisect the wall position for the sign of the discriminant.
    let (mut exists, mut beyond) = (p.wall, 50.0);
    for _ in 0..200 {
        p.wall = f64::midpoint(exists, beyond);
        match orbit(&p) {
            Ok(_) => exists = p.wall,
            Err(ImpactError::BeyondFold { discriminant }) => {
                assert!(discriminant < 0.0);
                beyond = p.wall;
            }
            Err(error) => panic!("{error}"),
        }
    }
    p.wall = exists * (1.0 - 1e-9);
    let lower = orbit(&p).unwrap();
    let upper = orbit(&Parameters { branch: Branch::Plus, ..p.clone() }).unwrap();
    near(lower.velocity, upper.velocity, 1e-3);
    // det - trace + 1 = G(1) changes sign through the fold.
    for (found, sign) in [(lower, -1.0), (upper, 1.0)] {
        let map = uncontrolled_map(&p, &found);
        let gap = 1.0 - map.trace + map.determinant;
        assert!(gap * sign > 0.0 && gap.abs() < 1e-2, "{gap}");
    }
}

#[test]
fn a_missing_equivalent_orbit_leaves_the_other_answers() {
    let p = parameters(&data("O8_saddle")).nearest();
    let report = stability(&p, &Request::default(), &Stop::default()).unwrap();
    assert!(matches!(report.kbm, Err(ImpactError::BeyondFold { .. })));
    let exact = report.exact.unwrap();
    assert_eq!((exact.verdict, exact.zeros_in_unit_disc), (Verdict::Unstable, Some(1)));
    let flow = predicted_flow(&p, &rates(&p, 1), 1).unwrap();
    assert!(predict(Variant::S, &p, &flow, None).is_ok());
    assert!(report.orbit.is_ok());
}

#[test]
fn parameters_outside_their_domain_are_named() {
    let refused = |p: Parameters<f64>| orbit(&p).unwrap_err();
    assert_eq!(
        refused(Parameters { force: 0.0, ..base() }),
        ImpactError::NotPositive { name: "P0", value: 0.0 }
    );
    assert!(matches!(
        refused(Parameters { omega: -1.0, ..base() }),
        ImpactError::NotPositive { name: "omega", .. }
    ));
    assert!(matches!(
        refused(Parameters { restitution: 1.5, ..base() }),
        ImpactError::OutOfRange { name: "R_r, the restitution,", .. }
    ));
    assert!(matches!(
        refused(Parameters { damping: -0.1, ..base() }),
        ImpactError::Negative { name: "c", .. }
    ));
    assert_eq!(
        refused(Parameters { wall: f64::NAN, ..base() }),
        ImpactError::NotFinite { name: "s" }
    );
    assert!(matches!(
        refused(Parameters { periods: 0, ..base() }),
        ImpactError::NotPositive { name: "k", .. }
    ));
    // A wall beyond F: the larger root of the velocity is not positive for s kappa > 0.
    let p = Parameters { wall: 0.5, ..base() };
    assert!(matches!(
        refused(p),
        ImpactError::NoPositiveVelocity { .. } | ImpactError::BeyondFold { .. }
    ));
}

/// A stop ends the work, and what was stopped is not called undecided.
#[test]
fn a_stop_ends_the_work() {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};
    let p = ExactParameters { velocity_gain: exact("50"), ..base_exact() };
    let asked = Arc::new(AtomicU32::new(0));
    let counter = Arc::clone(&asked);
    let stop = Stop::new(move || counter.fetch_add(1, Ordering::SeqCst) >= 100);
    let stopped = certified_stability(&p, &Request::default(), 30, &stop);
    assert!(matches!(stopped, Err(ImpactError::Cancelled)));
    let asked = asked.load(Ordering::SeqCst);
    assert!((101..500).contains(&asked), "{asked}");
}

#[test]
fn roots_are_exact_parameters() {
    let p = ExactParameters { alpha: Exact::Root(rug::Rational::from(2)), ..base_exact() };
    let alpha = p.certified(200).alpha;
    let square = alpha.clone() * &alpha;
    assert!((square.to_f64() - 2.0).abs() < 1e-15 && alpha.ball().relative_accuracy_bits() > 190);
    assert_eq!(p.alpha.to_string(), "sqrt(2)");
}
