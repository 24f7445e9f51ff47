//! The series against collocation, and enclosures against exact numbers.

use crate::residual::tests::wright;
use crate::{DelayEquation, Factor, HopfCycle, HopfError, HopfSettings, Term, cycle};
use lindstedt_equation::Expression;
use std::f64::consts::FRAC_PI_2;

fn found(equation: &DelayEquation<Expression>, near: f64, order: usize) -> HopfCycle {
    let settings = HopfSettings { unknown: "alpha".into(), near, order, digits: 20 };
    cycle(equation, &settings, &mut |_| true).unwrap()
}

fn values(list: &[crate::Coefficient]) -> Vec<f64> {
    list.iter().map(|c| c.number.decimal.parse().unwrap()).collect()
}

fn constant(q: (i32, i32)) -> Vec<Expression> {
    vec![Expression::Number(q.into())]
}

fn term(coefficient: Vec<Expression>, factors: &[(u32, usize)]) -> Term<Expression> {
    let factor = |&(derivative, delay): &(u32, usize)| Factor { derivative, delay };
    Term { coefficient, factors: factors.iter().map(factor).collect() }
}

/// Solves the linear system by Gauss with pivots.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let row = a[k].clone();
            a[i].iter_mut().zip(&row).for_each(|(x, y)| *x -= factor * y);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let rest: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - rest) / a[k][k];
    }
    b
}

/// (alpha, omega) of the cycle of Wright's equation with the first harmonic 2 eps cos s: Newton's method for its
/// values at the nodes of one period, sines and cosines of which interpolate them. No series, no complex number.
fn collocation(eps: f64) -> [f64; 2] {
    const M: usize = 12;
    const NODES: usize = 2 * M + 1;
    // x = c_0 + 2 eps cos s + sum_(k >= 2) a_k cos ks + b_k sin ks.
    let wave = |y: &[f64], s: f64| {
        let mut sums = [y[0] + 2.0 * eps * s.cos(), -2.0 * eps * s.sin()];
        for k in 2..=M {
            let (sin, cos) = (k as f64 * s).sin_cos();
            let [a, b] = [y[2 * k - 3], y[2 * k - 2]];
            sums[0] += a * cos + b * sin;
            sums[1] += k as f64 * (b * cos - a * sin);
        }
        sums
    };
    let residual = |y: &[f64]| -> Vec<f64> {
        let [alpha, omega] = [y[NODES - 2], y[NODES - 1]];
        let at = |j: usize| {
            let s = std::f64::consts::TAU * j as f64 / NODES as f64;
            let ([x, slope], [late, _]) = (wave(y, s), wave(y, s - omega));
            omega * slope + alpha * late * (1.0 + x)
        };
        (0..NODES).map(at).collect()
    };
    let mut y = vec![0.0; NODES];
    (y[NODES - 2], y[NODES - 1]) = (FRAC_PI_2, FRAC_PI_2);
    for _ in 0..12 {
        let r = residual(&y);
        let column = |j: usize| -> Vec<f64> {
            let shifted = |h: f64| {
                let mut moved = y.clone();
                moved[j] += h;
                residual(&moved)
            };
            let (up, down) = (shifted(1e-5), shifted(-1e-5));
            up.iter().zip(&down).map(|(a, b)| (a - b) / 2e-5).collect()
        };
        let columns: Vec<_> = (0..NODES).map(column).collect();
        let rows = (0..NODES).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
        let step = solve(rows, r);
        y.iter_mut().zip(&step).for_each(|(y, d)| *y -= d);
    }
    [y[NODES - 2], y[NODES - 1]]
}

/// Cut after eps^2 and eps^4 the errors fall like eps^4 and eps^6.
#[test]
fn wright_against_collocation() {
    let found = found(&wright(), 0.0, 4);
    assert!(found.exact);
    let both = [values(&found.parameter), values(&found.frequency)];
    let errors = |eps: f64| -> Vec<f64> {
        let truth = collocation(eps);
        let of = |n: usize, which: usize| {
            let sum: f64 = (0..=n).map(|k| both[which][k] * eps.powi(k as i32)).sum();
            (sum - truth[which]).abs()
        };
        vec![of(2, 0), of(2, 1), of(4, 0), of(4, 1)]
    };
    // Another collocation, by fsolve over complex Fourier coefficients, at eps = 0.1.
    let [alpha, omega] = collocation(0.1);
    assert!((alpha - 1.578277141759863).abs() < 1e-13, "{alpha}");
    assert!((omega - 1.5687744870465221).abs() < 1e-13, "{omega}");
    let all = [0.4, 0.2, 0.1].map(errors);
    for pair in all.windows(2) {
        let slopes: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a / b).log2()).collect();
        for (slope, expected) in slopes.iter().zip([4.0, 4.0, 6.0, 6.0]) {
            assert!((slope - expected).abs() < 0.45, "{slopes:?} {all:?}");
        }
    }
}

