//! First-order averaging of any law as numbers: exact rates, Bessel functions, the equation in time.

use lindstedt::averaging::{Coefficient, RateTerm};
use lindstedt::evaluate::{Belt, FirstOrder};
use lindstedt::motion::End;
use lindstedt::{Exact, Kind, Number, Oscillator, Refusal, Simulate, Work};
use lindstedt_simulate::{Doubles, Integrator, Model, Parameters, Settings};
use std::f64::consts::PI;
use std::ops::ControlFlow;

fn first_order(equation: &str, largest: &str) -> FirstOrder {
    let case = Oscillator::parse(equation).unwrap();
    case.first_order(&Exact::parse(largest).unwrap(), &Work::default()).unwrap().value
}

fn value(number: &Number) -> f64 {
    number.decimal.parse().unwrap()
}

/// Within its own error, with a digit of rounding.
fn assert_is(number: &Number, exact: f64) {
    let error: f64 = number.error.as_ref().unwrap().parse().unwrap();
    assert!((value(number) - exact).abs() <= error && error < 1e-9, "{number:?} {exact}");
}

/// Of odd laws, polynomial on each half turn, the exact rates of first order.
#[test]
fn odd_laws_have_their_exact_rates() {
    for law in [
        "sign(x')",
        "x'*abs(x') + x^3",
        "x^2*sign(x') - x'/3 + x'^2*x",
        "x*abs(x') + abs(x'^3)*sign(x')",
    ] {
        let equation = format!("x'' + 4*x + eps*({law}) = 0");
        let found = first_order(&equation, "13/10");
        let exact =
            Oscillator::parse(&equation).unwrap().average(1, &Work::default()).unwrap().value;
        assert!(exact.between_turning_points());
        let sum = |rate: &[RateTerm]| {
            let term = |term: &RateTerm| match &term.coefficient {
                Coefficient::ClosedForm { number, .. } | Coefficient::Number(number) => {
                    value(number) * 1.3f64.powi(term.exponent)
                }
                Coefficient::Formula(formula) => panic!("{formula:?}"),
            };
            rate.iter().map(term).sum::<f64>()
        };
        assert_is(&found.amplitude_rate, sum(&exact.amplitude_rate[1]));
        assert_is(&found.phase_rate, sum(&exact.phase_rate[1]));
    }
}

/// A root within a turn has an infinite slope, and is no pole: quadrature in 30 digits, split there.
#[test]
fn roots_within_a_turn() {
    for (power, largest, exact) in [
        ("1/3", "2", -0.717_434_325_889_681),
        ("1/3", "1/2", -0.311_504_900_990_815),
        ("1/10", "2", -0.649_030_889_887_980),
    ] {
        let law = format!("sign(x' + 2/5)*abs(x' + 2/5)^({power})");
        let found = first_order(&format!("x'' + x + eps*{law} = 0"), largest);
        assert!(found.unresolved.is_empty(), "{:?}", found.unresolved);
        assert_is(&found.amplitude_rate, exact);
    }
}

/// Intervals end where the amplitudes asked for end, though the search goes on by a cell.
#[test]
fn nothing_is_said_beyond_the_amplitudes_asked_for() {
    let steady = first_order("x'' + x + eps*x^3 = 0", "2").steady;
    assert!(matches!(steady[..], [[from, 2.0]] if from < 0.01), "{steady:?}");
}

/// Forces of x alone, however large, hide neither the cycle of van der Pol's law nor its errors; the rate of the phase is that
/// where the amplitude may be: 5/16 10^6 a^4.
#[test]
fn a_stiff_spring_hides_nothing() {
    let error = |number: &Number| number.error.as_ref().unwrap().parse::<f64>().unwrap();
    for spring in ["1000000*x^5", "exp(20*x) - 1", "100000000000000*x^3*abs(x)^(1/2)"] {
        let found = first_order(&format!("x'' + x + eps*({spring} - x'*(1 - x^2)) = 0"), "3");
        assert_eq!((found.cycles.len(), found.touching.len(), found.steady.len()), (1, 0, 0));
        let cycle = &found.cycles[0];
        assert!((value(&cycle.amplitude) - 2.0).abs() <= error(&cycle.amplitude), "{found:?}");
        assert_is(&found.amplitude_rate, 1.5 - 27.0 / 8.0);
        if spring == "1000000*x^5" {
            assert!(
                (value(&cycle.phase_rate) - 5e6).abs() <= error(&cycle.phase_rate),
                "{found:?}"
            );
        }
    }
}

