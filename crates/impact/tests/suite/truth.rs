//! Flip boundary, impact-aware prediction, mismatch, penetration, charts, reports.

use crate::collocation::{monodromy, orbit_by_exponential};
use crate::support::{Random, data, exact, orbit_number, parameters, random_orbit};
use lindstedt_algebra::Stop;
use lindstedt_impact::ImpactError;
use lindstedt_impact::aware::impact_aware;
use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::chart::{Axis, Plan, Point, Predictor, Swept, chart};
use lindstedt_impact::flight::clearance;
use lindstedt_impact::flip::flip_boundary;
use lindstedt_impact::flow::{Flow, characteristic_root, rates};
use lindstedt_impact::kick::ReturnMap;
use lindstedt_impact::map::Verdict;
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::{Branch, ExactParameters, Parameters};
use lindstedt_impact::prediction::{Variant, mismatch, predict, predicted_flow, uncontrolled_map};
use lindstedt_impact::report::{Request, certified_stability, stability};
use lindstedt_impact::winding::zero_count;
use lindstedt_impact::zeros::{exact_verdict, multipliers};
use lindstedt_number::Exact;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn flip_boundary_is_where_the_simulation_flips() {
    // Confirmed by nonlinear simulation of the delayed system (ratio of perturbations -1.00000).
    for (n, expected) in [(3, -0.029_290_324_697_4), (5, 0.026_603_414_374_5)] {
        let p = orbit_number(n);
        let flips = flip_boundary(&p, Kick::None, -0.3, 0.3, 192).unwrap();
        let hits = flips.iter().filter(|a| (a.to_f64() - expected).abs() < 1e-12).count();
        assert_eq!(hits, 1, "O{n}: {:?}", flips.iter().map(Real::to_f64).collect::<Vec<_>>());
        for a in &flips {
            assert!(a.ball().relative_accuracy_bits() > 120);
            // An independent method has a multiplier of modulus 1 there.
            let p = Parameters { displacement_gain: a.to_f64(), ..p.nearest() };
            let (_, sigma) = orbit_by_exponential(&p).unwrap();
            let moduli = monodromy(&p, sigma, 0.0, 40);
            assert!(moduli.iter().any(|modulus| (modulus - 1.0).abs() < 1e-9), "{moduli:?}");
        }
    }
    let flips = flip_boundary(&orbit_number(2), Kick::None, -0.5, 0.3, 128).unwrap();
    let flips: Vec<f64> = flips.iter().map(Real::to_f64).collect();
    println!("O2 flips at A = {flips:?}");
    assert!(flips.iter().any(|a| (a + 0.270).abs() < 1e-3));
    assert!(flips.iter().any(|a| (a - 0.176).abs() < 1e-3));
}

#[test]
fn a_certified_report_without_a_predicted_orbit() {
    let p = parameters(&data("O8_saddle"));
    let report = certified_stability(&p, &Request::default(), 30, &Stop::default()).unwrap();
    assert!(matches!(report.kbm, Err(ImpactError::BeyondFold { .. })));
    let exact = report.exact.unwrap();
    assert_eq!(exact.verdict, Verdict::Unstable);
    // Settled at the first precision: 30 digits and guard bits.
    assert!(exact.multipliers.unwrap().values[0].re.precision() < 256);
}

/// The nonlinear simulation of the delayed system, done elsewhere, against the linear return map:
/// impact times T l + delta_l after a perturbed start.
#[test]
fn return_map_reproduces_the_nonlinear_simulation() {
    let file = data("delay_simulations");
    for case in file.as_array().unwrap() {
        let name = case["name"].as_str().unwrap();
        let p = parameters(&data(name)).nearest();
        let found = orbit(&p).unwrap();
        let perturbation = case["velocity_perturbation_over_v"].as_f64().unwrap();
        let mut map = ReturnMap::new(&p, &found).unwrap();
        map.start([0.0, perturbation * found.velocity]);
        let (mut largest, mut worst) = (0.0_f64, 0.0_f64);
        for (l, time) in case["impact_times"].as_array().unwrap().iter().enumerate() {
            let time: f64 = time.as_str().unwrap().parse().unwrap();
            let simulated = time - found.period * (l + 1) as f64;
            largest = largest.max(simulated.abs());
            worst = worst.max((map.fly() - simulated).abs());
        }
        println!("{name}: delays up to {largest:.2e}, linear map off by {worst:.2e}");
        // Second order in the perturbation.
        assert!(worst < 4.0 * largest * largest, "{name}: {worst:e} of {largest:e}");
    }
}

