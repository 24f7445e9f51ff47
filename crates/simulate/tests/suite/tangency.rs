//! Homoclinic tangencies of the stick-slip oscillator: small eps against Melnikov's threshold,
//! eps = 1 against an independent event code (five digits known).

use crate::common::{parameters, stick_slip};
use lindstedt_equation::{Expression, Function};
use lindstedt_simulate::{
    Doubles, Homoclinic, Loop, Model, Parameters, Settings, SimulateError, Tangency,
    continue_tangency, go_on, saddle,
};
use std::f64::consts::PI;
use std::ops::ControlFlow;

fn with_loop<T>(eps: &str, side: Loop, work: impl FnOnce(&Homoclinic<'_>) -> T) -> T {
    let (model, parameters) = (stick_slip(), parameters(&[("eps", eps)]));
    let eps: f64 = eps.parse().unwrap();
    let guess = [-0.35 * eps, 0.0];
    let (model, parameters) = (&model, &parameters);
    work(&Homoclinic { model, parameters, name: "gamma", period: PI, side, guess })
}

fn tangency(eps: &str, side: Loop, bracket: (f64, f64), count: u32) -> Tangency {
    with_loop(eps, side, |homoclinic| homoclinic.first_tangency(bracket, count, &go_on)).unwrap()
}

/// |G| cosh(pi omega/2)/(pi omega) with G = 2 T0 sqrt(1 - y) - 4/3 V (alpha - 3 beta vstar^2)
/// + 32/35 beta V^3, V = 1/sqrt 2, y = vstar/V: the zeros of Melnikov's function at a = b = 1.
fn threshold() -> f64 {
    let (t0, alpha, beta, omega, vstar) = (0.3, 0.3, 0.3, 2.0, 0.4f64);
    let v = 0.5f64.sqrt();
    let g = 2.0 * t0 * (1.0 - vstar / v).sqrt()
        - 4.0 / 3.0 * v * (alpha - 3.0 * beta * vstar * vstar)
        + 32.0 / 35.0 * beta * v.powi(3);
    g.abs() * (PI * omega / 2.0).cosh() / (PI * omega)
}

/// gamma = threshold +- c eps + O(eps^2) on the two loops: the mean converges like eps^2.
#[test]
fn both_loops_tend_to_the_threshold() {
    let mut errors = Vec::new();
    for eps in ["0.01", "0.005"] {
        let [right, left] =
            [Loop::Right, Loop::Left].map(|side| tangency(eps, side, (0.62, 0.65), 24));
        let eps: f64 = eps.parse().unwrap();
        println!("{eps} {right:?} {left:?}");
        assert!((right.value - threshold()).abs() < 0.21 * eps);
        assert!((left.value - threshold()).abs() < 0.21 * eps);
        assert!(right.error < 1e-10 && left.error < 1e-10);
        errors.push((right.value + left.value) / 2.0 - threshold());
    }
    println!("{errors:?}");
    let slope = (errors[0] / errors[1]).log2();
    assert!(errors[1].abs() < 1e-5 && (slope - 2.0).abs() < 0.05, "{slope}");
}

#[test]
fn first_tangencies_at_eps_one() {
    let right = tangency("1", Loop::Right, (1.1, 1.115), 48);
    let left = tangency("1", Loop::Left, (0.595, 0.61), 48);
    println!("{right:?} {left:?}");
    assert!((right.value - 1.10867).abs() < 5e-6, "{right:?}");
    assert!((left.value - 0.60227).abs() < 5e-6, "{left:?}");
}

/// The left loop is tangled between .1456 and .3476 already.
#[test]
fn an_earlier_pair_on_the_left() {
    let (model, parameters) = (stick_slip(), parameters(&[]));
    let (model, parameters) = (&model, &parameters);
    for (bracket, known, guess) in
        [((0.12, 0.17), 0.1456, [-0.25, 0.0]), ((0.32, 0.37), 0.3476, [-0.28, -0.008])]
    {
        let (period, side) = (PI, Loop::Left);
        let left = Homoclinic { model, parameters, name: "gamma", period, side, guess };
        let tangency = left.first_tangency(bracket, 96, &go_on);
        println!("{tangency:?}");
        assert!((tangency.unwrap().value - known).abs() < 1e-4);
    }
}

/// Below 1.10867 every orbit of the right manifold turns back; above, some pass over.
#[test]
fn no_tangency_of_the_right_loop_before() {
    for (gamma, guess) in [
        (0.6, [-0.35, -0.015]),
        (0.7, [-0.38, -0.016]),
        (0.8, [-0.41, -0.018]),
        (0.9, [-0.44, -0.018]),
        (1.06, [-0.44, 0.005]),
        (1.1, [-0.437, 0.018]),
        (1.108, [-0.436, 0.02]),
        (1.112, [-0.436, 0.02]),
    ] {
        let (model, parameters) = (stick_slip(), parameters(&[]));
        let (model, parameters) = (&model, &parameters);
        let (period, side) = (PI, Loop::Right);
        let right = Homoclinic { model, parameters, name: "gamma", period, side, guess };
        let returns = right.returns(gamma, 256, &go_on).unwrap();
        let least = returns.iter().map(|back| back.excess).fold(f64::INFINITY, f64::min);
        println!("{gamma} {} {least:e}", returns.len());
        assert_eq!(returns.len(), 256);
        assert_eq!(least < 0.0, gamma > 1.10867);
    }
}

/// From eps = 0.005, where Melnikov's method tells where to look, to eps = 1; the values in
/// between by an independent code.
#[test]
fn continued_to_eps_one() {
    let values = [0.005, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
    let right = [
        (0.005, 0.6380714),
        (0.01, 0.6390785),
        (0.05, 0.6473862),
        (0.1, 0.6583849),
        (0.2, 0.6822086),
        (0.5, 0.7624558),
        (0.7, 0.8313867),
        (1.0, 1.10867),
    ];
    let left = [
        (0.005, 0.6360782),
        (0.01, 0.6350921),
        (0.05, 0.6274550),
        (0.1, 0.6185320),
        (0.2, 0.6027019),
        (0.5, 0.5704759),
        (1.0, 0.60227),
    ];
    for (side, known) in [(Loop::Right, &right[..]), (Loop::Left, &left[..])] {
        let start = tangency("0.005", side, (0.62, 0.65), 24);
        let start = (start.value, start.phase);
        let mut found = Vec::new();
        let outcome = with_loop("0.005", side, |homoclinic| {
            continue_tangency(homoclinic, ("eps", &values), start, &go_on, &mut |eps, tangency| {
                println!("{side:?} {eps} {tangency:?}");
                found.push((eps, tangency.value));
                ControlFlow::Continue(())
            })
        });
        assert_eq!(outcome, Ok(()));
        for (eps, value) in known {
            let at = found.iter().find(|(other, _)| other == eps).unwrap();
            let bound = if *eps == 1.0 { 5e-6 } else { 1e-7 };
            assert!((at.1 - value).abs() < bound, "{at:?} {value}");
        }
    }
}

/// x'' = x - x^3 - F cos 2t with F = 0.
#[test]
fn the_saddle_of_duffing() {
    let x = Expression::DISPLACEMENT;
    let model = Model::second_order(&(Expression::ACCELERATION - x.clone() + x.pow(3))).unwrap();
    let system = model.linearised().compile(Doubles, &Parameters::new()).unwrap();
    let settings = Settings::for_digits(16);
    let point = saddle(&system, PI, [0.1, -0.1], settings, &go_on).unwrap();
    let [unstable, stable] = point.multipliers;
    assert!((unstable / PI.exp() - 1.0).abs() < 1e-13 && (stable * PI.exp() - 1.0).abs() < 1e-11);
    let [[x, v], [p, q]] = point.directions;
    assert!((x - v).abs() < 1e-13 && (p + q).abs() < 1e-13);
    // The centre is no saddle.
    let outcome = saddle(&system, PI, [1.01, 0.0], settings, &go_on);
    assert_eq!(outcome, Err(SimulateError::NoSaddle));
}

/// x'' = x - x^3 + (F cos t - x')/100: Melnikov's threshold is 4 cosh(pi/2)/(3 sqrt 2 pi).
#[test]
fn the_damped_duffing_oscillator() {
    let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let force = Expression::parameter("F") * Expression::Time.apply(Function::Cos);
    let equation =
        Expression::ACCELERATION - x.clone() + x.pow(3) + Expression::Small * (v - force);
    let model = Model::second_order(&equation).unwrap().with_small("eps");
    let parameters = Parameters::new().with("eps", rug::Rational::from((1, 100)));
    let (model, parameters, side) = (&model, &parameters, Loop::Right);
    let (period, guess) = (2.0 * PI, [0.0, 0.0]);
    let homoclinic = Homoclinic { model, parameters, name: "F", period, side, guess };
    let tangency = homoclinic.first_tangency((0.7, 0.8), 24, &go_on).unwrap();
    let threshold = 4.0 * (PI / 2.0).cosh() / (3.0 * 2f64.sqrt() * PI);
    println!("{tangency:?} {threshold}");
    assert!((tangency.value - threshold).abs() < 1e-3);
    // The order of the ends does not matter.
    assert_eq!(homoclinic.first_tangency((0.8, 0.7), 24, &go_on), Ok(tangency));
    // A force of half the period, followed by both periods: a fundamental domain has one extremum, or two equal ones.
    let double =
        Expression::Time.apply(Function::Cos).pow(2) * Expression::from(2) - Expression::from(1);
    let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let small = Expression::Small * (v - Expression::parameter("F") * double);
    let model = Model::second_order(&(Expression::ACCELERATION - x.clone() + x.pow(3) + small));
    let model = &model.unwrap().with_small("eps");
    let values = [PI, 2.0 * PI].map(|period| {
        let homoclinic = Homoclinic { model, parameters, name: "F", period, side, guess };
        homoclinic.first_tangency((1.85, 1.7), 24, &go_on).unwrap()
    });
    println!("{values:?}");
    assert!((values[0].value - values[1].value).abs() < values[0].error + values[1].error);
}

/// x'' = x - x^3 + (F (cos 3t + cos(t - p)/7000) - x')/100 for p = 0 and a third of a turn either way, which are one another shifted in time: of three
/// extrema that the orbits followed do not tell apart another one has the first
/// tangency each time, 8e-3 before the others.
#[test]
fn of_three_equal_extrema_the_first_counts() {
    let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let wave = |function: Function, n: i64| (Expression::Time * n).apply(function);
    let slow = Expression::parameter("c") * wave(Function::Cos, 1)
        + Expression::parameter("s") * wave(Function::Sin, 1);
    let force = Expression::parameter("F") * (wave(Function::Cos, 3) + slow);
    let small = Expression::Small * (v - force);
    let model = Model::second_order(&(Expression::ACCELERATION - x.clone() + x.pow(3) + small));
    let model = &model.unwrap().with_small("eps");
    // sqrt(3)/2 = 0.8660254.
    let shifts = [(10_000_000, 0), (-5_000_000, 8_660_254), (-5_000_000, -8_660_254)];
    let values = shifts.map(|(c, s)| {
        let share = |n: i64| rug::Rational::from((n, 70_000_000_000i64));
        let small = rug::Rational::from((1, 100));
        let parameters = Parameters::new().with("eps", small).with("c", share(c));
        let parameters = &parameters.with("s", share(s));
        let (period, side, guess) = (2.0 * PI, Loop::Right, [0.0, 0.0]);
        let homoclinic = Homoclinic { model, parameters, name: "F", period, side, guess };
        homoclinic.first_tangency((5.0, 6.2), 25, &go_on).unwrap().value
    });
    println!("{values:?}");
    assert!(values.iter().all(|value| (value - values[0]).abs() < 1e-5), "{values:?}");
}

/// Derivatives serve the next number of periods, too: 10573 steps and events, with the returns that bracket the value, where
/// each search with derivatives of its own takes 12171.
#[test]
fn kept_derivatives_save_orbits() {
    with_loop("0.01", Loop::Right, |homoclinic| {
        let count = std::cell::Cell::new(0u32);
        let tick = || {
            count.set(count.get() + 1);
            ControlFlow::Continue(())
        };
        homoclinic.first_tangency((0.62, 0.65), 24, &tick).unwrap();
        assert!(count.get() < 11_500, "{}", count.get());
    });
}

/// Every long computation stops at the end of the step in which the tick breaks off.
#[test]
fn ticks_break_off() {
    with_loop("1", Loop::Right, |homoclinic| {
        for steps in [0u32, 1, 5000] {
            let count = std::cell::Cell::new(0);
            let tick = || {
                count.set(count.get() + 1);
                if count.get() > steps { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let found = homoclinic.first_tangency((1.1, 1.115), 48, &tick);
            assert_eq!(found, Err(SimulateError::Stopped));
            // The events of the step that was begun are told of, too.
            assert!((steps + 1..steps + 4).contains(&count.get()), "{}", count.get());
        }
        let stop = || ControlFlow::Break(());
        let returns = homoclinic.returns(1.1, 4, &stop);
        assert_eq!(returns, Err(SimulateError::Stopped));
        let (target, start) = (("eps", &[1.0][..]), (1.1, 0.3));
        let outcome = continue_tangency(homoclinic, target, start, &stop, &mut |_, _| go_on());
        assert_eq!(outcome, Err(SimulateError::Stopped));
    });
}

/// x'' = x - x^3 + eps (h x cos t - x^2 x'): Melnikov's integral gives h = (16/15) sinh(pi/2)/pi, a force that multiplies x
/// against friction that depends on x. The first tangency tends to it with eps^2.
#[test]
fn a_parametric_force_against_friction_that_depends_on_x() {
    let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let force = Expression::parameter("h") * x.clone() * Expression::Time.apply(Function::Cos);
    let small = Expression::Small * (x.clone().pow(2) * v - force);
    let model = Model::second_order(&(Expression::ACCELERATION - x.clone() + x.pow(3) + small));
    let model = model.unwrap().with_small("eps");
    let threshold = 16.0 / 15.0 * (PI / 2.0).sinh() / PI;
    let errors = [(1, 20), (1, 40)].map(|eps| {
        let parameters = Parameters::new().with("eps", rug::Rational::from(eps));
        let (model, parameters, side) = (&model, &parameters, Loop::Right);
        let (period, guess) = (2.0 * PI, [0.0, 0.0]);
        let homoclinic = Homoclinic { model, parameters, name: "h", period, side, guess };
        let tangency = homoclinic.first_tangency((0.7, 0.87), 24, &go_on).unwrap();
        tangency.value - threshold
    });
    let slope = (errors[0] / errors[1]).log2();
    println!("{threshold} {errors:?} {slope}");
    assert!(errors[1].abs() < 2e-4 && (slope - 2.0).abs() < 0.05, "{errors:?} {slope}");
}
