//! Thresholds of equations as they are written, with friction that depends on x and forces that multiply x, against
//! integrals over the orbit by the trapezoidal rule; nothing is shared but the text of the equation.

use super::support::decimals;
use lindstedt::{Number, Oscillator, Refusal, Threshold, Work};
use lindstedt_tests::Random;
use std::f64::consts::PI;

fn work() -> Work {
    Work { digits: 14, ..Work::default() }
}

fn value(number: &Number) -> f64 {
    number.decimal.parse().unwrap()
}

/// The orbits (x, x') of a force.
type Orbits = Vec<Box<dyn Fn(f64) -> [f64; 2]>>;

fn both(orbit: impl Fn(f64) -> [f64; 2] + Clone + 'static, sign: f64, centre: f64) -> Orbits {
    let at = move |sign: f64| {
        let orbit = orbit.clone();
        move |t: f64| orbit(t).map(|y| sign * y)
    };
    let moved = move |orbit: Box<dyn Fn(f64) -> [f64; 2]>| -> Box<dyn Fn(f64) -> [f64; 2]> {
        Box::new(move |t| {
            let [x, v] = orbit(t);
            [centre + x, v]
        })
    };
    vec![moved(Box::new(at(sign))), moved(Box::new(at(-sign)))]
}

/// x'' = ... with its orbits, right or upper first.
fn unperturbed(random: &mut Random, kind: u32) -> (String, Orbits) {
    let mut q = |low, high| decimals(random, low, high);
    let (a, b, c) = (q(0.5, 2.0), q(0.5, 2.0), q(-1.0, 1.0));
    let (p, r, centre) = (a.to_f64(), b.to_f64(), c.to_f64());
    let y = format!("(x - ({c}))");
    match kind {
        0 => {
            let orbit = move |t: f64| {
                let y = (2.0 * p / r).sqrt() / (p.sqrt() * t).cosh();
                [y, -y * p.sqrt() * (p.sqrt() * t).tanh()]
            };
            (format!("({a})*{y} - ({b})*{y}^3"), both(orbit, 1.0, centre))
        }
        1 => {
            let k = (p / 2.0).sqrt();
            let orbit = move |t: f64| {
                [(p / r).sqrt() * (k * t).tanh(), (p / r).sqrt() * k / (k * t).cosh().powi(2)]
            };
            (format!("-({a})*{y} + ({b})*{y}^3"), both(orbit, 1.0, centre))
        }
        2 | 3 => {
            let (sign, k) = (if kind == 2 { 1.0 } else { -1.0 }, p.sqrt() / 2.0);
            let orbit = move |t: f64| {
                let y = 1.5 * p / r / (k * t).cosh().powi(2);
                [y, -2.0 * k * y * (k * t).tanh()]
            };
            let mut list = both(orbit, sign, centre);
            list.truncate(1);
            (format!("({a})*{y} - ({sign})*({b})*{y}^2"), list)
        }
        _ => {
            // x'' = -a sin(n x + turns pi/2), n a > 0: y = n x + turns pi/2.
            let (n, turns) = [(1.0, 0), (2.0, 1), (1.0, 3), (2.0, 2)][kind as usize - 4];
            let orbit = move |t: f64| {
                let z = (p * n).sqrt() * t;
                [4.0 * (z / 2.0).tanh().atan() / n, 2.0 * (p * n).sqrt() / z.cosh() / n]
            };
            let centre = -f64::from(turns) * PI / 2.0 / n;
            (format!("-({a})*sin({n}*x + {turns}*pi/2)"), both(orbit, 1.0, centre))
        }
    }
}

fn quadrature(orbit: &dyn Fn(f64) -> [f64; 2], g: &dyn Fn(f64, f64, f64) -> f64) -> f64 {
    let term = |n: i32| {
        let t = 0.05 * f64::from(n);
        let [x, v] = orbit(t);
        0.05 * g(t, x, v)
    };
    (-1200..=1200).map(term).sum()
}

