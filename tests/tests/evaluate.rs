//! Values from expansions: the table of powers from one expansion, the pendulum, van der Pol,
//! estimates never below the true error, refusals, problem files, averaged motions. Reference numbers: mpmath 1.3.0 (gamma
//! functions, elliptic integrals, Taylor integration of the limit cycle).
#![allow(clippy::unwrap_used)]

use lindstedt::equation::{Condition, Problem};
use lindstedt::evaluate::averaged::{Motion, MotionSettings, Start};
use lindstedt::evaluate::{EvaluateSettings, Evaluation, Trajectory, evaluate};
use lindstedt::series::resummation::{Kind, Method, ResummationError};
use lindstedt::simulate::{
    Digits, Doubles, EventKind, Integrator, Model, Parameters, Quantity, Real, Report,
    Settings as Precision, Trajectory as Path,
};
use lindstedt::{Error, ProblemFile, Value, problems};
use rug::Float;
use std::ops::ControlFlow;

fn settings(order: usize, method: Option<Method>, set: &[(&str, &str)]) -> EvaluateSettings {
    let parameters = set.iter().map(|(n, v)| ((*n).to_owned(), Value::parse(v).unwrap())).collect();
    EvaluateSettings { order: Some(order), method, parameters, ..EvaluateSettings::default() }
}

fn run(
    name: &str,
    order: usize,
    method: Option<Method>,
    set: &[(&str, &str)],
) -> Result<Evaluation, Error> {
    evaluate(&problems::find(name).unwrap(), &settings(order, method, set), &mut |_| true)
}

/// |value/exact - 1| of T/2pi without the amplitude, from the raw outcome.
fn relative_error(result: &Evaluation, exact: &str) -> f64 {
    let value = &result.resummed.outcome.estimate.value;
    let exact = Float::with_val(300, Float::parse(exact).unwrap());
    let two_pi = Float::with_val(300, rug::float::Constant::Pi) * 2u32;
    let value = Float::with_val(300, value) * two_pi;
    ((value - &exact) / exact).abs().to_f64()
}

/// The same for the estimate of the error.
fn relative_estimate(result: &Evaluation, exact: &str) -> f64 {
    let exact = Float::with_val(300, Float::parse(exact).unwrap());
    let two_pi = Float::with_val(300, rug::float::Constant::Pi) * 2u32;
    let estimate = Float::with_val(300, &result.resummed.outcome.estimate.error) * two_pi;
    (estimate / exact).abs().to_f64()
}

/// Section 3 of the numbers: exponent and relative error of T at orders 2, 4, 8, 12, 20 by the
/// change of variable.
#[test]
fn one_expansion_for_every_exponent() {
    let table: [(&str, [f64; 5]); 5] = [
        ("0", [6.3e-3, 5.6e-4, 6.4e-6, 7.9e-8, 1.2e-11]),
        ("3", [1.8e-3, 4.2e-5, 3.1e-8, 2.3e-11, 1.4e-17]),
        ("5", [5.0e-3, 2.1e-4, 4.7e-7, 1.1e-9, 6.8e-15]),
        ("101", [2.2e-2, 2.0e-3, 2.1e-5, 2.4e-7, 3.1e-11]),
        ("10000", [2.3e-2, 2.2e-3, 2.6e-5, 3.1e-7, 4.8e-11]),
    ];
    for (n, errors) in table {
        for (order, expected) in [2, 4, 8, 12, 20].into_iter().zip(errors) {
            let found = run("power-law", order, Some(Method::Uniform), &[("n", n)]).unwrap();
            let exact = found.exact_period.as_ref().unwrap().decimal.clone();
            let error = relative_error(&found, &exact);
            assert!((error / expected - 1.0).abs() < 0.05, "n = {n}, order {order}: {error:e}");
        }
    }
    for n in ["0", "1/2", "2", "3", "5", "9", "101", "1e4", "1e9"] {
        let found = run("power-law", 20, Some(Method::Uniform), &[("n", n)]).unwrap();
        let exact = found.exact_period.as_ref().unwrap().decimal.clone();
        let error = relative_error(&found, &exact);
        assert!(error < 5e-11, "n = {n}: {error:e}");
        assert!(error <= relative_estimate(&found, &exact), "n = {n}");
    }
    // 4 Gamma(1/4)^2/sqrt(8 pi) and 4 sqrt 2, independent of the closed form's code.
    let exact = |n| run("power-law", 20, None, &[("n", n)]).unwrap().exact_period.unwrap().decimal;
    assert_eq!(exact("3"), "7.41629870920548767373540138878");
    assert_eq!(exact("0"), "5.65685424949238019520675489684");
}

