//! Limit cycles of averaged equations and their Floquet exponents.

use lindstedt_coeff::print::Style;
use lindstedt_derivation::averaging::{
    Algebraic, Averaging, AveragingSettings, Coefficient, Cycles, average, print_series,
};
use lindstedt_derivation::numeric::{self, Tier};
use lindstedt_derivation::{Settings, derive};
use lindstedt_equation::{Condition, Quantity};
use lindstedt_problem_file::ProblemFile;

fn averaged(equation: &str, order: usize) -> Averaging {
    let problem = ProblemFile::parse(&format!("equation = {equation:?}")).unwrap().problem;
    let settings = AveragingSettings { order, digits: 12, ..AveragingSettings::default() };
    average(&problem, &settings, &mut |_| true).unwrap()
}

fn cycles(equation: &str, order: usize) -> Cycles {
    averaged(equation, order).cycles.unwrap()
}

/// x = sqrt(mu/beta) y, eps' = eps mu make van der Pol's equation of this one, whatever the symbols are. With sqrt(2) in the place of
/// omega_0, eps' = eps/sqrt(2) in the time t sqrt(2).
#[test]
fn one_cycle_in_symbols_and_balls() {
    let known = cycles("x'' + x = eps*(1 - x^2)*x'", 6);
    let [known] = &known.cycles[..] else { panic!("one cycle") };
    let found = averaged("x'' + x = eps*(mu - beta*x^2)*x'", 6);
    assert!(found.cycles.is_none());
    let found = found.single_cycle.unwrap();
    let text = |c: &Coefficient| match c {
        Coefficient::Number(number) => number.exact.clone().unwrap(),
        Coefficient::Formula(formula) => formula.text().to_owned(),
        _ => panic!("a formula"),
    };
    let with = |c: &Algebraic, factor: &dyn Fn(usize) -> String, n: usize| {
        let exact = c.number.exact.clone().unwrap();
        match &*factor(n) {
            _ if exact == "0" => exact,
            "" => exact,
            factor if exact == "1" || exact == "-1" => exact.replace('1', factor),
            factor => format!("{exact}*{factor}"),
        }
    };
    let power = |n: usize| match n {
        0 => String::new(),
        1 => "mu".to_owned(),
        n => format!("mu^{n}"),
    };
    let over_beta = |n: usize| format!("beta^(-1)*{}", power(n + 1));
    let lists = [
        (
            &found.squared_amplitude,
            &known.squared_amplitude,
            &over_beta as &dyn Fn(usize) -> String,
        ),
        (&found.frequency, &known.frequency, &power),
        (&found.exponent, &known.exponent, &power),
    ];
    for (found, known, factor) in lists {
        let expected: Vec<_> = known.iter().enumerate().map(|(n, c)| with(c, factor, n)).collect();
        assert_eq!(found.iter().map(text).collect::<Vec<_>>(), expected);
    }
    let enclosed = averaged("x'' + 2*x = eps*(1 - x^2)*x'", 6).single_cycle.unwrap();
    let lists = [
        (&enclosed.squared_amplitude, &known.squared_amplitude, 0),
        (&enclosed.frequency, &known.frequency, 1),
        (&enclosed.exponent, &known.exponent, 1),
    ];
    for (found, known, time) in lists {
        for (n, (found, known)) in (0i32..).zip(found.iter().zip(known)) {
            let Coefficient::Number(found) = found else { panic!("a number") };
            let value: f64 = known.number.decimal.parse().unwrap();
            let expected = value * f64::sqrt(2.0).powi(time - n);
            assert!((found.decimal.parse::<f64>().unwrap() - expected).abs() < 1e-11);
        }
    }
    // Two zeros, one that is not positive, none.
    for equation in [
        "x'' + x = eps*(mu - x^2 - x^4)*x'",
        "x'' + 2*x = eps*(1 + x^2)*x'",
        "x'' + x = -eps*(1 + 2*x^2)*x' + eps*mu*x^3",
        "x'' + x = eps*mu*x'",
        "x'' + x = -eps*(pi + x^2)*x' + eps*mu*x^3",
        "x'' + x = -eps*(pi + x^2)*x'",
    ] {
        assert!(averaged(equation, 2).single_cycle.is_none(), "{equation}");
    }
    // a^2 = 4 pi, and one of unknown sign.
    for equation in ["x'' + x = eps*(pi - x^2)*x'", "x'' + x = eps*(mu*pi - x^2)*x'"] {
        assert!(averaged(equation, 2).single_cycle.is_some(), "{equation}");
    }
}

