//! Slow flows with delays against the characteristic roots of linear equations.

use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{Detuned, SlowFlow, slow_flow};
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use lindstedt_phase::amplitudes::AmplitudeTerm;
use lindstedt_problem_file::ProblemFile;
use rug::Rational;
use std::collections::BTreeMap;

/// A complex number.
pub type C = [f64; 2];

pub fn add(a: C, b: C) -> C {
    [a[0] + b[0], a[1] + b[1]]
}

pub fn mul(a: C, b: C) -> C {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

pub fn times(a: C, x: f64) -> C {
    [a[0] * x, a[1] * x]
}

/// e^(-lambda T).
fn late(lambda: C, delay: f64) -> C {
    let size = (-lambda[0] * delay).exp();
    [size * (lambda[1] * delay).cos(), -size * (lambda[1] * delay).sin()]
}

/// Newton's method with a difference for the derivative.
fn root(f: &dyn Fn(C) -> C, mut at: C) -> C {
    for _ in 0..40 {
        let (value, h) = (f(at), 1e-7);
        let slope = times(add(f(add(at, [h, 0.0])), times(f(add(at, [-h, 0.0])), -1.0)), 0.5 / h);
        let size = slope[0] * slope[0] + slope[1] * slope[1];
        at = add(at, times(mul(value, [slope[0], -slope[1]]), -1.0 / size));
    }
    at
}

fn flow(equations: &[&str], order: usize, set: &[(&str, &str)]) -> SlowFlow {
    let list: Vec<String> = equations.iter().map(|text| format!("{text:?}")).collect();
    let file = format!("equations = [{}]", list.join(", "));
    let problem = ProblemFile::parse(&file).unwrap().problem;
    let value = |(name, text): &(&str, &str)| ((*name).to_owned(), Exact::parse(text).unwrap());
    let parameters = set.iter().map(value).collect();
    let settings = AveragingSettings { order, parameters, ..AveragingSettings::default() };
    let found = slow_flow(&problem, &settings, Detuned::Beside, &mut |_| true).unwrap();
    assert_eq!(found.checked_orders, Some(order));
    found
}

/// sum eps^n h_n with z_j' = z_j sum eps^n h_n; orders 0 to N.
fn rate(found: &SlowFlow, j: usize, values: &BTreeMap<&str, f64>, small: f64, order: usize) -> C {
    let exact = |name: &str| Exact::from_f64(*values.get(name)?);
    let value = |name: &String| match found.system.wave(name, &exact, Balls::new(80)) {
        Some(ball) => ball.midpoint().to_f64(),
        None => values[name.as_str()],
    };
    let symbols: Vec<f64> = found.system.symbols.iter().map(value).collect();
    let mut sum = [0.0, 0.0];
    for (n, terms) in found.flow[j].iter().enumerate().take(order + 1) {
        for term in terms {
            let (phases, own) = term.exponents.split_at(found.first_symbol());
            assert!(
                phases.iter().enumerate().all(|(i, e)| *e == i32::from(i == 2 * j)),
                "{phases:?}"
            );
            let powers = symbols.iter().zip(own).map(|(x, e)| x.powi(*e));
            let size = powers.product::<f64>() * small.powi(n as i32);
            sum = add(sum, times([term.re.to_f64(), term.im.to_f64()], size));
        }
    }
    sum
}

/// The rates of orders 0 to N miss the root by O(eps^(N + 1)).
fn agrees(
    found: &SlowFlow,
    j: usize,
    values: &BTreeMap<&str, f64>,
    equation: &dyn Fn(C, f64) -> C,
) {
    let start = [0.0, found.system.frequencies[j].to_f64()];
    for order in 1..=found.order {
        let error = |small: f64| {
            let truth = root(&|lambda| equation(lambda, small), start);
            let gap = add(rate(found, j, values, small, order), times(truth, -1.0));
            gap[0].hypot(gap[1])
        };
        let slope = (error(0.04) / error(0.02)).log2();
        assert!((slope - order as f64 - 1.0).abs() < 0.25, "unknown {j}, order {order}: {slope}");
    }
}

/// x'' + x + eps (k x(t - T) + x'(t - T/2)) = 0 with T as a symbol: one constant phase of half of it.
#[test]
fn one_unknown() {
    let found = flow(&["x'' + x + eps*(k*x(t - T) + x'(t - T/2))"], 5, &[]);
    let first = ["T", "k", "cos(1/2*T)", "sin(1/2*T)", "cos(T)", "sin(T)"];
    assert_eq!(found.system.symbols[..6], first);
    let (k, delay) = (0.7, 1.3);
    let values = BTreeMap::from([("k", k), ("T", delay)]);
    agrees(&found, 0, &values, &|s, small| {
        let loops = add(times(late(s, delay), k), mul(s, late(s, delay / 2.0)));
        add(add(mul(s, s), [1.0, 0.0]), times(loops, small))
    });
}

/// Two unknowns that are coupled by their delayed values, with rational and with irrational frequencies; the determinant of
/// the linear equations.
#[test]
fn two_unknowns() {
    for (text, square) in [
        ("y'' + 9/4*y + eps*(x(t - 3) - y(t - 2))", 2.25),
        ("y'' + 2*y + eps*(x(t - 3) - y(t - 2))", 2.0),
    ] {
        let found = flow(&["x'' + x + eps*(y(t - 1) + x'(t - 2)/3)", text], 4, &[]);
        let equation = |s: C, small: f64| {
            let square = |c: f64| add(mul(s, s), [c, 0.0]);
            let a = add(square(1.0), times(mul(s, late(s, 2.0)), small / 3.0));
            let b = add(square(square_of(&found)), times(late(s, 2.0), -small));
            let couples = times(mul(late(s, 1.0), late(s, 3.0)), -small * small);
            add(mul(a, b), couples)
        };
        assert!((square_of(&found) - square).abs() < 1e-14);
        for j in [0, 1] {
            agrees(&found, j, &BTreeMap::new(), &equation);
        }
    }
}

fn square_of(found: &SlowFlow) -> f64 {
    found.system.squares[1].to_f64()
}

/// Delays that turn phases by whole quarters leave no cosines: e^(-i pi) = -1, and T = pi is a number.
#[test]
fn quarters_of_a_turn() {
    let written = flow(&["x'' + x + eps*(k*x(t - pi) + x^3)"], 2, &[]);
    let given = flow(&["x'' + x + eps*(k*x(t - T) + x^3)"], 2, &[("T", "pi")]);
    assert_eq!(written.system.symbols, ["k", "pi"]);
    assert_eq!(written.flow, given.flow);
    let first: Vec<_> = written.flow[0][1].iter().map(|t| t.im.to_string()).collect();
    assert!(first.contains(&"-1/2".to_owned()), "{first:?}");
    // A quarter: f_1 = (i/2) k e^(-i pi/2) z = (k/2) z.
    let quarter = flow(&["x'' + x + eps*k*x(t - pi/2)"], 1, &[]);
    let parts: Vec<_> = quarter.flow[0][1].iter().map(|t| (t.re.clone(), t.im.clone())).collect();
    assert_eq!(parts, [(Rational::from((1, 2)), Rational::new())]);
    // Two eighths, by the characteristic root: f_2 = k^2 e^(-2iT) (T/4 - i/8) z = -k^2 (1/8 + i pi/16) z.
    let eighth = flow(&["x'' + x + eps*k*x(t - pi/4)"], 2, &[]);
    let place = eighth.factors().iter().position(|name| name == "pi").unwrap();
    let second =
        eighth.flow[0][2].iter().map(|t| (t.exponents[place], [t.re.clone(), t.im.clone()]));
    let by_hand = [(0, [(-1, 8), (0, 1)]), (1, [(0, 1), (-1, 16)])];
    let by_hand = by_hand.map(|(power, c)| (power, c.map(Rational::from)));
    assert_eq!(second.collect::<BTreeMap<_, _>>(), by_hand.into());
    // Three times a third of a turn.
    let common = flow(&["x'' + x + eps*(x(t - pi/3) + k*x(t - pi))"], 1, &[]);
    assert_eq!(common.system.symbols, ["k", "pi", "cos(1/3*pi)", "sin(1/3*pi)"]);
    assert_eq!(common.flow[0][1].iter().filter(|t| t.exponents[3] == 1).count(), 1);
}

/// sqrt(2) turns a phase of frequency sqrt(2) by the number 2, and sqrt(2) pi/4 by a quarter: f_1 = (i/(2 sqrt 2)) e^(-i pi/2) z =
/// sqrt(2)/4 z. Delays that are equal cancel however they are written.
#[test]
fn delays_in_roots() {
    let two = flow(&["x'' + 2*x + eps*x(t - sqrt(2)) = eps*cos(sqrt(2)*t)"], 1, &[]);
    assert_eq!(two.system.symbols, ["sqrt(2)", "cos(2)", "sin(2)"]);
    let linear = |delayed: &str| {
        let text = format!("x'' + 2*x + eps*({delayed}) = eps*cos(sqrt(2)*t)");
        let found = flow(&[&text], 1, &[]);
        let place = found.factors().iter().position(|name| name == "sqrt(2)").unwrap();
        let own = found.flow[0][1].iter().filter(|term| term.exponents[0] == 1);
        own.map(|t| (t.exponents[place], t.re.clone(), t.im.clone())).collect::<Vec<_>>()
    };
    assert_eq!(linear("x(t - sqrt(2)) - x(t - 2/sqrt(2))"), []);
    let quarter = (1, Rational::from((1, 4)), Rational::new());
    assert_eq!(linear("x(t - sqrt(2)*pi/4)"), [quarter]);
}

/// Delays 7/4 and 1/3 have the common unit 1/12: each turns by an angle of its own, not by the powers 21 and 4 of one.
/// Order one by hand: -g_1 = k x(t - 7/4) + h x(t - 1/3), f_1 = (i/2) (k e^(-7i/4) + h e^(-i/3)) z.
#[test]
fn a_small_common_unit() {
    let found = flow(&["x'' + x + eps*(k*x(t - 7/4) + h*x(t - 1/3))"], 1, &[]);
    let waves = ["cos(1/3)", "sin(1/3)", "cos(7/4)", "sin(7/4)"];
    assert_eq!(found.system.symbols, [&["h", "k"][..], &waves].concat());
    let parts = |term: &AmplitudeTerm| {
        let of = |q: &Rational| q.to_string();
        (term.exponents[3..].to_vec(), [of(&term.re), of(&term.im)])
    };
    let read: BTreeMap<_, _> = found.flow[0][1].iter().map(parts).collect();
    let mut known = BTreeMap::new();
    for (k, [re, im]) in [["0", "1/2"], ["1/2", "0"]].into_iter().enumerate() {
        for delay in [0, 1] {
            let mut exponents = vec![0; 6];
            exponents[delay] = 1;
            exponents[2 + 2 * delay + k] = 1;
            known.insert(exponents, [re.to_owned(), im.to_owned()]);
        }
    }
    assert_eq!(read, known);
}
