//! Duffing and van der Pol: published coefficients, both normalisations, two routes.

use lindstedt::unstable::algebra::Rationals;
use lindstedt::unstable::equation::{Condition, Expression};
use lindstedt::unstable::expand::{
    Binding, ExpandError, Request, check, compile, expand, leading_amplitude,
};
use lindstedt::unstable::phase::Trigonometric;
use lindstedt::{Quantity, Solution, unstable::derivation::Settings, unstable::problems};
use lindstedt_tests::{expansion, with};
use rug::Rational;

fn coefficients(result: &lindstedt::Derivation, series: Quantity) -> Vec<String> {
    (0..=result.order).map(|n| result.exact(series, n).unwrap()).collect()
}

#[test]
fn duffing_in_the_initial_amplitude_normalisation() {
    let result = expansion("duffing", 6);
    let expected =
        ["1", "3/8", "-21/256", "81/2048", "-6549/262144", "37737/2097152", "-936183/67108864"];
    assert_eq!(coefficients(&result, Quantity::Frequency), expected);
    let expected =
        ["1", "3/4", "-3/128", "9/512", "-1779/131072", "5643/524288", "-146661/16777216"];
    assert_eq!(coefficients(&result, Quantity::FrequencySquared), expected);
}

#[test]
fn duffing_in_the_fundamental_amplitude_normalisation() {
    let condition = Some(Condition::FundamentalAmplitude);
    let result = with("duffing", Settings { order: 5, condition, ..Settings::default() });
    let expected = ["1", "3/8", "-15/256", "123/8192", "-921/262144", "579/2097152"];
    assert_eq!(coefficients(&result, Quantity::Frequency), expected);
    // The corrections have no first harmonic, by definition.
    let Solution::Rational(proved) = &result.solution else { panic!("over Q") };
    for x in &proved.expansion().solution[1..] {
        assert!(x.cos[1].is_zero() && x.sin.is_empty());
    }
}

#[test]
fn van_der_pol_limit_cycle() {
    // C. M. Andersen and J. F. Geer, SIAM J. Appl. Math. 42 (1982) 678.
    let result = expansion("van-der-pol", 10);
    let expected = [
        "1",
        "0",
        "-1/16",
        "0",
        "17/3072",
        "0",
        "35/884736",
        "0",
        "-678899/5096079360",
        "0",
        "28160413/2293235712000",
    ];
    assert_eq!(coefficients(&result, Quantity::Frequency), expected);
    let amplitude = coefficients(&result, Quantity::Amplitude);
    let expected = ["2", "0", "1/96", "0", "-1033/552960", "0", "1019689/55738368000"];
    assert_eq!(amplitude[..7], expected);
    let period = coefficients(&result, Quantity::Period);
    let expected = ["1", "0", "1/16", "0", "-5/3072", "0", "-431/884736", "0", "557039/5096079360"];
    assert_eq!(period[..9], expected);
}

struct NoNames;
impl Binding<Rationals> for NoNames {
    fn parameter(&self, _: &str) -> Option<Rational> {
        None
    }
}

type Plain = Trigonometric<Rationals>;

fn directly(
    equation: &Expression,
    condition: Condition,
    order: usize,
) -> Result<lindstedt::unstable::expand::Expansion<Plain>, ExpandError> {
    let algebra = Trigonometric::new(Rationals);
    let compiled = compile(&algebra, equation, &NoNames, order)?;
    let leading_amplitude = leading_amplitude(&algebra, &compiled, condition)?;
    let request = Request { condition, order, leading_amplitude };
    let expansion = expand(&algebra, &compiled, &request, &mut |_| true)?;
    check(&algebra, &compiled, &expansion)?;
    Ok(expansion)
}