#[test]
fn pade_of_the_cubic_oscillator() {
    let found = run("power-law", 20, Some(Method::Pade), &[("n", "3")]).unwrap();
    assert_eq!(found.resummed.outcome.degrees, Some((10, 10)));
    let error = relative_error(&found, "7.41629870920548767373540138878");
    assert!((6.4e-17..6.6e-17).contains(&error), "{error:e}");
    assert!(error <= relative_estimate(&found, "7.41629870920548767373540138878"));
}

/// Every exponent, amplitude and method: refused, or a true error below the estimate.
#[test]
fn estimates_of_the_power_law_hold() {
    let (mut checked, mut refused) = (0, 0);
    let exponents =
        ["-0.999", "-0.9", "-0.6", "-0.5", "-0.49", "-0.3", "0", "0.99", "1", "3.5", "40", "1e300"];
    for n in exponents {
        for order in [9, 24] {
            for method in [
                None,
                Some(Method::PartialSum),
                Some(Method::Pade),
                Some(Method::Uniform),
                Some(Method::UniformPade),
            ] {
                match run("power-law", order, method, &[("n", n)]) {
                    Ok(found) => {
                        let exact = found.exact_period.as_ref().unwrap().decimal.clone();
                        let error = relative_error(&found, &exact);
                        let estimate = relative_estimate(&found, &exact);
                        // The exact value is known to 30 digits here.
                        assert!(
                            error <= estimate + 1e-29,
                            "{n} {order} {method:?}: {error:e} {estimate:e}"
                        );
                        checked += 1;
                    }
                    Err(Error::Resummation { reason, .. }) => {
                        assert!(matches!(reason, ResummationError::OutsideDisc { .. }), "{reason}");
                        assert_eq!(method, Some(Method::Uniform));
                        refused += 1;
                    }
                    Err(other) => panic!("{n}: {other}"),
                }
            }
        }
    }
    // n = -0.999, -0.9, -0.6, -0.5 at two orders: |u| >= 3.
    assert_eq!((checked, refused), (12 * 10 - 8, 8));
    assert!(matches!(run("power-law", 4, None, &[("n", "-1")]), Err(Error::OutsideDomain { .. })));
}

#[test]
fn the_pendulum_is_asymptotic() {
    let found = run("pendulum", 24, None, &[]).unwrap();
    assert!(found.verdict.contains("diverges"), "{}", found.verdict);
    assert_eq!(found.best_truncation.as_ref().unwrap().0, 5);
    let error = relative_error(&found, "6.69997566437045271270121137916");
    assert!(error < 1e-9 && error <= relative_estimate(&found, "6.69997566437045271270121137916"));
    assert!(found.period.unwrap().decimal.starts_with("6.69997566"));
    // 4 K(sin(a/2)) and what the expansion supports.
    for (amplitude, exact, digits) in [
        ("1e-300", "6.28318530717958647692528676656", 29),
        ("0.1", "6.28711454931047998585118371157", 12),
        ("2", "8.34975292691849473440637164590", 5),
        ("3", "16.1555393723933747637602761155", 2),
    ] {
        let found = run("pendulum", 20, None, &[("amplitude", amplitude)]).unwrap();
        assert_eq!(found.exact_period.as_ref().unwrap().decimal, exact);
        let error = relative_error(&found, exact);
        let estimate = relative_estimate(&found, exact);
        assert!(error <= estimate + 1e-29, "{amplitude}: {error:e} {estimate:e}");
        assert!(estimate < 10f64.powi(-digits), "{amplitude}: {estimate:e}");
    }
    // Next to the saddle nothing is left of the expansion, and that is said.
    let found = run("pendulum", 20, None, &[("amplitude", "3.14159")]).unwrap();
    assert_eq!(found.period, None);
    assert!(found.verdict.contains("not one digit"));
    assert_eq!(found.exact_period.unwrap().decimal, "59.6761549495602934780033398169");
}

