//! Functions of many points against the values of single ones, which are summed with many digits by
//! other code.

use lindstedt::unstable::evaluation::Expansion;
use lindstedt::unstable::evaluation::compiled::Varied;
use lindstedt::unstable::evaluation::setting::Setting;
use lindstedt::unstable::problems;
use lindstedt::unstable::series::resummation::Method;
use lindstedt::{Evaluate, Exact, Oscillator, Work};
use std::collections::BTreeMap;

/// omega at one point, and its error.
/// omega and its error, and what the sum alone estimates of it.
fn single(
    oscillator: &Oscillator,
    order: usize,
    values: &[(&str, &str)],
) -> Option<(f64, f64, f64)> {
    let set = |case: Oscillator, (name, value): &(&str, &str)| case.set(name, value).unwrap();
    let case = values.iter().fold(oscillator.clone(), set);
    let question = Evaluate { order: Some(order), ..Evaluate::default() };
    let found = case.evaluate(&question, &Work::default()).ok()?.value;
    let sum = &found.resummed.outcome.estimate;
    let omega = found.frequency?;
    let value: f64 = omega.decimal.parse().ok()?;
    let estimate = value * sum.error.to_f64() / sum.value.to_f64().abs();
    Some((value, omega.error?.parse().ok()?, estimate))
}

/// A number of phases beyond that of all integers would wrap around.
#[test]
fn too_many_harmonics_are_refused() {
    let duffing = Oscillator::builtin("duffing").unwrap();
    for harmonics in [100_001, 1 << 62, (1 << 62) - 1, usize::MAX] {
        let (question, work) = (Evaluate::default(), Work::default());
        let function = duffing.solution_function(&question, harmonics, &work).unwrap_err();
        let case = duffing.clone().set("eps", "1/2").unwrap();
        let solution = case.periodic_solution(&question, harmonics, &work).unwrap_err();
        for error in [function, solution] {
            assert!(error.to_string().contains("too many"), "{error}");
        }
    }
}

/// omega by the function lies within its error, and where one point alone has eight digits it has six.
#[test]
fn frequencies_of_many_points_are_those_of_single_ones() {
    let builtin = |name| Oscillator::builtin(name).unwrap();
    let parse = |equation| Oscillator::parse(equation).unwrap();
    // The small parameter is the first value.
    let cases: [(Oscillator, usize, &[[&str; 2]]); 4] = [
        (builtin("duffing"), 8, &[["-3/10", "1"], ["1", "3/2"]]),
        (parse("x'' + 4*x + eps*x^5/3 = 0"), 8, &[["1/50", "2"]]),
        (builtin("van-der-pol"), 14, &[["-1/2", "1"], ["1/10", "1"]]),
        (builtin("power-law"), 8, &[["1", "2"], ["-1/4", "3"]]),
    ];
    for (oscillator, order, points) in cases {
        let question = Evaluate { order: Some(order), ..Evaluate::default() };
        let function = oscillator.frequency_function(&question, &Work::default()).unwrap().value;
        for [small, amplitude] in points {
            let mut set = vec![(&*function.small, *small)];
            set.extend(function.has_amplitude.then_some(("amplitude", *amplitude)));
            let double = |text: &str| Exact::parse(text).unwrap().to_f64();
            let (omega, error, estimate) = single(&oscillator, order, &set).unwrap();
            let found = function.at(double(small), double(amplitude));
            let gap = (found.value - omega).abs();
            assert!(
                gap <= found.error + error,
                "{oscillator} {set:?}: {gap:e} {found:?} {error:e}"
            );
            if estimate < 1e-8 * omega {
                assert!(found.error < 1e-6 * omega, "{oscillator} {set:?}: {found:?} {estimate:e}");
            }
        }
        let list = function.list(&[0.01, 0.02], &[1.0], &Default::default());
        assert_eq!(list, [function.at(0.01, 1.0), function.at(0.02, 1.0)]);
    }
}

/// Few orders far out: the error is that of the sum, not of its rounding. Duffing's omega is
/// sqrt(1 + eps) agm(1, sqrt(1 - k^2)), k^2 = eps/(2 + 2 eps).
#[test]
fn the_truth_lies_within_the_error_of_few_orders() {
    let duffing = Oscillator::builtin("duffing").unwrap();
    let mut largest = 0.0f64;
    for order in [4, 6, 9] {
        let question = Evaluate { order: Some(order), ..Evaluate::default() };
        let function = duffing.frequency_function(&question, &Work::default()).unwrap().value;
        for eps in [-0.6f64, -0.2, 0.3, 1.0, 3.0, 8.0] {
            let (mut a, mut b) = (1.0f64, (1.0 - eps / (2.0 + 2.0 * eps)).sqrt());
            for _ in 0..6 {
                (a, b) = (0.5 * (a + b), (a * b).sqrt());
            }
            let truth = (1.0 + eps).sqrt() * a;
            let found = function.at(eps, 1.0);
            let gap = (found.value - truth).abs();
            assert!(gap <= found.error, "{order} {eps}: {gap:e} {found:?}");
            if found.error.is_finite() {
                largest = largest.max(gap);
            }
        }
    }
    assert!(largest > 1e-9, "nothing to see: {largest:e}");
}

