//! Traps of averaging at resonance: each is refused with a code and a reason of its own, by every question alike.

use lindstedt::respond::Respond;
use lindstedt::verify::Verify;
use lindstedt::{Error, Oscillator, Refusal, Work};

type Question = fn(&Oscillator, &Work) -> Option<Error>;
const AVERAGE: Question = |case, work| case.averaged(2, work).err();
const RESPOND: Question = |case, work| case.respond(&Respond::default(), work).err();
const VERIFY: Question = |case, work| case.verify(&Verify::default(), work).err();
const NORMAL_MODE: Question = |case, work| case.normal_mode(1, 2, work).err();

#[test]
fn every_trap_is_refused_by_its_own_name() {
    let forced = |force: &str| format!("x'' + x + eps*x^3 = eps*{force}");
    let alike = [AVERAGE, RESPOND, VERIFY];
    let traps: [(&str, &[Question], &str, &str); 6] = [
        (&forced("cos(sqrt(2)*t)"), &alike, "ratio-not-rational", "irrational number"),
        (&forced("cos((1 + sigma)*t)"), &alike, "detuning-not-small", "is not small"),
        (&forced("cos(1000001/1000000*t)"), &[VERIFY], "near-miss", "misses a resonance"),
        (
            "x'' + x - y + eps*x^3 = 0; y'' + y = 0",
            &alike,
            "not-diagonalisable",
            "the linear part is not diagonalisable",
        ),
        (
            // Twice the same irrational squares.
            "x'' + 2*x - y + eps*x^3; y'' + 5*y - x; u'' + 2*u - v; v'' + 5*v - u",
            &[NORMAL_MODE],
            "no-rational-modes",
            "strongly coupled modes without rational form",
        ),
        (&forced("cos(t/2^(1/2))"), &alike, "ratio-not-rational", "irrational number"),
    ];
    for (equation, questions, code, words) in traps {
        let case = Oscillator::parse(equation).unwrap();
        for question in questions {
            let refused = question(&case, &Work::default());
            let refused = refused.unwrap_or_else(|| panic!("{equation} is taken"));
            let text = refused.to_string();
            assert!(refused.code() == code && text.contains(words), "{equation}: {refused:?}");
        }
    }
    for (equation, code, words) in [
        ("x'' + x + eps*y*x^2 = 0", "second-unknown", "y is the name of an unknown"),
        (&*forced("cos(w*t)"), "undeclared-parameter", "w stands for a frequency"),
        // Of a frequency and of a term alike: the name of an unknown.
        (&*forced("w*cos(w*t)"), "second-unknown", "w is the name of an unknown"),
    ] {
        let refused = Oscillator::parse(equation).unwrap_err();
        assert!(refused.code() == code && refused.to_string().contains(words), "{refused:?}");
    }
}

/// With a value the detuning is part of a rational frequency: cos((1 + 1/2) t) is cos(3 t/2).
#[test]
fn a_detuning_with_a_value_is_a_frequency() {
    let found = |force: &str, sigma: Option<&str>| {
        let case = Oscillator::parse(&format!("x'' + x + eps*x^3 = eps*{force}")).unwrap();
        let case = match sigma {
            Some(value) => case.set("sigma", value).unwrap(),
            None => case,
        };
        case.slow_flow(2, &Work::default()).unwrap().value.flow
    };
    let terms = |flow| format!("{flow:?}");
    assert_eq!(terms(found("cos((1 + sigma)*t)", Some("1/2"))), terms(found("cos(3*t/2)", None)));
}
