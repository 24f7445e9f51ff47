//! Averaged motions against the integrator.

use super::support::{integrated, valued};
use lindstedt::evaluate::averaged::{AveragedMotion, Ended, Motion, Start};
use lindstedt::unstable::equation::Problem;
use lindstedt::unstable::orbit::{self, Field, Kind, Request, prove};
use lindstedt::{Exact, Standing, Work, unstable::problems};

fn motion(problem: &Problem, order: usize, set: &[(&str, &str)], start: Start) -> Motion {
    let case = valued(problem, set);
    Motion::new(case.problem(), case.given(), order, &start, &work()).unwrap()
}

fn work() -> Work {
    Work { digits: 14, ..Work::default() }
}

fn state(x: &str, v: &str) -> Start {
    Start::State(Exact::parse(x).unwrap(), Exact::parse(v).unwrap())
}

fn values(times: &[f64]) -> Vec<Exact> {
    times.iter().map(|t| Exact::Rational(rug::Rational::from_f64(*t).unwrap())).collect()
}

/// The averaged van der Pol oscillator from rest at x = 1/2, 1 and 3, at many orders: the true
/// error is below the estimate wherever there is one.
#[test]
fn averaged_van_der_pol() {
    let problem = problems::find("van-der-pol").unwrap();
    let times = [0.0, 1.0, 7.0, 15.0, 30.0, 50.0, 80.0];
    let (mut checked, mut sharp) = (0, 0);
    for (eps, x) in [("1/20", "1/2"), ("1/10", "1"), ("1/10", "3"), ("1/4", "1"), ("1/2", "2")] {
        let start =
            [Exact::parse(x).unwrap().ball(lindstedt::unstable::number::ball::Balls::new(60))];
        let start = [start[0].midpoint().to_f64(), 0.0];
        let expected = integrated(&problem, &[("eps", eps)], start, &times);
        for order in 2..=9 {
            let mut motion = motion(&problem, order, &[("eps", eps)], state(x, "0"));
            let found = motion.at(&values(&times), &work());
            assert_eq!(found.len(), times.len());
            for (moment, expected) in found.iter().zip(&expected) {
                let x = &moment.displacement;
                let error = (x.double - expected).abs();
                let text = format!("eps {eps} order {order} t {}: {error:e}", moment.time);
                assert!(error <= x.error + 1e-11, "{text} {:e}", x.error);
                checked += i32::from(x.error.is_finite());
                sharp += i32::from(x.error < 1e-5);
            }
        }
    }
    assert!(checked > 250 && sharp > 60, "{checked} {sharp}");
}

/// The impact oscillator between impacts. Without the loop against the integrator; with it against
/// the root of alpha^2 + z^2 - (A + B z)(1 - exp(-z T)) + c z and the forced response, which the
/// loop does not see (T is a period of the force).
#[test]
fn averaged_free_flight() {
    let problem = problems::vibro_impact::problem();
    let times = [0.0, 1.0, 2.5, 6.0];
    let off = [("eps", "1"), ("c", "1/10")];
    let mut free = problem.clone();
    free.impact = None;
    // Any delay will do: its gain is zero.
    let still = [("eps", "1"), ("c", "1/10"), ("T", "1")];
    let mut model_problem = free.clone();
    let without = |e: &lindstedt::unstable::equation::Expression| match e {
        lindstedt::unstable::equation::Expression::Parameter(name)
            if name == "A" || name == "B" =>
        {
            Some(lindstedt::unstable::equation::Expression::integer(0))
        }
        _ => None,
    };
    model_problem.equation = free.equation.substitute(&without).canonical();
    let expected = integrated(&model_problem, &still, [-0.5, 0.25], &times);
    let mut flight = motion(&problem, 10, &off, state("-1/2", "1/4"));
    assert!(flight.has_wall && flight.verdict().contains("between impacts"));
    for (moment, expected) in flight.at(&values(&times), &work()).iter().zip(expected) {
        let error = (moment.displacement.double - expected).abs();
        assert!(error <= moment.displacement.error + 1e-13 && error < 1e-9, "{error:e}");
    }
    let on = [("eps", "1"), ("A", "1/10"), ("B", "1/20")];
    let mut flight = motion(&problem, 10, &on, state("-1/2", "1/3"));
    let [growth, frequency] = flight.linear.clone().unwrap().map(Option::unwrap);
    // mpmath 1.3.0, findroot.
    let (r, w) = (-0.016_832_789_994_242_716, 0.959_070_214_690_621_9);
    let near = |number: &lindstedt::Number, exact: f64| {
        let value: f64 = number.decimal.parse().unwrap();
        let error: f64 = number.error.as_ref().unwrap().parse().unwrap();
        (value - exact).abs() <= error && error < 1e-8
    };
    assert!(near(&growth, r) && near(&frequency, w), "{growth:?} {frequency:?}");
    let (omega, c): (f64, f64) = (3.3, 0.2);
    let d = (1.0 - omega * omega).powi(2) + c * c * omega * omega;
    let forced =
        |t: f64| ((1.0 - omega * omega) * (omega * t).cos() + c * omega * (omega * t).sin()) / d;
    let first = -0.5 - forced(0.0);
    let second = (r * first - (1.0 / 3.0 - c * omega * omega / d)) / w;
    let exact =
        |t: f64| forced(t) + (r * t).exp() * (first * (w * t).cos() - second * (w * t).sin());
    // Backwards too.
    let times = [-3.0, 0.0, 2.0, 6.0];
    for (moment, time) in flight.at(&values(&times), &work()).iter().zip(times) {
        let error = (moment.displacement.double - exact(time)).abs();
        assert!(error <= moment.displacement.error + 1e-13, "{time}: {error:e}");
        assert!(error < 1e-8, "{time}: {error:e}");
    }
}

