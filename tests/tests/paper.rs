//! The paper, re-read: verdicts, and the tables against numbers computed outside this project.

#![allow(clippy::panic, reason = "a test that panics has failed")]

use lindstedt::coeff::ball::Balls;
use lindstedt::paper::{Decimal, Findings, Options, Paper, Row, Section, Verdict, read};
use rug::Rational;
use std::collections::BTreeMap;
use std::sync::OnceLock;

fn section() -> &'static Section {
    static PAPER: OnceLock<Paper> = OnceLock::new();
    let paper = PAPER.get_or_init(|| match read(Options::QUICK, &mut |_| true) {
        Ok(paper) => paper,
        Err(error) => panic!("{error}"),
    });
    assert!(paper.complete);
    &paper.sections[0]
}

fn row(label: &str) -> &'static Row {
    section().row(label).unwrap_or_else(|| panic!("no row {label}"))
}

/// Every formula number of the section has a row.
#[test]
fn every_formula_has_a_row() {
    for number in 28..=51 {
        row(&format!("({number})"));
    }
    let mut labels: Vec<&str> = section().rows.iter().map(|r| r.label.as_str()).collect();
    labels.sort_unstable();
    let all = labels.len();
    labels.dedup();
    assert_eq!(labels.len(), all, "labels are unique");
}

/// The verdicts that are not "agrees"; every disagreement was found before by hand
/// and with mpmath 1.3.0.
#[test]
fn verdicts() {
    let expected = BTreeMap::from([
        ("(37)", Verdict::Misprint),
        ("(39)", Verdict::Misprint),
        ("(47)", Verdict::Misprint),
        ("(49)", Verdict::Misprint),
        ("Omega", Verdict::Misprint),
        ("n = 3, exact", Verdict::Misprint),
        ("alpha_1", Verdict::Wrong),
        ("(42)", Verdict::Wrong),
        ("n = 3, 8 %", Verdict::Wrong),
        ("n = 3, 7.5111", Verdict::Wrong),
        ("n = 5", Verdict::Wrong),
        ("alpha_1, pendulum", Verdict::Wrong),
        ("(51)", Verdict::Wrong),
        ("T numerical", Verdict::Wrong),
        ("T order 1", Verdict::Wrong),
        ("0.5 %", Verdict::Wrong),
        ("n = 3, first", Verdict::NotReproducible),
        ("n = 3, second", Verdict::NotReproducible),
    ]);
    for row in &section().rows {
        let verdict = expected.get(row.label.as_str()).copied().unwrap_or(Verdict::Agrees);
        assert_eq!(row.verdict, verdict, "{}: {}", row.label, row.evidence);
    }
    assert_eq!(section().rows.len() - expected.len(), section().count(Verdict::Agrees));
    assert_eq!(section().count(Verdict::Agrees), 32);
}

/// The corrections are found by the program.
#[test]
fn corrections() {
    let cases = [
        ("(37)", "-x_0 ln(x_0^2) in the place of -x_0 (ln x_0)^2"),
        ("(39)", "the factor of x_0 [ln(x_0^2)]^2 is -1/2, printed -1"),
        ("(49)", "the term 2 omega_1^2 x_1 is missing"),
        ("Omega", "the factor of omega_1^2 is -1, printed 1"),
        ("n = 3, exact", "7.4163"),
        ("T order 1", "(51) with the missing 1/omega"),
        ("n = 3, first", "none of the 16 formulas"),
    ];
    for (label, part) in cases {
        assert!(row(label).evidence.contains(part), "{label}: {}", row(label).evidence);
    }
    // (51) as printed, 6.0351, and the wrong period -2.43: mpmath 1.3.0.
    assert!(row("(51)").evidence.contains("6.03510"));
    assert!(row("(42)").evidence.contains("-2.42716"));
    assert!(row("alpha_1").derived.contains("-0.386294361119891"));
}

fn cell(table: &str, row: usize, column: usize) -> &'static str {
    let found = section().tables.iter().find(|t| t.name == table);
    let found = found.unwrap_or_else(|| panic!("no table {table}"));
    &found.rows[row][column]
}