/// x^i x'^j, or sin(k x) x'^j.
fn friction(random: &mut Random, wave: bool) -> (String, Box<dyn Fn(f64, f64) -> f64>) {
    let c = decimals(random, 0.2, 1.0);
    let (i, j) =
        ((random.between(0.0, 1.0) * 4.0) as i32, 1 + (random.between(0.0, 1.0) * 3.0) as i32);
    let i = if wave { i.max(1) } else { i };
    let size = c.to_f64();
    if wave {
        let text = format!("({c})*cos({i}*x)^2*x'^{j}");
        let k = f64::from(i);
        return (text, Box::new(move |x, v| size * (k * x).cos().powi(2) * v.powi(j)));
    }
    (format!("({c})*x^{i}*x'^{j}"), Box::new(move |x, v| size * x.powi(i) * v.powi(j)))
}

#[test]
fn random_equations_against_quadrature() {
    let mut random = Random(5);
    let mut least = f64::INFINITY;
    for round in 0..40 {
        let kind = round % 8;
        let (force, orbits) = unperturbed(&mut random, kind);
        let swings = kind >= 4;
        let (first, f) = friction(&mut random, swings);
        let (second, g) = friction(&mut random, swings);
        let damping = move |x: f64, v: f64| f(x, v) - g(x, v) + 0.7 * v;
        let mut size = || decimals(&mut random, 0.3, 1.0);
        let (p, q, r) = (size(), size(), size());
        let factor = if swings { "sin(2*x)" } else { "x^2" };
        let equation = format!(
            "x'' = {force} + eps*(({p})*cos(3/2*t) + ({q})*{factor}*cos(3/2*t) + ({r})*{factor}*sin(3/2*t) \
             - 7/10*x' - {first} + {second})"
        );
        let [p, q, r] = [p, q, r].map(|q| q.to_f64());
        let found = Oscillator::parse(&equation).unwrap();
        let found = found.threshold(&Threshold::default(), &work()).unwrap();
        assert_eq!(found.header.tier, "certified", "{equation}");
        assert_eq!(found.value.orbits.len(), orbits.len(), "{equation}");
        for (known, orbit) in found.value.orbits.iter().zip(&orbits) {
            let d = quadrature(orbit, &|_, x, v| v * damping(x, v));
            let work = |phase: f64| {
                quadrature(orbit, &|t, x, v| {
                    let (angle, g) =
                        (1.5 * t + phase, if swings { (2.0 * x).sin() } else { x * x });
                    v * ((p + q * g) * angle.cos() + r * g * angle.sin())
                })
            };
            let amplitude = work(0.0).hypot(work(PI / 2.0));
            let signed = d * p / amplitude;
            least = least.min(signed.abs());
            let error = (value(&known.signed) - signed).abs();
            assert!(error < 1e-11 * (1.0 + signed.abs()), "{}: {equation} {signed}", known.signed);
        }
    }
    assert!(least > 1e-4);
}

/// Two frequencies on a loop to the left and to the right of its saddle: the extremes of the work differ.
#[test]
fn two_frequencies_on_both_sides_of_a_saddle() {
    for sign in [1.0, -1.0] {
        let equation =
            format!("x'' = x - ({sign})*x^2 + eps*((1 + x)*cos(t) + 4/5*cos(2*t + 3/10) - x^2*x')");
        let found = Oscillator::parse(&equation).unwrap();
        let found = found.threshold(&Threshold::default(), &work()).unwrap().value;
        let orbit = |t: f64| {
            let y = 1.5 / (t / 2.0).cosh().powi(2);
            [sign * y, -sign * y * (t / 2.0).tanh()]
        };
        let d = quadrature(&orbit, &|_, x, v| v * x * x * v);
        let work = |s: f64| {
            quadrature(&orbit, &|t, x, v| {
                v * ((1.0 + x) * (t + s).cos() + 0.8 * (2.0 * (t + s) + 0.3).cos())
            })
        };
        let scan = (0..2000).map(|n| work(f64::from(n) * PI / 1000.0));
        let largest = scan.fold(f64::NEG_INFINITY, f64::max);
        let error = (value(&found.gamma_c) - d / largest).abs();
        assert!(error < 1e-5, "{equation}: {} {}", found.gamma_c, d / largest);
    }
}

