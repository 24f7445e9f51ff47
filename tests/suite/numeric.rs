//! The numeric tiers against closed forms and against each other.

use lindstedt::unstable::algebra::{RationalAlgebra, Ring};
use lindstedt::unstable::coeff::floats::Floats;
use lindstedt::unstable::derivation::numeric::{Estimate, Tier, derive};
use lindstedt::unstable::equation::{AmplitudeRole, Condition, Expression, Function, Problem};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::phase::lobachevsky_function::means;
use lindstedt::unstable::series::Series;
use lindstedt::{
    DerivationError, Exact, Quantity, unstable::derivation::Settings, unstable::problems,
};
use lindstedt_tests::Random;
use rug::{Float, Rational};

/// omega^power of the power law from T/2pi = (1 + delta)^(-1/2) M(u), M(u) = sum_m mu_m u^m,
/// u = delta/(1 + delta): the Gamma function's moments and the binomial series, no quadrature.
fn closed_form(power: i32, order: usize, bits: u32) -> Vec<Float> {
    let reals = Floats::new(bits);
    let moments = means(order, Balls::new(bits));
    let moments = Series::truncated(moments.iter().map(|mu| mu.midpoint().clone()).collect());
    let of_u = moments.power(&reals, &Rational::from(-power)).unwrap().coefficients;
    let binomial = |top: Rational, k: usize| {
        (0..k)
            .fold(Rational::from(1), |b, i| b * (top.clone() - Rational::from(i)) / (i as u64 + 1))
    };
    let coefficient = |n: usize| {
        of_u.iter().take(n + 1).enumerate().fold(reals.zero(), |sum, (j, c)| {
            let top = Rational::from((power, 2)) - Rational::from(j);
            reals.add(&sum, &reals.scale(c, &binomial(top, n - j)))
        })
    };
    (0..=order).map(coefficient).collect()
}

fn estimate(problem: &Problem, order: usize, tier: Tier) -> Result<Estimate, DerivationError> {
    let settings = Settings { order, ..Settings::default() };
    derive(problem, &settings, tier, &mut |_| true)
}

/// Every coefficient within the error stated, and the stated error within the digits asked.
fn check_power_law(order: usize, digits: u32) {
    let result =
        estimate(&problems::find("power-law").unwrap(), order, Tier::Collocation { digits });
    let result = result.unwrap();
    assert_eq!(result.order, order);
    let allowed = Float::with_val(53, Float::i_pow_u(10, digits)).recip();
    for (series, power) in result.series.iter().zip([2, 1, -1]) {
        let truth = closed_form(power, order, 2 * result.bits + 40 * order as u32);
        assert_eq!(series.coefficients.len(), truth.len());
        for (n, ((value, error), truth)) in series.coefficients.iter().zip(&truth).enumerate() {
            let distance = Float::with_val(53, value - truth).abs();
            assert!(distance <= *error && *error <= allowed, "{} {n}: {distance}", series.quantity);
        }
    }
}

#[test]
fn power_law_to_many_digits() {
    check_power_law(20, 60);
}

#[test]
#[ignore = "seconds"]
fn power_law_50_digits_order_60_and_100_digits_order_100() {
    check_power_law(60, 50);
    check_power_law(100, 100);
}

/// x'' + x + eps F(x) = 0.
fn perturbed(force: Expression) -> Problem {
    let x = Expression::DISPLACEMENT;
    let conditions = [Condition::InitialAmplitude, Condition::FundamentalAmplitude];
    Problem::new("test", Expression::ACCELERATION + x + Expression::Small * force)
        .under(conditions, AmplitudeRole::InSmallParameter)
}

fn x() -> Expression {
    Expression::DISPLACEMENT
}

/// |x| = (x^2)^(1/2).
fn absolute() -> Expression {
    x().pow(2).pow(Expression::Number(Rational::from((1, 2))))
}

