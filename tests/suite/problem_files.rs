//! Problem files: the examples, published coefficients, rewriting invariance, scaling, and every
//! file that parses ends in an expansion or a refusal.

mod fuzz;
mod rewriting;

use lindstedt::unstable::equation::classify::{Algebra, Method, Reason, classify};
use lindstedt::unstable::equation::{Condition, Problem};
use lindstedt::unstable::problem_file::write;
use lindstedt::{
    Derivation, DerivationError, Error, Oscillator, ProblemFile, Quantity, Work,
    unstable::derivation::Settings, unstable::derivation::derive,
    unstable::derivation::known_values, unstable::problems,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn examples() -> Vec<(PathBuf, ProblemFile)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/examples");
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let file = ProblemFile::parse(&text);
        let file = file.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path, file)
    };
    paths.into_iter().map(read).collect()
}

fn example(name: &str) -> Problem {
    let named = |(path, _): &(PathBuf, ProblemFile)| path.file_stem().is_some_and(|s| s == name);
    examples().into_iter().find(named).unwrap().1.problem
}

fn expand(problem: &Problem, order: usize) -> Derivation {
    let settings = Settings { order, ..Settings::default() };
    derive(problem, &settings, &mut |_| true).unwrap()
}

/// The examples that the expansion at constant amplitude takes.
const EXPANDED: [&str; 8] = [
    "duffing-van-der-pol",
    "duffing",
    "helmholtz-duffing",
    "pendulum",
    "power-law",
    "rayleigh",
    "sign-power",
    "van-der-pol",
];

#[test]
fn every_example_is_classified_and_the_expandable_ones_expand_to_order_10() {
    let all = examples();
    assert!(all.len() >= 12);
    let mut expanded = Vec::new();
    for (path, file) in &all {
        let stem = path.file_stem().unwrap().to_str().unwrap();
        // What the file says is what is written and read again.
        let again = ProblemFile::parse(&file.to_text()).unwrap();
        assert_eq!(again.problem, file.problem, "{stem}");
        assert_eq!([&again.fixed, &again.swept], [&file.fixed, &file.swept]);
        assert_eq!(again.asked, file.asked);
        assert_eq!((&again.units, &again.follows), (&file.units, &file.follows));
        let values = known_values(&file.problem, &BTreeMap::new());
        let parts = classify(&file.problem, &values);
        if file.problem.equation.is_first_order() {
            assert!(parts.is_err() && file.unknown.is_some(), "{stem}");
            continue;
        }
        let parts = parts.unwrap();
        assert!(parts.takes(Method::TimeDomain), "{stem}");
        match (stem, parts.refusal()) {
            // About a saddle nothing oscillates: that file is for `threshold --unknown`; a linear part with a
            // delay is one for `derive --unknown`.
            ("takens-bogdanov", Some(Reason::NoLinearPart)) => {}
            ("delay-loop", Some(Reason::DelayedLinearPart(_))) => {}
            // A belt that a mass sticks to: for `evaluate --cycles`.
            ("stribeck", Some(Reason::NonSmooth(_))) => {}
            (_, refusal) => assert_eq!(refusal, None, "{stem}"),
        }
        if parts.takes(Method::LindstedtPoincare) {
            let order = if parts.algebra == Algebra::Lobachevsky { 8 } else { 10 };
            let result = expand(&file.problem, order);
            assert_eq!(result.checked_orders, Some(order), "{stem}");
            expanded.push(stem.to_owned());
        } else {
            let settings = Settings { order: 1, ..Settings::default() };
            assert!(derive(&file.problem, &settings, &mut |_| true).is_err(), "{stem}");
        }
    }
    assert_eq!(expanded, EXPANDED);
}

