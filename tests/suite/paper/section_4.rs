//! Section 4: verdicts, corrections and tables, against mpmath.

use super::{row, section};
use lindstedt_paper::Verdict;
use std::collections::BTreeMap;

/// The verdicts that are not "agrees"; every disagreement was found before by hand
/// and with mpmath 1.3.0.
#[test]
fn verdicts() {
    let expected = BTreeMap::from([
        ("(39)", Verdict::Misprint),
        ("(49)", Verdict::Misprint),
        ("Omega", Verdict::Misprint),
        ("n = 3, exact", Verdict::Misprint),
        ("alpha_1", Verdict::Wrong),
        ("(42)", Verdict::Wrong),
        ("n = 3, 8 %", Verdict::Wrong),
        ("n = 3, 7.5111", Verdict::Wrong),
        ("alpha_1, pendulum", Verdict::Wrong),
        ("(51)", Verdict::Wrong),
        ("T order 1", Verdict::Wrong),
        ("0.5 %", Verdict::Wrong),
        ("n = 3, first", Verdict::NotReproducible),
        ("n = 3, second", Verdict::NotReproducible),
    ]);
    for row in &section().rows {
        let verdict = expected.get(&*row.label).copied().unwrap_or(Verdict::Agrees);
        assert_eq!(row.verdict, verdict, "{}: {}", row.label, row.evidence);
    }
    assert_eq!(section().rows.len() - expected.len(), section().count(Verdict::Agrees));
    assert_eq!(section().count(Verdict::Agrees), 36);
    // The reading under which the print is right comes first.
    for label in ["(37)", "(47)"] {
        assert!(row(label).evidence.starts_with("right with ln(x_0)^2 read as ln((x_0)^2)"));
    }
}

/// The corrections are found by the program.
#[test]
fn corrections() {
    let cases = [
        ("(37)", "-x_0 ln(x_0^2) in the place of -x_0 (ln x_0)^2"),
        ("(39)", "the factor of x_0 [ln(x_0^2)]^2 is -1/2, printed -1"),
        ("(49)", "the term 2 omega_1^2 x_1 is missing"),
        ("Omega", "-omega_1^2 in the place of omega_1^2 at order 1, -omega_2^2 in the place of 1"),
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