#[test]
fn duffing_inside_and_outside_the_radius() {
    for (eps, exact) in [
        ("1/10", "6.06065673695746678006716557694"),
        ("1", "4.76802202910246080630451847006"),
        ("100", "0.736288960821622358633127721265"),
        ("-9/10", "12.4087172255853295275427037843"),
    ] {
        for method in
            [None, Some(Method::Pade), Some(Method::ConformalPade), Some(Method::UniformPade)]
        {
            let found = run("duffing", 24, method, &[("eps", eps)]).unwrap();
            assert_eq!(found.exact_period.as_ref().unwrap().decimal, exact);
            let error = relative_error(&found, exact);
            let estimate = relative_estimate(&found, exact);
            assert!(error <= estimate + 1e-29, "{eps} {method:?}: {error:e} {estimate:e}");
            assert!(estimate < 1e-4 || method.is_some(), "{eps}: {estimate:e}");
        }
    }
    // The radius zero of the pendulum leaves no nearest singularity to report, at any order.
    for order in [12, 20] {
        let found = run("pendulum", order, None, &[]).unwrap();
        assert!(found.resummed.singularity.is_none(), "{order}");
    }
    let found = run("duffing", 30, None, &[]).unwrap();
    let singularity = found.resummed.singularity.unwrap();
    assert!((singularity.at.re.to_f64() + 1.0).abs() < 1e-6);
    assert_eq!(singularity.kind, Kind::Logarithm);
    assert!(matches!(run("duffing", 4, None, &[("eps", "-1")]), Err(Error::OutsideDomain { .. })));
}

#[test]
fn van_der_pol_beyond_its_radius() {
    let exact = [
        ("1", 100, "6.663286859323130189699682030482328706812646", 1e-30),
        ("2", 60, "7.62987447967484", 1e-8),
        ("5", 100, "11.6122306677196", 1e-6),
    ];
    for (eps, order, exact, least) in exact {
        let found = run("van-der-pol", order, None, &[("eps", eps)]).unwrap();
        let error = relative_error(&found, exact);
        // The references for 2 and 5 have 15 digits.
        assert!(error <= relative_estimate(&found, exact) + 1e-14, "{eps}: {error:e}");
        assert!(error < least, "{eps}: {error:e}");
        if eps != "1" {
            continue;
        }
        let found = found.resummed.singularity.unwrap();
        let difference = |x: &Float, exact: &str| {
            let exact = Float::with_val(300, Float::parse(exact).unwrap());
            Float::with_val(300, x - exact).abs()
        };
        let re = difference(&found.at.re, "-0.751366562997634396907");
        let im = difference(&found.at.im, "3.336635074940298592");
        assert!(re < 5e-11 && im < 5e-11 && re <= found.error && im <= found.error, "{re} {im}");
        assert_eq!(found.kind, Kind::SquareRoot);
        assert!((found.exponent.to_f64() - 0.5).abs() < 1e-6);
    }
}

