//! Slow flows at resonance against formulas by hand, reference numbers and exact linear responses.

use lindstedt_algebra::{AmplitudeAlgebra, ForcedAlgebra, RationalAlgebra, Ring};
use lindstedt_equation::{Expression, Function};
use lindstedt_expand::resonance::{SlowFlow, check_flow, resonant};
use lindstedt_expand::{Binding, ExpandError, compile_system};
use lindstedt_number::Whole;
use lindstedt_number::ball::Balls;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_phase::amplitudes::scalars::{Integers, Over, Scalars};
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes};
use rug::Rational;
use std::collections::BTreeMap;

type Powers = BTreeMap<String, i32>;
type Terms = BTreeMap<Powers, [Rational; 2]>;

/// Names are symbols of the algebra.
struct Symbols<'a, S: Scalars>(&'a Amplitudes<S>);

impl<S: Scalars> Binding<Amplitudes<S>> for Symbols<'_, S> {
    fn parameter(&self, name: &str) -> Option<AmplitudeElement<S::Element>> {
        self.0.symbol(name)
    }
}

const SYMBOLS: [&str; 6] = ["s", "mu", "al", "F", "h", "be"];

fn q(n: i64, d: i64) -> Rational {
    Rational::from((n, d))
}

fn p(name: &str) -> Expression {
    Expression::parameter(name)
}

fn x(j: usize) -> Expression {
    Expression::unknown(j, 0)
}

fn eps(e: Expression) -> Expression {
    Expression::Small * e
}

/// cos(q t).
fn cos(rate: Rational) -> Expression {
    (Expression::Number(rate) * Expression::Time).apply(Function::Cos)
}

/// x_j'' + nu_j^2 x_j + the rest.
fn oscillator(j: usize, nu: i64, rest: Expression) -> Expression {
    Expression::unknown(j, 2) + (nu * nu) * x(j) + rest
}

/// s x + 2 mu x' + al x^3.
fn damped_cubic() -> Expression {
    p("s") * x(0) + 2 * p("mu") * Expression::VELOCITY + p("al") * x(0).pow(3)
}

fn algebra(frequencies: &[i64], force: Rational) -> Amplitudes<Integers> {
    let frequencies: Vec<_> = frequencies.iter().map(|nu| Rational::from(*nu)).collect();
    Amplitudes::new(Integers, &frequencies, &force, &SYMBOLS).unwrap()
}

fn derive<S: Scalars>(
    algebra: &Amplitudes<S>,
    equations: &[Expression],
    order: usize,
    detuning: &[Vec<AmplitudeElement<S::Element>>],
) -> SlowFlow<AmplitudeElement<S::Element>> {
    let graph = compile_system(algebra, equations, &Symbols(algebra), order).unwrap();
    let found = resonant(algebra, &graph, order, detuning, &mut |_| true).unwrap();
    assert_eq!(check_flow(algebra, &graph, &found), Ok(order));
    found
}

fn terms(algebra: &Amplitudes<Integers>, f: &AmplitudeElement<Whole>) -> Terms {
    let unknowns = algebra.unknowns();
    let phases = (1..=unknowns).flat_map(|j| [format!("z{j}"), format!("zbar{j}")]);
    let names: Vec<String> =
        phases.chain(["E".to_owned()]).chain(algebra.symbols().iter().cloned()).collect();
    let named = |exponents: &[i32]| {
        let all = names.iter().cloned().zip(exponents.iter().copied());
        all.filter(|(_, n)| *n != 0).collect::<Powers>()
    };
    let list = algebra.rational_terms(f).unwrap();
    list.into_iter().map(|t| (named(&t.exponents), [t.re, t.im])).collect()
}

/// `(3/2) i` of `z1^2 zbar1 al`: the words with their powers, then real and imaginary part.
fn by_hand(list: &[(&str, Rational, Rational)]) -> Terms {
    let powers = |text: &str| {
        let word = |word: &str| match word.split_once('^') {
            Some((name, n)) => (name.to_owned(), n.parse().unwrap()),
            None => (word.to_owned(), 1),
        };
        text.split_whitespace().map(word).collect::<Powers>()
    };
    list.iter().map(|(text, re, im)| (powers(text), [re.clone(), im.clone()])).collect()
}

fn im(text: &str, n: i64, d: i64) -> (&str, Rational, Rational) {
    (text, Rational::new(), q(n, d))
}

fn re(text: &str, n: i64, d: i64) -> (&str, Rational, Rational) {
    (text, q(n, d), Rational::new())
}

fn primary() -> Expression {
    oscillator(0, 1, eps(damped_cubic() - p("F") * cos(q(1, 1))))
}

