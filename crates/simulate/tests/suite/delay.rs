//! Constant delays: y' = -y(t-1) against its exact piecewise polynomial, and the delayed
//! vibro-impact oscillator against an independent simulation.

use lindstedt_equation::Expression;
use lindstedt_number::Exact;
use lindstedt_simulate::{
    Digits, Doubles, Integrator, Model, Parameters, Quantity, Real, Report, Settings,
};
use rug::{Float, Rational};
use serde_json::Value;
use std::ops::ControlFlow;

/// A polynomial in t - start on [start, next start].
type Pieces = Vec<(Rational, Vec<Rational>)>;

fn evaluate(c: &[Rational], s: &Rational) -> Rational {
    c.iter().rev().fold(Rational::new(), |sum, c| sum * s + c)
}

/// The method of steps on a grid of 1/2 with rationals: y = 1 for t <= 0, y' = -y(t-1), and
/// y -> y + jump at t = 5/2.
fn exact(end: i64, jump: i64) -> Pieces {
    let half = |n: i64| Rational::from((n, 2));
    let mut pieces: Pieces =
        vec![(half(-2), vec![Rational::from(1)]), (half(-1), vec![Rational::from(1)])];
    let mut y = Rational::from(1);
    for n in 0..2 * end {
        if n == 5 {
            y += jump;
        }
        let delayed = &pieces[n as usize].1;
        let mut c = vec![y.clone()];
        c.extend((1i64..).zip(delayed).map(|(k, d)| Rational::from(-d) / k));
        y = evaluate(&c, &half(1));
        pieces.push((half(n), c));
    }
    pieces.push((half(2 * end), vec![y]));
    pieces
}

/// The largest error of y on [0, 10] (on a grid of 1/8, from the dense output) and y(10); at
/// t = 5/2 y jumps.
fn run<R: Real>(real: &R, digits: u32, jump: i64) -> (f64, R::Element) {
    let y = Expression::DISPLACEMENT;
    let model = Model::first_order(&["y"], &[-y.delayed(1)]).unwrap();
    let model = model.with_history(&[Expression::integer(1)]);
    let system = model.compile(real.clone(), &Parameters::new()).unwrap();
    let one = real.double(1.0);
    let settings = Settings::for_digits(digits);
    let mut flow =
        Integrator::new(&system, &real.zero(), std::slice::from_ref(&one), settings).unwrap();
    let pieces = exact(10, jump);
    let mut worst = 0f64;
    let mut observe = |report: &Report<'_, R>| {
        let Report::Segment(segment) = report else { return ControlFlow::Continue(()) };
        for n in 0..80 {
            let t = Rational::from((n, 8));
            let s = real.difference(&real.rational(&t), segment.start);
            if real.sign(&s) >= 0 && s < *segment.length {
                let (start, c) = &pieces[(n / 4 + 2) as usize];
                let known = evaluate(c, &(t - start));
                let value = real.to_float(&segment.value(0, &s));
                worst = worst.max(Float::with_val(400, value - known).abs().to_f64());
            }
        }
        ControlFlow::Continue(())
    };
    flow.advance(&real.double(2.5), &mut observe).unwrap();
    let after = real.sum(&flow.state()[0], &real.double(jump as f64));
    flow.set_state(&[after]).unwrap();
    flow.advance(&real.double(10.0), &mut observe).unwrap();
    (worst, flow.state()[0].clone())
}

#[test]
fn method_of_steps_with_and_without_a_jump() {
    // y(10) = sum_k (-1)^k (11 - k)^k/k!, k = 0..11.
    assert_eq!(exact(10, 0).pop().unwrap().1[0], Rational::from((10_493, 518_400)));
    for jump in [0, 1] {
        let exact = exact(10, jump).pop().unwrap().1.remove(0);
        let (worst, end) = run(&Doubles, 16, jump);
        println!("{worst:e} {:e}", (end - exact.to_f64()).abs());
        assert!(worst < 1e-13 && (end - exact.to_f64()).abs() < 1e-13);
        for digits in [30, 60] {
            let (worst, end) = run(&Digits::for_digits(digits), digits, jump);
            let error = Float::with_val(400, end - &exact).abs().to_f64().max(worst);
            println!("{error:e}");
            assert!(error < 10f64.powi(-(digits as i32)), "{digits} {error:e}");
        }
    }
}

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/vibro-impact/");

fn read(name: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(format!("{DATA}{name}.json")).unwrap()).unwrap()
}

/// The uncontrolled orbit x = F cos(omega t + phi) + e^(-c t/2) (C cos W t + D sin W t), one impact
/// per period T at t = 0, T, ...; everything in floats of 200 bits from the parameters.
struct Orbit {
    parameters: Parameters,
    period: Float,
    velocity: Float,
    psi: Float,
    history: Expression,
}

fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// The regular form, solved by the formulas with kappa and q.
fn orbit(params: &Value, gains: Option<(&str, &str)>) -> Orbit {
    let bits = 200;
    let get = |name: &str| Quantity::parse(&text(&params[name])).unwrap().float(bits);
    let rational = |name: &str| Quantity::parse(&text(&params[name])).unwrap().rational().unwrap();
    let (alpha, omega, c, s, r, p0) =
        (get("alpha"), get("omega"), get("c"), get("s"), get("R_r"), get("P0"));
    let mut parameters = Parameters::new().with("eps", 1);
    for name in ["alpha", "omega", "R_r", "s", "c", "P0", "A", "B"] {
        parameters.set(name, Quantity::parse(&text(&params[name])).unwrap());
    }
    if let Some((a, b)) = gains {
        parameters.set("A", Quantity::parse(a).unwrap());
        parameters.set("B", Quantity::parse(b).unwrap());
    }
    let turns = Exact::pi_times(rational("k") * 2 / rational("omega"));
    let period = turns.float(bits);
    parameters.set("T", turns);
    let float = |x: f64| Float::with_val(bits, x);
    let w = (alpha.clone().square() - c.clone().square() / 4u32).sqrt();
    let rate = Float::with_val(bits, -&c) / 2u32;
    let theta = Float::with_val(bits, &w * &period);
    let (sin, cos) = theta.sin_cos(float(0.0));
    let e = Float::with_val(bits, &rate * &period).exp();
    let back = e.clone().recip();
    let delta = Float::with_val(bits, &e + &back) - float(2.0) * &cos;
    let gain = Float::with_val(bits, &r + 1u32);
    let scale = Float::with_val(bits, &w * &delta);
    let kappa = Float::with_val(bits, &gain * &sin) / &scale;
    let up = Float::with_val(bits, &e - &cos) * &r - Float::with_val(bits, &back - &cos);
    let q = (up * &w - Float::with_val(bits, &gain * &rate) * &sin) / &scale / &omega;
    let square = Float::with_val(bits, kappa.square_ref()) + Float::with_val(bits, q.square_ref());
    let natural = alpha.square() - omega.clone().square();
    let damping = Float::with_val(bits, &c * &omega);
    let f = p0 / Float::with_val(bits, natural.hypot_ref(&damping));
    let inside =
        Float::with_val(bits, f.square_ref()) * &square - (Float::with_val(bits, &s * &q)).square();
    let velocity = (inside.sqrt() - Float::with_val(bits, &s * &kappa)) / &square;
    let constant = Float::with_val(bits, -&kappa) * &velocity;
    let d = -(gain * Float::with_val(bits, &back - &cos) * &velocity / &scale);
    let f_cos = Float::with_val(bits, &kappa * &velocity) + &s;
    let f_sin = Float::with_val(bits, &q * &velocity);
    let phi = f_sin.atan2(&f_cos);
    // The force is P0 cos(omega t + psi), psi = phi + atan2(c omega, alpha^2 - omega^2).
    let psi = Float::with_val(bits, &phi + damping.atan2(&natural));
    for (name, value) in [("F", f), ("phi", phi), ("C", constant), ("D", d), ("W", w), ("R", rate)]
    {
        parameters.set(name, value);
    }
    parameters.set("psi", psi.clone());
    // One period back: t + T since the last impact.
    use lindstedt_equation::Function::{Cos, Exp, Sin};
    let symbol = Expression::parameter;
    let since = || Expression::Time + symbol("T");
    let angle = symbol("omega") * Expression::Time + symbol("phi");
    let free = symbol("C") * (symbol("W") * since()).apply(Cos)
        + symbol("D") * (symbol("W") * since()).apply(Sin);
    let history = symbol("F") * angle.apply(Cos) + (symbol("R") * since()).apply(Exp) * free;
    Orbit { parameters, period, velocity, psi, history }
}

/// The equation of section 2 with the phase psi in the force, from the built-in problem: t is
/// replaced by t + psi/omega.
fn model(orbit: &Orbit) -> Model {
    fn delay_time(e: &Expression) -> Expression {
        let list = |l: &[Expression]| l.iter().map(delay_time).collect();
        match e {
            Expression::Time => {
                Expression::Time
                    + Expression::parameter("psi") * Expression::parameter("omega").pow(-1)
            }
            Expression::Sum(l) => Expression::Sum(list(l)),
            Expression::Product(l) => Expression::Product(list(l)),
            Expression::Function(f, a) => delay_time(a).apply(*f),
            other => other.clone(),
        }
    }
    let mut problem = lindstedt_problems::vibro_impact::problem();
    problem.equation = delay_time(&problem.equation);
    Model::of_problem(&problem).unwrap().with_history(std::slice::from_ref(&orbit.history))
}

