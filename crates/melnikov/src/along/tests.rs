//! Integrals along the orbit against the trapezoidal rule over time, which converges geometrically for them; the orbits are
//! written here once more.

use crate::hyperbolic::line_fourier;
use crate::{
    Branch, Damping, Factor, Forcing, Friction, Harmonic, PolynomialFriction, Potential, System,
};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::f64::consts::PI;

fn balls() -> Balls {
    Balls::new(120)
}

fn float(ball: &Ball) -> f64 {
    assert!(ball.radius().to_f64() < 1e-20, "{ball:?}");
    ball.midpoint().to_f64()
}

/// (x, x') at t on the orbit with a, b; the time of symmetry is 0.
fn orbit(potential: &Potential, t: f64) -> (f64, f64) {
    let values: Vec<f64> = potential.parameters().iter().map(|p| p.1.to_f64()).collect();
    let (a, b) = (values[0], values.get(1).copied().unwrap_or(1.0));
    match potential {
        Potential::DoubleWell { .. } => {
            let (z, x) = (a.sqrt() * t, (2.0 * a / b).sqrt() / (a.sqrt() * t).cosh());
            (x, -x * a.sqrt() * z.tanh())
        }
        Potential::SoftDuffing { .. } => {
            let (x, k) = ((a / b).sqrt(), (a / 2.0).sqrt());
            (x * (k * t).tanh(), x * k / (k * t).cosh().powi(2))
        }
        Potential::Helmholtz { .. } => {
            let k = a.sqrt() / 2.0;
            let x = 1.5 * a / b / (k * t).cosh().powi(2);
            (x, -2.0 * k * x * (k * t).tanh())
        }
        Potential::Pendulum { .. } => {
            let z = a.sqrt() * t;
            (4.0 * (z / 2.0).tanh().atan(), 2.0 * a.sqrt() / z.cosh())
        }
        _ => {
            let x = (1.0 + (-2.0 * a.sqrt() * t).exp()).sqrt().recip();
            (x, a.sqrt() * x * (1.0 - x * x))
        }
    }
}

/// int g(t, x, v) dt.
fn quadrature(potential: &Potential, g: &dyn Fn(f64, f64, f64) -> f64) -> f64 {
    let h = 0.05;
    let term = |n: i32| {
        let t = h * f64::from(n);
        let (x, v) = orbit(potential, t);
        h * g(t, x, v)
    };
    (-1000..=1000).map(term).sum()
}

fn value(factor: &Factor, x: f64) -> f64 {
    match factor {
        Factor::Power(n) => x.powi(*n as i32),
        Factor::Sine(k) => (k.to_f64() * x).sin(),
        Factor::Cosine(k) => (k.to_f64() * x).cos(),
    }
}

fn close(found: f64, expected: f64, size: f64, what: &str) {
    assert!((found - expected).abs() < 2e-11 * (1.0 + size), "{what}: {found} {expected}");
}

fn well(a: (i32, u32), b: (i32, u32)) -> Potential {
    Potential::DoubleWell { a: Exact::from(a), b: Exact::from(b) }
}

fn potentials() -> Vec<Potential> {
    let (a, b) = (|| Exact::from((17, 10)), || Exact::from((23, 10)));
    vec![
        well((17, 10), (23, 10)),
        Potential::SoftDuffing { a: a(), b: b() },
        Potential::Helmholtz { a: a(), b: b() },
        Potential::Pendulum { a: a() },
        Potential::PhiSix { a: a() },
    ]
}

fn factors(potential: &Potential) -> Vec<Factor> {
    let mut list: Vec<Factor> = (0..6).map(Factor::Power).collect();
    if matches!(potential, Potential::Pendulum { .. }) {
        for k in [-3, 1, 2, 3, 4] {
            let k = Rational::from((k, 2));
            list.extend([Factor::Sine(k.clone()), Factor::Cosine(k)]);
        }
    }
    list
}

#[test]
fn moments_against_quadrature() {
    for potential in potentials() {
        for factor in factors(&potential) {
            assert!(potential.takes_damping(&factor));
            for n in 1..5 {
                let found = float(&potential.moment(balls(), &factor, n).unwrap());
                let g = |_: f64, x: f64, v: f64| value(&factor, x) * v.powi(n as i32);
                let size = quadrature(&potential, &|t, x, v| g(t, x, v).abs());
                let what = format!("{potential:?} {factor:?} {n}");
                close(found, quadrature(&potential, &g), size, &what);
            }
            assert!(potential.moment(balls(), &factor, 0).is_none());
        }
    }
    let sine = Factor::Sine(Rational::from(1));
    assert!(well((1, 1), (1, 1)).moment(balls(), &sine, 1).is_none());
    let third = Factor::Sine(Rational::from((1, 3)));
    assert!(!Potential::Pendulum { a: Exact::from(1) }.takes_damping(&third));
}