/// Cycles at a = 1 and sqrt(1 + 10^-5): the rate of the phase, 15/4 a^2, is as unsure as the amplitude.
#[test]
fn the_phase_of_close_cycles_is_as_unsure_as_their_amplitude() {
    let law = "x'*(x^2 + x'^2 - 1)*(x^2 + x'^2 - 1 - 1/100000) + 10*x^3";
    let found = first_order(&format!("x'' + x + eps*({law}) = 0"), "203/100");
    assert_eq!(found.cycles.len(), 2, "{found:?}");
    let rate = &found.cycles[0].phase_rate;
    let error: f64 = rate.error.as_ref().unwrap().parse().unwrap();
    assert!((value(rate) - 3.75).abs() <= error && error < 1e-7, "{found:?}");
}

/// f(w) = sgn w - w + w^3/3: a^2 = 4 (1 - v^2), lambda = -(1 - v^2) eps while a < v, and a = v at v^2 = 4/5.
#[test]
fn a_polynomial_law_on_a_belt() {
    let law = |v: &str| format!("x'' + x + eps*(sign(x' - {v}) - (x' - {v}) + (x' - {v})^3/3) = 0");
    let found = first_order(&law("9/10"), "2");
    assert_eq!(found.cycles.len(), 1, "{found:?}");
    let cycle = &found.cycles[0];
    assert_is(&cycle.amplitude, 0.76f64.sqrt());
    assert_is(&cycle.exponent, -0.19);
    assert!(cycle.stable == Some(true) && cycle.belt == Some(Belt::Slower));
    assert!(found.belt.is_none() && found.sticking.is_empty());
    let case = Oscillator::parse(&law("vstar")).unwrap().set("vstar", "1/2").unwrap();
    let found = case.first_order(&Exact::from(2), &Work::default()).unwrap().value;
    assert_eq!((found.belt.as_deref(), found.sticking.len()), (Some("vstar"), 1));
    assert_is(&found.sticking[0].value, 0.8f64.sqrt());
    // Faster than the belt, which it overtakes: how far is a matter of the jump.
    assert_eq!(found.cycles.len(), 1);
    assert!(
        value(&found.cycles[0].amplitude) > 0.5 && found.cycles[0].belt == Some(Belt::Overtakes)
    );
    // It meets the belt at x = 0.14, where friction is up to eps.
    let stuck = case.set("eps", "1/5").unwrap().first_order(&Exact::from(2), &Work::default());
    assert_eq!(stuck.unwrap().value.cycles[0].belt, Some(Belt::Sticks));
}

/// I_1(z).
fn bessel(z: f64) -> f64 {
    let terms = (0..40).scan(z / 2.0, |term, k| {
        let here = *term;
        *term *= z * z / 4.0 / (f64::from(k + 1) * f64::from(k + 2));
        Some(here)
    });
    terms.sum()
}

/// Stribeck's law with a cubic damper; slower than the belt A_1 = e^(-2 v) I_1(2 a) - 3 a^3/16.
fn stribeck(v: &str) -> String {
    format!("x'' + x + eps*(sign(x' - {v})*(1 + exp(-2*abs(x' - {v}))) + x'^3/2) = 0")
}

#[test]
fn stribecks_law_has_bessel_functions() {
    let rate = |v: f64, a: f64| (-2.0 * v).exp() * bessel(2.0 * a) - 3.0 * a.powi(3) / 16.0;
    assert_is(&first_order(&stribeck("6/5"), "1").amplitude_rate, rate(1.2, 1.0));
    let found = first_order(&stribeck("6/5"), "2");
    let (mut low, mut high) = (0.1, 1.2);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if rate(1.2, middle) > 0.0 { low = middle } else { high = middle }
    }
    assert_eq!(found.cycles.len(), 1);
    assert_is(&found.cycles[0].amplitude, low);
    let slope = (rate(1.2, low + 1e-4) - rate(1.2, low - 1e-4)) / 2e-4;
    assert!((value(&found.cycles[0].exponent) - slope).abs() < 1e-8);
}