/// T/2pi from the energy integral: coefficient n is binomial(-1/2, n) <g(cos)^n> with
/// g = 2 (V(1) - V(x))/(1 - x^2), by mpmath 1.3.0, quad at 30 digits.
#[test]
fn forces_of_any_shape() {
    let rational = (x().pow(2) + 1).pow(-1);
    let cases = [
        (
            x() * absolute(),
            ["1", "-0.42441318157838756205", "0.27519560614053747932", "-0.20165192733854891269"],
        ),
        (
            Expression::Function(Function::Sin, Box::new(x())),
            ["1", "-0.44005058574493351594", "0.29075141075464684256", "-0.21365984327832345649"],
        ),
        (
            x() * rational,
            ["1", "-0.29289321881345247557", "0.13040055603258382172", "-0.06535903513580522782"],
        ),
    ];
    for (force, expected) in cases {
        for tier in [Tier::Collocation { digits: 18 }, Tier::Doubles] {
            let result = estimate(&perturbed(force.clone()), 3, tier).unwrap();
            let series = result.named(Quantity::Period).unwrap();
            for ((value, error), text) in series.coefficients.iter().zip(expected) {
                let truth = Float::with_val(80, Float::parse(text).unwrap());
                let distance = Float::with_val(53, value - truth).abs();
                assert!(
                    distance <= error.clone() + 1e-19 && *error < 1e-12,
                    "{tier:?} {text}: {value}"
                );
            }
        }
    }
}

/// x + eps sgn x: T/2pi = (2/pi) arccos(eps/(1 + eps)), here to order 8.
#[test]
fn dry_spring() {
    let sign = x() * absolute().pow(-1);
    let result = estimate(&perturbed(sign), 8, Tier::Collocation { digits: 25 }).unwrap();
    // z = eps/(1 + eps) = eps - eps^2 + ...; arccos z = pi/2 - sum binomial(2k, k) z^(2k+1)/(4^k (2k+1)).
    let reals = Floats::new(200);
    let z: Vec<Float> = (0..=8i32)
        .map(|n| Float::with_val(200, if n == 0 { 0 } else { 1 - 2 * ((n + 1) % 2) }))
        .collect();
    let z = Series::truncated(z);
    let (square, mut power) = (z.mul(&reals, &z, 8), z);
    let mut angle = Series::truncated(vec![Float::new(200); 9]);
    let mut c = Rational::from(1);
    for k in 0..4u64 {
        angle = angle.add(&reals, &power.map(|v| reals.scale(v, &(c.clone() / (2 * k + 1)))));
        power = power.mul(&reals, &square, 8);
        c *= Rational::from((2 * k + 1, 2 * k + 2));
    }
    let two_over_pi = Float::with_val(200, 2) / Float::with_val(200, rug::float::Constant::Pi);
    let series = result.named(Quantity::Period).unwrap();
    for (n, (value, error)) in series.coefficients.iter().enumerate() {
        let truth =
            Float::with_val(200, -&angle.coefficients[n]) * &two_over_pi + u32::from(n == 0);
        let distance = Float::with_val(53, value - truth).abs();
        assert!(distance <= *error && *error < 1e-25, "{n}: {value} {distance} {error}");
    }
}

/// The exact ring and the tier on a limit cycle and with the first harmonic fixed.
#[test]
fn damped_and_renormalised() {
    let cases = [
        ("van-der-pol", None, Quantity::Amplitude),
        ("duffing", Some(Condition::FundamentalAmplitude), Quantity::InitialDisplacement),
        ("duffing", None, Quantity::Frequency),
    ];
    for (name, condition, series) in cases {
        let problem = problems::find(name).unwrap();
        let settings = Settings { order: 5, condition, ..Settings::default() };
        let exact =
            lindstedt::unstable::derivation::derive(&problem, &settings, &mut |_| true).unwrap();
        for tier in
            [Tier::Collocation { digits: 20 }, Tier::Doubles, Tier::Fourier { harmonics: 64 }]
        {
            let result = derive(&problem, &settings, tier, &mut |_| true).unwrap();
            for (n, (value, error)) in result.named(series).unwrap().coefficients.iter().enumerate()
            {
                let truth = exact.ball(series, n, Balls::new(200)).unwrap();
                let distance = Float::with_val(53, value - truth.midpoint()).abs();
                assert!(
                    distance <= *error && *error < 1e-6,
                    "{name} {tier:?} {n}: {distance} {error}"
                );
            }
        }
    }
}

/// What the tiers cannot do is refused: a pole inside the quarter period, sines in exact rings.
#[test]
fn refusals() {
    let pole = (x() - Expression::Number(Rational::from((1, 2)))).pow(-1);
    assert!(estimate(&perturbed(pole), 2, Tier::Doubles).is_err());
    let sine = perturbed(Expression::Function(Function::Sin, Box::new(x())));
    let settings = Settings { order: 2, ..Settings::default() };
    assert!(lindstedt::unstable::derivation::derive(&sine, &settings, &mut |_| true).is_err());
    assert!(estimate(&perturbed(Expression::VELOCITY), 2, Tier::Doubles).is_err());
}

