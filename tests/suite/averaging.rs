//! Averaging (Krylov, Bogoliubov, Mitropolsky) against published coefficients, the expansion at
//! fixed amplitude, characteristic roots and Hopf's bifurcation.

use lindstedt::unstable::algebra::{AmplitudeAlgebra, RationalAlgebra, Rationals, Ring};
use lindstedt::unstable::coeff::PolynomialRing;
use lindstedt::unstable::coeff::amplitude::{AmplitudePolynomial, AmplitudePolynomials};
use lindstedt::unstable::coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt::unstable::coeff::print::{Print, Style};
use lindstedt::unstable::derivation::averaging::{
    AveragedExpansion, Averaging, AveragingSettings, Coefficient, average as average_problem,
};
use lindstedt::unstable::equation::{Condition, Expression, Function, ParameterCard, Problem};
use lindstedt::unstable::expand::resonance::{SlowFlow, check_flow, resonant};
use lindstedt::unstable::expand::{Binding, ExpandError, compile_system};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::number::ball::ring::{BallRing, Enclosure};
use lindstedt::unstable::phase::amplitudes::scalars::{Integers, Over as Scalar, Scalars};
use lindstedt::unstable::phase::amplitudes::{AmplitudeElement, Amplitudes, Delay};
use lindstedt::{
    DerivationError as Error, Exact, Quantity, unstable::derivation::Settings,
    unstable::derivation::derive as derive_problem, unstable::problems,
};
use rug::{Float, Rational};
use std::collections::BTreeMap;

struct Nothing;

impl<S: Scalars> Binding<Amplitudes<S>> for Nothing {
    fn parameter(&self, _: &str) -> Option<AmplitudeElement<S::Element>> {
        None
    }
}

/// The checked flow of an equation without parameters.
fn flow<S: Scalars>(
    algebra: &Amplitudes<S>,
    equation: &Expression,
    order: usize,
) -> Result<SlowFlow<AmplitudeElement<S::Element>>, ExpandError> {
    let graph = compile_system(algebra, std::slice::from_ref(equation), &Nothing, order)?;
    let found = resonant(algebra, &graph, order, &[], &mut |_| true)?;
    assert_eq!(check_flow(algebra, &graph, &found), Ok(order));
    Ok(found)
}

fn derive(
    algebra: &Amplitudes<Integers>,
    equation: &Expression,
    order: usize,
) -> AveragedExpansion<Rational> {
    AveragedExpansion::of(algebra, &flow(algebra, equation, order).unwrap(), &|c| algebra.parts(c))
        .unwrap()
}

fn algebra(force: Option<Rational>) -> Amplitudes<Integers> {
    Amplitudes::off_resonance(Integers, &Rational::from(1), force.as_ref()).unwrap()
}

fn shown(list: &[AmplitudePolynomial<Rational>]) -> Vec<String> {
    let ring = AmplitudePolynomials::new(Rationals);
    list.iter().map(|c| ring.print(c, Style::Text)).collect()
}

fn van_der_pol() -> Expression {
    let x = Expression::DISPLACEMENT;
    let gain = 1 - x.clone().pow(2);
    Expression::ACCELERATION + x - Expression::Small * gain * Expression::VELOCITY
}

/// classics: A_1, B_2, A_3, B_4 (checked independently there); the others vanish by symmetry.
#[test]
fn van_der_pol_rates() {
    let result = derive(&algebra(None), &van_der_pol(), 8);
    let (a, b) = (shown(&result.amplitude_rate), shown(&result.phase_rate));
    assert_eq!(a[1], "1/2*a - 1/8*a^3");
    assert_eq!(b[2], "-1/8 + 1/8*a^2 - 7/256*a^4");
    assert_eq!(a[3], "-1/16*a^3 + 35/1024*a^5 - 37/8192*a^7");
    assert_eq!(b[4], "-1/128 - 1/64*a^2 + 85/4096*a^4 - 211/32768*a^6 + 497/786432*a^8");
    for n in [2, 4, 6, 8] {
        assert_eq!((a[n].as_str(), b[n - 1].as_str()), ("0", "0"), "order {n}");
    }
}

