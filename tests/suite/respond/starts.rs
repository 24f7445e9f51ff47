//! Where starts lead.

use super::{ask, to_order};
use lindstedt::{Oscillator, Refusal, Respond, Work};

/// Of two unknowns 1:2 the start at rest leads to the one state; pairs for each unknown, or the form is said.
#[test]
fn starts_of_several_unknowns() {
    let equation = "x'' + x + eps*(x'/10 + x*y) = eps*cos((1 + eps/5)*t); y'' + 4*y + eps*(x^2 + y/10 + y'/10)";
    let question = |start: &str| Respond {
        amplitude: Some("6".parse().unwrap()),
        start: Some(Respond::read_start(start).unwrap()),
        ..to_order(2)
    };
    let leads = ask(equation, &[("eps", "1/10")], &question("0,0,0,0")).leads_to.unwrap();
    assert_eq!((leads.fate, leads.state, leads.decided), ("steady", Some(0), true));
    let case = Oscillator::parse(equation).unwrap().set("eps", "1/10").unwrap();
    assert_eq!(case.respond(&question("0,0"), &Work::default()).unwrap_err().code(), "start");
    assert!(Respond::read_start("1,2,3").is_err());
}

/// A start with a velocity leads to the same state whether the frequency is sqrt(2) or the fraction 17/12 beside it, but where the
/// bound of a basin lies between the two.
#[test]
fn starts_in_the_unit_of_frequency() {
    let set = [("eps", "1/10"), ("F", "1"), ("sigma", "1")];
    let state = |square: &str, nu: &str, velocity: i32| {
        let equation =
            format!("x'' + {square}*x + eps*(x'/5 + x^3) = eps*F*cos(({nu} + eps*sigma)*t)");
        let start = Some(Respond::read_start(&format!("1,{velocity}/4")).unwrap());
        ask(&equation, &set, &Respond { start, ..to_order(1) }).leads_to.unwrap().state
    };
    let pairs: Vec<_> =
        (-16..=16).map(|v| [state("289/144", "17/12", v), state("2", "sqrt(2)", v)]).collect();
    let apart = pairs.iter().filter(|[a, b]| a != b).count();
    let bounds = pairs.windows(2).filter(|two| two[0][0] != two[1][0]).count();
    assert!(apart <= bounds && bounds > 0, "{pairs:?}");
    assert!(apart <= 1, "{pairs:?}");
}

/// Of a start at the rim of a basin the leading order does not decide. In time the first comes to rest (2400 periods), the slow flow
/// to a state of amplitude 2.24; the others leave rest, which is unstable, for a state that the force of order eps chooses.
#[test]
fn a_start_at_the_rim_is_undecided() {
    let rim = "x'' + x + eps*(x^3 + x'/20) = 8*cos((3 + eps*s)*t)";
    let thin = "x'' + x + eps*(x'/5 + x^3) = 3*cos(3*(1 + eps*s)*t)";
    let rest = "x'' + x + eps*(x'/10 - x*cos(2*t) + x^3 + x^2) = 5*eps*cos(5*t)";
    for (equation, set, start, order) in [
        (rim, &[("eps", "1/20"), ("s", "5")][..], "0,0", 3),
        (rest, &[("eps", "1/10")], "0,0", 2),
        (rest, &[("eps", "1/10")], "-1/100,0", 2),
        (rest, &[("eps", "1/10")], "-1/50,0", 2),
        // In time a third of the frequency, not rest (DOP853, 450 periods): neighbours along the axes go to rest, others do not.
        (thin, &[("eps", "1/5"), ("s", "1/2")], "1.43,-0.76", 2),
        (thin, &[("eps", "1/5"), ("s", "1/2")], "1.43,-0.76", 3),
        (thin, &[("eps", "1/5"), ("s", "1/2")], "1.14,0.35", 2),
    ] {
        let start = Some(Respond::read_start(start).unwrap());
        let found = ask(equation, set, &Respond { start, ..to_order(order) });
        assert!(!found.leads_to.unwrap().decided, "{equation}");
    }
}

/// Far outside the box the slow flow of order two runs off where the damping of the equation wins (a = 0.1137 in time): nothing is
/// decided there. A weakly damped motion is followed to its end; a forced van der Pol oscillator out of step beats for ever.
#[test]
fn starts_outside_the_box_are_undecided() {
    let hard = "x'' + x + eps*(x'/5 + x^3) = eps*cos((1+eps*sigma)*t)/2";
    let weak = "x'' + x + eps*(x'/1000 + x^3) = eps*cos((1+eps)*t)/2";
    let beats = "x'' + x = eps*((1 - x^2)*x' + cos((1 + 2*eps)*t))";
    for (equation, set, start, order, known) in [
        (hard, &[("sigma", "2"), ("eps", "1/10")][..], "4,4", 2, None),
        (hard, &[("sigma", "2"), ("eps", "1/10")], "1,0", 2, Some("steady")),
        (weak, &[("eps", "1/1000")], "1,0", 1, Some("steady")),
        (beats, &[("eps", "1/10")], "1,0", 1, Some("cycle")),
    ] {
        let start = Some(Respond::read_start(start).unwrap());
        let leads = ask(equation, set, &Respond { start, ..to_order(order) }).leads_to.unwrap();
        match known {
            Some(fate) => assert_eq!((leads.decided, leads.doubt, leads.fate), (true, None, fate)),
            None => assert_eq!(leads.doubt, Some("the start lies outside the box")),
        }
    }
}