/// Two results of one problem may differ by the sum of their stated errors, no more; for the power
/// law at amplitude one the closed form joins in, without an error.
fn random_combinations(count: usize, seed: u64) {
    let mut random = Random(seed);
    let mut between = |low: usize, high: usize| low + random.below(high - low + 1);
    let mut compared = 0;
    for _ in 0..count {
        let name = ["power-law", "power-law", "pendulum", "duffing"][between(0, 3)];
        let problem = problems::find(name).unwrap();
        let order = between(0, 16);
        let mut settings = Settings { order, ..Settings::default() };
        if name == "pendulum" {
            let a = Rational::from((between(1, 30), 10));
            settings.parameters.insert("amplitude".to_owned(), Exact::Rational(a));
        }
        let digits = between(3, 40) as u32;
        let other = between(3, 40) as u32;
        let harmonics = between(4, 160);
        let tiers = [
            Tier::Collocation { digits },
            Tier::Collocation { digits: other },
            Tier::Doubles,
            Tier::Fourier { harmonics },
        ];
        let results = tiers.map(|tier| derive(&problem, &settings, tier, &mut |_| true).unwrap());
        let mut lists: Vec<(String, Vec<(Float, Float)>)> = Vec::new();
        for result in &results {
            lists.push((format!("{:?}", result.tier), result.series[2].coefficients.clone()));
        }
        if name == "power-law" {
            let truth = closed_form(-1, order, 1000);
            let exact = truth.into_iter().map(|t| (t, Float::new(53))).collect();
            lists.push(("closed form".to_owned(), exact));
        }
        for (i, (one, a)) in lists.iter().enumerate() {
            for (two, b) in lists.iter().skip(i + 1) {
                for (n, ((v, e), (w, f))) in a.iter().zip(b).enumerate() {
                    let distance = Float::with_val(53, v - w).abs();
                    let allowed = Float::with_val(53, e + f);
                    assert!(
                        distance <= allowed,
                        "{name} {one} {two} order {n}: {distance} > {allowed}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 20 * count, "{compared} comparisons");
}

#[test]
fn tiers_agree_within_their_errors() {
    random_combinations(25, 1);
}

#[test]
#[ignore = "minutes"]
fn tiers_agree_within_their_errors_in_1000_combinations() {
    random_combinations(1000, 2);
}

/// Amplitudes that are scaled out, parameters with defaults, time that is scaled: as in the exact
/// tier.
#[test]
fn files_in_the_numeric_tiers() {
    let text = "name = \"q\"\nequation = \"x'' + k x + eps (q x^2 + c x^3 + b (x^2 - 1) x') = 0\"\n\
                [parameters]\nk = { value = \"4\" }\nq = { value = \"1\" }\nc = { value = \"2/5\" }\n\
                b = { value = \"0\" }\namplitude = { value = \"1/2\" }\n";
    let free = text.replace("b = { value = \"0\" }", "b = { value = \"1/3\" }");
    let cycle = free.replace("amplitude = { value = \"1/2\" }\n", "");
    let initial = text.replace("[parameters]", "condition = \"initial-amplitude\"\n[parameters]");
    for text in
        [initial, cycle.replace("[parameters]", "condition = \"limit-cycle\"\n[parameters]")]
    {
        let problem = lindstedt::ProblemFile::parse(&text).unwrap().problem;
        let settings = Settings { order: 4, ..Settings::default() };
        let exact =
            lindstedt::unstable::derivation::derive(&problem, &settings, &mut |_| true).unwrap();
        for tier in [Tier::Collocation { digits: 20 }, Tier::Doubles] {
            let found = derive(&problem, &settings, tier, &mut |_| true).unwrap();
            for name in [Quantity::Frequency, Quantity::Period] {
                let series = found.named(name).unwrap();
                for (n, (value, error)) in series.coefficients.iter().enumerate() {
                    let ball = exact.ball(name, n, Balls::new(200)).unwrap();
                    let distance = Float::with_val(64, value - ball.midpoint()).abs();
                    assert!(distance <= *error, "{text}{tier:?} {name} {n}: {distance} > {error}");
                    assert!(*error < 1e-4, "{tier:?} {name} {n}: {error}");
                }
            }
        }
    }
}
