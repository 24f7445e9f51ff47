//! The paper, re-read: every formula has its row, and what is said of the methods is true.

mod rules;
mod section_3;
mod section_4;

use lindstedt::Stop;
use lindstedt_paper::{Options, Paper, Row, Section, read};
use lindstedt_report::{Span, mathml};
use std::sync::OnceLock;

/// The paper, read once, and how often the observer was called.
fn counted() -> &'static (Paper, usize) {
    static PAPER: OnceLock<(Paper, usize)> = OnceLock::new();
    let found = PAPER.get_or_init(|| {
        let mut steps = 0;
        let paper = read(Options::QUICK, &Stop::default(), &mut |_| {
            steps += 1;
            true
        });
        match paper {
            Ok(paper) => (paper, steps),
            Err(error) => panic!("{error}"),
        }
    });
    assert!(found.0.complete);
    found
}

fn paper() -> &'static Paper {
    &counted().0
}

/// A section of the paper, read once for all tests.
pub fn numbered(number: u32) -> &'static Section {
    paper().section(number).unwrap_or_else(|| panic!("no section {number}"))
}

fn section() -> &'static Section {
    numbered(4)
}

fn row(label: &str) -> &'static Row {
    section().row(label).unwrap_or_else(|| panic!("no row {label}"))
}

/// Every formula number of the sections has a row.
#[test]
fn every_formula_has_a_row() {
    for number in 28..=51 {
        row(&format!("({number})"));
    }
    for number in 18..=27 {
        let label = format!("({number})");
        let found = numbered(3).rows.iter().any(|row| row.label.starts_with(&label));
        assert!(found, "no row {label}");
    }
    for section in &paper().sections {
        let mut labels: Vec<&str> = section.rows.iter().map(|r| &*r.label).collect();
        labels.sort_unstable();
        let all = labels.len();
        labels.dedup();
        assert_eq!(labels.len(), all, "labels are unique");
    }
}

/// The paper has formulas (1) to (51): each has a row that says what was compared.
#[test]
fn all_51_formulas_have_a_row() {
    let rows = || paper().sections.iter().flat_map(|section| &section.rows);
    for number in 1..=51 {
        let label = format!("({number})");
        let own = rows().filter(|row| row.label.contains(&label)).collect::<Vec<_>>();
        assert!(!own.is_empty(), "no row {label}");
        for row in own {
            assert!(!row.printed.is_empty() && !row.derived.is_empty(), "{}", row.label);
            let says_why = !row.evidence.is_empty() || !row.independent.is_empty();
            assert!(says_why, "{}: a verdict without a reason", row.label);
        }
    }
}

/// Every formula of the page is understood: none stands there as it was typed.
#[test]
fn every_formula_is_drawn() {
    let mut count = 0;
    let mut draw = |text: &lindstedt_paper::Text| {
        for span in text.line().0 {
            let Span::Formula(formula) = span else { continue };
            let drawn = mathml(&formula.latex, false);
            assert!(drawn.is_ok(), "{}: {drawn:?}", formula.text);
            count += 1;
        }
    };
    for section in &paper().sections {
        for row in &section.rows {
            let texts = [&row.label, &row.printed, &row.derived, &row.independent, &row.evidence];
            texts.into_iter().for_each(&mut draw);
        }
        for table in &section.tables {
            let cells = table.rows.iter().flatten().chain(&table.columns).chain(&table.notes);
            cells.chain([&table.title]).for_each(&mut draw);
        }
    }
    for finding in &paper().trust.findings {
        let lists = finding.trusted.iter().chain(&finding.not_trusted);
        lists.chain([&finding.method, &finding.class]).for_each(&mut draw);
    }
    assert!(count > 400, "{count} formulas");
}

/// The progress bar ends when the work does.
#[test]
fn steps_are_counted() {
    assert_eq!(counted().1, Options::QUICK.steps());
}

