//! Delays at resonance and between several unknowns, several phases, irrational modes, against the time domain.

#![allow(clippy::unwrap_used, clippy::panic)]

use lindstedt::grid::Axis;
use lindstedt::verify::Verdict;
use lindstedt::{Oscillator, Respond, Verify, Work};

fn case(equation: &str, values: &[(&str, &str)]) -> Oscillator {
    let set = |case: Oscillator, (name, value): &(&str, &str)| case.set(name, value).unwrap();
    values.iter().fold(Oscillator::parse(equation).unwrap(), set)
}

fn slope(case: &Oscillator, order: usize) -> f64 {
    let small = Verify::read_small("1/100,1/200,1/400").unwrap();
    let question = Verify { order, small, ..Verify::default() };
    let found = case.verify(&question, &Work::default()).unwrap().value;
    assert_eq!(found.verdict, Verdict::Agrees);
    found.observed_order.unwrap()
}

/// x_N along the truncated flow, the past included, misses the solution by O(eps^(N + 1)).
#[test]
fn motions() {
    let primary = "x'' + x + eps*(x'/5 + x^3 + k*x(t - T)) = eps*F*cos((1 + eps*sigma)*t)";
    let values = [("k", "1/5"), ("F", "1/2"), ("sigma", "1")];
    let forced = |delay| case(primary, &[&values[..], &[("T", delay)]].concat());
    for order in 1..=3 {
        let found = slope(&forced("1"), order);
        assert!((found - order as f64 - 1.0).abs() < 0.05, "order {order}: {found}");
    }
    for equation in [
        // Internal resonance 1:2 through delayed values.
        "x'' + x + eps*(y(t - 1)*x + x'/10); y'' + 4*y + eps*x(t - 2)^2 = 0",
        // Modes with the frequencies 1 and sqrt 3; a delayed velocity.
        "x'' + 2*x - y + eps*(x^3/2 + y'(t - 1)); y'' + 2*y - x",
        "x'' + x + eps*(x'/5 + y(t - 1)); y'' + 2*y + eps*x^2 = 0",
        // Phases at t = 0 of one force and of several, with detunings of their own.
        "x'' + x + eps*(x'/5 + x^3) = eps*cos(t + 1/2)",
        "x'' + x + eps*(x'/5 + x^3) = eps*(cos(t + 1/2) + x*cos(2*t + 1/3))",
        "x'' + x + eps*(x'/5 + x^3) = eps*(cos((1 + eps)*t + 1/2) + x*cos((2 + 3*eps)*t + 1/3))",
    ] {
        let found = slope(&case(equation, &[]), 2);
        assert!((found - 3.0).abs() < 0.05, "{equation}: {found}");
    }
    let found = slope(&forced("pi"), 2);
    assert!((found - 3.0).abs() < 0.05, "T = pi: {found}");
}

/// N orders of the slow flow give the steady amplitude to O(eps^N): against the equation integrated over 400 periods.
#[test]
fn steady_amplitudes() {
    let equation = "x'' + x + eps*(x' + x^3 + x(t - 1)/5) = eps*cos((1 + eps*sigma)*t)";
    let near = ["49999997/100000000", "49999998/100000000", "49999999/100000000", "1/2"].join(",");
    let ask = |small: &str, order: usize| {
        let sweep = Some(Axis::parse(&format!("sigma={near}")).unwrap());
        let question =
            Respond { sweep, follow: order == 1, order: Some(order), ..Respond::default() };
        case(equation, &[("eps", small)]).respond(&question, &Work::default()).unwrap().value
    };
    let mut errors = [[0.0; 3]; 3];
    for (k, small) in ["1/5", "1/10", "1/20"].into_iter().enumerate() {
        let mut truth = None;
        for order in 1..=3 {
            let found = ask(small, order);
            let read = || found.followed.as_ref()?[0].last()?.amplitudes.as_ref()?.first().copied();
            let truth = *truth.get_or_insert_with(|| read().unwrap().value);
            let state = &found.states.last().unwrap().list[0];
            assert!(found.states.last().unwrap().count_proved);
            let amplitude: f64 = state.amplitudes[0].decimal.parse().unwrap();
            errors[order - 1][k] = (amplitude - truth).abs();
        }
    }
    for (order, [_, b, c]) in (1..).zip(errors) {
        let slope = (b / c).log2();
        assert!((slope - f64::from(order)).abs() < 0.25, "order {order}: {errors:?}");
    }
}