#[test]
fn the_residual_check_finds_a_wrong_digit() {
    let algebra = Trigonometric::new(Rationals);
    let equation = problems::find("van-der-pol").unwrap().equation;
    let compiled = compile(&algebra, &equation, &NoNames, 6).unwrap();
    let right = directly(&equation, Condition::LimitCycle, 6).unwrap();
    let mut wrong = right.clone();
    wrong.solution[4].cos[3] += Rational::from((1, 1_000_000));
    assert_eq!(check(&algebra, &compiled, &wrong), Err(ExpandError::Residual { order: 4 }));
    let mut wrong = right.clone();
    wrong.frequency_squared[6] += Rational::from((1, 1_000_000));
    assert_eq!(check(&algebra, &compiled, &wrong), Err(ExpandError::Residual { order: 6 }));
    assert_eq!(check(&algebra, &compiled, &right), Ok(6));
    // The amplitude of the last order shows only in the secular condition of the order after it.
    let mut wrong = right.clone();
    wrong.solution[6].cos[1] += Rational::from((1, 1_000_000));
    assert_eq!(check(&algebra, &compiled, &wrong), Err(ExpandError::Residual { order: 7 }));
    // Another phase solves the equation as well: the normalisation is what it violates.
    let mut wrong = right.clone();
    wrong.solution[6].sin = vec![Rational::new(), Rational::from(1)];
    assert_eq!(check(&algebra, &compiled, &wrong), Err(ExpandError::Normalisation { order: 6 }));
}

#[test]
fn other_oscillators_of_the_same_driver() {
    let x = || Expression::DISPLACEMENT;
    let v = || Expression::VELOCITY;
    // Helmholtz-Duffing: harmonics of both parities.
    let helmholtz = Expression::ACCELERATION + x() + Expression::Small * (x().pow(2) + x().pow(3));
    let result = directly(&helmholtz, Condition::InitialAmplitude, 6);
    assert!(result.is_ok());
    // Rayleigh's x'' + x = eps (x' - x'^3/3) has the frequency of van der Pol's equation, whose
    // derivative it is.
    let third = Expression::Number(Rational::from((1, 3)));
    let rayleigh = Expression::ACCELERATION + x() - Expression::Small * (v() - third * v().pow(3));
    let rayleigh = directly(&rayleigh, Condition::LimitCycle, 8).unwrap();
    let pol = problems::find("van-der-pol").unwrap().equation;
    let pol = directly(&pol, Condition::LimitCycle, 8).unwrap();
    assert_eq!(rayleigh.frequency_squared, pol.frequency_squared);
    // Duffing-van der Pol: omega_1 and the amplitude couple.
    let gain = 1 - x().pow(2);
    let mixed = Expression::ACCELERATION + x() + Expression::Small * x().pow(3)
        - Expression::Small * gain * v();
    let mixed = directly(&mixed, Condition::LimitCycle, 6).unwrap();
    assert_eq!(mixed.frequency_squared[1], 3);
}

#[test]
fn what_cannot_be_expanded_is_refused_by_name() {
    let x = || Expression::DISPLACEMENT;
    let v = || Expression::VELOCITY;
    let refused = |equation: Expression, condition| directly(&equation, condition, 3).unwrap_err();
    let damped = Expression::ACCELERATION + x() + Expression::Small * v();
    assert_eq!(
        refused(damped.clone(), Condition::InitialAmplitude),
        ExpandError::AmplitudeDrifts { order: 1 }
    );
    assert_eq!(refused(damped, Condition::LimitCycle), ExpandError::NoLimitCycle);
    let strong = Expression::ACCELERATION + x() + x().pow(3);
    assert_eq!(refused(strong, Condition::InitialAmplitude), ExpandError::NotWeaklyNonlinear);
    let irrational = Expression::ACCELERATION + x() - Expression::Small * (v() - v().pow(3));
    assert_eq!(refused(irrational, Condition::LimitCycle), ExpandError::IrrationalAmplitude);
    // Averaged: a/2 (1 - a^2)(4 - a^2) up to a factor, two limit cycles.
    let two = 4 - 5 * (4 * x().pow(2)) + 8 * x().pow(4);
    let two = Expression::ACCELERATION + x() - Expression::Small * two * v();
    assert_eq!(refused(two, Condition::LimitCycle), ExpandError::SeveralLimitCycles { count: 2 });
    let unknown = Expression::ACCELERATION + x() + Expression::parameter("k") * Expression::Small;
    assert_eq!(
        refused(unknown, Condition::InitialAmplitude),
        ExpandError::UnknownName { name: "k".into() }
    );
    let logarithm = Expression::ACCELERATION + x() + Expression::Small * x() * x().pow(2).ln();
    assert!(matches!(
        refused(logarithm, Condition::InitialAmplitude),
        ExpandError::UnsupportedTerm { .. }
    ));
}

