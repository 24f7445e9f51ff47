//! Slow flows from equations as text: reference numbers, the ways to write a detuning, refusals by name.

#![allow(clippy::unwrap_used, clippy::panic)]

use lindstedt_derivation::DerivationError;
use lindstedt_derivation::resonance::{FlowSettings, ResonanceError, SlowFlow, slow_flow};
use lindstedt_number::Exact;
use lindstedt_phase::amplitudes::AmplitudeTerm;
use lindstedt_problem_file::{Names, parse_equation};
use rug::Rational;
use std::collections::BTreeMap;

type Powers = BTreeMap<String, i32>;
type Named = BTreeMap<Powers, [Rational; 2]>;

fn found(equation: &str, order: usize, set: &[(&str, &str)]) -> Result<SlowFlow, DerivationError> {
    let equation = parse_equation(equation, &Names::any("eps")).unwrap();
    let value = |(name, text): &(&str, &str)| ((*name).to_owned(), Exact::parse(text).unwrap());
    let given = set.iter().map(value).collect();
    let settings = FlowSettings { order, given: &given, cards: &[], stop: Default::default() };
    slow_flow(&[equation], &settings, &mut |_| true)
}

fn flow(equation: &str, order: usize, set: &[(&str, &str)]) -> SlowFlow {
    let found = found(equation, order, set).unwrap();
    assert_eq!(found.checked_orders, Some(order));
    found
}

fn refused(equation: &str) -> ResonanceError {
    match found(equation, 2, &[]) {
        Err(DerivationError::Resonance(error)) => error,
        other => panic!("{equation}: {:?}", other.map(|found| found.order)),
    }
}

/// Terms by the names of their factors.
fn named(found: &SlowFlow, terms: &[AmplitudeTerm]) -> Named {
    let phases = (1..=found.unknowns()).flat_map(|j| [format!("z{j}"), format!("zbar{j}")]);
    let names: Vec<String> =
        phases.chain(["E".to_owned()]).chain(found.system.symbols.iter().cloned()).collect();
    let powers = |exponents: &[i32]| {
        let all = names.iter().cloned().zip(exponents.iter().copied());
        all.filter(|(_, n)| *n != 0).collect::<Powers>()
    };
    terms.iter().map(|t| (powers(&t.exponents), [t.re.clone(), t.im.clone()])).collect()
}

/// Orders 1 to 3 of the oscillators of `tests/data/resonance`, where it says where the numbers come from.
#[test]
fn reference_flows() {
    let text = include_str!("../../../../tests/data/resonance/slow-flows.json");
    let data: serde_json::Value = serde_json::from_str(text).unwrap();
    let weak = "x'' + x + eps*(s*x + 2*mu*x' + al*x^3)";
    let cases = [
        ("primary", format!("{weak} = eps*F*cos(t)")),
        ("superharmonic", format!("{weak} = F*cos(t/3)")),
        ("van_der_pol_forced", "x'' + x + eps*(s*x - (1 - x^2)*x') = eps*F*cos(t)".to_owned()),
    ];
    let number = |v: &serde_json::Value| v.as_str().unwrap().parse::<Rational>().unwrap();
    for (name, equation) in cases {
        let found = flow(&equation, 3, &[]);
        for (order, unknowns) in data["cases"][name]["orders"].as_object().unwrap() {
            for (j, list) in unknowns.as_array().unwrap().iter().enumerate() {
                let term = |t: &serde_json::Value| {
                    let powers = t["powers"].as_object().unwrap().iter();
                    let powers = powers.map(|(k, n)| (k.clone(), n.as_i64().unwrap() as i32));
                    (powers.collect::<Powers>(), [number(&t["re"]), number(&t["im"])])
                };
                let expected: Named = list.as_array().unwrap().iter().map(term).collect();
                let order: usize = order.parse().unwrap();
                assert_eq!(named(&found, &found.flow[j][order]), expected, "{name} {order}");
            }
        }
    }
}

/// eta' = 1 + eps sigma is the same, written in the force or as a frequency that is a number.
#[test]
fn detunings() {
    let written = flow("x'' + x + eps*x^3 = eps*F*cos((1 + eps*sigma)*t)", 3, &[]);
    let number = flow("x'' + x + eps*x^3 = eps*F*cos(omega*t)", 3, &[("omega", "1.02")]);
    assert_eq!(written.system.detuning, number.system.detuning);
    assert_eq!(number.system.beside.as_ref().unwrap().rate, Rational::from((51, 50)));
    assert_eq!(written.flow[0], number.flow[0]);
    // The second harmonic of the same phase is detuned twice as much.
    let both = "x'' + x = eps*x^2*cos((1 + eps*sigma)*t) + eps*cos(2*(1 + eps*sigma)*t)";
    assert_eq!(flow(both, 2, &[]).system.force, 1);
    let second = refused("x'' + x = eps*cos((1 + eps*sigma)*t) + eps*cos(2*t)");
    assert_eq!(second, ResonanceError::SecondPhase);
    // The resonance 2/3 is none of order zero: nothing is detuned.
    let off = flow("x'' + x + eps*x^3 = F*cos(omega*t)", 2, &[("omega", "2/3")]);
    assert_eq!((off.system.force, off.system.beside), (Rational::from((2, 3)), None));
}

/// What has no slow flow says why, by name.
#[test]
fn refusals() {
    use ResonanceError::{
        Delay, NoOscillation, NoRationalModes, NotAForce, NotWeaklyNonlinear, Unset,
    };
    let is = |equation: &str, kind: fn(&ResonanceError) -> bool| {
        let error = refused(equation);
        assert!(kind(&error), "{equation}: {error}");
    };
    is("x'' + 2*x = eps*F*cos(t)", |e| matches!(e, NoRationalModes { .. }));
    is("x'' - x = eps*F*cos(t)", |e| matches!(e, NoOscillation { .. }));
    is("x'' + x + x^3 = eps*cos(t)", |e| matches!(e, NotWeaklyNonlinear { .. }));
    is("x'' + x + x' = eps*cos(t)", |e| matches!(e, NotWeaklyNonlinear { .. }));
    is("x'' + x*(1 + cos(2*t)) = eps*x^2", |e| matches!(e, NotWeaklyNonlinear { .. }));
    is("x'' + x = eps*cos(omega*t)", |e| matches!(e, Unset { .. }));
    is("x'' + x + eps*x(t - 1) = eps*cos(t)", |e| matches!(e, Delay { .. }));
    is("x'' + x = eps*cos(t) + eps*cos(t^2)", |e| matches!(e, NotAForce { .. }));
}
