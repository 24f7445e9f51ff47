//! Averaging between turning points: exact laws, and the equation integrated in time as the judge.

use lindstedt::averaging::{Averaging, Coefficient, RateTerm};
use lindstedt::motion::End;
use lindstedt::{Exact, Kind, Oscillator, Refusal, Simulate, Work};
use std::f64::consts::PI;

fn averaged(equation: &str, order: usize) -> Averaging {
    let found =
        Oscillator::parse(equation).unwrap().average(order, &Work::default()).unwrap().value;
    assert!(found.exact && found.between_turning_points());
    assert_eq!(found.checked_orders, order);
    found
}

/// The rate as exact text.
fn shown(rate: &[RateTerm]) -> Vec<(i32, String)> {
    let exact = |term: &RateTerm| match &term.coefficient {
        Coefficient::Number(number) | Coefficient::ClosedForm { number, .. } => {
            number.exact.clone().unwrap()
        }
        Coefficient::Formula(formula) => formula.text().to_owned(),
    };
    rate.iter().map(|term| (term.exponent, exact(term))).collect()
}

/// sum eps^n rate_n(a).
fn sum(rates: &[Vec<RateTerm>], eps: f64, a: f64) -> f64 {
    let value = |term: &RateTerm| {
        let Coefficient::ClosedForm { number, .. } = &term.coefficient else { panic!() };
        number.decimal.parse::<f64>().unwrap() * a.powi(term.exponent)
    };
    let order = |rate: &Vec<RateTerm>| rate.iter().map(value).sum::<f64>();
    rates.iter().rev().fold(0.0, |sum, rate| sum * eps + order(rate))
}

#[test]
fn coulomb_ends_at_order_one() {
    let found = averaged("x'' + x + eps*sign(x') = 0", 10);
    assert_eq!(shown(&found.amplitude_rate[1]), [(0, "-2*pi^(-1)".to_owned())]);
    assert!(found.amplitude_rate[2..].iter().chain(&found.phase_rate[1..]).all(Vec::is_empty));
    assert!(found.solution[2..].iter().all(|u| u.text() == "0"));
}

/// f = mu x' - nu x'|x'|: A_1 = mu a/2 - 4 nu omega a^2/(3 pi); the cubic force 3/8 k a^2/omega; sign(3 x') is
/// sign(x'), |x'^3| is -x'^3 where x' < 0, x' has the factor omega.
#[test]
fn laws_with_symbols() {
    let law = "x'' + omega^2*x = eps*(mu*x' - nu*x'*abs(x')) - eps^2*k*x^3";
    let found = averaged(law, 2);
    assert_eq!(found.symbols, ["k", "mu", "nu", "omega"]);
    let first = [(1, "1/2*mu".to_owned()), (2, "-4/3*nu*omega*pi^(-1)".to_owned())];
    assert_eq!(shown(&found.amplitude_rate[1]), first);
    let second = shown(&found.phase_rate[2]);
    assert_eq!(second[2].1, "3/8*k*omega^(-1) - 1/6*nu^2*omega");
    let one = averaged("x'' + 4*x + eps*sign(3*x')*abs(x'^3)*pi/2 = 0", 2);
    let other = averaged("x'' + 4*x + eps*x'^2*abs(x')*sign(x')*pi/2 = 0", 2);
    assert_eq!(shown(&one.amplitude_rate[1]), shown(&other.amplitude_rate[1]));
    // A_1 = -<f(2 a sin psi) sin psi>/2 over a turn, f = pi/2 v^3: -(1/2)(pi/2)(8 a^3)(3/8).
    assert_eq!(shown(&one.amplitude_rate[1]), [(3, "-3/4*pi".to_owned())]);
}