#[test]
fn forced_duffing_first_order() {
    let x = Expression::DISPLACEMENT;
    let t = Expression::Time;
    let ratio = Expression::Number(Rational::from((2, 7)));
    let force = (t * ratio).apply(Function::Cos);
    let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3)
        - Expression::integer(2) * force;
    let result = derive(&algebra(Some(Rational::from((2, 7)))), &equation, 3);
    // p = 2/(1 - 4/49) = 98/45: B_1 = 3/8 a^2 + 3/4 p^2.
    let expected = Rational::from((3, 4)) * Rational::from((9604, 2025));
    assert_eq!(shown(&result.phase_rate)[1], format!("{expected} + 3/8*a^2"));
}

/// A force whose harmonics meet the free frequency is refused with the resonance, at the order
/// at which it appears: omega = 1/3 at order 1 (x_0^3 contains cos 3 eta), omega = 1/5 at order 2.
#[test]
fn resonances_are_named_at_their_order() {
    let refused = |denominator: u32| {
        let frequency = Rational::from((1, denominator));
        let x = Expression::DISPLACEMENT;
        let force = (Expression::Time * Expression::Number(frequency.clone())).apply(Function::Cos);
        let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3) - force;
        flow(&algebra(Some(frequency)), &equation, 3).err().map(|error| error.to_string())
    };
    let message = |order, harmonic| {
        let words = "resonance with the harmonic";
        format!("order {order}: {words} cos({harmonic}) of the response and the force")
    };
    assert_eq!(refused(3), Some(message(1, "3*eta")));
    assert_eq!(refused(5), Some(message(2, "5*eta")));
    assert_eq!(refused(1), Some(message(0, "eta")));
}

/// Averaging leaves the corrections without first harmonic, so that Duffing's frequency is the
/// one of the fundamental normalisation, derived by the expansion at fixed amplitude: with
/// eps = 1 both are series in a^2.
#[test]
fn duffing_to_order_20_is_the_fundamental_normalisation() {
    let x = Expression::DISPLACEMENT;
    let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
    let result = derive(&algebra(None), &equation, 20);
    let duffing = problems::find("duffing").unwrap();
    let settings = Settings {
        order: 20,
        condition: Some(Condition::FundamentalAmplitude),
        ..Settings::default()
    };
    let fixed = derive_problem(&duffing, &settings, &mut |_| true).unwrap();
    for (n, rate) in result.phase_rate.iter().enumerate().skip(1) {
        let [(power, c)] = rate.terms() else { panic!("one power of a at order {n}") };
        assert_eq!(power.0, 2 * n as i32);
        assert_eq!(Some(c.to_string()), fixed.exact(Quantity::Frequency, n), "order {n}");
    }
    assert!(shown(&result.amplitude_rate).iter().all(|rate| rate == "0"));
    assert_eq!(shown(&result.phase_rate)[2], "-15/256*a^4");
}

/// The delay loop without its force, with T as a parameter of its own.
fn delay_loop() -> Problem {
    let mut problem = problems::vibro_impact::problem();
    let Expression::Sum(terms) = &problem.equation else { panic!("a sum") };
    let free = |term: &&Expression| !term.print("eps", Style::Text).contains("P0");
    problem.equation = Expression::Sum(terms.iter().filter(free).cloned().collect());
    problem.synchronous = None;
    let card = ParameterCard { name: "T".into(), meaning: "".into(), default: "1".into() };
    problem.parameters.push(card);
    problem
}

type Complex<E> = [E; 2];

/// Complex numbers over any ring.
struct Over<'a, R: RationalAlgebra>(&'a R);

impl<R: RationalAlgebra> Over<'_, R> {
    fn mul(&self, x: &Complex<R::Element>, y: &Complex<R::Element>) -> Complex<R::Element> {
        let r = self.0;
        let re = r.sub(&r.mul(&x[0], &y[0]), &r.mul(&x[1], &y[1]));
        [re, r.add(&r.mul(&x[0], &y[1]), &r.mul(&x[1], &y[0]))]
    }
    fn add(&self, x: &Complex<R::Element>, y: &Complex<R::Element>) -> Complex<R::Element> {
        [self.0.add(&x[0], &y[0]), self.0.add(&x[1], &y[1])]
    }
    fn scale(&self, x: &Complex<R::Element>, n: i32, d: u32) -> Complex<R::Element> {
        let q = Rational::from((n, d));
        [self.0.scale(&x[0], &q), self.0.scale(&x[1], &q)]
    }
    fn real(&self, x: &R::Element) -> Complex<R::Element> {
        [x.clone(), self.0.zero()]
    }
    fn i(&self) -> Complex<R::Element> {
        [self.0.zero(), self.0.one()]
    }
}

