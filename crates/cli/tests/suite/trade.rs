//! `lindstedt trade`: the rows, their order, their errors, the front, the files.

use crate::program::{self, Folder, lindstedt};
use serde_json::Value;

const SMALL: [&str; 8] =
    ["--orders", "2,6", "--digits", "20", "--harmonics", "16", "--repeats", "1"];

fn json(problem: &str, more: &[&str]) -> Value {
    read(problem, &[&SMALL[..], more].concat())
}

/// As [`json`] at one order: nothing is left out because times on a busy machine predict too much.
fn at_order(problem: &str, order: &str, more: &[&str]) -> Value {
    let one = ["--orders", order, "--digits", "20", "--harmonics", "16", "--limit-run", "60"];
    read(problem, &[&one[..], &["--repeats", "1"], more].concat())
}

fn read(problem: &str, arguments: &[&str]) -> Value {
    program::json(&[&["trade", problem, "--quiet"], arguments].concat())
}

/// Infinite where a run states no error.
fn stated(row: &Value) -> f64 {
    row["stated_error"].as_f64().unwrap_or(f64::INFINITY)
}

const PROBLEMS: [&str; 4] = ["power-law", "pendulum", "duffing", "van-der-pol"];

#[test]
fn every_true_error_is_below_the_stated_one() {
    for problem in PROBLEMS {
        let value = json(problem, &["--for", "1e-10"]);
        let rows = value["rows"].as_array().unwrap();
        assert!(rows.len() >= 11, "{problem}");
        let reference = value["period_error"].as_f64().unwrap();
        for row in rows {
            let number = |key: &str| row[key].as_f64().unwrap();
            assert!(number("true_error") <= stated(row) + reference, "{problem} {row}");
            assert!(number("seconds") > 0.0 && number("seconds_again") <= number("seconds"));
            assert!(number("memory_bytes") > 0.0 && row["pareto"].is_boolean());
        }
        let best = &value["recommendation"]["row"];
        assert!(best["stated_error"].as_f64().unwrap() <= 1e-10, "{problem}");
        assert_eq!(value["finished"], true);
        for key in
            ["problem", "at", "parameter", "period", "source", "errors", "memory", "left_out"]
        {
            assert!(!value[key].is_null(), "{key}");
        }
    }
}

#[test]
fn rows_have_a_fixed_order() {
    let tiers = [
        "exact", "energy", "collocation", "collocation-f64", "fourier", "simulation-f64",
        "simulation",
    ];
    let value = json("power-law", &["--digits", "20,10"]);
    let place = |row: &Value| {
        let tier = tiers.iter().position(|t| row["tier"] == **t).unwrap();
        let is_resummed = row["summed"].as_str().is_some_and(|summed| summed != "none");
        (tier, row["digits"].as_u64(), row["order"].as_u64(), is_resummed)
    };
    let places: Vec<_> = value["rows"].as_array().unwrap().iter().map(place).collect();
    assert!(places.is_sorted() && places.windows(2).all(|p| p[0] != p[1]), "{places:?}");
    assert_eq!(places.iter().filter(|p| !p.3).count(), 2 * 6 + 3 + 2);
}

/// At n = 9 the series itself diverges; the same coefficients resummed give the period.
#[test]
fn resummation_beside_the_partial_sum() {
    let value = at_order("power-law", "10", &["--set", "n=9", "--within", "1000"]);
    let rows = value["rows"].as_array().unwrap();
    let exact = |summed: &str| {
        let of =
            |r: &&Value| r["tier"] == "energy" && (r["summed"] == "none") == (summed == "none");
        rows.iter().rfind(of).unwrap()
    };
    assert!(exact("none")["stated_error"].is_null());
    let best = exact("resummed");
    let error = |row: &Value| row["true_error"].as_f64().unwrap();
    assert!(error(exact("none")) > 1e3 * error(best), "{best}");
    assert!(stated(best) < 1e-4 && best["true_error"].as_f64().unwrap() <= stated(best));
    let within = &value["recommendation"]["within"];
    assert!(rows.iter().all(|row| stated(within) <= stated(row)) && stated(within) < 1e-15);
    let short = lindstedt(&["trade", "duffing", "--quiet", "--orders", "2", "--within", "1e-12"]);
    assert_eq!(short.status.code(), Some(4));
    let text = String::from_utf8(short.stdout).unwrap();
    assert!(text.contains("Within 1.0e-12 s: no run here; the fastest that states"), "{text}");
}