#[test]
fn transforms_against_quadrature() {
    for potential in potentials() {
        for factor in factors(&potential) {
            if !potential.takes_force(&factor) {
                let pendulum = matches!(potential, Potential::Pendulum { .. });
                assert!(pendulum && matches!(factor, Factor::Power(1..)));
                assert!(potential.transform(balls(), &factor, &balls().one()).is_none());
                continue;
            }
            let w = balls().from_rational(&Rational::from((13, 10)));
            let (c, s) = potential.transform(balls(), &factor, &w).unwrap();
            let part = |trig: fn(f64) -> f64| {
                quadrature(&potential, &|t, x, v| value(&factor, x) * v * trig(1.3 * t))
            };
            let what = format!("{potential:?} {factor:?}");
            close(float(&c), part(f64::cos), 1.0, &what);
            close(float(&s), part(f64::sin), 1.0, &what);
        }
    }
}

/// With G' = g, int v g(x) e^{i omega t} dt = -i omega int (G(x) - G(saddle)) e^{i omega t} dt: for x^n in the well
/// with a = b = 1 the amplitude omega 2^((n+1)/2) C_(n+1)(omega)/(n+1).
#[test]
fn one_moment_of_a_polynomial_serves_all_forces() {
    let potential = well((1, 1), (1, 1));
    let w = balls().from_rational(&Rational::from((7, 5)));
    for n in 0..8u32 {
        let (c, s) = potential.transform(balls(), &Factor::Power(n), &w).unwrap();
        assert!(c.is_exact() && c.contains_zero());
        let root =
            balls().powi(&balls().sqrt(&balls().from_i64(2)).unwrap(), i64::from(n) + 1).unwrap();
        let form = line_fourier(n + 1, 0).unwrap().ball(balls(), &w).unwrap();
        let closed = balls().mul(&balls().mul(&w, &root), &form);
        let closed = balls().div_i64(&closed, i64::from(n) + 1).unwrap();
        assert!(balls().abs(&s).overlaps(&closed) && closed.relative_accuracy_bits() > 90, "{n}");
    }
}

/// Takens and Carr: mu = 4/5; Bogdanov and Takens, y = 2 - u: tau = 24/7 - 2 = 10/7.
#[test]
fn the_autonomous_problems() {
    let ratio = |potential: &Potential, m: u32| {
        let of = |m| potential.moment(balls(), &Factor::Power(m), 2).unwrap();
        balls().div(&of(m), &of(0)).unwrap()
    };
    let (carr, takens) = (well((1, 1), (1, 1)), Exact::from(4));
    let takens = Potential::Helmholtz { a: takens, b: Exact::from(1) };
    for (ball, q) in [(ratio(&carr, 2), (4, 5)), (ratio(&takens, 1), (24, 7))] {
        let error = balls().sub(&ball, &balls().from_rational(&Rational::from(q)));
        assert!(error.contains_zero() && error.radius().to_f64() < 1e-30);
    }
}

fn damped(potential: Potential, forcing: Forcing, damping: Vec<Damping>) -> System {
    let none = PolynomialFriction { dry: Exact::from(0), coefficients: Vec::new() };
    let friction = Friction::Polynomial(none);
    let system = System::new(potential, friction, forcing, Exact::from(0)).unwrap();
    system.damped(damping).unwrap()
}

fn term(factor: Factor, velocity: u32, coefficient: (i32, u32)) -> Damping {
    Damping { factor, velocity, coefficient: Exact::from(coefficient) }
}

/// x'' + sin x = eps (gamma sin x cos omega t - delta x'): gamma_c = 4 delta sinh(pi omega/2)/(pi omega^2).
#[test]
fn the_parametric_pendulum() {
    let (sine, omega) = (Factor::Sine(Rational::from(1)), 1.3f64);
    let forcing = Forcing::multiplied(Exact::from((13, 10)), sine);
    let potential = Potential::Pendulum { a: Exact::from(1) };
    let system = damped(potential, forcing, vec![term(Factor::ONE, 1, (1, 5))]);
    let closed = 4.0 * 0.2 * (PI * omega / 2.0).sinh() / (PI * omega * omega);
    for branch in [Branch::Positive, Branch::Negative] {
        let found = system.threshold(balls(), branch).unwrap();
        assert!((float(&found.gamma) - closed).abs() < 1e-13, "{closed}");
    }
}