#[test]
fn delay_never_stabilises_the_minus_branch() {
    let base = parameters(&data("O8_saddle")).nearest();
    let found = orbit(&base).unwrap();
    let map = uncontrolled_map(&base, &found);
    let at_one = 1.0 - map.trace + map.determinant;
    assert!(at_one < 0.0);
    let mut random = Random(11);
    for _ in 0..100 {
        let p = Parameters {
            displacement_gain: random.between(-1.0, 1.0),
            velocity_gain: random.between(-1.0, 1.0),
            ..base.clone()
        };
        let g = Characteristic::new(&p, &found, Kick::Mean);
        assert!((g.at(&1.0) - at_one).abs() < 1e-12);
        assert_eq!(exact_verdict(&g).0, Verdict::Unstable);
    }
}

fn leading(p: &Parameters<f64>, kick: Kick) -> f64 {
    let found = orbit(p).unwrap();
    let g = Characteristic::new(p, &found, kick);
    let mut least = 0.5;
    loop {
        let list = multipliers(&g, least).unwrap();
        if let Some(first) = list.values.first() {
            return first.norm_squared().sqrt();
        }
        least *= 0.5;
    }
}

#[test]
fn impact_aware_series_tends_to_the_exact_multiplier() {
    let mut random = Random(5);
    for _ in 0..40 {
        let mut p = random_orbit(&mut random);
        p.displacement_gain = random.between(-0.05, 0.05);
        p.velocity_gain = random.between(-0.05, 0.05);
        let found = orbit(&p).unwrap();
        let g = Characteristic::new(&p, &found, Kick::Mean);
        let errors: Vec<f64> = [1, 3, 40]
            .iter()
            .map(|&order| {
                let predicted =
                    impact_aware(&p, &found, Kick::Mean, order, &Stop::default()).unwrap();
                let gamma = &predicted.multipliers[0];
                let (value, slope) = g.value_and_slope(&gamma.inverse());
                value.over(&slope).norm_squared().sqrt() * gamma.norm_squared().sqrt()
            })
            .collect();
        assert!(errors[1] < errors[0] && errors[2] < 1e-12, "{p:?} {errors:?}");
    }
}

