//! `lindstedt verify`: the observed order is N + 1, and not where the digits do not suffice.
#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    let command = [&["verify", "--quiet"], arguments].concat();
    Command::new(env!("CARGO_BIN_EXE_lindstedt")).args(command).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--format", "json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Fewer values than by default: two of them make a slope.
fn slopes(problem: &str, orders: std::ops::RangeInclusive<u32>, more: &[&str]) {
    for order in orders {
        let order_text = order.to_string();
        let base = [problem, "--order", &order_text, "--small", "1/4000,1/8000"];
        let found = json(&[&base, more].concat());
        let slope = found["observed_order"].as_f64().unwrap();
        assert!((slope - f64::from(order) - 1.0).abs() < 0.05, "{problem} {order} {slope}");
        assert_eq!(found["verdict"], "agrees");
        assert_eq!(found["expected_order"], order + 1);
    }
}

#[test]
fn duffing_and_van_der_pol() {
    slopes("duffing", 1..=6, &[]);
    slopes("van-der-pol", 1..=6, &[]);
}

#[test]
fn power_law() {
    slopes("power-law", 1..=6, &[]);
}

#[test]
fn pendulum() {
    slopes("pendulum", 1..=6, &[]);
    slopes("pendulum", 2..=2, &["--set", "amplitude=5/2"]);
}

/// The end of the window may be rounded past the last step of the integrator: it did at order 3.
#[test]
fn the_end_of_the_window_has_a_value() {
    assert!(run(&["pendulum", "--order", "3"]).status.success());
}

#[test]
fn keys_of_the_result() {
    let found = json(&["duffing", "--order", "2"]);
    for key in ["problem", "parameter", "at", "order", "digits", "periods", "table", "tolerance"] {
        assert!(!found[key].is_null(), "{key}");
    }
    let rows = found["table"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    assert!(rows[0]["slope"].is_null());
    assert_eq!(rows[1]["small"]["exact"], "1/2000");
    assert_eq!(rows[1]["difference"]["status"], "estimated");
    let number = |v: &Value| v.as_str().unwrap().parse::<f64>().unwrap();
    let (error, noise) =
        (number(&rows[3]["difference"]["decimal"]), number(&rows[3]["difference"]["error"]));
    assert!(noise < 1e-9 * error && error < 1e-11, "{error} {noise}");
}

#[test]
fn a_verdict_can_be_negative_or_open() {
    // Far from small values the slope is not yet N + 1: a negative verdict, code 3.
    let far = run(&["van-der-pol", "--order", "3", "--small", "1,1/2"]);
    assert_eq!(far.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&far.stdout).contains("disagrees"));
    // Ten digits cannot see errors of 1e-30.
    let blind = run(&["duffing", "--order", "6", "--digits", "10"]);
    assert_eq!(blind.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&blind.stdout).contains("undecided"));
}

#[test]
fn text_and_figure() {
    let folder = std::env::temp_dir();
    let path = folder.join(format!("lindstedt-verify-{}.svg", std::process::id()));
    let output = run(&["duffing", "--order", "1", "--plot", path.to_str().unwrap()]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("duffing: order 1, 1 periods, integration with"), "{text}");
    assert_eq!(text.lines().count(), 9, "{text}");
    let drawn = std::fs::read_to_string(&path).unwrap();
    assert!(drawn.matches("<circle").count() >= 4 && drawn.contains("slope 2"));
    let _ = std::fs::remove_file(path);
}

#[test]
fn refusals_have_their_exit_code() {
    let cases: [(&[&str], i32); 12] = [
        (&["nonsense"], 2),
        (&["stick-slip"], 3),
        (&["duffing", "--set", "eps=1"], 2),
        (&["power-law", "--set", "x=1"], 2),
        (&["pendulum", "--set", "amplitude=4"], 3),
        (&["duffing", "--small", "0,1"], 2),
        (&["duffing", "--small", "1/100"], 2),
        (&["duffing", "--small", "1/100,1/50"], 2),
        (&["duffing", "--small", "pi,1"], 2),
        (&["duffing", "--digits", "2"], 2),
        (&["duffing", "--plot", "x.png"], 2),
        (&["duffing", "--plot", "/nonexistent/x.svg"], 5),
    ];
    for (arguments, code) in cases {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(!output.stderr.is_empty(), "{arguments:?}");
    }
}