/// At psi = 4 pi the motion turns: x = a, x' = 0. What is missed falls like eps^(N+1).
#[test]
fn a_mixed_law_agrees_with_the_equation_in_time() {
    let law = "x'*abs(x') + sign(x')/5 + x^3 - x'/3";
    let found = averaged(&format!("x'' + 4*x + eps*({law}) = 0"), 3);
    let miss = |n: usize, eps: f64| {
        let steps = 400;
        let (h, mut a, mut t) = (4.0 * PI / f64::from(steps), 1.0, 0.0);
        let pace = |a: f64| 1.0 / sum(&found.phase_rate[..=n], eps, a);
        let slope = |a: f64| sum(&found.amplitude_rate[..=n], eps, a) * pace(a);
        for _ in 0..steps {
            let k1 = slope(a);
            let k2 = slope(a + h / 2.0 * k1);
            let k3 = slope(a + h / 2.0 * k2);
            let k4 = slope(a + h * k3);
            // The time by Simpson's rule along the same step.
            let next = a + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            let middle = (a + next) / 2.0 + h / 8.0 * (k1 - k4);
            t += h / 6.0 * (pace(a) + 4.0 * pace(middle) + pace(next));
            a = next;
        }
        let equation = format!("x'' + 4*x + {eps}*({law}) = 0");
        let end = Some(End::Time(Exact::from_f64(t).unwrap()));
        let mut question = Simulate { end, ..Simulate::default() };
        question.start.state = Some(vec![Exact::from(1), Exact::from(0)]);
        let work = Work { digits: 13, ..Work::default() };
        let [_, x, v] = Oscillator::parse(&equation)
            .unwrap()
            .motion(&question, &work)
            .unwrap()
            .value
            .last
            .place;
        (x - a).hypot(v / 2.0)
    };
    for n in 1..=3 {
        let slope = (miss(n, 0.01) / miss(n, 0.005)).log2();
        assert!((slope - n as f64 - 1.0).abs() < 0.3, "order {n}: slope {slope}");
    }
}

#[test]
fn what_is_not_covered_says_why() {
    for (law, words) in [
        ("sign(x') + x^2", "x^2 is not odd"),
        ("abs(x)*x'^3", "abs(x) is not smooth"),
        ("sign(x' - 1)", "is not smooth"),
        ("sign(x')*cos(3*t)", "depends on t"),
        ("sign(x')*exp(-abs(x'))", "is no polynomial"),
        ("sign(x') + x(t - 1)", "is a delay"),
    ] {
        let oscillator = Oscillator::parse(&format!("x'' + x + eps*({law}) = 0")).unwrap();
        let error = oscillator.average(1, &Work::default()).unwrap_err();
        assert!(error.to_string().contains(words), "{law}: {error}");
        assert_eq!(error.kind(), Kind::NoAnswer);
        assert!(error.hint().contains("simulate"), "{law}: {}", error.hint());
    }
    let high = Oscillator::parse("x'' + x + eps*m^999*x'*abs(x') = 0").unwrap();
    assert_eq!(high.average(20, &Work::default()).unwrap_err().code(), "no-expansion");
    assert!(high.average(1, &Work::default()).is_ok());
    // The same without a jump: m^40000 at order 2 has no place in the exponents.
    let high = Oscillator::parse("x'' + x + eps*(m^1000)^20*x^2*x' = 0").unwrap();
    assert_eq!(high.average(2, &Work::default()).unwrap_err().code(), "no-expansion");
    let lower = Oscillator::parse("x'' + x + eps*m^1000*x^2*x' = 0").unwrap();
    let found = lower.average(3, &Work::default()).unwrap().value;
    assert_eq!(shown(&found.amplitude_rate[3]), [(7, "-37/8192*m^3000".to_owned())]);
    let irrational = Oscillator::parse("x'' + 2*x + eps*sign(x') = 0").unwrap();
    assert_eq!(irrational.average(1, &Work::default()).unwrap_err().code(), "no-expansion");
}

/// A belt of speed v below x'' + x = -eps f(x' - v), f(w) = sign w - w + w^3/3: as long as x' < v sign is -1, a
/// polynomial law with the cycle a^2 = 4 (1 - v^2), which touches the belt at v^2 = 4/5, v = 0.8944.
#[test]
fn a_cycle_on_a_belt_begins_to_stick_where_it_meets_its_speed() {
    for (v, sticks) in [("89/100", true), ("9/10", false)] {
        let below = format!("x'' + x + eps*((x' - {v})^3/3 - (x' - {v}) - 1) = 0");
        let found = Oscillator::parse(&below).unwrap().average(1, &Work::default()).unwrap().value;
        let cycles = found.cycles.unwrap().cycles;
        let amplitude: f64 = cycles[0].amplitude.decimal.parse().unwrap();
        assert!(cycles.len() == 1 && cycles[0].stable);
        let speed = Exact::parse(v).unwrap().to_f64();
        assert_eq!(amplitude > speed, sticks);
        let belt = format!("x'' + x + 1/50*((x' - {v})^3/3 - (x' - {v}) + sign(x' - {v})) = 0");
        let end = Some(End::Time(Exact::from(200)));
        let mut question = Simulate { end, ..Simulate::default() };
        question.start.state = Some(vec![Exact::from_f64(amplitude).unwrap(), Exact::from(0)]);
        let work = Work { doubles: true, ..Work::default() };
        let motion = Oscillator::parse(&belt).unwrap().motion(&question, &work).unwrap().value;
        let sticking: f64 = motion.sticking_time.decimal.parse().unwrap();
        assert_eq!(sticking > 0.0, sticks, "v = {v}: {sticking}");
    }
}