#[test]
fn published_coefficients() {
    let list = |result: &Derivation, series: Quantity, orders: &[usize]| -> Vec<String> {
        orders.iter().map(|n| result.exact(series, *n).unwrap()).collect()
    };
    // Rayleigh: the derivative of its solution solves van der Pol's equation, so the frequency is
    // that of C. M. Andersen and J. F. Geer, SIAM J. Appl. Math. 42 (1982) 678.
    let rayleigh = expand(&example("rayleigh"), 10);
    let expected =
        ["-1/16", "17/3072", "35/884736", "-678899/5096079360", "28160413/2293235712000"];
    assert_eq!(list(&rayleigh, Quantity::Frequency, &[2, 4, 6, 8, 10]), expected);
    // Helmholtz-Duffing: A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations (1979), (2.3.32):
    // omega = omega_0 [1 + (9 alpha_3 omega_0^2 - 10 alpha_2^2)/(24 omega_0^4) eps^2 a^2].
    let problem = example("helmholtz-duffing");
    for (omega, alpha_2, alpha_3, expected) in
        [("1", "1", "1", "-1/24"), ("1", "2", "0", "-5/3"), ("1", "1/2", "3", "49/48")]
    {
        let mut settings = Settings { order: 2, ..Settings::default() };
        for (name, value) in [("omega_0", omega), ("alpha_2", alpha_2), ("alpha_3", alpha_3)] {
            settings.parameters.insert(name.into(), lindstedt::Exact::parse(value).unwrap());
        }
        let result = derive(&problem, &settings, &mut |_| true).unwrap();
        assert_eq!(list(&result, Quantity::Frequency, &[1, 2]), ["0", expected]);
    }
    // Duffing-van der Pol: amplitude 2 of van der Pol in Duffing's 3/8 beta a^2, both averaged in
    // Nayfeh and Mook, sections 2.3 and 3.1.7; with beta = 0 van der Pol's series.
    let problem = example("duffing-van-der-pol");
    for (beta, first, second) in [("1", "3/2", None), ("2/3", "1", None), ("0", "0", Some("-1/16"))]
    {
        let mut settings = Settings { order: 2, ..Settings::default() };
        settings.parameters.insert("beta".into(), lindstedt::Exact::parse(beta).unwrap());
        let result = derive(&problem, &settings, &mut |_| true).unwrap();
        assert_eq!(result.exact(Quantity::Frequency, 1).as_deref(), Some(first));
        assert_eq!(result.exact(Quantity::Amplitude, 0).as_deref(), Some("2"));
        if let Some(second) = second {
            assert_eq!(result.exact(Quantity::Frequency, 2).as_deref(), Some(second));
        }
    }
}

/// The first harmonic of cos^(2m+1) is binomial(2m+1, m)/4^m, so omega_1 = binomial(2m+1, m)/2^(2m+1):
/// also in high degrees, where no tables of the basis are kept.
#[test]
fn high_degrees() {
    for m in [1u32, 2, 99, 499] {
        let degree = 2 * m + 1;
        let result = Oscillator::parse(&format!("x'' + x + eps x^{degree} = 0")).unwrap();
        let expected = rug::Rational::from((
            rug::Integer::from(rug::Integer::binomial_u(degree, m)),
            rug::Integer::from(1) << degree,
        ));
        let result = result.derive(1, &Work::default()).unwrap().value;
        assert_eq!(result.exact(Quantity::Frequency, 1), Some(expected.to_string()), "{degree}");
    }
}

/// The expansion of one equation against the motion of another that differs at order 2: the
/// errors do not fall faster than eps^2, however high the order.
#[test]
fn a_wrong_order_is_found() {
    use lindstedt::Verify;
    use lindstedt::verify::Verdict;
    let question = Verify { order: 4, ..Verify::default() };
    let check = |of: &str, against: &str| {
        let derivation = Oscillator::parse(of).unwrap().derive(4, &Work::default()).unwrap().value;
        let other = Oscillator::parse(against).unwrap();
        other.verify_derivation(&derivation, &question, &Work::default()).unwrap().value
    };
    for (right, wrong) in [
        ("x'' + x + eps x^3 = 0", "x'' + x + eps x^3 + eps^2 x^5/70 = 0"),
        ("x'' + x = eps (1 - x^2) x'", "x'' + x = eps (1 - x^2) x' + eps^2 x^3/50"),
    ] {
        let found = check(right, wrong);
        assert_eq!(found.verdict, Verdict::Disagrees, "{wrong}");
        assert!(found.observed_order.is_some_and(|slope| (slope - 2.0).abs() < 0.05), "{wrong}");
        assert_eq!(check(right, right).verdict, Verdict::Agrees, "{right}");
    }
}

#[test]
fn files_give_what_the_built_in_problems_give() {
    for (name, built_in) in [
        ("power-law", "power-law"),
        ("sign-power", "power-law"),
        ("van-der-pol", "van-der-pol"),
        ("duffing", "duffing"),
    ] {
        let (file, own) =
            (expand(&example(name), 5), expand(&problems::find(built_in).unwrap(), 5));
        for series in [Quantity::Frequency, Quantity::FrequencySquared, Quantity::Period] {
            for n in 0..=5 {
                assert_eq!(file.exact(series, n), own.exact(series, n), "{name} {series} {n}");
            }
        }
    }
}