#[test]
fn order_n_computes_only_what_order_n_needs() {
    // Products of phase functions at order n: x^2 needs n/2 and x x^2 needs n of them.
    let equation = problems::find("duffing").unwrap().equation;
    let result = directly(&equation, Condition::InitialAmplitude, 30).unwrap();
    for work in &result.work[1..] {
        assert!(work.products <= (3 * work.order as u64) / 2 + 2, "{work:?}");
        assert_eq!(work.terms, work.order + 1);
    }
}

#[test]
fn the_residual_check_reads_constants_inside_exp() {
    // exp(eps) satisfies E' = 0 in the phase whatever its coefficients are: its value at psi = 0
    // is what tells 1 + eps + eps^2/2 + ... from anything else.
    let x = || Expression::DISPLACEMENT;
    let exponential = Expression::Function(
        lindstedt::unstable::equation::Function::Exp,
        Box::new(Expression::Small),
    );
    let equation = Expression::ACCELERATION + x() + Expression::Small * exponential * x().pow(3);
    let algebra = Trigonometric::new(Rationals);
    let compiled = compile(&algebra, &equation, &NoNames, 4).unwrap();
    let right = directly(&equation, Condition::InitialAmplitude, 4).unwrap();
    assert_eq!(check(&algebra, &compiled, &right), Ok(4));
    let mut wrong = right.clone();
    let certificate = wrong.certificates.iter_mut().find(|list| !list.is_empty()).unwrap();
    certificate[2].cos[0] = Rational::from(777);
    assert_eq!(check(&algebra, &compiled, &wrong), Err(ExpandError::Residual { order: 2 }));
}

#[test]
fn an_unlucky_prime_is_no_verdict() {
    // The engine's own primes as coefficients: modulo one of them the stiffness vanishes.
    let (_, roots) = lindstedt::unstable::phase::Modular::points_for_degree(5);
    let mut groups = lindstedt::unstable::phase::modular::PrimeFields::with_roots_of_unity(roots);
    for prime in groups.next().unwrap().primes().into_iter().take(3) {
        let stiffness = Expression::Number(Rational::from(prime));
        let mut problem = problems::find("duffing").unwrap();
        problem.equation = Expression::ACCELERATION
            + stiffness * Expression::DISPLACEMENT
            + Expression::Small * Expression::DISPLACEMENT.pow(3);
        let settings = Settings { order: 1, ..Settings::default() };
        let result =
            lindstedt::unstable::derivation::derive(&problem, &settings, &mut |_| true).unwrap();
        assert_eq!(result.exact(Quantity::FrequencySquared, 1).as_deref(), Some("3/4"));
    }
}

#[test]
fn labels_do_not_stand_for_equations() {
    let derive = |name: &str, equation: Expression, route| {
        let mut problem = problems::find(name).unwrap();
        problem.equation = equation;
        let settings = Settings { order: 2, route, ..Settings::default() };
        lindstedt::unstable::derivation::derive(&problem, &settings, &mut |_| true)
    };
    let x = || Expression::DISPLACEMENT;
    let four = Expression::ACCELERATION + 4 * (x() * x().pow(2).pow(Expression::Small));
    assert!(derive("power-law", four.clone(), lindstedt::Route::EnergyIntegral).is_err());
    let driver = derive("power-law", four, lindstedt::Route::Driver).unwrap();
    assert_eq!(driver.exact(Quantity::FrequencySquared, 1).as_deref(), Some("4 - 8*ln(2)"));
    // A second formal function has no coefficients of its own.
    let argument = || Expression::Small * x().pow(2).ln();
    let two = Expression::ACCELERATION
        + x() * argument().formal("S")
        + Expression::Small * x() * argument().formal("G");
    assert!(derive("pendulum", two, lindstedt::Route::Driver).is_err());
    // A repulsive force is no oscillator.
    let repulsive = Expression::ACCELERATION - x() + Expression::Small * x().pow(3);
    assert!(derive("duffing", repulsive, lindstedt::Route::Driver).is_err());
    // Degrees beyond what the algebras are made for are refused, not wrapped around.
    let steep =
        Expression::ACCELERATION + x() + Expression::Small * x() * x().pow(2).ln().pow(1000);
    assert!(derive("power-law", steep, lindstedt::Route::Driver).is_err());
    // Orders that were not derived are not zero.
    let result = expansion("duffing", 2);
    assert_eq!(result.exact(Quantity::Frequency, 3), None);
    assert_eq!(result.terms(3), 0);
}
