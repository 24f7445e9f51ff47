//! Section 3: verdicts and numbers, against mpmath and an independent event code.

use super::numbered;
use lindstedt_paper::{Row, Verdict};

/// Section 3 simulated: an independent event code (exponents, doublings, tangencies).
#[test]
fn simulations_of_section_3() {
    for label in ["gamma = 0.6", "doubling", "gamma = 0.65", "gamma = 1.2", "sticks"] {
        assert_eq!(melnikov(label).verdict, Verdict::Agrees, "{label}");
    }
    let table = numbered(3).tables.iter().find(|t| t.name == "simulations");
    let Some(table) = table else { panic!("no table") };
    let cell = |row: usize, column: usize| &*table.rows[row][column];
    let number = |row, column| {
        let text: &str = cell(row, column);
        let first = text.split(' ').next().and_then(|text| text.parse::<f64>().ok());
        first.unwrap_or(f64::NAN)
    };
    assert_eq!([0, 1, 2, 3].map(|row| cell(row, 1)), ["2", "4", "none", "none"]);
    assert!((number(0, 2) + 0.0185).abs() < 5e-4 && (number(2, 2) - 0.072).abs() < 0.02);
    assert!((number(3, 2) - 0.185).abs() < 0.04 && (number(0, 4) - 0.27).abs() < 0.01);
}

fn melnikov(label: &str) -> &'static Row {
    numbered(3).row(label).unwrap_or_else(|| panic!("no row {label}"))
}

/// Section 3: the verdicts that are not "agrees", each found by hand before.
#[test]
fn verdicts_of_section_3() {
    // What the row must say is printed, the verdict, and what its evidence must contain.
    let expected = [
        ("dx/dt = x sqrt(a - b x^2/2) at t = 0.7", Verdict::Misprint, "-x sqrt"),
        ("sech(sqrt a) tanh", Verdict::Misprint, "sech(sqrt(a) t)"),
        ("gamma sin t0", Verdict::Misprint, "-1.18385"),
        ("no term beta int sech^4 tanh^4", Verdict::Misprint, "-1.25690"),
        ("16/35 beta a^4/sqrt(a b^2)", Verdict::Misprint, "-1.57520"),
        ("a^2/sqrt(a b)", Verdict::Misprint, "-1.28742"),
        ("sin(sech tanh - v*)", Verdict::Misprint, "-1.08077"),
        ("closes behind all terms", Verdict::Misprint, "-1.73649"),
        ("+ (alpha - beta v*^2) v*", Verdict::Misprint, "without effect"),
        ("second root", Verdict::Misprint, "no real value"),
        ("2 T0 a [...]", Verdict::Misprint, "0.750838"),
        ("without a modulus", Verdict::Wrong, "gamma F > |D|"),
        ("gamma_c = 0.65", Verdict::NotReproducible, "none of the formulas tried: (27);"),
        ("two cusps", Verdict::Agrees, "corners"),
        ("practically a good agreement", Verdict::Wrong, "stays in the right well"),
    ];
    let rows = &numbered(3).rows;
    for (printed, verdict, evidence) in expected {
        let found: Vec<&Row> = rows.iter().filter(|r| r.printed.contains(printed)).collect();
        let [row] = found[..] else { panic!("{printed}: {} rows", found.len()) };
        assert_eq!(row.verdict, verdict, "{}: {}", row.label, row.evidence);
        assert!(row.evidence.contains(evidence), "{}: {}", row.label, row.evidence);
    }
    // In (26) and in (27); (25) and (26) as a whole.
    for (printed, evidence) in
        [("first branch for all", "no real value"), ("all of it as printed", "changes above")]
    {
        let found: Vec<&Row> = rows.iter().filter(|r| r.printed.starts_with(printed)).collect();
        assert_eq!(found.len(), 2, "{printed}");
        for row in found {
            assert!(row.verdict == Verdict::Misprint && row.evidence.contains(evidence), "{row:?}");
        }
    }
    let others = expected.iter().filter(|row| row.1 != Verdict::Agrees).count();
    assert_eq!(rows.len() - others - 4, numbered(3).count(Verdict::Agrees));
    for label in ["(18)", "(19)", "(20)", "(21)", "critical points", "x_0", "(22), 1", "(24)"] {
        assert_eq!(melnikov(label).verdict, Verdict::Agrees, "{label}");
    }
}