/// The same point with the number pi/2 hidden in the delay and in a square: T = 1, x' + alpha^2 x(t - 1)(1 + x) has
/// beta = alpha^2, an irrational parameter, so that all is enclosed; and a delay that is sought.
#[test]
fn enclosures_hold_the_exact_numbers() {
    let exact = found(&wright(), 0.0, 4);
    let mut squared = wright();
    for term in &mut squared.terms[1..] {
        term.coefficient = [0, 0, 1].map(Expression::integer).to_vec();
    }
    let enclosed = found(&squared, 1.2, 4);
    assert!(!enclosed.exact && enclosed.checked_orders == Some(5));
    assert!(enclosed.parameter.iter().all(|c| c.number.exact.is_none() || c.number.decimal == "0"));
    // alpha^2 = beta: 2 alpha_0 alpha_2 = beta_2, 2 alpha_0 alpha_4 + alpha_2^2 = beta_4.
    let (a, b) = (values(&enclosed.parameter), values(&exact.parameter));
    assert!((a[0] * a[0] - b[0]).abs() < 1e-15 && (2.0 * a[0] * a[2] - b[2]).abs() < 1e-15);
    assert!((2.0 * a[0] * a[4] + a[2] * a[2] - b[4]).abs() < 1e-15);
    assert_eq!(values(&enclosed.frequency), values(&exact.frequency));
    // x' + x(t - tau)(1 + x): time in units of tau makes it Wright's, so tau = alpha and omega tau is its omega.
    let mut late = wright();
    late.delays[1] = [0, 1].map(Expression::integer).to_vec();
    for term in &mut late.terms[1..] {
        term.coefficient = constant((1, 1));
    }
    let late = found(&late, 1.0, 4);
    assert!(late.exact);
    let exact_of = |list: &[crate::Coefficient]| -> Vec<_> {
        list.iter().map(|c| c.number.exact.clone().unwrap()).collect()
    };
    assert_eq!(exact_of(&late.parameter), exact_of(&exact.parameter));
    let (tau, omega) = (values(&late.parameter), values(&late.frequency));
    for (n, whole) in values(&exact.frequency).iter().enumerate() {
        let product: f64 = (0..=n).map(|k| tau[k] * omega[n - k]).sum();
        assert!((product - whole).abs() < 1e-14, "{n}");
    }
}

/// x'' - alpha x' + x + x^2 x' is van der Pol's oscillator for x/sqrt(alpha): the amplitude of its first harmonic is
/// 2 sqrt(alpha) in leading order, omega = 1 - alpha^2/16 + ... (Andersen and Geer 1982).
#[test]
fn van_der_pol_without_delay() {
    let equation = DelayEquation {
        order: 2,
        delays: vec![constant((0, 1))],
        terms: vec![
            term(constant((1, 1)), &[(2, 0)]),
            term([0, -1].map(Expression::integer).to_vec(), &[(1, 0)]),
            term(constant((1, 1)), &[(0, 0)]),
            term(constant((1, 1)), &[(0, 0), (0, 0), (1, 0)]),
        ],
    };
    let found = found(&equation, 0.0, 4);
    assert!(found.exact && found.is_stable() == Some(true));
    assert_eq!(values(&found.parameter)[..4], [0.0, 0.0, 1.0, 0.0]);
    assert_eq!(values(&found.frequency), [1.0, 0.0, 0.0, 0.0, -0.0625]);
    let law = found.law.unwrap();
    assert_eq!((law.order, law.floquet_exponent.number.exact.as_deref()), (2, Some("-1")));
}