/// Impact times and speeds before impact, from x(0) = s, x'(0) = (-R_r + perturbation) v.
fn impacts<R: Real>(
    orbit: &Orbit,
    (real, digits): (R, u32),
    perturbation: &Rational,
    count: usize,
) -> Vec<(R::Element, R::Element)> {
    let system = model(orbit).compile(real.clone(), &orbit.parameters).unwrap();
    let value = |name: &str| orbit.parameters.get(name).unwrap().float(200);
    let rebound = Float::with_val(200, perturbation) - value("R_r");
    let speed = Float::with_val(200, &orbit.velocity * &rebound);
    let start = [real.float(&value("s")), real.float(&speed)];
    let settings = Settings::for_digits(digits);
    let mut flow = Integrator::new(&system, &real.zero(), &start, settings).unwrap();
    let mut list = Vec::new();
    flow.advance(&real.double(1e3), &mut |report| {
        if let Report::Event(event) = report {
            list.push((event.time.clone(), event.before[1].clone()));
        }
        if list.len() < count { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })
    .unwrap();
    println!("{:?}", flow.work());
    list
}

/// tests/data/vibro-impact/delay_simulations.json: 17 digits, two discretisations of an
/// independent spectral simulator agree to 5e-13.
#[test]
fn delayed_impacts_and_their_growth() {
    for case in read("delay_simulations").as_array().unwrap() {
        let name = case["name"].as_str().unwrap();
        let params = &read(name)["params"];
        let orbit = orbit(params, None);
        let known = |key: &str| case[key].as_str().unwrap().parse::<f64>().unwrap();
        assert!((orbit.velocity.to_f64() - known("v")).abs() < 1e-14, "{name}");
        assert!((orbit.psi.to_f64() - known("psi")).abs() < 1e-14, "{name}");
        let list = |key: &str| -> Vec<f64> {
            let list = case[key].as_array().unwrap().iter();
            list.map(|t| t.as_str().unwrap().parse().unwrap()).collect()
        };
        let perturbation = Quantity::parse(&case["velocity_perturbation_over_v"].to_string());
        let perturbation = perturbation.unwrap().rational().unwrap();
        let times = list("impact_times");
        let found = impacts(&orbit, (Doubles, 16), &perturbation, times.len());
        let mut worst = 0f64;
        let shifts = |times: &[f64]| -> Vec<f64> {
            let period = orbit.period.to_f64();
            (1..).zip(times).map(|(n, t): (i32, _)| t - f64::from(n) * period).collect()
        };
        let fast: Vec<f64> = found.iter().map(|impact| impact.0).collect();
        // Where the shift has decayed its ratio has no more digits than the reference.
        let agreement = case["agreement"].as_f64().unwrap();
        for (a, b) in shifts(&fast).windows(2).zip(shifts(&times).windows(2)) {
            let error = (a[1] / a[0] - b[1] / b[0]).abs();
            assert!(error < 1e-9 + 4.0 * agreement / b[0].abs(), "{name} {error:e}");
        }
        for ((time, speed), (t, v)) in
            found.iter().zip(times.iter().zip(list("pre_impact_velocities")))
        {
            worst = worst.max((time - t).abs()).max((speed - v).abs());
        }
        println!("{name} {worst:e}");
        assert!(worst < 2e-12, "{name} {worst:e}");
    }
}

/// Orbit O3: at the gain A where G(-1) = 0 perturbations alternate with ratio -1; on both sides
/// of it they shrink and grow. (The ratios are those of independent nonlinear
/// simulations; A from the closed form of the flip boundary.)
#[test]
fn flip_of_orbit_o3() {
    let params: Value = serde_json::from_str(
        r#"{"alpha":"1","omega":"3.3","k":1,"R_r":"0.6","s":"-0.2","c":"0.2","P0":"1","A":"0","B":"0"}"#,
    )
    .unwrap();
    for (gain, known, bound) in [
        ("-0.0292903246974", -1.0, 2e-6),
        ("-0.0352903246974", -0.959_882, 3e-6),
        ("-0.0232903246974", -1.037_560, 3e-6),
    ] {
        let orbit = orbit(&params, Some((gain, "0")));
        let perturbation = Rational::from((1, 100_000_000));
        let real = Digits::for_digits(40);
        let found = impacts(&orbit, (real, 40), &perturbation, 40);
        let period = |n: u32| Float::with_val(200, &orbit.period * n);
        let shift = |n: u32| Float::with_val(200, &found[n as usize - 1].0 - period(n));
        let ratio = (shift(40) / shift(39)).to_f64();
        println!("{gain} {ratio}");
        assert!((ratio - known).abs() < bound, "{gain} {ratio}");
    }
}