/// The proved error of a row is its distance from the period of the contraction test: it is there for
/// polynomial equations and the pendulum, closed form or not, and no row is farther off.
#[test]
fn errors_are_proved() {
    let cases = [
        ("x'' + x + eps*x^3 = 0", "eps=1/2"),
        ("x'' + x - eps*(1 - x^2)*x' = 0", "eps=3"),
        ("duffing", "amplitude=2"),
        // An unstable cycle around a focus, whose turns take equally long, too.
        ("van-der-pol", "eps=-1"),
        // n determines delta.
        ("power-law", "n=5"),
        // A polynomial in sin(x/2).
        ("pendulum", "amplitude=2"),
    ];
    for (problem, set) in cases {
        let value = at_order(problem, "4", &["--set", set]);
        let proved = &value["proved_period"];
        assert_eq!(proved["status"], "proved", "{problem}");
        assert_eq!(
            proved["decimal"].as_str().unwrap()[..18],
            value["period"].as_str().unwrap()[..18]
        );
        let reference = value["period_error"].as_f64().unwrap();
        for row in value["rows"].as_array().unwrap() {
            let number = |key: &str| row[key].as_f64().unwrap();
            let (bound, error) = (number("proved_error"), number("true_error"));
            assert!(error <= bound + reference && bound <= 1.01 * error + 1e-22, "{row}");
        }
    }
    // No polynomial, and nothing that the exact tier takes: judged in the time domain, or by a closed form.
    let value = at_order("x'' + x + eps*abs(x)*x = 0", "2", &["--set", "eps=1/2"]);
    assert!(value["source"].as_str().unwrap().starts_with("time domain"));
    let value = at_order("power-law", "2", &["--set", "n=3/2"]);
    assert!(value["proved_period"].is_null() && value["rows"][0]["proved_error"].is_null());
}

/// Polynomial files are judged by a proof; Rayleigh's limit cycle has van der Pol's period.
#[test]
fn problem_files() {
    let value = at_order(&program::example("rayleigh"), "24", &["--set", "eps=1", "--for", "1e-6"]);
    assert_eq!(value["source"], "contraction proof");
    let reference = "6.6632868593231301896996820304823287068126463168838";
    assert!(reference.starts_with(&value["period"].as_str().unwrap()[..20]));
    let rows = value["rows"].as_array().unwrap();
    for row in rows {
        assert!(row["true_error"].as_f64().unwrap() <= stated(row), "{row}");
    }
    assert!(rows.iter().any(|r| r["tier"] == "exact" && stated(r) < 1e-2), "{rows:?}");
    assert!(value["recommendation"]["row"].is_object());
}

#[test]
fn parameters_enter() {
    // T(a) = a^(-delta) T(1); rho = eps a^2.
    let period = |problem: &str, set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|s| ["--set", s]).collect();
        let value = json(problem, &set);
        for row in value["rows"].as_array().unwrap() {
            let error = row["true_error"].as_f64().unwrap();
            assert!(error <= stated(row), "{problem} {set:?} {row}");
        }
        value["period"].as_str().unwrap().parse::<f64>().unwrap()
    };
    let ratio = period("power-law", &["n=2", "amplitude=4"]) / period("power-law", &["delta=1/2"]);
    assert!((ratio - 0.5).abs() < 1e-15);
    let difference =
        period("duffing", &["eps=1", "amplitude=1/2"]) - period("duffing", &["eps=1/4"]);
    assert!(difference.abs() < 1e-15);
    // Outside the circle of convergence, and where sin a is far from a.
    assert!(period("duffing", &["eps=3"]) < 4.0);
    assert!(period("pendulum", &["amplitude=3"]) > 16.0);
}

#[test]
fn figure_and_table() {
    let folder = Folder::new("trade");
    let value =
        json("duffing", &["--plot", &folder.path("a.svg"), "--plot", &folder.path("a.csv")]);
    let count = value["rows"].as_array().unwrap().len();
    let table = folder.text("a.csv");
    assert_eq!(table.lines().count(), count + 1);
    let width = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().all(|line| line.split(',').count() == width));
    let figure = folder.text("a.svg");
    assert!(figure.starts_with("<svg") && figure.contains("Pareto front"));
    // Partial sums are rings; the marks of the others differ from method to method.
    assert!(["<circle", "<polygon"].iter().all(|mark| figure.contains(mark)));
    // Every row has its label.
    assert!(figure.matches("<text").count() > count);
}

#[test]
fn limits_keep_the_finished_rows() {
    let start = ["trade", "power-law", "--quiet", "--format", "json"];
    let limits = ["--limit-seconds", "0.5", "--orders", "2,4,8,16,32,64", "--repeats", "1000"];
    let output = lindstedt(&[&start[..], &limits].concat());
    assert_eq!(output.status.code(), Some(4));
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["finished"], false);
    assert!(value["rows"].as_array().unwrap().len() < 40);
    // A figure of no rows is no error about drawing.
    let folder = Folder::new("no-rows");
    let svg = folder.path("x.svg");
    let drawn = ["trade", "duffing", "--orders", "64", "--digits", "1000", "--repeats", "1000"];
    let drawn = [&drawn[..], &["--plot", &svg]].concat();
    // Which step a limit meets depends on the machine; one of them is between steps.
    let said = ["0.2", "0.4", "0.7", "1", "1.3", "1.7"].map(|limit| {
        let output = lindstedt(&[&drawn[..], &["--limit-seconds", limit]].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(4) && folder.names().is_empty(), "{said}");
        said
    });
    assert!(said.iter().any(|said| said.contains("is not written")), "{said:?}");
    // Before there is a truth there are no rows, and that is no fault of the problem.
    let limits = ["--limit-seconds", "0.000001"];
    let output = lindstedt(&[&start[..], &limits].concat());
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.status.code(), &value["error"]["code"]), (Some(4), &"limit-seconds".into()));
}