/// lambda_1 = g/(2 i alpha), lambda_2 = -i g (g - 2 i alpha g')/(8 alpha^3) and lambda_3 = -i g
/// (g^2 - 3 i alpha g g' - alpha^2 (g g'' + 2 g'^2))/(16 alpha^5) at i alpha, from Lagrange's
/// inversion of lambda^2 + alpha^2 = eps g(lambda): equal as canonical formulas.
#[test]
fn symbolic_rates_of_the_delay_loop() {
    let names = ["alpha", "A", "B", "c", "T", "cos", "sin"].map(str::to_owned).to_vec();
    let k = ParameterField {
        ring: PolynomialRing { parameters: names },
        pairs: vec![(5, 6)],
        affine: false,
    };
    let [alpha, a, b, c, t, cos, sin] = [0, 1, 2, 3, 4, 5, 6].map(|i| k.parameter(i));
    let turns = vec![[cos.clone(), sin.clone()], [k.one(), k.zero()]];
    let delay = Delay { time: t.clone(), turns };
    let algebra = Amplitudes::off_resonance(Scalar::exact(k.clone()), &alpha, None).unwrap();
    let algebra = algebra.with_delays(&[delay]);
    type Algebra = Amplitudes<Scalar<ParameterField>>;
    type Element = AmplitudeElement<ParameterFraction>;
    struct Named<'a>(&'a ParameterField, &'a Algebra);
    impl Binding<Algebra> for Named<'_> {
        fn parameter(&self, name: &str) -> Option<Element> {
            Some(self.1.number(&self.0.parameter(self.0.position(name)?)))
        }
    }
    let named = Named(&k, &algebra);
    let graph = compile_system(&algebra, &[delay_loop().equation], &named, 3).unwrap();
    let found = resonant(&algebra, &graph, 3, &[], &mut |_| true).unwrap();
    assert_eq!(check_flow(&algebra, &graph, &found), Ok(3));
    let result = AveragedExpansion::of(&algebra, &found, &|c| algebra.parts(c)).unwrap();

    let z = Over(&k);
    let late = [cos, k.neg(&sin)];
    let gain = [a, k.mul(&alpha, &b)];
    let early = z.add(&[k.one(), k.zero()], &z.scale(&late, -1, 1));
    let i_alpha = [k.zero(), alpha.clone()];
    let g = z.add(&z.mul(&gain, &early), &z.scale(&z.mul(&i_alpha, &z.real(&c)), -1, 1));
    let time = z.real(&t);
    let slope = z.mul(&z.mul(&gain, &time), &late);
    let g1 = z.add(&z.add(&z.mul(&z.real(&b), &early), &slope), &z.scale(&z.real(&c), -1, 1));
    let bend = z.scale(&z.mul(&z.mul(&z.real(&b), &time), &late), 2, 1);
    let g2 = z.add(&bend, &z.scale(&z.mul(&slope, &time), -1, 1));
    let over_alpha = |power: u32| {
        let inverse = k.reciprocal(&alpha).unwrap();
        z.real(&lindstedt::unstable::coeff::polynomial::power(&k, &inverse, power))
    };
    let minus_i = z.scale(&z.i(), -1, 1);
    let lambda_1 = z.scale(&z.mul(&z.mul(&minus_i, &g), &over_alpha(1)), 1, 2);
    let inner = z.add(&g, &z.scale(&z.mul(&i_alpha, &g1), -2, 1));
    let lambda_2 = z.scale(&z.mul(&z.mul(&minus_i, &z.mul(&g, &inner)), &over_alpha(3)), 1, 8);
    let first = z.mul(&g, &g);
    let second = z.scale(&z.mul(&i_alpha, &z.mul(&g, &g1)), -3, 1);
    let third = z.add(&z.mul(&g, &g2), &z.scale(&z.mul(&g1, &g1), 2, 1));
    let inner = z.add(&z.add(&first, &second), &z.mul(&z.mul(&i_alpha, &i_alpha), &third));
    let lambda_3 = z.scale(&z.mul(&z.mul(&minus_i, &z.mul(&g, &inner)), &over_alpha(5)), 1, 16);
    let constants = AmplitudePolynomials::new(k);
    for (n, lambda) in [lambda_1, lambda_2, lambda_3].iter().enumerate() {
        let rate = constants.power(1, lambda[0].clone());
        assert_eq!(result.amplitude_rate[n + 1], rate, "R_{}", n + 1);
        assert_eq!(result.phase_rate[n + 1], constants.embed(lambda[1].clone()), "alpha_{}", n + 1);
    }
}