#[test]
fn built_in_problems_are_their_printed_files() {
    let mut all = problems::all();
    all.push(problems::vibro_impact::problem());
    all.push(problems::stick_slip::problem());
    for problem in all {
        let text = write(&problem);
        let file =
            ProblemFile::parse(&text).unwrap_or_else(|e| panic!("{}: {e}\n{text}", problem.name));
        assert_eq!(file.problem, problem, "{text}");
    }
}

#[test]
fn amplitude_and_time_are_scaled_in_the_tree() {
    // omega depends on eps a^2 alone: coefficient n is that of a = 1 times a^(2n).
    let at =
        |a: &str| Oscillator::parse("x'' + x + eps x^3 = 0").unwrap().set("amplitude", a).unwrap();
    let (one, half) = (
        at("1").derive(4, &Work::default()).unwrap().value,
        at("1/2").derive(4, &Work::default()).unwrap().value,
    );
    for n in 0..=4u32 {
        let scaled = rug::Rational::from((1, 4u64.pow(n)));
        let value = |r: &Derivation| -> rug::Rational {
            r.exact(Quantity::Frequency, n as usize).unwrap().parse().unwrap()
        };
        assert_eq!(value(&half), value(&one) * scaled);
    }
    // x'' + 9/4 x = eps (1 - x^2) x': with t = s/(3/2) and eps = (3/2) mu it is van der Pol's
    // equation in mu, so omega = (3/2) sum c_n (2/3)^n eps^n.
    let fast = Oscillator::parse("x'' + 9/4 x = eps (1 - x^2) x'")
        .unwrap()
        .derive(4, &Work::default())
        .unwrap()
        .value;
    assert_eq!(fast.time_scale, rug::Rational::from((3, 2)));
    assert_eq!(fast.exact(Quantity::Frequency, 0).as_deref(), Some("3/2"));
    assert_eq!(fast.exact(Quantity::Frequency, 2).as_deref(), Some("-1/24"));
    assert_eq!(fast.exact(Quantity::Frequency, 4).as_deref(), Some("17/10368"));
    assert_eq!(fast.exact(Quantity::FrequencySquared, 0).as_deref(), Some("9/4"));
    assert_eq!(fast.exact(Quantity::Period, 0).as_deref(), Some("2/3"));
    assert_eq!(fast.exact(Quantity::Amplitude, 0).as_deref(), Some("2"));
    // An irrational omega_0 with x' is refused, without x' it is not.
    let irrational = Oscillator::parse("x'' + 2 x = eps (1 - x^2) x'").unwrap();
    let refused = irrational.derive(2, &Work::default());
    assert!(matches!(refused, Err(Error::Refused(why)) if why.code == "no-method"));
    let reasons = irrational.classify().unwrap().methods;
    assert_eq!(reasons[0].1, [Reason::IrrationalFrequency]);
    assert!(Oscillator::parse("x'' + 2 x + eps x^3").unwrap().derive(2, &Work::default()).is_ok());
    let pi = Oscillator::parse("x'' + k x + eps x^3").unwrap().set("k", "pi").unwrap();
    assert!(matches!(
        pi.derive(1, &Work::default()),
        Err(Error::Derivation(DerivationError::Irrational { .. }))
    ));
}

