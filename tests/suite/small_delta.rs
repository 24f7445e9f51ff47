//! The small-delta method against routes that share no code with the driver: the closed-form
//! period, the energy integral, the elliptic integral, published values.

use lindstedt::unstable::algebra::{FunctionAlgebra, PhaseAlgebra, Ring, Stop};
use lindstedt::unstable::coeff::closed_forms::ClosedForms;
use lindstedt::unstable::coeff::{PolynomialRing, Symbol};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::phase::Lobachevsky;
use lindstedt::unstable::phase::evaluate::PhaseFunctions;
use lindstedt::unstable::phase::lobachevsky::Word;
use lindstedt::unstable::phase::lobachevsky_function::{LambdaTable, Point};
use lindstedt::{
    Exact, Quantity, Solution, unstable::derivation::Settings, unstable::derivation::energy,
};
use lindstedt_tests::{decimal, expansion, with};
use rug::float::Constant;
use rug::ops::Pow;
use rug::{Float, Rational};

/// T/2pi of the power law by MPFR's gamma function (closed form, Gradshteyn and Ryzhik 3.251):
/// T = 4 sqrt(1+d) sqrt(pi) Gamma(1 + 1/(2+2d))/Gamma(1/2 + 1/(2+2d)).
fn closed_form_period(delta: &Float, bits: u32) -> Float {
    let one_plus = Float::with_val(bits, 1 + delta);
    let v = Float::with_val(bits, 1 / Float::with_val(bits, 2 * &one_plus));
    let pi = Float::with_val(bits, Constant::Pi);
    let numerator = Float::with_val(bits, 1 + &v).gamma();
    let denominator = Float::with_val(bits, &v + 0.5f64).gamma();
    let root = Float::with_val(bits, &one_plus * &pi).sqrt();
    4 * root * numerator / denominator / (2 * pi)
}

/// Taylor coefficients of a function by Newton interpolation at 0, h, 2h, ...: the error of coefficient n is about h.
fn taylor(f: impl Fn(&Float) -> Float, order: usize, bits: u32) -> Vec<Float> {
    // The differences cost order log2(1/h) bits, four fifths of all; h is 10^-29 or less.
    let h = Float::with_val(bits, 10).pow(-(bits as i32) / (4 * (order as i32 + 1)));
    let mut differences: Vec<Float> =
        (0..=order).map(|j| f(&Float::with_val(bits, &h * j as u32))).collect();
    let mut coefficients = Vec::new();
    for n in 0..=order {
        coefficients.push(differences[0].clone());
        differences = differences
            .windows(2)
            .map(|w| Float::with_val(bits, &w[1] - &w[0]) / (&h * Float::with_val(bits, n + 1)))
            .collect();
    }
    coefficients
}

#[test]
fn power_law_to_order_12_is_the_taylor_series_of_the_closed_form() {
    let bits = 4000;
    let period = taylor(|d| closed_form_period(d, bits), 12, bits);
    let squared = taylor(|d| closed_form_period(d, bits).square().recip(), 12, bits);
    let result = expansion("power-law", 12);
    assert_eq!(result.checked_orders, Some(12));
    for n in 0..=12 {
        for (name, expected) in
            [(Quantity::Period, &period), (Quantity::FrequencySquared, &squared)]
        {
            let derived = decimal(&result, name, n, 45);
            let derived = Float::with_val(bits, Float::parse(&derived).unwrap());
            let error = Float::with_val(bits, &derived - &expected[n]).abs();
            assert!(error < 1e-40, "{name} {n}: {derived} against {}", expected[n]);
        }
    }
}

#[test]
fn published_values_of_the_power_law() {
    // Awrejcewicz and Andrianov, section 4, re-derived: mpmath 1.3.0 from the closed form.
    let result = expansion("power-law", 5);
    for (n, alpha, t) in [
        (1, "-0.386294361119890618834464242916", "0.193147180559945309417232121458"),
        (2, "0.138438994412289631097997469330", "-0.0132607471687606426741931273624"),
        (3, "-0.0433189046678066559484248012427", "-0.000435408512562507800105640433444"),
        (4, "0.00968729961522442612386201024683", "0.00161535988670617687611737639770"),
        (5, "0.000489473294832618730018131494618", "-0.00115966415468489562344211883505"),
    ] {
        assert_eq!(decimal(&result, Quantity::FrequencySquared, n, 30), alpha);
        assert_eq!(decimal(&result, Quantity::Period, n, 30), t);
    }
    assert_eq!(result.exact(Quantity::FrequencySquared, 1).as_deref(), Some("1 - 2*ln(2)"));
    assert_eq!(
        result.exact(Quantity::FrequencySquared, 2).as_deref(),
        Some("2*ln(2)^2 - 1/12*pi^2")
    );
}