/// The Taylor coefficients of the characteristic root near i alpha,
/// lambda^2 + alpha^2 = eps [(A + B lambda)(1 - e^(-lambda T)) - c lambda], by their recursion.
fn characteristic_root(
    [alpha, a, b, c, t]: &[Float; 5],
    order: usize,
    bits: u32,
) -> Vec<[Float; 2]> {
    let zero = || Float::new(bits);
    let f = |x: &Float| Float::with_val(bits, x);
    let mul = |x: &[Float; 2], y: &[Float; 2]| {
        [f(&x[0]) * &y[0] - f(&x[1]) * &y[1], f(&x[0]) * &y[1] + f(&x[1]) * &y[0]]
    };
    let add = |x: [Float; 2], y: [Float; 2]| {
        let [p, q] = x;
        let [r, s] = y;
        [p + r, q + s]
    };
    let scale = |x: &[Float; 2], q: &Float| [f(&x[0]) * q, f(&x[1]) * q];
    let angle = f(alpha) * t;
    let mut lambda = vec![[zero(), f(alpha)]];
    let mut e = vec![[f(&angle).cos(), -f(&angle).sin()]];
    for m in 1..=order {
        let one = Float::with_val(bits, u32::from(m == 1));
        let mut g = scale(&add([one, zero()], scale(&e[m - 1], &f(&(-f(a) / a)))), a);
        let mut late = [zero(), zero()];
        for j in 0..m {
            late = add(late, mul(&lambda[j], &e[m - 1 - j]));
        }
        let minus = Float::with_val(bits, -1);
        g = add(g, scale(&add(lambda[m - 1].clone(), scale(&late, &minus)), b));
        g = add(g, scale(&lambda[m - 1], &-f(c)));
        for j in 1..m {
            g = add(g, scale(&mul(&lambda[j], &lambda[m - j]), &minus));
        }
        // Divided by 2 i alpha.
        let twice = f(alpha) * 2u32;
        lambda.push([f(&g[1]) / &twice, -f(&g[0]) / &twice]);
        let mut sum = [zero(), zero()];
        for j in 1..=m {
            sum = add(sum, scale(&mul(&lambda[j], &e[m - j]), &Float::with_val(bits, j)));
        }
        e.push(scale(&sum, &(-f(t) / Float::with_val(bits, m))));
    }
    lambda
}

fn averaged_loop(values: &[(&str, &str)], order: usize, digits: usize) -> Averaging {
    let mut parameters = BTreeMap::new();
    for (name, text) in values {
        parameters.insert((*name).to_owned(), Exact::parse(text).unwrap());
    }
    let settings = AveragingSettings { order, parameters, digits, ..AveragingSettings::default() };
    average_problem(&delay_loop(), &settings, &mut |_| true).unwrap()
}

fn decimal(rates: &[lindstedt::averaging::RateTerm], bits: u32) -> Float {
    let [term] = rates else { panic!("one term, not {rates:?}") };
    let Coefficient::Number(number) = &term.coefficient else { panic!("a number") };
    Float::with_val(bits, Float::parse(&number.decimal).unwrap())
}

fn close(x: &Float, y: &Float, digits: i32) -> bool {
    let size = Float::with_val(53, y.abs_ref()).to_f64();
    Float::with_val(53, x - y).abs().to_f64() <= size * 10f64.powi(-digits)
}