/// Nayfeh and Mook, Nonlinear Oscillations, chapters 4 to 6; the other cases of their table are among the
/// reference flows.
#[test]
fn first_orders_by_hand() {
    let common = || vec![im("z1 s", 1, 2), re("z1 mu", -1, 1), im("z1^2 zbar1 al", 3, 2)];
    let with =
        |more: &[(&'static str, Rational, Rational)]| by_hand(&[common(), more.to_vec()].concat());
    let parametric = oscillator(0, 1, eps(damped_cubic() + p("h") * x(0) * cos(q(2, 1))));
    let a = algebra(&[1], q(2, 1));
    let found = derive(&a, &[parametric], 1, &[]);
    assert_eq!(terms(&a, &found.flow[0][1]), with(&[im("zbar1 E h", 1, 4)]));

    let subharmonic = oscillator(0, 1, eps(damped_cubic()) - p("F") * cos(q(3, 1)));
    let a = algebra(&[1], q(3, 1));
    let found = derive(&a, &[subharmonic], 1, &[]);
    let expected = with(&[im("zbar1^2 E F al", -3, 32), im("z1 F^2 al", 3, 256)]);
    assert_eq!(terms(&a, &found.flow[0][1]), expected);

    // V = eps (al x_1^4/4 + be x_1^3 x_2) + eps s x_2^2/2.
    let internal = [
        oscillator(0, 1, eps(p("al") * x(0).pow(3) + 3 * p("be") * x(0).pow(2) * x(1))),
        oscillator(1, 3, eps(p("s") * x(1) + p("be") * x(0).pow(3))),
    ];
    let a = algebra(&[1, 3], q(0, 1));
    let found = derive(&a, &internal, 2, &[]);
    let first = [im("z1^2 zbar1 al", 3, 2), im("zbar1^2 z2 be", 3, 2)];
    assert_eq!(terms(&a, &found.flow[0][1]), by_hand(&first));
    let second = [im("z2 s", 1, 6), im("z1^3 be", 1, 6)];
    assert_eq!(terms(&a, &found.flow[1][1]), by_hand(&second));
}

/// V = x^2 y - y^3/3, frequencies 1:1. K4 = (1/48)(-5 (q^2 + p^2)^2 + 28 (q_1 p_2 - q_2 p_1)^2), and
/// z' = (i/2) dK/dzbar for z = (q - i p)/2 (Gustavson, Astron. J. 71 (1966) 670).
#[test]
fn henon_heiles() {
    let equations =
        [oscillator(0, 1, eps(2 * x(0) * x(1))), oscillator(1, 1, eps(x(0).pow(2) - x(1).pow(2)))];
    let a = algebra(&[1, 1], q(0, 1));
    let found = derive(&a, &equations, 4, &[]);
    let expected = [im("z1^2 zbar1", -5, 3), im("z1 z2 zbar2", 2, 3), im("zbar1 z2^2", -7, 3)];
    assert_eq!(terms(&a, &found.flow[0][2]), by_hand(&expected));
    assert!([1, 3].into_iter().all(|n| a.is_zero(&found.flow[0][n])));
    // K6 = -235/3456 at q_2 = 1 alone. Along q_1 = 0, K = I - (5/48)(2 I)^2 - (235/3456)(2 I)^3; of y with the harmonics z and
    // -z^2/3, ... the action is omega sum_n n^2 |c_n|^2, both ends of the spectrum counted: with r = |z|^2 and omega =
    // 1 - 5 r/3 it is I = 2 r (1 - 11 r/9). So omega = dK/dI = 1 - 5 I/6 - 235 I^2/144 has r^2 times:
    let k6 = q(-235, 3456);
    // dK6/dI = 3 K6 2^3 I^2.
    let sixth = k6 * q(3 * 8 * 4, 1) + q(5, 3) * q(11, 9);
    let along = terms(&a, &found.flow[1][4]);
    assert_eq!(sixth, q(-485, 108));
    for (monomial, size) in by_hand(&[im("z2^3 zbar2^2", -485, 108)]) {
        assert_eq!(along.get(&monomial), Some(&size));
    }
}

/// A complex number.
type C = [f64; 2];

fn over([a, b]: C, [c, d]: C) -> C {
    let n = c * c + d * d;
    [(a * c + b * d) / n, (b * c - a * d) / n]
}

/// The response of x'' + 2 mu eps x' + (1 + s eps) x = eps F cos eta, eta' = 1 + sigma eps, is known
/// exactly: X = (eps F/2)/(1 + s eps - Omega^2 + 2 i mu eps Omega) E + conj; the steady state of the flow is
/// right to O(eps^N), wherever the detuning is put, and F = 1 here.
#[test]
fn the_detuning_in_the_phase_or_in_the_stiffness() {
    let a = algebra(&[1], q(1, 1));
    let damped = p("s") * x(0) + 2 * p("mu") * Expression::VELOCITY;
    let linear = oscillator(0, 1, eps(damped - cos(q(1, 1))));
    let error = |s: Rational, sigma: Rational, order: usize, eps: f64| {
        let detuning = [vec![a.rational(&sigma)]];
        let found = derive(&a, std::slice::from_ref(&linear), order, &detuning);
        let (mu, s_value) = (0.3, s.to_f64());
        let (mut rate, mut force) = ([0.0, 1.0], [0.0, 0.0]);
        for n in 1..=order {
            for t in a.rational_terms(&found.flow[0][n]).unwrap() {
                let symbols = s_value.powi(t.exponents[3]) * f64::powi(mu, t.exponents[4]);
                let size = symbols * eps.powi(n as i32);
                let slot = if t.exponents[0] == 1 { &mut rate } else { &mut force };
                assert_eq!(t.exponents[0] + t.exponents[2], 1);
                *slot = [slot[0] + size * t.re.to_f64(), slot[1] + size * t.im.to_f64()];
            }
        }
        let omega = 1.0 + eps * sigma.to_f64();
        let w = over(force, [-rate[0], omega - rate[1]]);
        let exact =
            over([eps / 2.0, 0.0], [1.0 + eps * s_value - omega * omega, 2.0 * mu * eps * omega]);
        (w[0] - exact[0]).hypot(w[1] - exact[1])
    };
    for (s, sigma) in [(q(1, 2), q(0, 1)), (q(0, 1), q(-1, 4)), (q(1, 3), q(1, 5))] {
        for order in 1..=5 {
            let [large, small] =
                [0.04, 0.02].map(|eps| error(s.clone(), sigma.clone(), order, eps));
            let slope = (large / small).log2();
            // Without detuning of the phase X does not depend on eps, and every order is exact, up to
            // rounding.
            let exact = sigma.is_zero() && large < 1e-14;
            assert!(exact || slope > order as f64 - 0.25, "{s} {sigma} {order}: {slope}");
            assert!(exact || large > 1e-12, "{s} {sigma} {order}: {large} shows nothing");
        }
    }
}

/// Over balls the coefficients enclose the rational ones; symbols stay symbols.
#[test]
fn other_coefficients() {
    let exact = algebra(&[1], q(1, 1));
    let rational = derive(&exact, &[primary()], 3, &[]);
    let balls = BallRing { balls: Balls::new(80) };
    let one = [q(1, 1)];
    let a = Amplitudes::new(Over::exact(balls), &one, &one[0], &SYMBOLS).unwrap();
    let found = derive(&a, &[primary()], 3, &[]);
    let mut gap = found.flow[0][3].clone();
    let i = a.by_amplitude(&a.by_time(&a.amplitude(0)), 0);
    for term in exact.rational_terms(&rational.flow[0][3]).unwrap() {
        let parts = [a.rational(&term.re), a.mul(&i, &a.rational(&term.im))];
        let mut value = a.add(&parts[0], &parts[1]);
        let (cosine, sine) = a.forcing(1).unwrap();
        let e = a.add(&cosine, &a.mul(&i, &sine));
        let z = a.amplitude(0);
        let phases = [z.clone(), a.conjugate(&z), e.clone(), a.conjugate(&e)];
        let [p, q, m] = [0, 1, 2].map(|k| term.exponents[k]);
        let symbols = SYMBOLS.iter().map(|name| a.symbol(name).unwrap());
        let powers = [p, q, m.max(0), (-m).max(0)].into_iter().chain(term.exponents[3..].to_vec());
        for (factor, n) in phases.into_iter().chain(symbols).zip(powers) {
            value = (0..n).fold(value, |product, _| a.mul(&product, &factor));
        }
        gap = a.sub(&gap, &value);
    }
    assert!(a.may_vanish(&gap));
    let tiny = a.constant(Enclosure(balls.balls.from_rational(&q(1, 1_000_000_007))));
    assert!(!a.may_vanish(&a.add(&gap, &tiny)));
}

/// What the algebra says of order zero must be true, and a force at order zero off resonance.
#[test]
fn order_zero_is_checked() {
    let refused = |a: &Amplitudes<Integers>, equation: Expression| {
        let graph = compile_system(a, &[equation], &Symbols(a), 2).unwrap();
        resonant(a, &graph, 2, &[], &mut |_| true).err()
    };
    let wrong = Some(ExpandError::NotTheFrequency { unknown: 0 });
    assert_eq!(refused(&algebra(&[2], q(1, 1)), primary()), wrong);
    let strong = oscillator(0, 1, eps(x(0).pow(3)) - p("F") * cos(q(1, 1)));
    let forced = Some(ExpandError::ForcedAtResonance { unknown: 0 });
    assert_eq!(refused(&algebra(&[1], q(1, 1)), strong), forced);
    let cubic = oscillator(0, 1, x(0).pow(3));
    assert_eq!(refused(&algebra(&[1], q(1, 1)), cubic), wrong);
}

/// Near 1/3 the divisor is small; it is named.
#[test]
fn near_resonance_is_named() {
    let a = algebra(&[1], q(33, 100));
    let equation = oscillator(0, 1, eps(damped_cubic()) - p("F") * cos(q(33, 100)));
    let found = derive(&a, &[equation], 1, &[]);
    let near = found.nearest.first().unwrap();
    assert_eq!((near.order, near.harmonic.iter().map(|k| k.abs()).collect()), (1, vec![0, 3]));
    assert_eq!(near.size, 1 - q(99 * 99, 10_000));
}

/// The check finds a coefficient that is wrong by a little, a resonant term in u, and a wrong detuning.
#[test]
fn the_check_can_fail() {
    let a = algebra(&[1], q(1, 1));
    let graph = compile_system(&a, &[primary()], &Symbols(&a), 3).unwrap();
    let found = resonant(&a, &graph, 3, &[], &mut |_| true).unwrap();
    let little = a.scale(&a.amplitude(0), &q(1, 1_000_000_007));
    let mut wrong = found.clone();
    a.add_assign(&mut wrong.flow[0][2], &little);
    assert_eq!(check_flow(&a, &graph, &wrong), Err(ExpandError::Residual { order: 2 }));
    let mut wrong = found.clone();
    a.add_assign(&mut wrong.solution[0][2], &a.twice_real(&little));
    assert_eq!(check_flow(&a, &graph, &wrong), Err(ExpandError::Normalisation { order: 2 }));
    let mut wrong = found;
    wrong.detuning = vec![vec![a.one()]];
    assert_eq!(check_flow(&a, &graph, &wrong), Err(ExpandError::Residual { order: 2 }));
}

/// Liouville at every order: with rho the determinant of (x, x') by (z, zbar) and damping 2 mu x' the volume shrinks as
/// D rho + rho div f + 2 eps mu rho = 0, identically; and it does not with another damping.
#[test]
fn volume_shrinks_as_the_damping_says() {
    let (a, order) = (algebra(&[1], q(1, 1)), 3);
    let found = derive(&a, &[primary()], order, &[]);
    type Series = lindstedt_series::Series<AmplitudeElement<Whole>>;
    let mut flow = found.flow[0].clone();
    a.add_assign(&mut flow[0], &a.by_time(&a.amplitude(0)));
    let flow = Series::truncated(flow);
    let by_conjugate =
        |f: &AmplitudeElement<Whole>| a.conjugate(&a.by_amplitude(&a.conjugate(f), 0));
    // Not only of real f.
    let along = |f: &Series| {
        let parts = [
            flow.mul(&a, &f.map(|f| a.by_amplitude(f, 0)), order),
            flow.map(|f| a.conjugate(f)).mul(&a, &f.map(by_conjugate), order),
            f.map(|f| a.by_force(f, 0)),
        ];
        Series::truncated(parts[0].add(&a, &parts[1]).add(&a, &parts[2]).coefficients)
    };
    let x = Series::truncated(found.solution[0].clone());
    let velocity = along(&x);
    let product = |f: &Series, g: &Series| {
        f.map(|f| a.by_amplitude(f, 0)).mul(&a, &g.map(by_conjugate), order)
    };
    let minus = |f: &Series| f.map(|f| a.neg(f));
    let rho = product(&x, &velocity).add(&a, &minus(&product(&velocity, &x)));
    let divergence = flow.map(|f| a.twice_real(&a.by_amplitude(f, 0)));
    let change = along(&rho).add(&a, &divergence.mul(&a, &rho, order));
    let damped = |mu: AmplitudeElement<Whole>| {
        let rate = Series::polynomial(vec![a.zero(), a.scale(&mu, &q(2, 1))]);
        let rest = change.add(&a, &rate.mul(&a, &rho, order));
        (0..=order).all(|n| a.is_zero(&rest.coefficients[n]))
    };
    let mu = a.symbol("mu").unwrap();
    assert!(damped(mu.clone()) && !damped(a.neg(&mu)));
}