/// The cycles of a linear equation have every size: no law. No point where no pair of roots reaches the axis, or where
/// it stays there.
#[test]
fn what_has_no_answer() {
    let linear = DelayEquation { terms: wright().terms[..2].to_vec(), ..wright() };
    let cycle_of = |equation: &DelayEquation<Expression>| {
        let settings = HopfSettings { unknown: "alpha".into(), near: 0.0, order: 2, digits: 10 };
        cycle(equation, &settings, &mut |_| true)
    };
    let of_linear = cycle_of(&linear).unwrap();
    assert!(of_linear.law.is_none() && of_linear.is_stable().is_none());
    // x' + (1 + alpha^2) x: the root is real.
    let decays = DelayEquation {
        terms: vec![
            term(constant((1, 1)), &[(1, 0)]),
            term([1, 0, 1].map(Expression::integer).to_vec(), &[(0, 0)]),
        ],
        ..wright()
    };
    assert!(matches!(cycle_of(&decays), Err(HopfError::NoPoint { .. })));
    // x'' + (1 + alpha) x: the roots stay on the axis.
    let stays = DelayEquation {
        order: 2,
        delays: vec![constant((0, 1))],
        terms: vec![
            term(constant((1, 1)), &[(2, 0)]),
            term([1, 1].map(Expression::integer).to_vec(), &[(0, 0)]),
        ],
    };
    assert_eq!(cycle_of(&stays).err(), Some(HopfError::Even));
    // x'' + x + alpha x^2: none moves.
    let mut still = stays;
    still.terms[1] = term(constant((1, 1)), &[(0, 0)]);
    still.terms.push(term([0, 1].map(Expression::integer).to_vec(), &[(0, 0); 2]));
    let unknown = "alpha".to_owned();
    assert_eq!(cycle_of(&still).err(), Some(HopfError::Still { unknown }));
    // x'' + alpha x'(t - 1) + x'^3: L(0) = 0 for every alpha, twice at alpha = 0, and the cycle at pi/2 has any mean.
    let translated = DelayEquation {
        order: 2,
        delays: vec![constant((0, 1)), constant((1, 1))],
        terms: vec![
            term(constant((1, 1)), &[(2, 0)]),
            term([0, 1].map(Expression::integer).to_vec(), &[(1, 1)]),
            term(constant((1, 1)), &[(1, 0); 3]),
        ],
    };
    let at = |near| {
        let settings = HopfSettings { unknown: "alpha".into(), near, order: 2, digits: 20 };
        cycle(&translated, &settings, &mut |_| true).err()
    };
    assert!(matches!(at(0.0), Some(HopfError::ZeroRoot { .. })), "{:?}", at(0.0));
    assert_eq!(at(1.6), Some(HopfError::Resonant { harmonic: 0 }));
    // x'' + x - alpha (x' - x'^3) with a delay alpha in a term of third degree: the point alpha = 0 has no sign of it.
    let meets = DelayEquation {
        order: 2,
        delays: vec![constant((0, 1)), [0, 1].map(Expression::integer).to_vec()],
        terms: vec![
            term(constant((1, 1)), &[(2, 0)]),
            term(constant((1, 1)), &[(0, 0)]),
            term([0, -1].map(Expression::integer).to_vec(), &[(1, 0)]),
            term(constant((1, 1)), &[(0, 0), (0, 0), (1, 1)]),
        ],
    };
    assert!(matches!(cycle_of(&meets), Err(HopfError::UndecidedDelay { .. })));
    // x'(t - 1) as heavy as x'.
    let mut neutral = wright();
    neutral.terms.push(term(constant((1, 1)), &[(1, 1)]));
    assert_eq!(cycle_of(&neutral).err(), Some(HopfError::Unbounded));
}

/// x' +- alpha x(t - 1) +- x^3: the cubic term decides whether the cycle attracts, the sign of alpha on which side it
/// lives.
#[test]
fn sides_and_criticality() {
    for (alpha, cubic) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
        let mut equation = wright();
        equation.terms[1].coefficient = [0, alpha].map(Expression::integer).to_vec();
        equation.terms[2] = term(vec![Expression::integer(cubic)], &[(0, 0); 3]);
        let found = found(&equation, 1.2 * alpha as f64, 2);
        let law = found.law.clone().unwrap();
        assert_eq!((law.above, law.supercritical), (alpha == cubic, cubic == 1));
        assert_eq!(found.is_stable(), Some(cubic == 1));
        let beta: f64 = law.floquet_exponent.number.decimal.parse().unwrap();
        assert_eq!(beta < 0.0, cubic == 1);
    }
}

/// x'' + x = alpha x' - x^2 x'(t - 1) at alpha = 0: omega_0 = 1 is rational, but the delay turns by cos 1, sin 1. With
/// x = 2 eps cos s the first harmonic of x^2 x'(t - 1) has -2 eps^3 cos 1 sin s, so alpha_2 = cos 1.
#[test]
fn turns_outside_of_the_field_are_enclosed() {
    let integer = Expression::integer;
    let equation = DelayEquation {
        order: 2,
        delays: vec![vec![integer(0)], vec![integer(1)]],
        terms: vec![
            term(constant((1, 1)), &[(2, 0)]),
            term(constant((1, 1)), &[(0, 0)]),
            term(vec![integer(0), integer(-1)], &[(1, 0)]),
            term(constant((1, 1)), &[(0, 0), (0, 0), (1, 1)]),
        ],
    };
    let cycle = found(&equation, 0.0, 2);
    assert!(!cycle.exact);
    assert!((values(&cycle.parameter)[2] - 1f64.cos()).abs() < 1e-12, "{cycle:?}");
    // All digits of x_3 = (sin 1 cos 3s)/4 - (cos 1 sin 3s)/4.
    let printed = "0.21036774620197412666*cos(3*s) - 0.13507557646703492935*sin(3*s)";
    assert_eq!(cycle.solution[2][0], printed);
}