/// The amplitude after one turn, by the equation in time.
fn turn(equation: &str, eps: f64, a: f64) -> f64 {
    let case = Oscillator::parse(equation).unwrap();
    let model = Model::second_order(&case.problem().equation).unwrap().with_small("eps");
    let parameters = Parameters::new().with("eps", Exact::from_f64(eps).unwrap());
    let system = model.compile(Doubles, &parameters).unwrap();
    let mut flow = Integrator::new(&system, &0.0, &[0.0, a], Settings::for_digits(14)).unwrap();
    flow.advance(&(2.0 * PI), &mut |_| ControlFlow::Continue(())).unwrap();
    let state = flow.state();
    state[0].hypot(state[1])
}

/// Slower than the belt and overtaking it: a turn changes the amplitude by 2 pi eps A_1 + O(eps^2). (From x = 0: the
/// shift of the centre by friction's mean is felt only later.)
#[test]
fn rates_are_those_of_the_equation() {
    for a in ["7/10", "8/5"] {
        let law = stribeck("6/5");
        let rate = value(&first_order(&law, a).amplitude_rate);
        let a = Exact::parse(a).unwrap().to_f64();
        let miss = |eps: f64| (turn(&law, eps, a) - a) / (2.0 * PI * eps) - rate;
        let (coarse, fine) = (miss(0.01), miss(0.005));
        assert!(fine.abs() < 0.05 && (coarse / fine - 2.0).abs() < 0.4, "{a}: {coarse} {fine}");
    }
}

/// Where Stribeck's cycle is as fast as the belt: 1 % below it sticks in time, 1 % above it does not.
#[test]
fn sticking_begins_there_in_time() {
    let case = Oscillator::parse(&stribeck("vstar")).unwrap().set("vstar", "1").unwrap();
    let found = case.first_order(&Exact::from(2), &Work::default()).unwrap().value;
    assert_eq!(found.sticking.len(), 1);
    let v = value(&found.sticking[0].value);
    let gap = |v: f64| (-2.0 * v).exp() * bessel(2.0 * v) - 3.0 * v.powi(3) / 16.0;
    assert!(gap(v - 1e-6) > 0.0 && gap(v + 1e-6) < 0.0, "{v}");
    for (factor, sticks) in [(0.99, true), (1.01, false)] {
        let law = stribeck(&format!("{:.6}", factor * v)).replace("eps", "0.01");
        let mut question =
            Simulate { end: Some(End::Time(Exact::from(1000))), ..Simulate::default() };
        question.start.state = Some(vec![Exact::from_f64(0.97 * v).unwrap(), Exact::from(0)]);
        let work = Work { doubles: true, ..Work::default() };
        let motion = Oscillator::parse(&law).unwrap().motion(&question, &work).unwrap().value;
        let sticking: f64 = motion.sticking_time.decimal.parse().unwrap();
        assert_eq!(sticking > 0.0, sticks, "{factor}: {sticking}");
    }
}

#[test]
fn what_it_does_not_take_is_named() {
    for (equation, word) in [
        ("x'' + x + eps*cos(t) = 0", "depends on t"),
        ("x'' + x^3 + eps*x' = 0", "only a linear spring"),
        ("x'' - x + eps*x' = 0", "there is no spring"),
        ("x'' + x + eps*x'(t - 1) = 0", "is a delay"),
        ("x'' + x + eps*x' + eps^2*x^3 = 0", "of higher order"),
    ] {
        let refused =
            Oscillator::parse(equation).unwrap().first_order(&Exact::from(2), &Work::default());
        let refused = refused.unwrap_err();
        assert_eq!(refused.kind(), Kind::NoAnswer, "{equation}");
        assert!(refused.to_string().contains(word), "{refused}");
    }
    let case = Oscillator::parse("x'' + x + eps*x' = 0").unwrap();
    assert_eq!(
        case.first_order(&Exact::from(0), &Work::default()).unwrap_err().kind(),
        Kind::Usage
    );
}