#[test]
fn the_first_solutions_and_where_the_secant_appears() {
    let result = expansion("power-law", 6);
    let Solution::Clock(solution) = &result.solution else { panic!("Lobachevsky ring") };
    let expansion = solution.expansion();
    let a = Lobachevsky::new(result.ring.clone());
    let q = |n, d| a.constants().rational_number(n, d);
    let word = |exponents: &[u8]| {
        let mut product = a.one();
        for (m, &e) in exponents.iter().enumerate() {
            for _ in 0..e {
                let factor = if m == 0 { a.log_secant() } else { a.lambda(m as u16) };
                product = a.mul(&product, &factor);
            }
        }
        product
    };
    type Terms<'t> = &'t [(&'t [u8], i32, i32)];
    let build = |cos: Terms<'_>, sin: Terms<'_>| {
        let mut f = a.zero();
        for (list, factor) in [(cos, a.cosine()), (sin, a.sine())] {
            for &(exponents, n, d) in list {
                let term = a.scale_by(&a.mul(&factor, &word(exponents)), &q(n, d));
                f = a.add(&f, &term);
            }
        }
        f
    };
    // x_1, x_2, x_3: found by an independent prototype (residual zero).
    let x1 = build(&[(&[1], 1, 1)], &[(&[0, 1], 1, 1)]);
    let x2 = build(
        &[(&[1], -1, 1), (&[2], 1, 2), (&[0, 2], -1, 2)],
        &[(&[0, 1], -2, 1), (&[0, 0, 1], 1, 1)],
    );
    let x3 = build(
        &[
            (&[1], 1, 1),
            (&[2], -1, 1),
            (&[3], 1, 6),
            (&[0, 2], 3, 2),
            (&[1, 2], 1, 2),
            (&[0, 1, 1], -1, 1),
        ],
        &[(&[0, 1], 3, 1), (&[0, 3], -1, 6), (&[0, 0, 1], -3, 1), (&[0, 0, 0, 1], 1, 1)],
    );
    assert_eq!(&expansion.solution[1..4], &[x1, x2, x3]);
    let terms: Vec<usize> = (1..=4).map(|n| result.terms(n)).collect();
    assert_eq!(terms, [2, 5, 10, 19]);
    // The ring without 1/cos suffices to order 4 and fails at order 5, where the term
    // -(1/12) sec Lambda_1^4 is forced by x_1^2/x_0 in the force of order 3.
    let lowest = |n: usize| expansion.solution[n].blocks().keys().map(|f| f.power).min();
    let powers: Vec<_> = (1..=6).map(|n| lowest(n).unwrap()).collect();
    assert_eq!(powers, [0, 0, 0, 0, -1, -2]);
    let quartic = Word::lambda(1);
    let secant = expansion.solution[5]
        .blocks()
        .iter()
        .find(|(factor, _)| factor.power == -1 && !factor.sine)
        .map(|(_, polynomial)| polynomial.terms().to_vec())
        .unwrap();
    let coefficient = secant
        .iter()
        .find(|(w, _)| w.exponents().len() == quartic.exponents().len() && w.exponents()[1] == 4);
    assert_eq!(coefficient.map(|(_, c)| c.clone()), Some(q(-1, 12)));
}

trait RationalNumber: lindstedt::unstable::algebra::RationalAlgebra {
    fn rational_number(&self, n: i32, d: i32) -> Self::Element {
        self.rational(&Rational::from((n, d)))
    }
}

impl RationalNumber for PolynomialRing {}

#[test]
fn the_solution_has_rational_coefficients() {
    // All transcendence sits in the mu_m of the Lambda_m and of omega.
    let result = expansion("power-law", 8);
    let Solution::Clock(solution) = &result.solution else { panic!("Lobachevsky ring") };
    let expansion = solution.expansion();
    for x in &expansion.solution {
        for polynomial in x.blocks().values() {
            for (_, c) in polynomial.terms() {
                assert!(
                    lindstedt::unstable::algebra::RationalAlgebra::as_rational(&result.ring, c)
                        .is_some()
                );
            }
        }
    }
}

#[test]
fn the_driver_agrees_with_the_energy_integral() {
    let ring = PolynomialRing { parameters: vec!["ln(a)".into()] };
    let result = expansion("power-law", 10);
    let Solution::Clock(solution) = &result.solution else { panic!("Lobachevsky ring") };
    let solution = solution.expansion();
    // Identically in the mu_m, without any relation between them.
    let stop = Stop::default();
    let direct = energy::power_law_frequency(&ring, 2, 10, &stop).unwrap();
    assert_eq!(solution.frequency_squared, direct);

    let sums: Vec<_> = (0..=7).map(|n| ring.symbol(Symbol::Sum(n))).collect();
    let period = energy::period_over_2pi(&ring, &sums, 7, &stop).unwrap();
    let pendulum = expansion_of_pendulum();
    let derived = pendulum.named(Quantity::Period).unwrap();
    assert_eq!(derived.coefficients, period);
}

fn expansion_of_pendulum() -> lindstedt::Derivation {
    expansion("pendulum", 7)
}

#[test]
fn alpha_to_order_30_by_the_energy_integral() {
    let ring = PolynomialRing::default();
    let alpha = energy::power_law_frequency(&ring, 2, 30, &Stop::default()).unwrap();
    // All 28 629 monomials of weight at most 30 but 1 and mu_1: (1 + delta) u^j has no
    // coefficient of delta^30 for j = 0 and 1.
    assert_eq!(alpha[30].terms().len(), 28_629 - 2);
    let closed = ClosedForms::new(30).closed_form(&ring, &alpha[30]).unwrap();
    let constants = lindstedt::unstable::derivation::constants::Constants::default();
    let evaluate = |p: &lindstedt::unstable::coeff::Polynomial| {
        let number =
            lindstedt::unstable::number::certified(None, 20, |balls| constants.evaluate(p, balls));
        number.unwrap().decimal
    };
    assert_eq!(evaluate(&closed), evaluate(&alpha[30]));
    let bits = 3600;
    let expected = taylor(|d| closed_form_period(d, bits).square().recip(), 30, bits);
    let derived = Float::with_val(200, Float::parse(evaluate(&closed)).unwrap());
    let error = Float::with_val(200, &derived - &expected[30]).abs() / expected[30].clone().abs();
    assert!(error < 1e-19, "{derived} against {}", expected[30]);
}

#[test]
fn pendulum_numbers() {
    // Amplitude 1; computed independently (mpmath 1.3.0) for this project's embedding.
    let result = expansion("pendulum", 4);
    let ratio = |n: usize| {
        let numbers = [n, 0].map(|n| decimal(&result, Quantity::FrequencySquared, n, 40));
        let [a, b] = numbers.map(|text| Float::with_val(200, Float::parse(&text).unwrap()));
        (a / b).to_string_radix(10, Some(18))
    };
    for (n, expected) in [
        (1, "6.91288021338695204e-2"),
        (2, "-3.78395701905818735e-2"),
        (3, "2.11545913784808238e-2"),
        (4, "-9.51800937718355856e-3"),
    ] {
        assert_eq!(ratio(n), expected);
    }
    for (n, expected) in [
        (0, 6.84952248444249),
        (1, -0.236749642269258),
        (2, 0.141866157792787),
        (3, -0.0865942924118355),
    ] {
        let t: f64 = decimal(&result, Quantity::Period, n, 20).parse().unwrap();
        assert!((t * std::f64::consts::TAU - expected).abs() < 1e-13);
    }
}

#[test]
fn pendulum_at_other_amplitudes() {
    for (value, amplitude) in
        [("1/10", 0.1f64), ("2", 2.0), ("3", 3.0), ("pi/2", std::f64::consts::FRAC_PI_2)]
    {
        let parameters = [("amplitude".to_owned(), Exact::parse(value).unwrap())].into();
        let result = with("pendulum", Settings { order: 2, parameters, ..Settings::default() });
        // S_n by their definition in doubles.
        let s = |n: i32| -> f64 {
            let mut term = 1.0;
            (0..40)
                .map(|k| {
                    if k > 0 {
                        term *= -amplitude * amplitude / f64::from(2 * k * (2 * k + 1));
                    }
                    term * f64::from(k).powi(n)
                })
                .sum()
        };
        let ln2 = std::f64::consts::LN_2;
        let w: f64 = decimal(&result, Quantity::FrequencySquared, 1, 20).parse().unwrap();
        assert!((w - s(1) * (1.0 - 2.0 * ln2)).abs() < 1e-14, "{value}");
        let w: f64 = decimal(&result, Quantity::FrequencySquared, 0, 20).parse().unwrap();
        assert!((w - amplitude.sin() / amplitude).abs() < 1e-14);
    }
}

#[test]
fn an_amplitude_of_the_power_law_scales_the_frequency() {
    // omega^2 is multiplied by a^(2 delta) = exp(2 delta ln a).
    let a = Rational::from((3, 2));
    let parameters = [("amplitude".to_owned(), Exact::Rational(a))].into();
    let scaled = with("power-law", Settings { order: 3, parameters, ..Settings::default() });
    let plain = expansion("power-law", 3);
    let value = |r: &lindstedt::Derivation, n| -> f64 {
        decimal(r, Quantity::FrequencySquared, n, 20).parse().unwrap()
    };
    let log = 2.0 * 1.5f64.ln();
    let expected = value(&plain, 3)
        + log * value(&plain, 2)
        + log * log / 2.0 * value(&plain, 1)
        + log.powi(3) / 6.0;
    assert!((value(&scaled, 3) - expected).abs() < 1e-14);
    assert_eq!(
        scaled.exact(Quantity::FrequencySquared, 1).as_deref(),
        Some("1 + 2*ln(a) - 2*ln(2)")
    );
}

/// x(tau; delta) of the power law in scaled time, without any expansion in delta of x: energy
/// gives x = cos^(1-u) theta with tau = sum_m u^m int_0^theta l^m/m! / sum_m u^m mu_m and
/// u = delta/(1+delta); theta by Newton's method. u is about 10^-60, so ten moments suffice.
fn exact_solution(tau: &Float, delta: &Float, bits: u32) -> Float {
    let u = Float::with_val(bits, delta / Float::with_val(bits, 1 + delta));
    let table = LambdaTable::new(10, Balls::new(bits));
    let mean: Float = polynomial(table.means().iter().map(|b| b.midpoint().clone()), &u, bits);
    let mut theta = tau.clone();
    for _ in 0..8 {
        let point = Point::Rational(theta.to_rational().unwrap());
        // int_0^theta l^m/m! = Lambda_m + mu_m theta, and theta itself for m = 0.
        let integrals = table.values(&point).into_iter().zip(table.means()).enumerate();
        let integrals = integrals.map(|(m, (lambda, mu))| {
            let secular = Float::with_val(bits, mu.midpoint() * &theta);
            if m == 0 { theta.clone() } else { secular + lambda.midpoint() }
        });
        let value = polynomial(integrals, &u, bits) / &mean;
        let cos = Float::with_val(bits, theta.cos_ref());
        let slope = Float::with_val(bits, (&cos).pow(-u.clone())) / &mean;
        theta -= (value - tau) / slope;
    }
    let exponent = Float::with_val(bits, 1 - &u);
    Float::with_val(bits, theta.cos()).pow(exponent)
}

fn polynomial(coefficients: impl Iterator<Item = Float>, u: &Float, bits: u32) -> Float {
    let mut power = Float::with_val(bits, 1);
    let mut sum = Float::new(bits);
    for c in coefficients {
        sum += c * &power;
        power *= u;
    }
    sum
}

#[test]
fn the_solution_agrees_with_the_inverted_energy_integral() {
    let bits = 2600;
    let order = 7;
    let result = expansion("power-law", order);
    let Solution::Clock(solution) = &result.solution else { panic!("Lobachevsky ring") };
    let solution = solution.expansion();
    let constants = lindstedt::unstable::derivation::constants::Constants::default();
    for (numerator, denominator) in [(7, 10), (19, 7)] {
        let tau = Rational::from((numerator, denominator));
        let at = Float::with_val(bits, &tau);
        // Beyond pi/2 the solution is odd about the zero crossing: x(pi - tau) = -x(tau).
        let pi = Float::with_val(bits, Constant::Pi);
        let beyond = at > Float::with_val(bits, &pi / 2);
        let reflected = if beyond { Float::with_val(bits, &pi - &at) } else { at };
        let expected = taylor(|delta| exact_solution(&reflected, delta, bits), order, bits);
        let balls = Balls::new(400);
        let table = LambdaTable::new(order, balls);
        let of_coefficient = |c: &_| constants.evaluate(c, balls);
        let functions = PhaseFunctions::lobachevsky(&solution.solution, table, of_coefficient);
        let values = functions.unwrap().at(&Point::Rational(tau.clone())).unwrap();
        for n in 0..=order {
            let derived = values[n].midpoint().clone();
            let expected = if beyond { -expected[n].clone() } else { expected[n].clone() };
            let error = Float::with_val(bits, &derived - &expected).abs();
            assert!(error < 1e-45, "x_{n}({tau}): {derived} against {expected}");
        }
    }
}