/// The orbit in closed form that does not take a factor is followed numerically: two routes to what it does take.
#[test]
fn numeric_orbits_agree_with_closed_ones() {
    let ask = |equation: &str| {
        let found = Oscillator::parse(equation).unwrap();
        let found = found.threshold(&Threshold::default(), &Work { digits: 7, ..work() }).unwrap();
        (found.header.tier, value(&found.value.gamma_c))
    };
    // sin(x/3) leaves the ring; with a factor so small it changes nothing.
    let closed = ask("x'' + sin(x) = eps*(sin(x)*cos(t) - (1 + cos(x))*x')");
    let numeric = ask("x'' + sin(x) = eps*(sin(x)*cos(t) - (1 + cos(x) + 1/10^30*sin(x/3))*x')");
    assert_eq!((closed.0, numeric.0), ("certified", "estimated"));
    assert!((closed.1 - numeric.1).abs() < 1e-6, "{closed:?} {numeric:?}");
    // int (2 gd)^2 (2 sech) cos/sin(z) dz, by the trapezoidal rule.
    let squared = ask("x'' + sin(x) = eps*(x*cos(t) - x^2*x')").1;
    let orbit = |t: f64| [4.0 * (t / 2.0).tanh().atan(), 2.0 / t.cosh()];
    let d = quadrature(&orbit, &|_, x, v| x * x * v * v);
    let f = quadrature(&orbit, &|t, x, v| x * v * t.sin());
    assert!((squared - d / f).abs() < 1e-6, "{squared}");
}

/// x'' + sin x = eps (gamma sin x cos(omega t) - delta x'): 4 delta sinh(pi omega/2)/(pi omega^2); a force that is
/// silent keeps its factor.
#[test]
fn the_parametric_pendulum() {
    let closed =
        |delta: f64, omega: f64| 4.0 * delta * (PI * omega / 2.0).sinh() / (PI * omega * omega);
    let equation = "x'' + sin(x) = eps*(gamma*sin(x)*cos(omega*t) - delta*x')";
    for (gamma, delta, omega) in [("1", "1/5", "3/2"), ("0", "1/3", "2")] {
        let mut found = Oscillator::parse(equation).unwrap();
        for (name, value) in [("gamma", gamma), ("delta", delta), ("omega", omega)] {
            found = found.set(name, value).unwrap();
        }
        let found = found.threshold(&Threshold::default(), &work()).unwrap().value;
        let exact = |text: &str| lindstedt::Exact::parse(text).unwrap().to_f64();
        let error = value(&found.gamma_c) - closed(exact(delta), exact(omega));
        assert!(error.abs() < 1e-12, "{}", found.gamma_c);
        assert_eq!(found.amplitude.to_string(), gamma);
        let harmonic = found.harmonic.unwrap();
        assert_eq!(harmonic.parameter.as_deref(), Some("gamma"));
        assert!(harmonic.term.contains("sin(x)"), "{}", harmonic.term);
    }
}

/// To first order and by the nonlinear time: two routes to mu_0.
#[test]
fn first_order_agrees_with_the_series() {
    for (equation, name) in [
        ("x'' - x + x^3 = eps*(mu - x^2)*x'", "mu"),
        ("x'' = x^2 - 4 + eps*x'*(x + tau)", "tau"),
        ("x'' + (x - 5)^2 - 4 = eps*x'*(5 - x + tau + x^2/7)", "tau"),
        ("x'' = (x + 2) - (x + 2)^3 + eps*(2*mu*x' - (x + 2)^2*x' + x'^3 + (x + 2)^3*mu)", "mu"),
    ] {
        let case = Oscillator::parse(equation).unwrap();
        let series = case.homoclinic(name, 0, &work()).unwrap().value;
        let first = case.persistence(name, &work()).unwrap();
        assert_eq!(first.header.tier, "certified");
        for orbit in &first.value.orbits {
            let difference = value(&series.series[name][0]) - value(&orbit.value);
            assert!(difference.abs() < 1e-13, "{equation}: {}", orbit.value);
        }
    }
}

