//! Hopf points of equations as they are written, against the time domain.

use lindstedt::unstable::equation::{Expression, Function};
use lindstedt::unstable::hopf::{Coefficient, HopfCycle};
use lindstedt::unstable::simulate::{
    Doubles, EventKind, Integrator, Model, Parameters, Quantity, Report, Settings,
};
use lindstedt::{HopfSeries, Oscillator, Refusal, Work};
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

fn example(name: &str) -> Oscillator {
    let path = format!("{}/../docs/examples/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Oscillator::file(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn found(oscillator: &Oscillator, name: &str, order: usize) -> HopfSeries {
    oscillator.hopf(name, order, &Work { digits: 17, ..Work::default() }).unwrap().value
}

fn sum(list: &[Coefficient], eps: f64, order: usize) -> f64 {
    let value = |c: &Coefficient| c.number.decimal.parse::<f64>().unwrap();
    list.iter().take(order + 1).rev().fold(0.0, |sum, c| sum * eps + value(c))
}

/// x(t) of the series times `scale` as an expression in t, and x(0), x'(0).
fn motion(cycle: &HopfCycle, eps: f64, scale: f64) -> (Expression, [f64; 2]) {
    let number = |x: f64| Expression::Number(Rational::from_f64(x).unwrap());
    let omega = sum(&cycle.frequency, eps, cycle.frequency.len());
    let (mut terms, mut start) = (vec![number(0.0)], [0.0, 0.0]);
    for (n, waves) in cycle.harmonics.iter().enumerate() {
        let size = scale * eps.powi(n as i32 + 1);
        for wave in waves {
            let rate = wave.harmonic as f64 * omega;
            let [cos, sin] =
                [&wave.cos, &wave.sin].map(|c| size * c.decimal.parse::<f64>().unwrap());
            for (function, c) in [(Function::Cos, cos), (Function::Sin, sin)] {
                terms.push(number(c) * (number(rate) * Expression::Time).apply(function));
            }
            start = [start[0] + cos, start[1] + rate * sin];
        }
    }
    (Expression::Sum(terms), start)
}

/// (t, x) where x' falls through zero, the section, up to the time `end`.
fn maxima(
    model: Model,
    parameters: &Parameters,
    (history, start): (&Expression, &[f64]),
    end: f64,
) -> Vec<[f64; 2]> {
    let model = model.with_history(std::slice::from_ref(history));
    let system = model.compile(Doubles, parameters).unwrap();
    let mut flow = Integrator::new(&system, &0.0, start, Settings::for_digits(15)).unwrap();
    let mut list = Vec::new();
    flow.advance(&end, &mut |report| {
        if let Report::Event(event) = report
            && matches!(event.kind, EventKind::Section { rising: false, .. })
        {
            list.push([*event.time, event.before[0]]);
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    list
}

/// Frequency of the last maxima, their size, and the rate at which the first ones come to it.
fn settled(list: &[[f64; 2]]) -> [f64; 3] {
    let last = list.len() - 1;
    let turns = (last / 4) as f64;
    let omega = std::f64::consts::TAU * turns / (list[last][0] - list[last - last / 4][0]);
    let off = |n: usize| (list[n][1] - list[last][1]).abs();
    // Between two maxima at which the deviation is neither large nor lost.
    let (from, to) = (last / 12, last / 4);
    let rate = (off(to) / off(from)).ln() / (list[to][0] - list[from][0]);
    [omega, list[last][1], rate]
}

fn slope(pair: &[f64]) -> f64 {
    (pair[0] / pair[1]).log2()
}

/// The delay loop of the paper on a cubic spring, for B = sum B_n eps^n: the frequency of the simulated cycle, its
/// largest x and its exponent against the series.
#[test]
fn the_delay_loop_in_the_time_domain() {
    let oscillator = example("delay-loop");
    let cycle = found(&oscillator, "B", 4).cycle;
    assert_eq!(
        (cycle.is_stable(), cycle.checked_orders, cycle.exact),
        (Some(true), Some(5), false)
    );
    // (7) with R = 0 has the other sign.
    let (c, gain, delay) = (0.1f64, 0.1, 2f64);
    let averaged = (c - gain * delay.sin()) / (1.0 - delay.cos());
    assert!((averaged - 0.0064).abs() < 1e-5 && sum(&cycle.parameter, 0.0, 0) < -0.002);
    let law = cycle.law.clone().unwrap();
    let beta: f64 = law.floquet_exponent.number.decimal.parse().unwrap();
    let (mut frequency, mut size, mut rates) = (Vec::new(), Vec::new(), Vec::new());
    for eps in [0.4, 0.2] {
        let given = BTreeMap::new();
        let gain = Float::with_val(53, sum(&cycle.parameter, eps, 4));
        let parameters =
            Parameters::of_problem(oscillator.problem(), &given).with("B", Quantity::Float(gain));
        let model = Model::of_problem(oscillator.problem()).unwrap();
        let model = model.with_section(Expression::VELOCITY);
        let (history, start) = motion(&cycle, eps, 1.02);
        let end = 30.0 / (-beta * eps * eps);
        let [omega, largest, rate] = settled(&maxima(model, &parameters, (&history, &start), end));
        frequency.push((omega - sum(&cycle.frequency, eps, 4)).abs());
        let (wave, _) = motion(&cycle, eps, 1.0);
        size.push((largest - largest_of(&wave)).abs());
        rates.push((rate / (beta * eps * eps) - 1.0).abs());
    }
    println!("{frequency:?} {size:?} {rates:?}");
    assert!((slope(&frequency) - 6.0).abs() < 0.5, "{frequency:?}");
    assert!((slope(&size) - 5.0).abs() < 0.5, "{size:?}");
    assert!((slope(&rates) - 2.0).abs() < 0.4 && rates[1] < 0.2, "{rates:?}");
}

/// The largest value of a function of t near t = 0, by Newton's method on a parabola through three points.
fn largest_of(wave: &Expression) -> f64 {
    let at = |t: f64| {
        let number = Expression::Number(Rational::from_f64(t).unwrap());
        let put = wave.substitute(&|e| (*e == Expression::Time).then(|| number.clone()));
        numeric(&put)
    };
    let (mut t, h) = (0.0, 1e-3);
    for _ in 0..5 {
        let [a, b, c] = [at(t - h), at(t), at(t + h)];
        t -= h * (c - a) / (2.0 * (a - 2.0 * b + c));
    }
    at(t)
}

fn numeric(e: &Expression) -> f64 {
    match e {
        Expression::Number(q) => q.to_f64(),
        Expression::Sum(list) => list.iter().map(numeric).sum(),
        Expression::Product(list) => list.iter().map(numeric).product(),
        Expression::Function(Function::Cos, z) => numeric(z).cos(),
        Expression::Function(Function::Sin, z) => numeric(z).sin(),
        other => panic!("{other:?}"),
    }
}

/// The equation of first order integrated in time to the end of some thirty lives of a perturbation: how far the frequency
/// is from the series to order 4, and in parts of it the exponent from its first term.
fn against_time(cycle: &HopfCycle, eps: f64, model: Model) -> [f64; 2] {
    let beta: f64 = cycle.law.clone().unwrap().floquet_exponent.number.decimal.parse().unwrap();
    let exponent = beta * eps * eps;
    let (history, start) = motion(cycle, eps, 1.02);
    let list = maxima(model, &Parameters::new(), (&history, &start[..1]), -30.0 / exponent);
    let [omega, _, rate] = settled(&list);
    [(omega - sum(&cycle.frequency, eps, 4)).abs(), (rate / exponent - 1.0).abs()]
}

/// Wright's equation integrated in time at alpha_0 + alpha_2 eps^2 + alpha_4 eps^4: frequency and exponent.
#[test]
fn wright_in_the_time_domain() {
    let cycle = found(&example("wright-hopf"), "alpha", 4).cycle;
    assert!(cycle.exact && cycle.is_stable() == Some(true));
    let (mut frequency, mut rates) = (Vec::new(), Vec::new());
    for eps in [0.4, 0.2] {
        let alpha = Rational::from_f64(-sum(&cycle.parameter, eps, 4)).unwrap();
        let late = Expression::DISPLACEMENT.delayed(1);
        let right = Expression::Number(alpha) * late.clone() * (Expression::DISPLACEMENT + 1);
        // x' has the sign of -x(t - 1).
        let model = Model::first_order(&["x"], &[right]).unwrap().with_section(-late);
        let [off, rate] = against_time(&cycle, eps, model);
        frequency.push(off);
        rates.push(rate);
    }
    println!("{frequency:?} {rates:?}");
    assert!((slope(&frequency) - 6.0).abs() < 0.6, "{frequency:?}");
    assert!((slope(&rates) - 2.0).abs() < 0.5 && rates[1] < 0.2, "{rates:?}");
}

/// Each refusal by its code, and the term or the name that it is about.
#[test]
fn what_is_refused() {
    let table = [
        ("x' + b*x + a*x(t - 1)", "no-value-set", "b"),
        ("x' + a*x(t - 1) + abs(x)", "no-method", "abs(x)"),
        ("x' + a*x(t - 1) = cos(t)", "no-method", "cos(t)"),
        ("x' + a*x(t - 1) + 1", "no-method", "1 does not vanish"),
        ("x' + x(t - 1)/a + x", "no-method", "x(t - 1)"),
        ("x' + x(t - 1)*(1 + x)", "unknown-parameter", "a"),
        ("x' + a*x(t - 1) + eps*x^2", "no-value-set", "eps"),
        ("x' + a*x^2 + x", "no-hopf-point", "does not depend on a"),
        ("x' + (1 + a^2)*x + x^2", "no-hopf-point", "between -128 and 128"),
        ("x' + a*x(t - 1) - 2*x'(t - 1)", "no-hopf-point", "no bound"),
    ];
    for (equation, code, word) in table {
        let oscillator = Oscillator::parse(equation).unwrap();
        let error = oscillator.sought("a", 2, &Work::default()).err().unwrap();
        assert_eq!(error.code(), code, "{equation}: {error}");
        assert!(error.to_string().contains(word), "{equation}: {error}");
    }
    // Other questions say what kind of equation it is.
    let first = Oscillator::parse("x' + eps*x(t - 1)").unwrap();
    let refused = [
        first.derive(2, &Work::default()).err(),
        first.average(2, &Work::default()).err(),
        first.slow_flow(2, &Work::default()).err(),
        first.parameter_series("eps", 2, &Work::default()).err(),
        first.motion(&Default::default(), &Work::default()).err(),
    ];
    for error in refused {
        let error = error.unwrap();
        assert_eq!(error.code(), "first-order", "{error}");
        assert!(error.hint().contains("--unknown"), "{}", error.hint());
    }
    // A delay in the linear part is no lack of linearity.
    let late = Oscillator::parse("x'' + x + x(t - 1) + eps*x^3").unwrap();
    let error = late.derive(2, &Work::default()).err().unwrap();
    assert!(error.to_string().contains("the linear part has a delay"), "{error}");
    assert!(error.hint().contains("--unknown"), "{}", error.hint());
}

/// Two delays at once, and one that the value moves to another point: L = lambda + alpha (e^-lambda + e^(-2 lambda))/2
/// vanishes at lambda = i omega, 3 omega = pi: alpha = omega/(2 cos(omega/2) sin(3 omega/2)) (real and imaginary part).
#[test]
fn several_delays_and_another_point() {
    let two = Oscillator::parse("x' + alpha*(x(t - 1) + x(t - 2))/2*(1 - x^2)").unwrap();
    let cycle = found(&two, "alpha", 2).cycle;
    let omega = sum(&cycle.frequency, 0.0, 0);
    assert!((omega - std::f64::consts::FRAC_PI_3).abs() < 1e-15);
    let alpha = omega / ((0.5 * omega).cos() * (1.5 * omega).sin());
    assert!((sum(&cycle.parameter, 0.0, 0) - alpha).abs() < 1e-14);
    let other = example("wright-hopf").set("alpha", "8").unwrap();
    let found = found(&other, "alpha", 2);
    let exact = |n: usize| found.cycle.parameter[n].number.exact.clone();
    assert_eq!((exact(0).as_deref(), found.cycle.unstable_roots), (Some("5/2*pi"), Some(2)));
    assert_eq!(found.cycle.is_stable(), Some(false));
}

/// With y = e^x - 1 the equation x' + alpha (e^(x(t - 1)) - 1) = 0 is Wright's, y' + alpha y(t - 1) (1 + y) = 0: amplitudes differ,
/// the frequency as a function of alpha does not. Its functions are expanded as far as the order needs.
#[test]
fn functions_are_expanded_about_rest() {
    let curve = |equation: &str| {
        let found = found(&Oscillator::parse(equation).unwrap(), "alpha", 4).cycle;
        assert_eq!(found.checked_orders, Some(5));
        let [a, w] = [&found.parameter, &found.frequency].map(|list| {
            let value = |n: usize| list[n].number.decimal.parse::<f64>().unwrap();
            [2, 4].map(value)
        });
        // omega_0 + slope (alpha - alpha_0) + bend (alpha - alpha_0)^2.
        let slope = w[0] / a[0];
        [slope, (w[1] - slope * a[1]) / (a[0] * a[0])]
    };
    let wright = curve("x' + alpha*x(t - 1)*(1 + x) = 0");
    // y = x/(1 - x), too: y' = x'/(1 - x)^2.
    for other in
        ["x' + alpha*(exp(x(t - 1)) - 1) = 0", "x' + alpha*x(t - 1)*(1 - x)/(1 - x(t - 1)) = 0"]
    {
        for (a, b) in curve(other).into_iter().zip(wright) {
            assert!((a - b).abs() < 1e-13, "{other}: {a} {b}");
        }
    }
    // What is no equilibrium is refused.
    let other = Oscillator::parse("x' + alpha*(exp(x(t - 1) + 1) - 1) = 0").unwrap();
    let error = other.hopf("alpha", 2, &Work::default()).err().unwrap().to_string();
    assert!(error.contains("does not vanish"), "{error}");
}

/// Quotients and functions about another number than zero, against alpha_2, alpha_4, omega_2, omega_4 of the cycles of the full equations:
/// Fourier collocation with 15 points of a period at three sizes, extrapolated to none (mpmath 1.4, 30 digits).
#[test]
fn quotients_and_functions_are_truncated_series() {
    let hill = "x' = 2*(1 + x(t - a))/(1 + (1 + x(t - a))^10) - (1 + x)";
    let table = [
        (hill, [18.90758555403918, 382.0909838, -137.7329702495, 2624.04928], 1e-9),
        (
            "x' = -a*(cos(x(t - 1) - 1) - cos(1))",
            [1.68195381930, 2.1114886, -0.08245658549, -0.3103409],
            1e-6,
        ),
        ("x' = -a*x(t - 1)*sin(x)/x", [0.2617993878, 0.0501782158, 0.0, 0.0], 1e-9),
        ("x' = -a*x(t - 1)*sqrt(1 + x)", [0.38196898987, 0.3413374, -0.05, -0.05975], 1e-6),
        (
            "x' = a*sin(pi + x(t - 1))/(pi + x)",
            [2.20373912307, 0.714128, -0.0202642367, 0.0093846],
            1e-6,
        ),
    ];
    for (equation, expected, tolerance) in table {
        let cycle = found(&Oscillator::parse(equation).unwrap(), "a", 4).cycle;
        assert_eq!(cycle.checked_orders, Some(5), "{equation}");
        let value = |list: &[Coefficient], n: usize| list[n].number.decimal.parse::<f64>().unwrap();
        let own = [2, 4].map(|n| value(&cycle.parameter, n));
        let own: Vec<f64> =
            own.into_iter().chain([2, 4].map(|n| value(&cycle.frequency, n))).collect();
        for (a, b) in own.iter().zip(expected) {
            assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{equation}: {own:?}");
        }
    }
    // Also at an order at which the quotient multiplied out has millions of terms.
    let long = found(&Oscillator::parse(hill).unwrap(), "a", 10).cycle;
    assert_eq!((long.checked_orders, long.is_stable()), (Some(11), Some(true)));
}

/// What has no such series about x = 0 is named as it is written, with the reason.
#[test]
fn what_has_no_series_about_rest() {
    let table = [
        ("x' = a*sin(x(t - 1))/x", "-a*sin(x(t - 1))*x^(-1) divides by what vanishes"),
        ("x' = -a*x(t - 1) + x(t - 1)^99/x", "-x(t - 1)^99*x^(-1) divides by what vanishes"),
        ("x' = -a*x(t - 1) + x^2/(x + x(t - 1))", "divides by what vanishes"),
        ("x' = -a*(exp(x(t - 1)) - 2)", "-2*a does not vanish"),
        ("x' = -a*x(t - 1) + x^30*cos(t)", "depends on t"),
        ("x' = -a*x(t - 1) + abs(x)^3", "-abs(x)^3 has no power series"),
        ("x' = -a*x(t - 1) + x^2*abs(x + pi - 3)", "has no known sign at x = 0"),
        ("x' = -x(t - 1)*sin(a + x) + x^2", "is no polynomial in the parameter"),
    ];
    for (equation, words) in table {
        let oscillator = Oscillator::parse(equation).unwrap();
        let error = oscillator.hopf("a", 4, &Work::default()).err().unwrap();
        assert_eq!(error.code(), "no-method", "{equation}: {error}");
        assert!(error.to_string().contains(words), "{equation}: {error}");
        assert!(error.hint().contains("write c + x for x"), "{}", error.hint());
    }
    let open = Oscillator::parse("x' = -a*(2*sin(1)*cos(1) - sin(2) + x(t - 1))").unwrap();
    let error = open.hopf("a", 4, &Work::default()).err().unwrap();
    assert_eq!(error.code(), "could-not-decide", "{error}");
    assert!(error.to_string().contains("not told from zero"), "{error}");
    let second = |equation: &str| {
        let oscillator = Oscillator::parse(equation).unwrap();
        found(&oscillator, "a", 2).cycle.parameter[2].number.decimal.clone()
    };
    let smooth = second("x' = -a*x(t - 1) + x^2*(x + pi)");
    assert_eq!(second("x' = -a*x(t - 1) + x^2*abs(x + pi)"), smooth);
    assert_eq!(second("x' = -a*x(t - 1) - x^2*abs(-2*pi - x) + 2*x^3 + 3*pi*x^2"), smooth);
    // The hint followed: the equilibrium ln 2, and the one at pi above.
    let moved = Oscillator::parse("x' = -a*(exp(ln(2) + x(t - 1)) - 2)").unwrap();
    let cycle = found(&moved, "a", 2).cycle;
    assert_eq!(cycle.parameter[2].number.exact.as_deref(), Some("3/20*pi - 1/10"));
}

/// The loop with a quotient in time, at tau_0 + tau_2 eps^2 + tau_4 eps^4: its frequency and its exponent.
#[test]
fn a_quotient_in_the_time_domain() {
    let equation = Oscillator::parse("x' = 2*(1 + x(t - a))/(1 + (1 + x(t - a))^10) - (1 + x)");
    let cycle = found(&equation.unwrap(), "a", 4).cycle;
    let (mut frequency, mut rates) = (Vec::new(), Vec::new());
    for eps in [0.02, 0.01] {
        let delay = Rational::from_f64(sum(&cycle.parameter, eps, 4)).unwrap();
        let late = (Expression::DISPLACEMENT + 1).delayed(Expression::Number(delay));
        let own = Expression::DISPLACEMENT + 1;
        let right = 2 * late.clone() * (late.pow(10) + 1).pow(-1) - own;
        let model =
            Model::first_order(&["x"], std::slice::from_ref(&right)).unwrap().with_section(right);
        let [off, rate] = against_time(&cycle, eps, model);
        frequency.push(off);
        rates.push(rate);
    }
    println!("{frequency:?} {rates:?}");
    assert!((slope(&frequency) - 6.0).abs() < 0.6, "{frequency:?}");
    assert!(rates[1] < 0.5 * rates[0] && rates[0] < 0.01, "{rates:?}");
}