/// The numbers of section 3: mpmath 1.3.0 at 60 digits.
#[test]
fn numbers_of_section_3() {
    let threshold = melnikov("gamma_c");
    assert!(threshold.derived.ends_with("0.63707134284816358297"), "{}", threshold.derived);
    assert!(threshold.independent.contains("0.63707134284816358"), "{}", threshold.independent);
    assert!(
        threshold.evidence.contains("0.653148 and") || threshold.evidence.contains("and 0.653148")
    );
    for (label, value) in
        [("v* = 0.310429", "0.31042902187992282774"), ("v* = 0.557204", "0.55720390385943140500")]
    {
        let zero = melnikov(label);
        assert_eq!(zero.verdict, Verdict::Agrees, "{label}: {}", zero.evidence);
        assert!(zero.derived.ends_with(value), "{label}: {}", zero.derived);
    }
    assert!(melnikov("two cusps").derived.contains("0.316227766016837933"));
    let touching = melnikov("the cusp touches");
    assert_eq!(touching.verdict, Verdict::Agrees);
    assert!(touching.derived.ends_with("129/70") && touching.evidence.contains("-0.14735367"));
}

/// The table of thresholds, against the same numbers computed with mpmath 1.3.0.
#[test]
fn thresholds() {
    let table = numbered(3).tables.iter().find(|t| t.name == "thresholds");
    let Some(table) = table else { panic!("no table") };
    let expected = [
        ["1", "0.70710678", "0.7640389020310007", "0.4398207539534909", "none", "none"],
        [
            "2",
            "0.5",
            "0.8012209511748848",
            "-0.02899154757540702",
            "0.49964774500409317",
            "0.52553827281224361",
        ],
        [
            "5",
            "0.31622776",
            "0.8895866574359596",
            "-0.1473536758846797",
            "0.31042902187992282",
            "0.55720390385943140",
        ],
        [
            "10",
            "0.22360679",
            "0.9475932707030540",
            "-0.1346045731909936",
            "0.22026426856003061",
            "0.56736651461358019",
        ],
    ];
    assert_eq!(table.rows.len(), expected.len());
    for (row, expected) in table.rows.iter().zip(expected) {
        assert_eq!(row.len(), table.columns.len());
        for (cell, expected) in row.iter().zip(expected) {
            // The reference is rounded in its last digit.
            let kept = expected.len() - usize::from(expected.len() > 8);
            assert!(cell.starts_with(&expected[..kept]), "{cell} is not {expected}");
        }
    }
    let notes = table.notes.join("\n");
    assert!(notes.contains("129/70"));
}

/// The range of x on the periodic orbit at gamma = 0.6, whose extremes lie within steps of the integration: a
/// Runge-Kutta integration of fourth order with step 5e-4 and 1e-4 gives 0.1123 and 1.4748.
#[test]
fn extremes_lie_within_steps() {
    let table = numbered(3).tables.iter().find(|t| t.name == "simulations").unwrap();
    let number = |column: usize| -> f64 { table.rows[0][column].parse().unwrap() };
    assert!((number(5) - 0.1123).abs() < 1.5e-4 && (number(6) - 1.4748).abs() < 1.5e-4);
}

/// The cycles on the belt, against zeros of the work of friction by the trapezoidal rule in doubles (Python).
#[test]
fn cycles_on_the_belt() {
    let table = numbered(3).tables.iter().find(|t| t.name == "cycles");
    let Some(table) = table else { panic!("no table") };
    let expected = [
        [
            "1", "in a well", "0.51757874720", "0.51771914790", "1.3160421284", "0.51757874720",
            "-0.0527778471224",
        ],
        [
            "1", "in a well", "0.55000000000", "0.70791489337", "1.2242779519", "0.35274481663",
            "-0.0267248286985",
        ],
        [
            "5", "around both", "0.51312731764", "-0.72424457932", "0.72424457932",
            "0.51312731764", "-0.0979366238297",
        ],
        [
            "5", "around both", "0.55000000000", "-0.65602829581", "0.65602829581",
            "0.36425189320", "-0.0362997432614",
        ],
    ];
    assert_eq!(table.rows.len(), expected.len());
    for (row, expected) in table.rows.iter().zip(expected) {
        assert_eq!(row.len(), table.columns.len());
        for (cell, expected) in row.iter().zip(expected) {
            // The reference is good to ten digits or so.
            assert!(
                cell.starts_with(&expected[..expected.len().min(12)]),
                "{cell} is not {expected}"
            );
        }
    }
}