/// Delays 7/4 and 1/3, of which the common unit is small: all five states with proof, amplitudes to O(eps^N) and exponents to
/// O(eps^(N + 1)). The truth is that of harmonic balance of the equation with the odd harmonics to 15 and of Hill's
/// determinant about it, in Python: the larger amplitude and the exponent with a positive imaginary part, the smaller one
/// and the positive exponent.
#[test]
fn delays_of_a_small_common_unit() {
    let equation =
        "x'' + x + eps*(x^3 + x'/10 - x(t - 7/4)/6) = eps*h*x(t - 1/3)*cos((2 + eps*sigma)*t)";
    let truth = [
        ("1/40", [1.0924804838922932, -3.2522469988351e-3, 1.49218117954280e-2]),
        ("1/80", [1.092413204148088, -1.6380855327640e-3, 7.4935701493237e-3]),
    ];
    let small =
        [[0.24464323863617635, 1.4744707839157e-3], [0.2456961909957723, 7.428120224875e-4]];
    for order in 1..=4 {
        let mut errors = [[0.0f64; 2]; 4];
        for (k, ((eps, large), small)) in truth.into_iter().zip(small).enumerate() {
            let case = case(equation, &[("eps", eps), ("h", "1"), ("sigma", "1/2")]);
            let question = Respond { order: Some(order), ..Respond::default() };
            let found = case.respond(&question, &Work::default()).unwrap().value;
            let states = &found.states[0];
            assert_eq!((states.count, states.count_proved), (5, true), "order {order}, {eps}");
            let amplitude = |j: usize| states.list[j].amplitudes[0].decimal.parse::<f64>().unwrap();
            let exponent = |j: usize| states.list[j].exponents[0].map(|part| part.value);
            errors[0][k] = (amplitude(0) - large[0]).abs();
            errors[1][k] = (amplitude(2) - small[0]).abs();
            let [re, im] = exponent(0);
            errors[2][k] = (re - large[1]).hypot(im.abs() - large[2]);
            errors[3][k] = (exponent(2)[0] - small[1]).abs();
        }
        for (k, [a, b]) in errors.into_iter().enumerate() {
            let slope = (a / b).log2() - f64::from(u8::from(k > 1));
            assert!((slope - order as f64).abs() < 0.3, "order {order}: {errors:?}");
        }
    }
}

/// A mode of the frequency sqrt 2 that the force does not meet and the other one drives: the states are near those of 99/70.
#[test]
fn irrational_modes() {
    let amplitude = |square: &str| {
        let equation = format!(
            "x'' + x + eps*(x' + x^3 + x*y) = eps*cos((1 + eps*sigma)*t); y'' + {square}*y + eps*(y' + 4*x^2 + y^3)"
        );
        let case = case(&equation, &[("eps", "1/10"), ("sigma", "1/2")]);
        let found = case.respond(&Respond::default(), &Work::default()).unwrap();
        let states = &found.value.states[0];
        assert_eq!((states.count, states.count_proved), (1, true));
        (states.list[0].amplitudes[0].decimal.parse::<f64>().unwrap(), found.header.tier)
    };
    let ((found, tier), (near, exact)) = (amplitude("2"), amplitude("9801/4900"));
    assert_eq!((tier, exact), ("certified", "exact"));
    assert!(found != near && (found - near).abs() < 1e-4, "{found} {near}");
}
