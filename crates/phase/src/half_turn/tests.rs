//! Known flows, and the equation itself integrated over a half turn.

use super::{FrictionTerm, HalfTurn, HalfTurnExpansion, HalfTurnMonomial};
use lindstedt_algebra::Stop;
use lindstedt_coeff::{PowerProduct, Symbol};
use rug::Rational;
use std::f64::consts::PI;

fn term(factor: i32, displacement: usize, velocity: usize) -> FrictionTerm {
    let factors = vec![HalfTurn::constant(factor.into(), PowerProduct::default())];
    FrictionTerm { factors, displacement, velocity }
}

fn average_half_turn(law: &[FrictionTerm], order: usize) -> HalfTurnExpansion {
    let found = super::average_half_turn(law, order, &Stop::default(), &mut |_, _| true);
    assert_eq!(found.checked_orders(law), order);
    found
}

fn exact(numerator: i32, denominator: i32, amplitude: i32, pi: i16) -> HalfTurn {
    let constants = PowerProduct::power(Symbol::Pi, pi);
    let monomial = HalfTurnMonomial { amplitude, constants, ..HalfTurnMonomial::default() };
    HalfTurn::monomial(monomial, Rational::from((numerator, denominator)))
}

/// Classical Runge-Kutta over `length` in 400 steps.
fn integrate(mut y: [f64; 2], length: f64, f: impl Fn([f64; 2]) -> [f64; 2]) -> [f64; 2] {
    let h = length / 400.0;
    let along = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
    for _ in 0..400 {
        let k1 = f(y);
        let k2 = f(along(y, k1, h / 2.0));
        let k3 = f(along(y, k2, h / 2.0));
        let k4 = f(along(y, k3, h));
        for i in 0..2 {
            y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    y
}

/// The amplitude after a half turn from a = 1 and the time it takes, by the slow flow.
fn half_turn(found: &HalfTurnExpansion, eps: f64) -> [f64; 2] {
    let sum = |series: &[HalfTurn], a: f64| {
        series.iter().rev().fold(0.0, |sum, rate| sum * eps + rate.value(a, 0.0, &[]))
    };
    integrate([1.0, 0.0], PI, |[a, _]| {
        let phase_rate = 1.0 + sum(&found.phase_rate, a);
        [sum(&found.amplitude_rate, a) / phase_rate, 1.0 / phase_rate]
    })
}

#[test]
fn dry_friction_has_no_higher_orders() {
    let found = average_half_turn(&[term(-1, 0, 0)], 10);
    assert_eq!(found.amplitude_rate[1], exact(-2, 1, 0, -1));
    assert!(found.amplitude_rate[2..].iter().chain(&found.phase_rate).all(HalfTurn::is_zero));
    assert!(found.solution[2..].iter().all(HalfTurn::is_zero));
}

#[test]
fn quadratic_friction_obeys_the_half_turn_law() {
    let found = average_half_turn(&[term(-1, 0, 2)], 4);
    assert_eq!(found.amplitude_rate[1], exact(-4, 3, 2, -1));
    // The half period pi (1 + eps^2 a^2/6 + ...).
    assert!(found.phase_rate[1].is_zero());
    assert_eq!(found.phase_rate[2], exact(-1, 6, 2, 0));
    // Time backwards is eps with the other sign: a' is odd in eps, psi' even.
    assert!(found.amplitude_rate[2].is_zero() && found.amplitude_rate[4].is_zero());
    assert!(found.phase_rate[3].is_zero());
    // (1 + 2 eps a_0) e^{-2 eps a_0} = (1 - 2 eps a_1) e^{2 eps a_1}; divided by 4 eps^2 the
    // difference of the sides is that of a_1, of order N + 1.
    let defect = |eps: f64| {
        let [after, _] = half_turn(&found, eps);
        let side = |a: f64| (1.0 + 2.0 * eps * a) * (-2.0 * eps * a).exp();
        (side(1.0) - side(-after)) / (4.0 * eps * eps)
    };
    let slope = (defect(0.04) / defect(0.02)).log2();
    assert!((slope - 5.0).abs() < 0.5, "{slope}");
}

#[test]
fn mixed_laws_agree_with_the_equation_over_a_half_turn() {
    // x' + x^3 + sign x', and x'|x'| + x^2 sign x' - x.
    let laws = [vec![term(1, 0, 1), term(1, 3, 0), term(-1, 0, 0)], {
        vec![term(-1, 0, 2), term(-1, 2, 0), term(-1, 1, 0)]
    }];
    for law in laws {
        let found = average_half_turn(&law, 4);
        let miss = |eps: f64| {
            let [after, time] = half_turn(&found, eps);
            let [x, v] = integrate([1.0, 0.0], time, |[x, v]| {
                let mut h = 0.0;
                for term in &law {
                    let powers = [term.displacement, term.velocity].map(|power| power as f64);
                    h += term.factors[0].value(1.0, 0.0, &[])
                        * x.powf(powers[0])
                        * v.powf(powers[1]);
                }
                [v, -x - eps * h]
            });
            (x + after).hypot(v)
        };
        let slope = (miss(0.04) / miss(0.02)).log2();
        assert!((slope - 5.0).abs() < 0.5, "{slope}");
    }
}

#[test]
fn the_equation_holds_at_points_of_the_half_turn() {
    // x' and x'' of the finished expansion by the chain rule, in numbers and not order by order.
    let found = average_half_turn(&[term(1, 0, 1), term(-1, 0, 2)], 3);
    let defect = |eps: f64, psi: f64| {
        let sum = |series: &[HalfTurn], f: &dyn Fn(&HalfTurn) -> HalfTurn| {
            series.iter().rev().fold(0.0, |sum, u| sum * eps + f(u).value(1.0, psi, &[]))
        };
        let (same, da, dpsi) = (HalfTurn::clone, HalfTurn::by_amplitude, HalfTurn::by_phase);
        let u = &found.solution;
        let drift = sum(&found.amplitude_rate, &same);
        let drift_by_a = sum(&found.amplitude_rate, &da);
        let turning = 1.0 + sum(&found.phase_rate, &same);
        let turning_by_a = sum(&found.phase_rate, &da);
        let v = drift * sum(u, &da) + turning * sum(u, &dpsi);
        let acceleration = drift * drift * sum(u, &|u| u.by_amplitude().by_amplitude())
            + 2.0 * drift * turning * sum(u, &|u| u.by_amplitude().by_phase())
            + turning * turning * sum(u, &|u| u.by_phase().by_phase())
            + drift * (drift_by_a * sum(u, &da) + turning_by_a * sum(u, &dpsi));
        (acceleration + sum(u, &same) + eps * (v - v * v)).abs()
    };
    for psi in [0.7, 1.9, 2.8] {
        let slope = (defect(0.01, psi) / defect(0.005, psi)).log2();
        assert!((slope - 4.0).abs() < 0.5, "{psi}: {slope}");
    }
}

#[test]
fn a_wrong_rate_leaves_a_residual() {
    let law = [term(1, 0, 1), term(-1, 0, 2)];
    let mut found = average_half_turn(&law, 3);
    found.phase_rate[2] = exact(-1, 6, 2, 0);
    assert_eq!(found.checked_orders(&law), 1);
    // Turning points that are not at the amplitude leave none in the equation.
    let mut found = average_half_turn(&law, 3);
    found.solution[3] = HalfTurn::default();
    assert_eq!(found.checked_orders(&law), 2);
}

#[test]
fn factors_stay_symbols_and_have_orders() {
    // eps (m x' + x'|x'|) + eps^2 k x^3 against its values at m = 2, k = -1.
    let symbol = |index| PowerProduct::power(Symbol::Parameter(index), 1);
    let factor = |index| HalfTurn::constant(1.into(), symbol(index));
    let law = |first: HalfTurn, second: HalfTurn| {
        let [velocity, displacement] =
            [vec![first], vec![HalfTurn::default(), second]].map(term_of);
        let velocity = FrictionTerm { velocity: 1, ..velocity };
        [velocity, FrictionTerm { displacement: 3, ..displacement }, term(-1, 0, 2)]
    };
    let open = average_half_turn(&law(factor(0), factor(1)), 3);
    let number = |n: i32| HalfTurn::constant(n.into(), PowerProduct::default());
    let closed = average_half_turn(&law(number(2), number(-1)), 3);
    for (open, closed) in open.solution.iter().zip(&closed.solution) {
        let [open, closed] = [open, closed].map(|u| u.value(0.7, 1.3, &[2.0, -1.0]));
        assert!((open - closed).abs() < 1e-13, "{open} {closed}");
    }
    // 3/8 k a^2 from x^3, -1/8 m^2 from m x'.
    let [_, _, second, ..] = &open.phase_rate[..] else { panic!() };
    let cubic = HalfTurnMonomial { amplitude: 2, constants: symbol(1), ..Default::default() };
    assert_eq!(second.0[&cubic], [Rational::from((3, 8)), Rational::new()]);
}

fn term_of(factors: Vec<HalfTurn>) -> FrictionTerm {
    FrictionTerm { factors, displacement: 0, velocity: 0 }
}

#[test]
fn stopped_work_keeps_the_orders_that_are_finished() {
    use std::sync::atomic::{AtomicU32, Ordering};
    let law = [term(1, 0, 1), term(-1, 0, 2)];
    let whole = average_half_turn(&law, 4);
    let left = AtomicU32::new(100);
    let stop = Stop::new(move || left.fetch_sub(1, Ordering::Relaxed) == 0);
    let found = super::average_half_turn(&law, 4, &stop, &mut |_, _| true);
    let orders = found.solution.len();
    assert!((2..5).contains(&orders), "{orders}");
    assert_eq!(found.solution[..], whole.solution[..orders]);
    assert_eq!((found.phase_rate.len(), found.checked_orders(&law)), (orders, 0));
}