/// mpmath 1.3.0: closed-form periods, Taylor coefficients of T at 50 digits, 4 ellipk.
#[test]
fn tables() {
    for (table, exact) in [
        ("n3", "7.416298709205487"),
        ("n5", "8.41309263195"),
        ("n7", "9.30874056974"),
        ("n9", "10.1276768767"),
        ("pendulum", "6.699975664370452712701211"),
    ] {
        let found = section().tables.iter().find(|t| t.name == table);
        let note = found.map(|t| t.notes.join("\n")).unwrap_or_default();
        let digits = exact.len().min(12);
        assert!(note.contains(&exact[..digits]), "{table}: {note}");
    }
    assert!(cell("n3", 1, 1).starts_with("7.49676"));
    assert_eq!(cell("n3", 1, 2), "+1.08");
    assert!(cell("n3", 2, 1).starts_with("7.413445"));
    assert!(cell("n3", 1, 5).starts_with("8.0204") && cell("n3", 2, 5).starts_with("7.2448"));
    let sums = ["6.8495", "6.6128", "6.7546", "6.6680", "6.7130", "6.7043", "6.6792", "6.7350"];
    for (order, sum) in sums.iter().enumerate() {
        let value: f64 = cell("pendulum", order, 1).parse().unwrap_or(f64::NAN);
        let sum: f64 = sum.parse().unwrap_or(f64::NAN);
        assert!((value - sum).abs() <= 0.5e-4, "order {order}: {value}");
    }
    assert_eq!(cell("pendulum", 5, 2), "+0.0646");
    assert!(cell("pendulum", 1, 5).starts_with("6.62438"));
    assert_eq!(cell("n7", 1, 5), "none");
}

/// Each table says which quantity is cut off and whether the series converges.
#[test]
fn tables_say_where_nothing_converges() {
    for table in &section().tables {
        let notes = table.notes.join("\n");
        let expected = if table.name == "n3" { "ON the circle" } else { "NO CONVERGENCE" };
        assert!(notes.contains(expected), "{}: {notes}", table.name);
        assert_eq!(table.columns[1], "T through T");
        assert_eq!(table.columns[5], "T through omega^2");
        assert_eq!(notes.matches("smallest true error").count(), 3);
    }
    let notes = section().tables.last().map(|t| t.notes.join("\n")).unwrap_or_default();
    assert!(notes.contains("through T: smallest true error at order 5, smallest term at order 5"));
}

#[test]
fn the_rules() {
    let agrees = Findings { holds: true, ..Findings::default() };
    assert_eq!(agrees.verdict(), Verdict::Agrees);
    let misprint = Findings { correction: Some("sign".into()), ..Findings::default() };
    assert_eq!(misprint.verdict(), Verdict::Misprint);
    let used = Findings { propagates: true, ..misprint };
    assert_eq!(used.verdict(), Verdict::Wrong);
    assert_eq!(
        Findings { reproduced: Some(true), ..Findings::default() }.verdict(),
        Verdict::Wrong
    );
    let lost = Findings { reproduced: Some(false), ..Findings::default() };
    assert_eq!(lost.verdict(), Verdict::NotReproducible);
    assert_eq!(Findings::default().verdict(), Verdict::Wrong);
}

#[test]
fn printed_decimals() {
    let balls = Balls::new(100);
    let value = |n: i32, d: u32| balls.from_rational(&Rational::from((n, d)));
    let shows = |text, n, d| Decimal::new(text).is_some_and(|p| p.shows(&value(n, d)));
    assert!(shows("0.67", 2, 3), "rounded");
    assert!(shows("0.66", 2, 3), "cut off");
    assert!(!shows("0.68", 2, 3) && !shows("0.65", 2, 3));
    let correct = |text, n, d| Decimal::new(text).and_then(|p| p.correct(&value(n, d)));
    assert_eq!(correct("0.05", 2, 33).as_deref(), Some("0.06"));
    assert_eq!(correct("12.50", 9999, 1000).as_deref(), Some("10.00"));
    assert_eq!(correct("8", 17, 2).as_deref(), Some("9"));
    let wide = balls.hull(&value(84, 10), &value(86, 10));
    let neither = Decimal::new("8").and_then(|p| p.correct(&wide));
    assert_eq!(neither, None, "the ends of the ball round to different sides");
    assert!(Decimal::new("pi").is_none());
    let one_digit = Decimal::new("7.4164").map(|p| p.compare(&value(74163, 10_000)));
    assert!(one_digit.is_some_and(|f| !f.holds && f.correction.is_some()));
    let two_digits = Decimal::new("7.51").map(|p| p.compare(&value(742, 100)));
    assert!(two_digits.is_some_and(|f| !f.holds && f.correction.is_none()));
}

/// A reader that is stopped keeps its finished rows.
#[test]
fn interruption() {
    let mut calls = 0;
    let stop = read(Options::QUICK, &mut |what| {
        calls += 1;
        !what.contains("pendulum")
    });
    let rows = stop.as_ref().ok().and_then(|p| p.sections.first()).map(|s| s.rows.len());
    assert!(stop.is_ok_and(|paper| !paper.complete));
    assert!(rows.is_some_and(|n| n > 25 && n < section().rows.len()), "{rows:?}");
    let at_once = read(Options::QUICK, &mut |_| false);
    assert!(at_once.is_ok_and(|paper| !paper.complete && paper.sections[0].rows.is_empty()));
}