/// Where nothing is known the error is infinite: beyond the separatrix, at no number.
#[test]
fn points_without_a_digit_say_so() {
    let duffing = Oscillator::builtin("duffing").unwrap();
    let question = Evaluate { order: Some(6), ..Evaluate::default() };
    let function = duffing.frequency_function(&question, &Work::default()).unwrap();
    for (eps, amplitude) in
        [(-1.5, 1.0), (-0.5, 2.0), (0.1, -1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)]
    {
        let found = function.value.at(eps, amplitude);
        assert!(found.error.is_infinite(), "{eps} {amplitude}: {found:?}");
    }
    let question = Evaluate { method: Some(Method::BorelPade), ..Evaluate::default() };
    assert!(duffing.frequency_function(&question, &Work::default()).is_err());
}

/// x(t) by its harmonics against the table that is summed phase by phase, early and late.
#[test]
fn a_solution_at_many_times_is_that_at_single_ones() {
    for (name, eps, order) in [("duffing", "1/2", 8), ("van-der-pol", "1/4", 14)] {
        let case = Oscillator::builtin(name).unwrap().set("eps", eps).unwrap();
        let question = Evaluate { order: Some(order), ..Evaluate::default() };
        let x = case.periodic_solution(&question, 15, &Work::default()).unwrap().value;
        for times in ["0..7:8", "1000..1003:2"] {
            let times = Some(times.parse().unwrap());
            let table = case.evaluate(&Evaluate { times, ..question.clone() }, &Work::default());
            for point in table.unwrap().value.solution.unwrap().points {
                let (t, found) = (point.time.to_f64(), x.at(point.time.to_f64()));
                let gap = (found.value - point.double).abs();
                let allowed = found.error + point.error;
                assert!(gap <= allowed && found.error < 1e-3, "{name} {t}: {gap:e} {found:?}");
                assert_eq!(x.list(&[t], &Default::default()), [found.value]);
            }
        }
    }
}

/// x(t; eps, amplitude) of Duffing's oscillator against a cn(sqrt(1 + rho) t, k), k^2 = rho/(2 + 2 rho),
/// rho = eps a^2 (mpmath 1.3.0), of van der Pol's against its cycle in the time domain, started where x' = 0
/// (DOP853 of SciPy at 1e-13): within the stated errors, which are not idle.
#[test]
fn solutions_at_many_parameters_are_the_true_ones() {
    type Point = (f64, f64, [f64; 3]);
    let duffing: [Point; 3] = [
        (2.0, 2.0, [-0.432_051_131_044_673, 0.072_054_129_431_3, 1.117_758_858_076_84]),
        (10.0, 1.0, [-0.370_401_170_086_857, -0.621_705_708_019_942, -0.901_811_833_612_849]),
        (0.25, 2.0, [f64::NAN, f64::NAN, 1.597_749_537_994_828_7]),
    ];
    let cycle: [Point; 4] = [
        (0.1, 1.0, [1.555_589_93, -1.979_234_06, -1.699_772_53]),
        (0.5, 1.0, [1.644_505_59, -1.962_671_82, -1.852_607_38]),
        (1.0, 1.0, [1.729_284_24, -1.854_384_48, -2.008_594_18]),
        (2.0, 1.0, [1.835_590_72, -0.208_017_97, 0.902_767_3]),
    ];
    // Errors of the truth as printed, and the largest that may be stated over the gap that is seen.
    for (name, points, printed) in
        [("duffing", &duffing[..], 2e-14), ("van-der-pol", &cycle[..], 1e-8)]
    {
        let oscillator = Oscillator::builtin(name).unwrap();
        let question = Evaluate::default();
        let x = oscillator.solution_function(&question, 15, &Work::default()).unwrap().value;
        for (small, amplitude, truths) in points {
            let solution = x.at(*small, *amplitude);
            let mut largest = 0.0f64;
            for (time, truth) in [0.7, 3.0, 10.0].into_iter().zip(truths) {
                let found = solution.at(time);
                let gap = (found.value - truth).abs();
                assert!(
                    truth.is_nan() || gap <= found.error + printed,
                    "{name} {small} {time}: {gap:e} {found:?}"
                );
                largest = largest.max(if truth.is_nan() { 0.0 } else { gap });
            }
            let stated = solution.at(10.0).error;
            assert!(
                stated < 100.0 * largest.max(printed),
                "{name} {small}: {stated:e} {largest:e}"
            );
        }
        let list = x.list(&[0.1, 0.2], &[1.0], &Default::default());
        assert_eq!(list[1].harmonics, x.at(0.2, 1.0).harmonics);
        assert!(x.at(f64::NAN, 1.0).at(1.0).error.is_infinite());
    }
    // With an even force there is no symmetry by half a turn: a constant and even harmonics.
    let quadratic = Oscillator::parse("x'' + x + eps*x^2 = 0").unwrap();
    let x = quadratic.solution_function(&Evaluate::default(), 12, &Work::default()).unwrap().value;
    let one = quadratic.set("eps", "1/10").unwrap();
    let one = one.periodic_solution(&Evaluate::default(), 12, &Work::default()).unwrap().value;
    let (found, other) = (x.at(0.1, 1.0).at(20.0), one.at(20.0));
    let gap = (found.value - other.value).abs();
    assert!(gap <= found.error + other.error && found.error < 1e-9, "{gap:e} {found:?} {other:?}");
}