/// The rates of x'' + x + eps (c x' + x(t - T)) = 0 are a root of lambda^2 + 1 + eps (c lambda + e^(-lambda T)), followed
/// from i (Newton's method in doubles, 2000 steps of eps).
#[test]
fn rates_with_a_delay_against_the_characteristic_root() {
    let equation = "x'' + x + eps*(c*x' + x(t - T)) = 0";
    let case = lindstedt::Oscillator::parse(equation).unwrap();
    let mut known = 0;
    for (set, truth) in [
        (["1/2", "10", "1/10"], [-0.020_861_205_462_9, 0.936_183_421_910_7]),
        (["1/2", "10", "1/20"], [-0.021_081_869_210_8, 0.969_777_937_610_2]),
        (["-1", "5", "1/10"], [0.005_502_437_159_3, 1.017_384_419_583_9]),
        (["1", "3", "1/5"], [-0.041_953_353_084_4, 0.889_618_773_365_0]),
        (["1/4", "8", "2/25"], [0.023_124_888_246_7, 0.996_562_016_193_7]),
        (["3/2", "1", "1/4"], [-0.076_219_070_611_9, 1.053_837_150_232_5]),
    ] {
        let [c, delay, eps] = set;
        for order in [2, 3, 4, 6] {
            let set = [("c", c), ("T", delay), ("eps", eps)];
            let motion = motion(case.problem(), order, &set, Start::Amplitude(1.into(), 0.into()));
            for (found, truth) in motion.linear.clone().unwrap().iter().zip(truth) {
                let Some(found) = found else { continue };
                let Some(error) = &found.error else { continue };
                let [value, error] = [&found.decimal, error].map(|x| x.parse::<f64>().unwrap());
                assert!((value - truth).abs() <= error, "{set:?}, order {order}: {found}, {truth}");
                known += 1;
            }
        }
    }
    assert!(known > 20, "{known}");
}

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// The root of l^2 + 1 + eps (a l + b e^(-l T) + c l e^(-l T) + d) that comes from i, by Newton's method along eps.
fn characteristic_root([a, b, c, d, delay]: [f64; 5], eps: f64) -> Complex {
    let mut root = (0.0, 1.0);
    for k in 1..=40 {
        let eps = eps * f64::from(k) / 40.0;
        for _ in 0..8 {
            let (size, angle) = ((-root.0 * delay).exp(), -root.1 * delay);
            let late = (size * angle.cos(), size * angle.sin());
            // b + c l and its product with e^(-l T).
            let factor = (b + c * root.0, c * root.1);
            let product = times(factor, late);
            let square = times(root, root);
            let f = (
                square.0 + 1.0 + eps * (a * root.0 + product.0 + d),
                square.1 + eps * (a * root.1 + product.1),
            );
            let slope = (
                2.0 * root.0 + eps * (a + c * late.0 - delay * product.0),
                2.0 * root.1 + eps * (c * late.1 - delay * product.1),
            );
            let step = times(f, (slope.0, -slope.1));
            let norm = slope.0 * slope.0 + slope.1 * slope.1;
            root = (root.0 - step.0 / norm, root.1 - step.1 / norm);
        }
    }
    root
}

