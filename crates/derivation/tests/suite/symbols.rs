//! Averaged formulas at numbers against the averages of the same equations over numbers.

use lindstedt_algebra::Ring;
use lindstedt_coeff::amplitude::AmplitudePolynomial;
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_derivation::averaging::{
    AveragingSettings, Coefficient, RateTerm, average, formulas,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_problem_file::ProblemFile;
use rug::{Float, Rational};
use std::collections::BTreeMap;

const DIGITS: usize = 30;

/// The symbols of a field at numbers, a cosine and a sine of a product of symbols among them.
fn images(
    field: &ParameterField,
    ring: BallRing,
    given: &BTreeMap<String, Exact>,
) -> Vec<Enclosure> {
    let image = |name: &String| {
        let wave = |open: &str| name.strip_prefix(open)?.strip_suffix(')');
        let balls = ring.balls;
        let product = |text: &str| {
            let factors = text.split('*').map(|name| Enclosure(given[name].ball(balls)));
            factors.fold(ring.one(), |product, x| ring.mul(&product, &x)).0
        };
        Enclosure(match (wave("cos("), wave("sin(")) {
            (Some(angle), _) => balls.cos(&product(angle)),
            (_, Some(angle)) => balls.sin(&product(angle)),
            _ => product(name),
        })
    };
    field.ring.parameters.iter().map(image).collect()
}

/// The rates of one order as numbers, to so many digits.
fn agree(
    field: &ParameterField,
    at: &[Enclosure],
    formula: &AmplitudePolynomial<ParameterFraction>,
    numbers: &[RateTerm],
    ring: BallRing,
) {
    assert_eq!(formula.terms().len(), numbers.len());
    for ((power, formula), term) in formula.terms().iter().zip(numbers) {
        assert_eq!(power.0, term.exponent);
        let value = field.evaluate(&ring, formula, |i| at[usize::from(i)].clone()).unwrap();
        let Coefficient::Number(number) = &term.coefficient else { panic!("a number") };
        let number = Float::with_val(200, Float::parse(&number.decimal).unwrap());
        let gap = Float::with_val(200, &number - value.0.midpoint()).abs().to_f64();
        assert!(gap <= number.to_f64().abs() * 10f64.powi(2 - DIGITS as i32), "{gap:e}");
    }
}

/// Symbols in the words of the algebra, and in the field of the parameters where divisors are sums of frequencies.
#[test]
fn formulas_at_numbers_are_the_numbers() {
    let linear = "x'' + alpha^2*x = P*cos(omega*t) + eps*(A*(x - x(t - T)) + B*(x' - x'(t - T)))";
    let two = "x'' + alpha^2*x + eps*(A*x(t - T) + B*x(t - S) - x') = P*cos(omega*t)";
    for (equation, order) in [
        (linear, 4),
        (two, 3),
        ("x'' + alpha^2*x + eps*(k*x'/m + x^3/m^2) = 0", 4),
        ("x'' + x + eps*(k*x(t - T)^3 + x') = 0", 3),
        ("x'' + p^2*q^4*x + eps*(k*x^2*x' - x') = P*cos(5*p*q^2*t)", 1),
        ("x'' + alpha^2*x + eps*k*x^3 = P*cos(omega*t)", 2),
        ("x'' + alpha^2*x + eps*k*x' = P*cos(2*omega*t)", 2),
    ] {
        let problem = ProblemFile::parse(&format!("equation = \"{equation}\"\n")).unwrap().problem;
        let (field, expansion) = formulas(&problem, order).unwrap();
        let names = problem.equation.parameters();
        let value = |i: usize| Exact::Rational(Rational::from((2 * i + 5, i + 3)));
        let parameters: BTreeMap<String, Exact> =
            names.into_iter().enumerate().map(|(i, name)| (name.to_string(), value(i))).collect();
        let ring = BallRing { balls: Balls::new(200) };
        let at = images(&field, ring, &parameters);
        let settings =
            AveragingSettings { order, parameters, digits: DIGITS, ..AveragingSettings::default() };
        let numbers = average(&problem, &settings, &mut |_| true).unwrap();
        for n in 1..=order {
            agree(&field, &at, &expansion.amplitude_rate[n], &numbers.amplitude_rate[n], ring);
            agree(&field, &at, &expansion.phase_rate[n], &numbers.phase_rate[n], ring);
        }
    }
}