/// x_1 of x'' + x (x^2)^delta: by the Fourier series of ln |cos tau|, its harmonics are c_1 = ln 2 - 3/4, c_3 = 1/16,
/// ..., which fall like a power of k and fold onto the lower ones where the phases are few: at 128 of them c_3 was wrong by 3e-9.
#[test]
fn harmonics_beyond_half_of_the_phases_hardly_fold() {
    let problem = problems::find("power-law").unwrap();
    let given = BTreeMap::from([("amplitude".to_owned(), Exact::from(1))]);
    let setting = Setting::new(&problem, None, &given).unwrap();
    let varied = Varied { setting: &setting, small: problem.small.to_string(), weight: None };
    let found = Expansion::new(&varied, 1, 3, &Work::default()).unwrap();
    let exact = [(1, std::f64::consts::LN_2 - 0.75), (3, 0.0625)];
    for (k, exact) in exact {
        let (_, cosines, _) = found.harmonics.iter().find(|(other, ..)| *other == k).unwrap();
        let distance = (cosines[1] - exact).abs();
        assert!(distance < 1e-11, "c_{k}: {distance:e}");
        assert!(distance <= found.left_out[1], "c_{k}: {distance:e}");
    }
    assert!(found.left_out[1] < 0.1, "{:e}", found.left_out[1]);
}

/// A small parameter so small that the equations of approximants are singular at single phases: the partial sum stands in.
/// x = cos(omega t) + eps (cos(3 omega t) - cos(omega t))/32 + O(eps^2), omega = 1 + 3 eps/8.
#[test]
fn tiny_parameters_have_values_at_all_phases() {
    for (text, eps) in [("1e-10", 1e-10), ("3e-10", 3e-10), ("1e-15", 1e-15)] {
        let case = Oscillator::parse("x'' + x + eps*x^3 = 0").unwrap().set("eps", text).unwrap();
        let x = case.periodic_solution(&Evaluate::default(), 15, &Work::default()).unwrap().value;
        for t in [0.0, 1.0, 3.0, 20.0] {
            let phase: f64 = (1.0 + 0.375 * eps) * t;
            let exact = phase.cos() + eps / 32.0 * ((3.0 * phase).cos() - phase.cos());
            let found = x.at(t);
            assert!((found.value - exact).abs() < 1e-14 && found.error < 1e-13, "{text} {found:?}");
        }
    }
}

/// x(t) of a sum whose order is asked for is as wrong as it says, and hardly more: van der Pol's cycle at eps = 1 begins at
/// 2.00861986087484 with the period 6.66328685932313 (DOP853 of SciPy, rtol 1e-13).
#[test]
fn harmonics_of_an_order_are_measured() {
    let cycle = Oscillator::builtin("van-der-pol").unwrap().set("eps", "1").unwrap();
    let question = Evaluate { order: Some(12), ..Evaluate::default() };
    let x = cycle.periodic_solution(&question, 25, &Work::default()).unwrap().value;
    assert_eq!(x.by, "expansion");
    let distance = (x.at(0.0).value - 2.008_619_860_874_84).abs();
    assert!(distance <= x.error(0.0) && x.error(0.0) < 20.0 * distance, "{distance:e} {x:?}");
    assert!((std::f64::consts::TAU / x.frequency - 6.663_286_859_323_13).abs() < 1e-12);
}