/// Random linear equations with delayed values and velocities: no rate is further off than estimated, among them those whose terms
/// fall less and less from order to order; and the estimates are not much too large.
#[test]
fn rates_of_random_equations_with_a_delay() {
    let mut random = lindstedt_tests::Random(6);
    let mut ratios = Vec::new();
    for _ in 0..100 {
        let mut twelfths = || random.below(25) as i64 - 12;
        let [a, b, c, d] = [twelfths(), twelfths(), twelfths(), twelfths()];
        let (delay, eps) = (1 + random.below(36), 2 + random.below(59));
        let order = 2 + random.below(4);
        let equation = format!(
            "x'' + x + eps*({a}/12*x' + {b}/12*x(t - {delay}/12) + {c}/12*x'(t - {delay}/12) + {d}/12*x) = 0"
        );
        let case = lindstedt::Oscillator::parse(&equation).unwrap();
        let set = format!("{eps}/100");
        let start = Start::Amplitude(1.into(), 0.into());
        let motion = motion(case.problem(), order, &[("eps", &set)], start);
        let part = |n: i64| n as f64 / 12.0;
        let parts = [part(a), part(b), part(c), part(d), delay as f64 / 12.0];
        let truth = characteristic_root(parts, eps as f64 / 100.0);
        let Some(linear) = &motion.linear else { continue };
        for (found, truth) in linear.iter().zip([truth.0, truth.1]) {
            let Some((found, error)) = found.as_ref().and_then(|it| Some((it, it.error.as_ref()?)))
            else {
                continue;
            };
            let [value, error] = [&found.decimal, error].map(|x| x.parse::<f64>().unwrap());
            let miss = (value - truth).abs();
            assert!(miss <= error, "{equation}, eps {set}, order {order}: {found}, {truth}");
            ratios.push(error / miss.max(1e-300));
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    println!("{} rates, the smallest ratio {}, the median {median}", ratios.len(), ratios[0]);
    assert!(ratios.len() > 120 && median < 4.0, "{} {median}", ratios.len());
}

/// All limit cycles of averaged equations against proved orbits: amplitude of the first harmonic, frequency and Floquet
/// exponent lie within their estimated errors, at orders with and without a resummation.
#[test]
fn summed_cycles_against_proved_orbits() {
    let cubic = ("x'' + x = eps*(1 - x^4)*x'", &[(true, 1.68)][..]);
    let two = ("x'' + x = eps*(5 - 20*x^2 + 8*x^4)*x'", &[(true, 1.18), (false, 1.90)][..]);
    for (equation, expected) in [cubic, two] {
        let case = lindstedt::Oscillator::parse(equation).unwrap().set("eps", "1/20").unwrap();
        let values = [("eps".to_owned(), rug::Rational::from((1, 20)))].into();
        let field = Field::new(&case.problem().equation, "eps", &values).unwrap();
        for (k, (stable, amplitude)) in expected.iter().enumerate() {
            let (cosines, sines) = (vec![0.0, *amplitude], vec![0.0; 2]);
            let start = orbit::Start { frequency: 1.0, cosines, sines };
            let proof = prove(&field, &Kind::LimitCycle, &start, &Request::default()).unwrap();
            let (cosine, sine) = proof.harmonic(1);
            let first = cosine.midpoint().to_f64().hypot(sine.midpoint().to_f64());
            let [frequency, exponent] =
                [&proof.frequency, &proof.exponent].map(|ball| ball.midpoint().to_f64());
            for order in [4, 8, 14] {
                let question = AveragedMotion { order: Some(order), ..AveragedMotion::default() };
                let found = case.averaged_motion(&question, &work()).unwrap().value.cycles.unwrap();
                assert_eq!(found.len(), expected.len());
                let cycle = &found[k];
                assert_eq!(cycle.stable, Some(*stable));
                let numbers = [&cycle.amplitude, &cycle.frequency, &cycle.floquet_exponent];
                for (number, truth) in numbers.into_iter().zip([first, frequency, exponent]) {
                    let number = number.as_ref().unwrap();
                    let error = number.error.as_ref().unwrap().parse::<f64>().unwrap();
                    let gap = (number.decimal.parse::<f64>().unwrap() - truth).abs();
                    assert!(gap <= error + 1e-14, "{equation} {order}: {number}, {truth}");
                    let limit = [1e-2, 1e-4, 1e-6][(order - 4).div_ceil(5)];
                    assert!(error < limit, "{equation} {order}: {number}");
                }
            }
        }
    }
}

/// Of two orders and less, of which one vanishes or is small by accident. True values: collocation of the whole equation by
/// Fourier series, and DOP853 of SciPy with the divergence along the cycle.
#[test]
fn short_sums_of_cycles() {
    let drift = "x'' + 4*x - eps*x'/2 - 2*eps*x'^2 + 4/3*eps*x^4*x' = 0";
    let turn = "x'' + 4*x - eps*x' - 11/6*eps*x^2 - 2/5*eps*x^3 + 3/5*eps*x'^3 = 0";
    for (equation, order, which, truth) in
        [(drift, 2, 2, -0.111_718_3), (turn, 1, 1, 1.994_507_171_8)]
    {
        let case = lindstedt::Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
        let question = AveragedMotion { order: Some(order), ..AveragedMotion::default() };
        let found = case.averaged_motion(&question, &work()).unwrap().value.cycles.unwrap();
        let cycle = &found[0];
        let numbers = [&cycle.amplitude, &cycle.frequency, &cycle.floquet_exponent];
        let number = numbers[which].as_ref().unwrap();
        let error = number.error.as_ref().unwrap().parse::<f64>().unwrap();
        let gap = (number.decimal.parse::<f64>().unwrap() - truth).abs();
        assert!(gap <= error && error < 40.0 * gap, "{equation} {order}: {number}, {truth}");
    }
}

/// The exponent of van der Pol's cycle beside its period: at eps = 0.4 that of the integration, -0.403974101; the sum to
/// order 7 alone -0.403974056; with -eps the cycle is unstable.
#[test]
fn the_exponent_beside_the_period() {
    let exponent = |eps: &str, order: usize| {
        let case = lindstedt::Oscillator::builtin("van-der-pol").unwrap().set("eps", eps).unwrap();
        let question = lindstedt::Evaluate { order: Some(order), ..lindstedt::Evaluate::default() };
        let found = case.evaluate(&question, &work()).unwrap().value.stability.unwrap();
        let number = found.floquet_exponent.unwrap();
        let error = number.error.as_ref().unwrap().parse::<f64>().unwrap();
        (number.decimal.parse::<f64>().unwrap(), error, found.stable)
    };
    let (value, error, stable) = exponent("2/5", 40);
    assert!((value + 0.403974101).abs() < 5e-10 && error < 1e-12, "{value} {error}");
    assert_eq!((stable, exponent("-2/5", 40).2), (Some(true), Some(false)));
    let [c1, c3, c5, c7] = [-1.0, -1.0 / 16.0, 11.0 / 4608.0, 4859.0 / 5308416.0];
    let sum = [c7, c5, c3, c1].iter().fold(0.0, |sum, c| sum * 0.16 + c) * 0.4;
    assert!((sum + 0.403974056_f64).abs() < 5e-10, "{sum}");
    let (value, error, _) = exponent("2/5", 7);
    assert!((value + 0.403974101).abs() < error && error < 1e-4, "{value} {error}");
}

/// An averaged motion that is not slow (a' of order 4 grows with a^17) ends after some thousand steps.
#[test]
fn a_motion_that_is_not_slow() {
    let equation = "x'' + x - eps*(x'/4 + 29/6*x^4*x' + x^2*x' - x*x'^2/2) = 0";
    let case = lindstedt::Oscillator::parse(equation).unwrap().set("eps", "1/20").unwrap();
    let start = Start::Amplitude(Exact::parse("2").unwrap(), Exact::parse("0").unwrap());
    let times = Some(lindstedt::evaluate::Times::parse("0,40").unwrap());
    let question = AveragedMotion { order: Some(4), start: Some(start), times };
    let found = case.averaged_motion(&question, &work()).unwrap();
    assert_eq!(found.standing, Standing::Undecided);
    let ended = found.value.ended;
    assert!(matches!(ended, Some(Ended::Fast { time }) if (0.3..0.4).contains(&time)), "{ended:?}");
}