/// The means of sin^2, sin^4, sin^6 are 1/2, 3/8, 5/16: w (8 w^4/5 - 8 w^2/3 + 1 + d), w = x', has the rate
/// A_1 = -(a/2) ((a^2 - 1)^2 + d).
#[test]
fn touching_zeros_are_said() {
    let law = |last: &str| format!("x'' + x + eps*x'*(8/5*x'^4 - 8/3*x'^2 + {last}) = 0");
    let found = first_order(&law("1"), "2");
    assert!(found.cycles.is_empty() && found.steady.is_empty(), "{found:?}");
    assert_eq!(found.touching.len(), 1);
    let error: f64 = found.touching[0].error.as_ref().unwrap().parse().unwrap();
    assert!((value(&found.touching[0]) - 1.0).abs() <= error && error < 1e-6, "{found:?}");
    // Two cycles much closer than the grid: a^2 = 1 +- 10^-4.
    let found = first_order(&law("(1 - 1/100000000)"), "2");
    assert!(found.cycles.len() == 2 && found.touching.is_empty(), "{found:?}");
    for (cycle, square) in found.cycles.iter().zip([1.0 - 1e-4, 1.0 + 1e-4]) {
        assert_is(&cycle.amplitude, f64::sqrt(square));
    }
    assert_eq!([found.cycles[0].stable, found.cycles[1].stable], [Some(false), Some(true)]);
    // None.
    let found = first_order(&law("(1 + 1/1000000)"), "2");
    assert!(found.cycles.is_empty() && found.touching.is_empty(), "{found:?}");
}

/// A conservative law, and a clearance: |x'| <= 1 feels nothing.
#[test]
fn steady_states_are_said() {
    let found = first_order("x'' + x + eps*x^3 = 0", "2");
    assert!(found.cycles.is_empty() && found.unresolved.is_empty());
    assert!(found.steady.len() == 1 && found.steady[0][0] < 0.01 && found.steady[0][1] >= 2.0);
    let found = first_order("x'' + x + eps*x'*(abs(x' - 1) + abs(x' + 1) - 2) = 0", "2");
    assert!(found.cycles.is_empty() && found.steady.len() == 1, "{found:?}");
    assert!((found.steady[0][1] - 1.0).abs() < 0.01, "{found:?}");
}

/// The law sgn w - w + w^3/3 at v^2 = 4/5 has its cycle as fast as the belt.
#[test]
fn a_cycle_as_fast_as_the_belt_is_undecided() {
    let law = "x'' + x + eps*(sign(x' - vstar) - (x' - vstar) + (x' - vstar)^3/3) = 0";
    let v = format!("{:.18}", 0.8f64.sqrt());
    let case = Oscillator::parse(law).unwrap().set("vstar", &v).unwrap();
    let found = case.first_order(&Exact::from(2), &Work::default()).unwrap().value;
    let near =
        found.cycles.iter().find(|cycle| (value(&cycle.amplitude) - 0.8f64.sqrt()).abs() < 1e-9);
    let near = near.unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!((near.belt, near.stable), (Some(Belt::Undecided), None), "{found:?}");
}

/// A pole that is met is refused, and said where it is met further on; fast laws are resolved or said.
#[test]
fn integrals_that_do_not_converge_are_said() {
    let refused = |law: &str, largest: &str| {
        let case = Oscillator::parse(law).unwrap();
        case.first_order(&Exact::parse(largest).unwrap(), &Work::default()).unwrap_err()
    };
    assert_eq!(refused("x'' + x + eps*(1/x - x') = 0", "3").code(), "no-value");
    for law in ["x'' + x + eps/(x' - 1/2) = 0", "x'' + x + eps*x/(x' - 1/2)^2 = 0"] {
        let found = refused(law, "3");
        assert!(found.code() == "no-value" && found.to_string().contains("converge"), "{found}");
        // Smaller amplitudes do not meet it.
        let found = first_order(law, "2/5");
        assert!(found.unresolved.is_empty(), "{found:?}");
    }
    assert_eq!(refused("x'' + x + eps*cos(1000000*x')*x' = 0", "3").code(), "no-value");
    // A_1 = -(J_1(z) - z J_2(z))/50, z = 50 a, by parts: its zeros are about pi/50 apart.
    let found = first_order("x'' + x + eps*cos(50*x')*x' = 0", "1/2");
    assert!(found.unresolved.is_empty());
    let places: Vec<f64> = found.cycles.iter().map(|cycle| value(&cycle.amplitude)).collect();
    assert!(places.len() == 8, "{places:?}");
    for pair in places.windows(2) {
        assert!((pair[1] - pair[0] - PI / 50.0).abs() < 0.01, "{pair:?}");
    }
}