/// x(t) against Taylor integration with tolerance 1e-18 (mpmath 1.3.0, odefun), at
/// t = 1/2, 1, 2, 3.
#[test]
fn the_solution_at_asked_times() {
    let cases: [(&str, usize, [f64; 4], f64); 4] = [
        (
            "power-law",
            8,
            [0.88226639489044, 0.595976567672141, -0.103183615527762, -0.776571607370589],
            1e-3,
        ),
        (
            "pendulum",
            6,
            [0.896032544910296, 0.600085366127506, -0.306200957588524, -0.948751596946198],
            1e-2,
        ),
        (
            "duffing",
            20,
            [0.768801895376325, 0.233691791143141, -0.859349358101855, -0.661798490270232],
            1e-12,
        ),
        (
            "van-der-pol",
            30,
            [1.846349123078, 1.51808469155026, 0.344480964943823, -1.85438447940234],
            1e-9,
        ),
    ];
    for (name, order, expected, most) in cases {
        let problem = problems::find(name).unwrap();
        let settings = EvaluateSettings { digits: 16, ..settings(order, None, &[]) };
        let period = evaluate(&problem, &settings, &mut |_| true).unwrap();
        let phase = Value::parse("0").unwrap();
        let path = Trajectory::new(&problem, &settings, &period, phase, &mut |_| true).unwrap();
        for (time, expected) in ["1/2", "1", "2", "3"].iter().zip(expected) {
            let found = path.at(&Value::parse(time).unwrap());
            let error = (found.double - expected).abs();
            assert!(error <= found.error + 1e-14, "{name} {time}: {error:e} {:e}", found.error);
            assert!(error < most, "{name} {time}: {error:e}");
        }
        // Half a period later with phase pi: the same, by symmetry with the other sign.
        let half = Value::PiTimes(rug::Rational::from(1));
        let shifted = Trajectory::new(&problem, &settings, &period, half, &mut |_| true).unwrap();
        let (a, b) =
            (path.at(&Value::parse("1").unwrap()), shifted.at(&Value::parse("1").unwrap()));
        assert!((a.double + b.double).abs() < 1e-9);
    }
}