/// lambda = -eps <1 - x^2> over the period, from the known solution of van der Pol's equation.
#[test]
fn exponent_of_van_der_pol() {
    let found = cycles("x'' + x = eps*(1 - x^2)*x'", 7);
    let [cycle] = &found.cycles[..] else { panic!("one cycle") };
    assert_eq!(
        print_series(&cycle.exponent, "eps", Style::Text),
        "-eps - 1/16*eps^3 + 11/4608*eps^5 + 4859/5308416*eps^7"
    );
    // The frequency of the cycle in Lindstedt's expansion.
    assert_eq!(
        print_series(&cycle.frequency, "eps", Style::Text),
        "1 - 1/16*eps^2 + 17/3072*eps^4 + 35/884736*eps^6"
    );
    assert!(cycle.stable);
    assert_eq!(cycle.amplitude.decimal, "2.00000000000");
}

/// Lindstedt's expansion by Liouville's theorem against A'(a) of averaging: products of up to four factors, a unit of
/// time, the velocity in the damping, and the same in values.
#[test]
fn exponents_of_expansions() {
    let cases = [
        ("x'' + x = eps*(1 - x^2)*x'", 9),
        ("x'' + 4*x = eps*(1 - x'^2/3)*x'", 6),
        ("x'' + x = eps*(1 - x^2)*x' + eps^2*x^3", 6),
        ("x'' + x = eps*(5/4 - x^2 - x^4/8)*x' + eps^2*x*x'^2 + eps^3*x'^5", 5),
    ];
    for (equation, order) in cases {
        let problem = ProblemFile::parse(&format!("equation = {equation:?}")).unwrap().problem;
        let settings =
            Settings { order, condition: Some(Condition::LimitCycle), ..Settings::default() };
        let found = derive(&problem, &settings, &mut |_| true).unwrap();
        let expected = cycles(equation, order);
        let exponent = &expected.cycles[0].exponent;
        let tier = Tier::Collocation { digits: 20 };
        let values = numeric::derive(&problem, &settings, tier, &mut |_| true).unwrap();
        let values = values.named(Quantity::FloquetExponent).unwrap();
        for (n, c) in exponent.iter().enumerate() {
            let own = found.exact(Quantity::FloquetExponent, n);
            assert_eq!(own, c.number.exact, "{equation}, order {n}");
            let value: f64 = c.number.decimal.parse().unwrap();
            let (estimate, error) = &values.coefficients[n];
            let bound = error.to_f64() + 1e-11 * value.abs();
            assert!((estimate.to_f64() - value).abs() <= bound, "{equation} {n}");
        }
    }
}

/// (1 - x^4) x': R_1 = 1/2 - rho^2/16, a_0 = 8^(1/4), lambda_1 = 2 rho R_1' = -rho^2/4 = -2.
#[test]
fn algebraic_amplitude() {
    let found = cycles("x'' + x = eps*(1 - x^4)*x'", 3);
    let [cycle] = &found.cycles[..] else { panic!("one cycle") };
    assert_eq!(cycle.print_polynomial(Style::Text), "-8 + r^2");
    assert_eq!(cycle.amplitude.decimal, "1.68179283051");
    let exponent = &cycle.exponent;
    assert_eq!(
        (&*exponent[1].number.decimal, &*exponent[2].number.decimal),
        ("-2.00000000000", "0")
    );
}

/// A_1 = (rho - 1)(rho - 4) a/8: the inner cycle is stable (2 rho R' = -3/4), the outer one is not (3); and
/// (rho^2 - 5 rho + 5) with both amplitudes irrational, whose product of leading exponents is rational.
#[test]
fn every_cycle_with_its_sign() {
    let found = cycles("x'' + x = eps*(1 - 5*x^2 + 2*x^4)*x'", 2);
    let leading = found.cycles.iter().map(|c| c.exponent[1].number.exact.as_deref().unwrap());
    assert_eq!(leading.collect::<Vec<_>>(), ["-3/4", "3"]);
    assert_eq!(found.cycles.iter().map(|c| c.stable).collect::<Vec<_>>(), [true, false]);
    let found = cycles("x'' + x = eps*(5 - 20*x^2 + 8*x^4)*x'", 3);
    let amplitudes: Vec<_> = found.cycles.iter().map(|c| c.amplitude.decimal.as_str()).collect();
    assert_eq!(amplitudes, ["1.17557050458", "1.90211303259"]);
    assert_eq!(found.cycles.iter().map(|c| c.stable).collect::<Vec<_>>(), [true, false]);
    // (rho - 6/5)(rho^2 - 3): by amplitude, of whatever factor.
    let found = cycles("x'' + x = eps*(36/5 - 24*x^2 - 96/5*x^4 + 128/5*x^6)*x'", 1);
    let amplitudes: Vec<_> = found.cycles.iter().map(|c| c.amplitude.decimal.as_str()).collect();
    assert_eq!(amplitudes, ["1.09544511501", "1.31607401295"]);
    // (rho - 1)^2: the order of the averaging does not decide.
    let found = cycles("x'' + x = eps*(1 - 8*x^2 + 8*x^4)*x'", 2);
    assert_eq!((found.cycles.len(), &*found.degenerate[0].decimal), (0, "1.00000000000"));
}