#[test]
fn classification_finds_forces_delays_and_resonances() {
    let parts = |text: &str, values: &[(&str, &str)]| {
        let mut oscillator = Oscillator::parse(text).unwrap();
        for (name, value) in values {
            oscillator = oscillator.set(name, value).unwrap();
        }
        oscillator.classify().unwrap()
    };
    let driven = |omega| parts("x'' + 4 x + eps x^3 = F cos(omega t)", &[("omega", omega)]);
    assert_eq!(driven("2").forcing[0].resonance, Some((1, 1)));
    assert_eq!(driven("2/3").forcing[0].resonance, Some((1, 3)));
    assert_eq!(driven("2.001").forcing[0].resonance, None);
    assert!(!driven("2").takes(Method::Averaging));
    assert!(driven("6").takes(Method::Averaging));
    assert!(matches!(driven("2").refusal(), Some(Reason::Resonant(_, (1, 1)))));
    let mathieu = parts("x'' + (1 + eps cos(2 t)) x = 0", &[]);
    assert!(mathieu.forcing[0].parametric);
    assert_eq!(mathieu.forcing[0].resonance, Some((2, 1)));
    let delayed = parts("x'' + x = eps (x(t - T) - x')", &[]);
    assert_eq!(delayed.delays.len(), 1);
    assert!(delayed.takes(Method::Averaging) && !delayed.takes(Method::LindstedtPoincare));
    let friction = parts("x'' + x + eps sign(x') = 0", &[]);
    assert!(matches!(friction.methods[0].1[0], Reason::NonSmooth(_)));
    assert!(matches!(friction.refusal(), Some(Reason::Condition)));
    let whole = parts("x'' + sin(x) + eps x' = 0", &[]);
    assert!(matches!(whole.refusal(), Some(Reason::NotPolynomial(_))));
    let complex = parts("x'' + x + eps x^(1/3) = 0", &[]);
    assert!(matches!(complex.refusal(), Some(Reason::NotReal(_))));
    assert!(!complex.takes(Method::TimeDomain));
    let damped = parts("x'' + x + eps x' = 0", &[]);
    let condition = Oscillator::parse("x'' + x + eps x' = 0").unwrap();
    assert_eq!(condition.problem().conditions, [Condition::LimitCycle]);
    assert!(!damped.reversible && matches!(damped.methods[0].1[..], [Reason::Drift(_)]));
    // x x' does no work alone, but may with x^2; two terms that work may cancel.
    for cycle in ["x' + x x' + x^2", "(x^2 - 1) x'", "x'^3 - x'"] {
        let parts = parts(&format!("x'' + x + eps ({cycle}) = 0"), &[]);
        assert!(parts.takes(Method::LindstedtPoincare), "{cycle}");
    }
    let fixed = condition.under(Condition::InitialAmplitude).unwrap().classify().unwrap();
    assert!(matches!(fixed.methods[0].1[..], [Reason::Drift(_)]));
    // x x' changes its sign with x -> -x, t -> -t: no drift.
    let even = Oscillator::parse("x'' + x + eps x x' = 0").unwrap();
    assert_eq!(even.problem().conditions, [Condition::InitialAmplitude]);
    assert!(even.derive(3, &Work::default()).is_ok());
    let saddle = parts("x'' - a x + b x^3 + eps (x' - gamma cos(omega t))", &[("a", "1")]);
    assert!(saddle.takes(Method::Melnikov));
    assert!(!parts("x'' - a x + b x^3 + eps x'", &[("a", "1")]).takes(Method::Melnikov));
}

#[test]
fn what_is_taken_is_what_the_driver_takes() {
    // |x|^3 = (x^2)^(3/2) is in no ring; |x|^2 and sign(x) |x| are polynomials.
    for (text, taken) in [
        ("x'' + x + eps |x|^3 = 0", false),
        ("x'' + x + eps x |x|^2 = 0", true),
        ("x'' + x + eps sign(x)|x|^5 = 0", true),
        ("x'' + x + eps ln(x^2) x = 0", true),
        ("x'' + x exp(eps) + eps x^3 = 0", true),
        ("x'' + x + eps exp(x) = 0", false),
        ("x'' + x + eps sin(1) x^3 = 0", false),
        ("x'' + x + eps exp(1) x^3 = 0", false),
        ("x'' + x + eps ln(2) x^3 = 0", false),
        ("x'' + x + eps sqrt(2) x^3 = 0", false),
        ("x'' + x + eps*4^(-1) x^3 = 0", true),
        ("x'' + x (x^2)^(2 eps) = 0", true),
        ("x'' + x (x^2)^(1 + eps) = 0", false),
        ("x'' + x + eps x/(1 + x^2) = 0", false),
        ("x'' + x + eps x taylor(1/(1 + x^2), 3) = 0", true),
    ] {
        let oscillator = Oscillator::parse(text).unwrap();
        let parts = oscillator.classify().unwrap();
        assert_eq!(parts.takes(Method::LindstedtPoincare), taken, "{text}: {:?}", parts.methods[0]);
        assert_eq!(
            oscillator.derive(2, &Work::default()).is_ok(),
            taken,
            "{text}: {:?}",
            oscillator.derive(2, &Work::default()).err()
        );
    }
}