/// What no series takes: a heteroclinic orbit, both loops of their own, a numeric orbit, a saddle that is moved.
#[test]
fn orbits_that_persist() {
    let ask = |equation: &str, name: &str| {
        let case = Oscillator::parse(equation).unwrap();
        let found = case.persistence(name, &Work { digits: 9, ..work() }).unwrap();
        let orbits = found.value.orbits.iter();
        (found.header.tier, orbits.map(|o| value(&o.value)).collect::<Vec<_>>())
    };
    let near = |found: Vec<f64>, expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 2e-9, "{found:?} {expected:?}");
        }
    };
    // Dry friction at rest: the saddle is on the switching line.
    let case = Oscillator::parse("x'' - x + x^3 = eps*(mu*x' - sign(x'))").unwrap();
    assert!(case.persistence("mu", &work()).unwrap().value.validity.starts_with("fails"));
    // A torque against friction: 4 delta/pi.
    let torque = 0.8 / PI;
    near(ask("x'' + sin(x) = eps*(torque - x'/5)", "torque").1, &[torque, -torque]);
    let orbit = |t: f64| [2f64.sqrt() / t.cosh(), -(2f64.sqrt()) * t.tanh() / t.cosh()];
    let mu =
        quadrature(&orbit, &|_, x, v| x.powi(3) * v * v) / quadrature(&orbit, &|_, _, v| v * v);
    near(ask("x'' - x + x^3 = eps*(mu - x^3)*x'", "mu").1, &[mu, -mu]);
    near(ask("x'' = x^2 - 4 + eps*(x'*(x + tau) + 1)", "tau").1, &[10.0 / 7.0]);
    // x'^2 = x^2 (1 - x^2/2 - x^4/15) on a loop without closed form here, x = x_m sin phi; Simpson's rule.
    let (tier, numeric) = ask("x'' - x + x^3 + x^5/5 = eps*(mu - x^2)*x'", "mu");
    assert_eq!(tier, "estimated");
    let top = ((-0.5 + (0.25f64 + 4.0 / 15.0).sqrt()) * 7.5).sqrt();
    let moment = |n: i32| {
        let at = |i: i32| {
            let phi = f64::from(i) * PI / 4000.0;
            let x = top * phi.sin();
            let v = x * (1.0 - x * x / 2.0 - x.powi(4) / 15.0).max(0.0).sqrt();
            let weight = if i == 0 || i == 2000 { 1.0 } else { f64::from(2 + i % 2 * 2) };
            weight * x.powi(n) * v * phi.cos()
        };
        (0..=2000).map(at).sum::<f64>()
    };
    let mu = moment(2) / moment(0);
    near(numeric, &[mu, mu]);
}

#[test]
fn what_is_refused() {
    let refused = |equation: &str| {
        let found = Oscillator::parse(equation).unwrap().threshold(&Threshold::default(), &work());
        let error = found.unwrap_err();
        format!("{error} ({})", error.hint())
    };
    for (equation, reason) in [
        ("x'' - x + x^3 = eps*(cos(t) - x^2*sign(x' - 1/5))", "depends on x"),
        ("x'' - x + x^3 = eps*(cos(t) - exp(x)*x')", "--section stroboscopic"),
        ("x'' - x + x^3 = eps*(x*sin(x)*cos(t) - x')", "factor of x"),
        ("x'' + sin(x) = eps*(sin(x + 1)*cos(t) - x')", "factor of x"),
        ("x'' + sin(x) = eps*(x'*cos(t) - x')", "no harmonic force"),
        ("x'' - x + x^3 = eps*(mu - x^2)*x'", "--unknown mu"),
        ("x'' - x + x^3 = eps*(1 - x^2)*x'", "--unknown NAME"),
        ("x'' + x = eps*(cos(t) - x')", "no homoclinic or heteroclinic orbit"),
    ] {
        let said = refused(equation);
        assert!(said.contains(reason), "{equation}: {said}");
    }
    let sought = |equation: &str| {
        let found = Oscillator::parse(equation).unwrap().persistence("mu", &work());
        found.unwrap_err().to_string()
    };
    for (equation, reason) in [
        ("x'' - x + x^3 = eps*(mu*cos(t) - x')", "periodic force"),
        ("x'' - x + x^3 = eps*(mu^2 - x^2)*x'", "not linear"),
        ("x'' - x + x^3 = eps*(sign(x' - mu) - x^2*x')", "not linear"),
        ("x'' - mu*x + x^3 = eps*(1 - x^2)*x'", "no factor of the small parameter"),
        ("x'' - x + x^3 = eps*(mu*x - x^2*x')", "does no work"),
        ("x'' - x + x^3 + x^5/5 = eps*(mu*x'^2 - x^2*x')", "does no work"),
    ] {
        let said = sought(equation);
        assert!(said.contains(reason), "{equation}: {said}");
    }
}