fn example(name: &str) -> Problem {
    let path = format!("{}/../docs/examples/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    ProblemFile::parse(&std::fs::read_to_string(path).unwrap()).unwrap().problem
}

/// A problem from an equation and further lines of its file.
fn written(equation: &str, lines: &str) -> Problem {
    let text = format!("name = 'test'\nequation = \"{equation}\"\n{lines}");
    ProblemFile::parse(&text).unwrap().problem
}

fn quantity(text: &str) -> Quantity {
    Quantity::parse(text).unwrap()
}

/// The period of the limit cycle: the time between crossings of x' = 0 after a long transient,
/// by Taylor integration with 25 digits.
fn cycle_period(problem: &Problem, set: &[(&str, &str)], transient: i32) -> Float {
    let real = Digits::for_digits(25);
    let mut parameters = Parameters::new();
    for card in &problem.parameters {
        parameters.set(&card.name, quantity(&card.default));
    }
    for (name, value) in set {
        parameters.set(name, quantity(value));
    }
    let model = Model::of_problem(problem).unwrap();
    let system = model
        .with_section(lindstedt::equation::Expression::Velocity)
        .compile(real, &parameters)
        .unwrap();
    let start = [real.double(2.0), real.zero()];
    let mut flow =
        Integrator::new(&system, &real.zero(), &start, Precision::for_digits(25)).unwrap();
    let mut crossings: Vec<Float> = Vec::new();
    let end = real.double(f64::from(transient));
    let _ = flow.advance(&end, &mut |_| ControlFlow::Continue(())).unwrap();
    let end = real.double(f64::from(transient) + 20.0);
    let _ = flow
        .advance(&end, &mut |report| {
            if let Report::Event(event) = report
                && matches!(event.kind, EventKind::Section { rising: false, .. })
            {
                crossings.push(event.time.clone());
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    Float::with_val(100, &crossings[1] - &crossings[0])
}

/// A problem, values of its parameters, a bound of the error.
type Case = (Problem, &'static [(&'static str, &'static str)], f64);

/// Limit cycles of files, parameters of their own included, against the time domain.
#[test]
fn limit_cycles_of_files() {
    let own = written(
        "x'' + omega_0^2 x = eps (k - x^2) x' + eps c x^3",
        "condition = 'limit-cycle'\n[parameters]\nomega_0 = { value = '2' }\nk = { value = '4' }\n\
         c = { value = '1/5' }\n",
    );
    let cases: [Case; 4] = [
        (example("rayleigh"), &[("eps", "1/2")], 1e-16),
        (example("duffing-van-der-pol"), &[("eps", "1/4")], 1e-12),
        (example("duffing-van-der-pol"), &[("eps", "1/4"), ("beta", "-1/3")], 1e-8),
        (own, &[("eps", "1/5"), ("c", "-1/10")], 1e-8),
    ];
    for (problem, set, most) in cases {
        let found = evaluate(&problem, &settings(24, None, set), &mut |_| true).unwrap();
        let exact = cycle_period(&problem, set, 320).to_string();
        let (error, estimate) = (relative_error(&found, &exact), relative_estimate(&found, &exact));
        assert!(error <= estimate + 1e-22, "{} {set:?}: {error:e} {estimate:e}", problem.name);
        assert!(error < most, "{} {set:?}: {error:e}", problem.name);
    }
}

/// T of x'' + sum c_k x^k = 0 from x(0) = a at rest: with x = m + r cos theta between the turning
/// points and E - V = (a - x)(x - b) Q(x), T = 2 int_0^pi d theta/sqrt(2 Q), by the midpoint rule.
fn energy_period(force: &[f64], a: f64) -> f64 {
    let mut minus: Vec<f64> = vec![0.0];
    minus.extend(force.iter().zip(1..).map(|(c, k)| -c / f64::from(k)));
    let value = |p: &[f64], x: f64| p.iter().rev().fold(0.0, |sum, c| sum * x + c);
    minus[0] = -value(&minus, a);
    let mut b = -a;
    for _ in 0..100 {
        b += value(&minus, b) / value(force, b);
    }
    let divide = |p: &[f64], root: f64| {
        let mut quotient = vec![0.0; p.len() - 1];
        let mut carry = 0.0;
        for k in (0..quotient.len()).rev() {
            carry = p[k + 1] + carry * root;
            quotient[k] = carry;
        }
        quotient
    };
    let rest = divide(&divide(&minus, a), b);
    let number = 400;
    let (m, r) = ((a + b) / 2.0, (a - b) / 2.0);
    let term = |i: i32| {
        let theta = std::f64::consts::PI * (f64::from(i) + 0.5) / f64::from(number);
        1.0 / (-2.0 * value(&rest, m + r * theta.cos())).sqrt()
    };
    2.0 * std::f64::consts::PI / f64::from(number) * (0..number).map(term).sum::<f64>()
}

/// Conservative files against the energy integral: Helmholtz-Duffing, fifth powers, a stiffness
/// that is no square, amplitudes other than one, and the closed forms for other stiffnesses.
#[test]
fn conservative_files() {
    let with_amplitude = "condition = 'initial-amplitude'\n[parameters]\n\
                          amplitude = { value = '2' }\n";
    let scales = "small = 'delta'\namplitude = 'scales-frequency'\n";
    let mut helmholtz = example("helmholtz-duffing");
    helmholtz.conditions = vec![Condition::InitialAmplitude];
    let eps = 0.1;
    type Force = (Problem, &'static [(&'static str, &'static str)], Vec<f64>, f64, bool);
    let cases: Vec<Force> = vec![
        (
            helmholtz,
            &[("eps", "1/10"), ("amplitude", "2"), ("alpha_3", "3")],
            vec![0.0, 1.0, eps, 3.0 * eps * eps],
            2.0,
            false,
        ),
        (
            written("x'' + 2 x + eps x^5 = 0", with_amplitude),
            &[("eps", "1/30")],
            vec![0.0, 2.0, 0.0, 0.0, 0.0, 1.0 / 30.0],
            2.0,
            false,
        ),
        (
            written("2 x'' + 8 x + 6 eps x^3 = 0", with_amplitude),
            &[("eps", "1/2")],
            vec![0.0, 4.0, 0.0, 1.5],
            2.0,
            true,
        ),
        (
            written("x'' + 9 (x^2)^delta x = 0", &format!("{scales}{with_amplitude}")),
            &[("delta", "1")],
            vec![0.0, 0.0, 0.0, 9.0],
            2.0,
            true,
        ),
        // Through the Lobachevsky ring, order by order.
        (
            written("x'' + x (x^2)^(2 delta) = 0", scales),
            &[("delta", "1/2")],
            vec![0.0, 0.0, 0.0, 1.0],
            1.0,
            false,
        ),
    ];
    for (problem, set, force, amplitude, is_closed) in cases {
        let order = if problem.small == "delta" && !is_closed { 8 } else { 24 };
        let found = evaluate(&problem, &settings(order, None, set), &mut |_| true).unwrap();
        let exact = energy_period(&force, amplitude);
        let period = found.period.as_ref().unwrap();
        let (value, error) = (&period.decimal, period.error.as_ref().unwrap());
        let (value, error): (f64, f64) = (value.parse().unwrap(), error.parse().unwrap());
        let name = problem.equation.print("eps", lindstedt::equation::print::Style::Text);
        assert!((value - exact).abs() <= error + 1e-13, "{name}: {value} {exact} {error:e}");
        assert!(error < if order == 8 { 0.1 } else { 1e-4 }, "{name}: {error:e}");
        assert_eq!(found.exact_period.is_some(), is_closed, "{name}");
        if let Some(closed) = &found.exact_period {
            let closed: f64 = closed.decimal.parse().unwrap();
            assert!((closed - exact).abs() < 1e-13, "{name}: {closed} {exact}");
        }
    }
}

/// x(t) of a file against the integrator.
#[test]
fn solutions_of_files() {
    let mut helmholtz = example("helmholtz-duffing");
    helmholtz.conditions = vec![Condition::InitialAmplitude];
    let cases: [(Problem, &[(&str, &str)]); 3] = [
        (helmholtz, &[("eps", "1/10"), ("amplitude", "2")]),
        (example("duffing"), &[("eps", "1/8"), ("amplitude", "2")]),
        (example("duffing-van-der-pol"), &[("eps", "1/10")]),
    ];
    for (problem, set) in cases {
        let settings = EvaluateSettings { digits: 16, ..settings(20, None, set) };
        let period = evaluate(&problem, &settings, &mut |_| true).unwrap();
        let zero = Value::parse("0").unwrap();
        let path =
            Trajectory::new(&problem, &settings, &period, zero.clone(), &mut |_| true).unwrap();
        let start = path.at(&zero).double;
        let times = [0.5, 1.0, 2.0, 5.0];
        let expected = integrated(&problem, set, [start, 0.0], &times);
        for (time, expected) in times.iter().zip(expected) {
            let time = Value::Rational(rug::Rational::from_f64(*time).unwrap());
            let found = path.at(&time);
            let error = (found.double - expected).abs();
            assert!(error <= found.error + 1e-12, "{} {time}: {error:e}", problem.name);
            assert!(found.error < 1e-6, "{} {time}: {:e}", problem.name, found.error);
        }
    }
}

/// x at times >= 0 in doubles.
fn integrated(problem: &Problem, set: &[(&str, &str)], start: [f64; 2], times: &[f64]) -> Vec<f64> {
    let mut parameters = Parameters::new();
    for card in problem.parameters.iter().filter(|card| card.name != "branch") {
        parameters.set(&card.name, quantity(&card.default));
    }
    for (name, value) in set {
        parameters.set(name, quantity(value));
    }
    let system = Model::of_problem(problem).unwrap().compile(Doubles, &parameters).unwrap();
    let mut flow = Integrator::new(&system, &0.0, &start, Precision::for_digits(16)).unwrap();
    let mut path = Path::new(Doubles);
    let end = times.iter().fold(0.0f64, |top, t| top.max(*t));
    let _ = flow.advance(&end, &mut |report| path.record(report)).unwrap();
    times.iter().map(|t| path.value(0, t).unwrap()).collect()
}

fn motion(problem: &Problem, order: usize, set: &[(&str, &str)], start: Start) -> Motion {
    let parameters = set.iter().map(|(n, v)| ((*n).to_owned(), Value::parse(v).unwrap())).collect();
    let settings = MotionSettings { order, parameters, digits: 14, start };
    Motion::new(problem, &settings, &mut |_| true).unwrap()
}

fn state(x: &str, v: &str) -> Start {
    Start::State(Value::parse(x).unwrap(), Value::parse(v).unwrap())
}

fn values(times: &[f64]) -> Vec<Value> {
    times.iter().map(|t| Value::Rational(rug::Rational::from_f64(*t).unwrap())).collect()
}

/// The averaged van der Pol oscillator from rest at x = 1/2, 1 and 3, at many orders: the true
/// error is below the estimate wherever there is one.
#[test]
fn averaged_van_der_pol() {
    let problem = problems::find("van-der-pol").unwrap();
    let times = [0.0, 1.0, 7.0, 15.0, 30.0, 50.0, 80.0];
    let (mut checked, mut sharp) = (0, 0);
    for (eps, x) in [("1/20", "1/2"), ("1/10", "1"), ("1/10", "3"), ("1/4", "1"), ("1/2", "2")] {
        let start = [Value::parse(x).unwrap().ball(lindstedt::coeff::ball::Balls::new(60))];
        let start = [start[0].midpoint().to_f64(), 0.0];
        let expected = integrated(&problem, &[("eps", eps)], start, &times);
        for order in 2..=9 {
            let mut motion = motion(&problem, order, &[("eps", eps)], state(x, "0"));
            let found = motion.at(&values(&times), &mut || true);
            assert_eq!(found.len(), times.len());
            for (moment, expected) in found.iter().zip(&expected) {
                let x = &moment.displacement;
                let error = (x.double - expected).abs();
                let text = format!("eps {eps} order {order} t {}: {error:e}", moment.time);
                assert!(error <= x.error + 1e-11, "{text} {:e}", x.error);
                checked += i32::from(x.error.is_finite());
                sharp += i32::from(x.error < 1e-5);
            }
        }
    }
    assert!(checked > 250 && sharp > 60, "{checked} {sharp}");
}

/// The impact oscillator between impacts. Without the loop against the integrator; with it against
/// the root of alpha^2 + z^2 - (A + B z)(1 - exp(-z T)) + c z and the forced response, which the
/// loop does not see (T is a period of the force).
#[test]
fn averaged_free_flight() {
    let problem = problems::vibro_impact::problem();
    let times = [0.0, 1.0, 2.5, 6.0];
    let off = [("eps", "1"), ("c", "1/10")];
    let mut free = problem.clone();
    free.impact = None;
    // Any delay will do: its gain is zero.
    let still = [("eps", "1"), ("c", "1/10"), ("T", "1")];
    let mut model_problem = free.clone();
    let without = |e: &lindstedt::equation::Expression| match e {
        lindstedt::equation::Expression::Parameter(name) if name == "A" || name == "B" => {
            Some(lindstedt::equation::Expression::integer(0))
        }
        _ => None,
    };
    model_problem.equation = free.equation.substitute(&without).canonical();
    let expected = integrated(&model_problem, &still, [-0.5, 0.25], &times);
    let mut flight = motion(&problem, 10, &off, state("-1/2", "1/4"));
    assert!(flight.has_wall && flight.verdict().contains("between impacts"));
    for (moment, expected) in flight.at(&values(&times), &mut || true).iter().zip(expected) {
        let error = (moment.displacement.double - expected).abs();
        assert!(error <= moment.displacement.error + 1e-13 && error < 1e-9, "{error:e}");
    }
    let on = [("eps", "1"), ("A", "1/10"), ("B", "1/20")];
    let mut flight = motion(&problem, 10, &on, state("-1/2", "1/3"));
    let [growth, frequency] = flight.linear.clone().unwrap();
    // mpmath 1.3.0, findroot.
    let (r, w) = (-0.016_832_789_994_242_716, 0.959_070_214_690_621_9);
    let near = |number: &lindstedt::Number, exact: f64| {
        let value: f64 = number.decimal.parse().unwrap();
        let error: f64 = number.error.as_ref().unwrap().parse().unwrap();
        (value - exact).abs() <= error && error < 1e-8
    };
    assert!(near(&growth, r) && near(&frequency, w), "{growth:?} {frequency:?}");
    let (omega, c): (f64, f64) = (3.3, 0.2);
    let d = (1.0 - omega * omega).powi(2) + c * c * omega * omega;
    let forced =
        |t: f64| ((1.0 - omega * omega) * (omega * t).cos() + c * omega * (omega * t).sin()) / d;
    let first = -0.5 - forced(0.0);
    let second = (r * first - (1.0 / 3.0 - c * omega * omega / d)) / w;
    let exact =
        |t: f64| forced(t) + (r * t).exp() * (first * (w * t).cos() - second * (w * t).sin());
    // Backwards too.
    let times = [-3.0, 0.0, 2.0, 6.0];
    for (moment, time) in flight.at(&values(&times), &mut || true).iter().zip(times) {
        let error = (moment.displacement.double - exact(time)).abs();
        assert!(error <= moment.displacement.error + 1e-13, "{time}: {error:e}");
        assert!(error < 1e-8, "{time}: {error:e}");
    }
}

/// What cannot be evaluated says so.
#[test]
fn refusals_of_files() {
    let run = |problem: &Problem, set: &[(&str, &str)]| {
        evaluate(problem, &settings(6, None, set), &mut |_| true)
    };
    let named = |error: Error| match error {
        Error::Unset { name, .. } => name,
        other => panic!("{other}"),
    };
    let duffing = example("duffing");
    assert_eq!(named(run(&duffing, &[]).unwrap_err()), "eps");
    let open = written("x'' + x + eps k x^3 = 0", "[parameters]\nk = { meaning = 'open' }\n");
    assert_eq!(named(run(&open, &[("eps", "1")]).unwrap_err()), "k");
    // Beyond the saddle; an amplitude whose scaling is not the power law's.
    let beyond = run(&duffing, &[("eps", "-1/4"), ("amplitude", "2")]);
    assert!(matches!(beyond, Err(Error::OutsideDomain { .. })));
    let scales = "small = 'delta'\namplitude = 'scales-frequency'\n[parameters]\n\
                  amplitude = { value = '2' }\n";
    let other = written("x'' + x (x^2)^(2 delta) = 0", scales);
    assert!(matches!(run(&other, &[("delta", "1/4")]), Err(Error::OutsideDomain { .. })));
    let unknown = run(&duffing, &[("eps", "1"), ("k", "1")]);
    assert!(
        matches!(unknown, Err(Error::UnknownParameter { known, .. }) if known == "amplitude, eps")
    );
    for name in ["stick-slip", "vibro-impact", "wright"] {
        let found = run(&example(name), &[("eps", "1")]);
        assert!(matches!(found, Err(Error::NotEvaluated { .. })), "{name}");
    }
    // A wall bounds a motion whose expansion does not know it.
    let mut walled = duffing.clone();
    walled.impact = problems::vibro_impact::problem().impact;
    assert!(matches!(run(&walled, &[("eps", "1")]), Err(Error::NotEvaluated { .. })));
}