/// M(t0) on a branch, integrated directly.
fn scan(
    potential: &Potential,
    branch: Branch,
    force: &dyn Fn(f64, f64) -> f64,
    damping: &[Damping],
    t0: f64,
) -> f64 {
    let sign = branch.sign() as f64;
    quadrature(potential, &|t, x, v| {
        let (x, v) = (sign * x, sign * v);
        let friction: f64 = damping
            .iter()
            .map(|d| d.coefficient.to_f64() * value(&d.factor, x) * v.powi(d.velocity as i32))
            .sum();
        v * (force(x, t + t0) - friction)
    })
}

/// Forces of one frequency with factors of both parities, friction of all: the extremes of M are where the
/// threshold says, on both branches.
#[test]
fn phases_of_several_factors_are_not_lost() {
    let harmonic = |factor: Factor, weight: (i32, u32), phase: (i32, u32)| {
        let (weight, phase) = (Exact::from(weight), Exact::from(phase));
        Harmonic { number: 1, weight, phase, factor }
    };
    for potential in potentials() {
        let second = match potential {
            Potential::Pendulum { .. } => Factor::Sine(Rational::from(1)),
            _ => Factor::Power(1),
        };
        let harmonics = vec![
            harmonic(Factor::ONE, (1, 1), (0, 1)),
            harmonic(second.clone(), (-4, 5), (3, 10)),
            harmonic(Factor::Power(0), (1, 2), (-7, 10)),
        ];
        let force = |x: f64, t: f64| {
            let t = 1.1 * t;
            t.cos() + 0.5 * (t - 0.7).cos() - 0.8 * value(&second, x) * (t + 0.3).cos()
        };
        let forcing = Forcing::Harmonics { omega: Exact::from((11, 10)), harmonics };
        let damping = vec![
            term(Factor::Power(2), 1, (3, 10)),
            term(Factor::Power(1), 2, (-1, 5)),
            term(Factor::Power(1), 0, (1, 10)),
            term(second.clone(), 1, (1, 7)),
        ];
        let system = damped(potential.clone(), forcing, damping.clone());
        for branch in [Branch::Positive, Branch::Negative] {
            if branch == Branch::Negative && !potential.has_mirror_image() {
                continue;
            }
            let found = system.threshold(balls(), branch).unwrap();
            let none = |_: f64, _: f64| 0.0;
            let d = -scan(&potential, branch, &none, &damping, 0.0);
            close(float(&found.dissipation), d, 1.0, &format!("{potential:?} {branch:?}"));
            let period = 2.0 * PI / 1.1;
            let work = |n: i32| scan(&potential, branch, &force, &[], period * f64::from(n) / 24.0);
            // A harmonic is known by its values at three phases a third of a period apart.
            let [p, q, r] = [work(0), work(8), work(16)];
            let amplitude = (2.0 / 3.0 * (p * p + q * q + r * r)).sqrt();
            assert!((p + q + r).abs() < 1e-12);
            close(float(&found.forcing), amplitude, 1.0, &format!("{potential:?} {branch:?}"));
            let (m, _) =
                system.melnikov(balls(), branch, &Exact::from(2), &Exact::from((1, 3))).unwrap();
            let expected = 2.0 * scan(&potential, branch, &force, &[], 1.0 / 3.0) - d;
            close(float(&m), expected, 1.0, "M");
        }
    }
}

/// Frequencies without a common period: the extremes of the parts add, each with its own factors.
#[test]
fn independent_frequencies() {
    let potential = well((1, 1), (1, 1));
    let one = |omega: Exact, factor| Forcing::multiplied(omega, factor);
    let list = [
        one(Exact::from(1), Factor::Power(2)),
        one(Exact::PiTimes(Rational::from(1)), Factor::Power(1)),
    ];
    let amplitude = |forcing: Forcing| {
        let system = damped(potential.clone(), forcing, vec![term(Factor::ONE, 1, (1, 1))]);
        float(&system.threshold(balls(), Branch::Positive).unwrap().forcing)
    };
    let parts: Vec<_> = list
        .iter()
        .flat_map(|f| f.parts().map(|(omega, list)| (omega.clone(), list.to_vec())))
        .collect();
    let sum: f64 = list.iter().cloned().map(amplitude).sum();
    assert!((amplitude(Forcing::Incommensurate(parts)) - sum).abs() < 1e-14);
}