/// Median of |error| over median of |true change| and how often the sign is right, for the change
/// of max |gamma| by a small gain.
#[test]
fn only_the_impact_aware_prediction_is_right_to_first_order() {
    let mut random = Random(17);
    let names = ["P1", "E1", "S1", "impact-aware 1"];
    let mut errors: [Vec<f64>; 4] = Default::default();
    let mut signs = [0_u32; 4];
    let (mut changes, mut near_signs, mut near, mut far_signs, mut far) = (Vec::new(), 0, 0, 0, 0);
    while changes.len() < 600 {
        let p0 = random_orbit(&mut random);
        let mut p = p0.clone();
        let gain = random.between(-0.1, 0.1);
        let displacement = changes.len() % 2 == 0;
        if displacement {
            p.displacement_gain = gain;
        } else {
            p.velocity_gain = gain;
        }
        let found = orbit(&p).unwrap();
        let zero = uncontrolled_map(&p0, &found).spectral_radius();
        let truth = leading(&p, Kick::Mean) - zero;
        let flow = predicted_flow(&p, &rates(&p, 1), 1).unwrap();
        let start = predicted_flow(&p0, &rates(&p0, 1), 1).unwrap();
        let by = |variant| {
            let at = |p: &Parameters<f64>, flow: &Flow<f64>| {
                predict(variant, p, flow, Some(&found)).map(|found| found.map.spectral_radius())
            };
            Ok::<f64, ImpactError>(at(&p, &flow)? - at(&p0, &start)?)
        };
        let aware = |p: &Parameters<f64>| {
            impact_aware(p, &found, Kick::Mean, 1, &Stop::default())
                .map(|found| found.spectral_radius())
        };
        let (Ok(e), Ok(after), Ok(before)) = (by(Variant::E), aware(&p), aware(&p0)) else {
            continue;
        };
        let s = by(Variant::S).unwrap();
        let predicted = [by(Variant::P).unwrap(), e, s, after - before];
        changes.push(truth.abs());
        for (rule, value) in predicted.into_iter().enumerate() {
            errors[rule].push((value - truth).abs());
            signs[rule] += u32::from((value > 0.0) == (truth > 0.0));
        }
        let m = mismatch(&p0, &uncontrolled_map(&p0, &found), &found.period);
        if displacement && m < 1.0 {
            near += 1;
            near_signs += i32::from((s > 0.0) == (truth > 0.0));
        } else if displacement && m > 2.0 {
            far += 1;
            far_signs += i32::from((s > 0.0) == (truth > 0.0));
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let scale = median(&mut changes);
    for rule in 0..4 {
        let relative = median(&mut errors[rule]) / scale;
        let right = f64::from(signs[rule]) / 600.0;
        println!(
            "{}: median error {relative:.3} of the change, sign right {right:.2}",
            names[rule]
        );
        if rule == 3 {
            assert!(relative < 0.15 && right > 0.88);
        } else {
            assert!(relative > 0.8 && right < 0.6);
        }
    }
    println!(
        "S1, response to A: sign right {near_signs}/{near} for m < 1, {far_signs}/{far} for m > 2"
    );
    assert!(f64::from(near_signs) >= 0.9 * f64::from(near));
    assert!(f64::from(far_signs) <= 0.25 * f64::from(far));
}

#[test]
fn clearance_agrees_with_dense_sampling() {
    let mut random = Random(23);
    let (mut passes, mut stays) = (0, 0);
    for _ in 0..300 {
        let p = Parameters {
            alpha: random.between(0.5, 1.5),
            omega: random.between(0.5, 5.0),
            periods: random.between(1.0, 4.999) as u32,
            restitution: random.between(0.0, 1.0),
            wall: random.between(-0.5, 0.5),
            damping: random.between(0.0, 0.3),
            force: 1.0,
            displacement_gain: 0.0,
            velocity_gain: 0.0,
            branch: Branch::Plus,
        };
        let Ok(found) = orbit(&p) else { continue };
        // Free motion and forced response of a damped oscillator, by the textbook.
        let half = p.damping / 2.0;
        let w = (p.alpha * p.alpha - half * half).sqrt();
        let (a, lag) = (p.forced_amplitude(), p.phase_lag());
        let angle = found.force_angle() - lag;
        let (c, start) = (p.wall - a * angle.cos(), -p.restitution * found.velocity);
        let d = (start + a * p.omega * angle.sin() + half * c) / w;
        let x = |t: f64| {
            let free = (c * (w * t).cos() + d * (w * t).sin()) * (-half * t).exp();
            a * (p.omega * t + angle).cos() + free - p.wall
        };
        let n = 20_000;
        let at = |i: i32| x(found.period * f64::from(i) / f64::from(n));
        let sampled = (1..n)
            .filter(|&i| at(i) >= at(i - 1) && at(i) >= at(i + 1))
            .map(at)
            .fold(f64::NEG_INFINITY, f64::max);
        match clearance(&p, &found, &Stop::default()).unwrap() {
            None => assert!(sampled == f64::NEG_INFINITY, "{p:?} {sampled}"),
            Some(found) => {
                assert!((found.margin - sampled).abs() < 1e-5, "{p:?} {} {sampled}", found.margin);
                if found.margin > 0.0 { passes += 1 } else { stays += 1 }
            }
        }
    }
    assert!(passes > 10 && stays > 10, "{passes} {stays}");
}

#[test]
fn observed_order_of_the_series_is_the_order_plus_one() {
    let p = parameters(&data("O1_A"));
    let scaled = |eps: f64| {
        let p = p.nearest();
        Parameters {
            damping: p.damping * eps,
            displacement_gain: p.displacement_gain * eps,
            velocity_gain: -0.1 * eps,
            ..p
        }
    };
    let error = |eps: f64, order: usize| {
        let p = scaled(eps);
        let root = characteristic_root(&p).unwrap();
        let flow = rates(&p, order).flow(order).unwrap();
        (flow.growth_rate - root.growth_rate).hypot(flow.frequency - root.frequency)
    };
    for order in 1..=5 {
        let slope = (error(0.5, order) / error(0.25, order)).log2();
        assert!((slope - order as f64 - 1.0).abs() < 0.35, "order {order}: {slope}");
    }
}

#[test]
fn the_winding_number_takes_a_few_dozen_evaluations() {
    let mut random = Random(29);
    let mut total = 0;
    for _ in 0..200 {
        let mut p = random_orbit(&mut random);
        p.displacement_gain = random.between(-0.3, 0.3);
        p.velocity_gain = random.between(-0.3, 0.3);
        let g = Characteristic::new(&p, &orbit(&p).unwrap(), Kick::Mean);
        total += zero_count(&g, 1.0).unwrap().evaluations;
    }
    println!("{} evaluations on average", total / 200);
    assert!(total / 200 < 120);
}

/// The guarantee rests on it: |G| on a disc stays below the bound, here at 200 x 300 points.
#[test]
fn the_bound_of_g_holds_on_discs() {
    let mut random = Random(31);
    let mut tightest = f64::INFINITY;
    for _ in 0..200 {
        let mut p = random_orbit(&mut random);
        p.displacement_gain = random.between(-0.5, 0.5);
        p.velocity_gain = random.between(-0.5, 0.5);
        let g = Characteristic::new(&p, &orbit(&p).unwrap(), Kick::After);
        let centre = Complex::new(random.between(-3.0, 3.0), random.between(-3.0, 3.0));
        let radius = random.between(0.01, 1.0);
        let bound = g.bound(&centre, radius);
        for _ in 0..300 {
            let (sin, cos) = random.between(0.0, 6.3).sin_cos();
            let w = centre.clone() + Complex::new(radius * cos, radius * sin);
            let size = g.value_and_slope(&w).0.norm_squared().sqrt();
            assert!(size <= bound, "{p:?} {centre:?} {radius} {size} {bound}");
            tightest = tightest.min(bound / size);
        }
    }
    println!("bound/|G| down to {tightest:.2}");
    assert!(tightest < 2.0);
}

/// Discs at 80 bits contain the zeros at 300 bits; counts on several circles equal the lists.
#[test]
fn enclosures_of_multipliers_contain_the_truth() {
    let mut random = Random(37);
    for _ in 0..12 {
        let p = random_orbit(&mut random);
        let of = |x: f64| Exact::from(rug::Rational::from_f64(x).unwrap());
        let p = ExactParameters {
            alpha: of(p.alpha),
            omega: of(p.omega),
            periods: p.periods,
            restitution: of(p.restitution),
            wall: of(p.wall),
            damping: of(p.damping),
            force: of(1.0),
            displacement_gain: of(random.between(-0.3, 0.3)),
            velocity_gain: of(random.between(-0.3, 0.3)),
            branch: Branch::Plus,
        };
        let at = |bits: u32| {
            let p = p.certified(bits);
            let g = Characteristic::new(&p, &orbit(&p).unwrap(), Kick::Mean);
            multipliers(&g, 0.05).unwrap().values
        };
        let (rough, fine) = (at(80), at(300));
        assert_eq!(rough.len(), fine.len());
        for (rough, fine) in rough.iter().zip(&fine) {
            for (rough, fine) in [(&rough.re, &fine.re), (&rough.im, &fine.im)] {
                let truth = fine.ball().midpoint().to_rational().unwrap();
                assert!(rough.ball().contains(&truth));
                assert!(rough.ball().radius().to_f64() < 1e-15);
            }
        }
    }
}

#[test]
fn a_chart_equals_its_points() {
    let base = orbit_number(5).nearest();
    let axis = |parameter, count| Axis { parameter, low: -0.3, high: 0.3, count };
    let plan = Plan {
        columns: axis(Swept::DisplacementGain, 9),
        rows: axis(Swept::VelocityGain, 7),
        predictor: Some((Predictor::Kbm(Variant::E), 2)),
        exact: Some(Kick::Mean),
        radius: true,
        part: None,
    };
    let rows = AtomicUsize::new(0);
    let observer = |_: usize| {
        rows.fetch_add(1, Ordering::Relaxed);
        true
    };
    let found = chart(&base, &plan, &observer).unwrap();
    assert_eq!(rows.load(Ordering::Relaxed), 7);
    let request = Request { order: 2, ..Request::default() };
    for row in 0..7 {
        for column in 0..9 {
            let p = Parameters {
                displacement_gain: plan.columns.value(column),
                velocity_gain: plan.rows.value(row),
                ..base.clone()
            };
            let report = stability(&p, &request, &Stop::default()).unwrap();
            let point = found.point(column, row).unwrap();
            assert_eq!(point.predicted, report.kbm.as_ref().ok().map(|kbm| kbm.verdict));
            assert_eq!(point.exact, report.exact.map(|exact| exact.verdict));
            assert!((point.exact_radius - leading(&p, Kick::Mean)).abs() < 1e-9);
            if let Ok(kbm) = report.kbm {
                let radius = kbm.prediction.map.spectral_radius();
                assert!((point.predicted_radius - radius).abs() < 1e-12);
            }
        }
    }
    // In parts it is the same, bit by bit.
    let parts = [(0, 3), (3, 1), (4, 100)].map(|part| {
        let plan = Plan { part: Some(part), ..plan };
        chart(&base, &plan, &|_| true).unwrap()
    });
    assert!(parts[1].point(2, 3).is_some() && parts[1].point(2, 2).is_none());
    let points = parts.iter().flat_map(|part| &part.points);
    assert_eq!(points.clone().count(), 63);
    for (point, whole) in points.zip(&found.points) {
        assert_eq!((point.predicted, point.exact), (whole.predicted, whole.exact));
        assert_eq!(point.exact_radius.to_bits(), whole.exact_radius.to_bits());
    }
    let agreement = found.agreement();
    let wrong = agreement.false_stable + agreement.false_unstable;
    assert_eq!(agreement.equal + wrong, agreement.compared);
    assert!(agreement.false_stable > 0);
    for variant in [Variant::P, Variant::S] {
        let predictor = Some((Predictor::Kbm(variant), 2));
        let found =
            chart(&base, &Plan { predictor, exact: None, radius: false, ..plan }, &|_| true);
        let found = found.unwrap();
        for (index, point) in found.points.iter().enumerate() {
            let p = Parameters {
                displacement_gain: plan.columns.value(index % 9),
                velocity_gain: plan.rows.value(index / 9),
                ..base.clone()
            };
            let one = predict(variant, &p, &rates(&p, 2).flow(2).unwrap(), None);
            assert_eq!(point.predicted, one.ok().map(|found| found.map.verdict()));
            assert!(point.predicted_radius.is_nan());
        }
    }
    let stopped = chart(&base, &plan, &|_| false);
    // Short rows in progress are finished; what there is begins with the first point, and is the same.
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    assert!(stopped.unwrap().points.len() <= 9 * threads);
    let rows = AtomicUsize::new(0);
    let some = chart(&base, &plan, &|_| rows.fetch_add(1, Ordering::Relaxed) < 3).unwrap();
    assert!(some.points.len() < 63 && some.points.len().is_multiple_of(9));
    let same = |(a, b): (&Point, &Point)| (a.predicted, a.exact) == (b.predicted, b.exact);
    assert!(some.points.iter().zip(&found.points).all(same));
    let twice = Plan { rows: plan.columns, ..plan };
    assert_eq!(chart(&base, &twice, &|_| true).unwrap_err(), ImpactError::BadAxes);
    // A long row is kept as far as it was computed.
    let columns = Axis { count: 1000, ..plan.columns };
    let rows = Axis { count: 1, ..plan.rows };
    let long = Plan { columns, rows, exact: None, ..plan };
    let asked = AtomicUsize::new(0);
    let part = chart(&base, &long, &|_| asked.fetch_add(1, Ordering::Relaxed) < 1).unwrap();
    let whole = chart(&base, &long, &|_| true).unwrap();
    let verdicts = |points: &[Point]| points.iter().map(|p| p.predicted).collect::<Vec<_>>();
    assert_eq!(verdicts(&part.points), verdicts(&whole.points[..512]));
}

#[test]
fn a_certified_report_has_the_digits_asked_for() {
    let p = ExactParameters {
        displacement_gain: exact("0.05"),
        velocity_gain: exact("-0.2"),
        ..orbit_number(2)
    };
    for digits in [30, 100] {
        let report =
            certified_stability(&p, &Request::default(), digits, &Stop::default()).unwrap();
        let bits = i64::from(digits) * 10 / 3;
        let orbit = report.orbit.unwrap();
        assert!(orbit.orbit.velocity.ball().relative_accuracy_bits() > bits);
        assert_eq!(orbit.penetrates, Some(false));
        let exact = report.exact.unwrap();
        assert_eq!((exact.verdict, exact.zeros_in_unit_disc), (Verdict::Stable, Some(0)));
        for gamma in exact.multipliers.unwrap().values {
            assert!(gamma.re.ball().relative_accuracy_bits() > bits);
        }
        let growth = exact.growth.unwrap();
        assert!(growth.verdict() == Verdict::Stable && (growth.rate - 0.57).abs() < 0.02);
        assert!(report.impact_aware.unwrap().is_ok());
    }
}