#[test]
fn rates_to_order_50_are_the_characteristic_root() {
    let values = ["1", "0.1", "0.05", "0.02", "2.5"];
    let names = ["alpha", "A", "B", "c", "T"];
    let given: Vec<_> = names.into_iter().zip(values).collect();
    let result = averaged_loop(&given, 50, 50);
    assert!(result.is_linear() && !result.exact);
    assert_eq!(result.checked_orders, 50);
    let bits = 300;
    let parsed = values.map(|text| {
        let Exact::Rational(q) = Exact::parse(text).unwrap() else { panic!("rational") };
        Float::with_val(bits, q)
    });
    let root = characteristic_root(&parsed, 50, bits);
    for (n, lambda) in root.iter().enumerate().skip(1) {
        assert!(close(&decimal(&result.amplitude_rate[n], bits), &lambda[0], 49), "R_{n}");
        assert!(close(&decimal(&result.phase_rate[n], bits), &lambda[1], 49), "alpha_{n}");
    }
}

/// Both halves of the reference file, computed elsewhere to 30 digits.
#[test]
fn rates_of_the_reference_file() {
    let text = include_str!("../data/vibro-impact/kbm_series.json");
    let cases: Vec<serde_json::Value> = serde_json::from_str(text).unwrap();
    assert!(cases.len() > 1);
    for case in cases {
        let given: Vec<(&str, &str)> = ["alpha", "A", "B", "c", "T"]
            .into_iter()
            .map(|name| (name, case["params"][name].as_str().unwrap()))
            .collect();
        let result = averaged_loop(&given, 10, 30);
        for (n, lambda) in case["lambda_n"].as_array().unwrap().iter().enumerate().skip(1) {
            let part = |name: &str| {
                Float::with_val(150, Float::parse(lambda[name].as_str().unwrap()).unwrap())
            };
            assert!(close(&decimal(&result.amplitude_rate[n], 150), &part("re"), 27), "R_{n}");
            assert!(close(&decimal(&result.phase_rate[n], 150), &part("im"), 27), "alpha_{n}");
        }
    }
}

/// Duffing with delayed feedback, x'' + d x' + a x + x^3 + b (x - x(t - tau)) = 0 with
/// (a, b, d) = (1/2, 3/5, 1/20): the linear part with damping and delay has the roots +-i omega at
/// Hopf points, found here in closed form, and averaging of eps x^3 gives da/dt = C a^3. C was
/// computed from the centre manifold elsewhere, to 15 digits.
#[test]
fn amplitude_equation_at_hopf_points() {
    let bits = 200;
    let q = |n: i32, d: u32| Float::with_val(bits, Rational::from((n, d)));
    let (a, b, d) = (q(1, 2), q(3, 5), q(1, 20));
    // |L(i omega)| = 0: (a + b - w)^2 + d^2 w = b^2 for w = omega^2, the larger root.
    let sum = Float::with_val(bits, &a + &b);
    let half = Float::with_val(bits, &sum - Float::with_val(bits, &d * &d) / 2u32);
    let rest = Float::with_val(bits, &sum * &sum) - Float::with_val(bits, &b * &b);
    let w = Float::with_val(bits, &half + (Float::with_val(bits, &half * &half) - rest).sqrt());
    let omega = w.clone().sqrt();
    // e^(-i omega tau) = (a + b - w + i d omega)/b.
    let cos = Float::with_val(bits, &sum - &w) / &b;
    let sin = -(Float::with_val(bits, &d * &omega) / &b);
    let two_pi = Float::with_val(bits, rug::float::Constant::Pi) * 2u32;
    let mut first = Float::with_val(bits, sin.atan2_ref(&cos));
    if first.is_sign_negative() {
        first += &two_pi;
    }
    let known = [
        ("2.4955054150976768709", 0.110899716974414),
        ("7.3195205831689957252", 0.115098034138736),
    ];
    for (turns, (printed, coefficient)) in (0u32..).zip(known) {
        let tau = (Float::with_val(bits, &two_pi * turns) + &first) / &omega;
        assert!(close(&tau, &Float::with_val(bits, Float::parse(printed).unwrap()), 19), "{tau}");
        let ring = BallRing { balls: Balls::new(180) };
        // The last digits of omega and tau are unknown: enclosed, so that L(i omega) = 0 is.
        let ulp = Float::with_val(53, Float::i_exp(1, -185));
        let ball = |x: &Float| Enclosure(ring.balls.from_parts(x, &ulp));
        let angle = Float::with_val(bits, &omega * &tau);
        let turn = [ball(&angle.clone().cos()), ball(&angle.sin())];
        let delay = Delay { time: ball(&tau), turns: vec![turn, [ring.one(), ring.zero()]] };
        let algebra = Amplitudes::off_resonance(Scalar::exact(ring), &ball(&omega), None).unwrap();
        let algebra = algebra.with_delays(&[delay]);
        let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
        let number = |n: i32, d: u32| Expression::Number(Rational::from((n, d)));
        let late = x.clone().delayed(Expression::parameter("tau"));
        let equation = Expression::ACCELERATION + number(1, 20) * v + number(11, 10) * x.clone()
            - number(3, 5) * late
            + Expression::Small * x.pow(3);
        let found = flow(&algebra, &equation, 2).unwrap();
        let result = AveragedExpansion::of(&algebra, &found, &|c| algebra.parts(c)).unwrap();
        let [(power, c)] = result.amplitude_rate[1].terms() else { panic!("one power") };
        assert_eq!(power.0, 3);
        let c = c.0.midpoint().to_f64();
        assert!((c - coefficient).abs() < 2e-15, "{c} for {coefficient}");
    }
}