/// The summary: the tangencies against an independent event code, the agreement against a count
/// made outside this project (order 1, 21 x 21 gains; here 7 x 7), the best orders against mpmath.
#[test]
fn where_the_methods_can_be_trusted() {
    let trust = &paper().trust;
    let (Some(region), Some(onset)) = (&trust.region, &trust.onset) else { panic!("unfinished") };
    assert!((onset.threshold - 0.637_071_342_848_163_6).abs() < 1e-15);
    for (eps, right, left) in
        [(0.005, 0.6380714, 0.6360782), (0.1, 0.6583849, 0.6185320), (0.2, 0.6822086, 0.6027019)]
    {
        let point = onset.points.iter().find(|p| p.eps == eps);
        let sides = point.and_then(|p| Some((p.right?.0, p.left?.0)));
        let Some(found) = sides else { panic!("no tangency at {eps}") };
        assert!(
            (found.0 - right).abs() < 1e-7 && (found.1 - left).abs() < 1e-7,
            "{eps}: {found:?}"
        );
    }
    let last = onset.points.last().and_then(|p| Some((p.eps, p.right?.0, p.left?.0)));
    let Some((eps, right, left)) = last else { panic!("no last point") };
    assert!(eps == 1.0 && (right - 1.10867).abs() < 5e-6 && (left - 0.60227).abs() < 5e-6);
    // The first-order slope is 0.2 per eps: 1 % of the threshold at 0.03, 10 % before 0.3.
    let [one, ten] = [0.01, 0.1].map(|share| onset.reach(share).unwrap_or(f64::NAN));
    assert!((one - 0.03).abs() < 0.005 && (0.25..0.3).contains(&ten), "{one} {ten}");
    assert_eq!(onset.reach(2.0), None);
    let share = |rule: &str| {
        let rate = region.sample.rates.iter().find(|r| r.rule == rule);
        rate.map_or(f64::NAN, |r| r.rate)
    };
    for (rule, known, error) in [
        ("(17), letter", 0.579, 0.03),
        ("(17), own orbit", 0.658, 0.03),
        ("(17), true orbit", 0.692, 0.03),
        ("G", 0.999, 0.01),
    ] {
        assert!((share(rule) - known).abs() < error, "{rule}: {}", share(rule));
    }
    assert!(region.orbit.starts_with("orbit O2") && region.charts.len() == 2);
    let best = |name: &str| {
        let found = trust.truncations.iter().find(|t| t.name == name);
        found.and_then(|t| t.best()).unwrap_or((0, f64::NAN))
    };
    assert_eq!(best("pendulum").0, 5);
    assert!((best("pendulum").1 - 6.46e-4).abs() < 1e-6);
    let cubic = trust.truncations.iter().find(|t| t.name == "n = 3");
    // 2.3e-11 at order 12 of the series in u.
    assert!(cubic.is_some_and(|t| (t.resummed[12] / 2.3e-11 - 1.0).abs() < 0.03));
    let sections: Vec<u32> = trust.findings.iter().map(|f| f.section).collect();
    assert_eq!(sections, [2, 3, 4]);
}

/// A reader that is stopped keeps its finished rows.
#[test]
fn interruption() {
    let mut calls = 0;
    let stop = read(Options::QUICK, &Stop::default(), &mut |what| {
        calls += 1;
        !what.contains("pendulum")
    });
    let rows = stop.as_ref().ok().and_then(|p| p.section(4)).map(|s| s.rows.len());
    assert!(stop.is_ok_and(|paper| !paper.complete));
    assert!(rows.is_some_and(|n| n > 25 && n < section().rows.len()), "{rows:?}");
    let at_once = read(Options::QUICK, &Stop::default(), &mut |_| false);
    assert!(at_once.is_ok_and(|paper| !paper.complete && paper.sections.is_empty()));
}

/// The sections come in the order of the paper.
#[test]
fn order_of_the_sections() {
    let numbers: Vec<u32> = paper().sections.iter().map(|s| s.number).collect();
    assert_eq!(numbers, [2, 3, 4]);
    assert!(paper().section(5).is_none());
}