#[test]
fn refusals() {
    let problem = delay_loop();
    let set = |pairs: &[(&str, &str)]| {
        let list = pairs.iter().map(|(n, v)| ((*n).to_owned(), Exact::parse(v).unwrap()));
        AveragingSettings { parameters: list.collect(), digits: 20, ..AveragingSettings::default() }
    };
    let run = |pairs: &[(&str, &str)]| average_problem(&problem, &set(pairs), &mut |_| true).err();
    assert!(matches!(run(&[("zeta", "1")]), Some(Error::UnknownParameter { .. })));
    assert!(matches!(run(&[("T", "pi")]), Some(Error::NotAmongSymbols { .. })));
    assert_eq!(run(&[("T", "2"), ("alpha", "3/2")]), None);
}

/// The residual check sees a wrong rate, a wrong response and a first harmonic too many.
#[test]
fn a_wrong_expansion_is_noticed() {
    let algebra = algebra(None);
    let graph = compile_system(&algebra, &[van_der_pol()], &Nothing, 4).unwrap();
    let right = resonant(&algebra, &graph, 4, &[], &mut |_| true).unwrap();
    type Flow = SlowFlow<AmplitudeElement<lindstedt_number::Whole>>;
    let spoil = |change: &dyn Fn(&mut Flow)| {
        let mut wrong = right.clone();
        change(&mut wrong);
        check_flow(&algebra, &graph, &wrong).err().map(|error| error.to_string())
    };
    let z = algebra.amplitude(0);
    let square = algebra.mul(&z, &algebra.conjugate(&z));
    let tiny = algebra.scale(&algebra.mul(&z, &square), &Rational::from((1, 1_000_000)));
    let residual = |n: u32| Some(format!("the residual does not vanish at order {n}"));
    assert_eq!(spoil(&|e| algebra.add_assign(&mut e.flow[0][3], &tiny)), residual(3));
    let turned = algebra.by_time(&tiny);
    assert_eq!(spoil(&|e| algebra.add_assign(&mut e.flow[0][4], &turned)), residual(4));
    let third = algebra.twice_real(&algebra.mul(&z, &algebra.mul(&z, &tiny)));
    assert_eq!(spoil(&|e| algebra.add_assign(&mut e.solution[0][1], &third)), residual(1));
    let first = algebra.twice_real(&tiny);
    let normalisation = Some("the normalisation does not hold at order 2".to_owned());
    assert_eq!(spoil(&|e| algebra.add_assign(&mut e.solution[0][2], &first)), normalisation);
}

/// A delay of a quarter turn, sin(pi/2) = 1: x(t - pi/2) = a sin(psi) takes the growth of van der Pol's equation away, and no
/// cycle is left.
#[test]
fn pi_beside_numbers_is_a_number() {
    let case =
        lindstedt::Oscillator::parse("x'' + x = eps*(1 - x^2)*x' + eps*x(t - pi/2)").unwrap();
    let found = case.average(1, &lindstedt::Work::default()).unwrap();
    assert!(found.header.at.is_empty() && found.value.symbols.is_empty());
    let numbers: Vec<(i32, f64)> = found.value.amplitude_rate[1]
        .iter()
        .map(|term| match &term.coefficient {
            Coefficient::Number(number) => (term.exponent, number.decimal.parse().unwrap()),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(numbers, [(1, 0.0), (3, -0.125)]);
}
