//! `lindstedt evaluate`: the contract's keys, the numbers of the issue, tables, figures, code,
//! refusals.
#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    let command = [&["evaluate", "--quiet"], arguments].concat();
    Command::new(env!("CARGO_BIN_EXE_lindstedt")).args(command).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--format", "json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_keys_of_the_contract() {
    let found = json(&["power-law", "--set", "n=3", "--order", "20", "--resum", "pade"]);
    for key in ["problem", "at", "order", "resum", "period", "frequency", "exact_period", "verdict"]
    {
        assert!(!found[key].is_null(), "{key}");
    }
    assert_eq!(found["resum"], "pade");
    assert_eq!(found["at"]["delta"], "1");
    assert_eq!(found["period"]["status"], "estimated");
    assert_eq!(found["exact_period"]["status"], "exact");
    assert_eq!(found["exact_period"]["decimal"], "7.41629870920548767373540138878");
    assert_eq!(found["degrees"], serde_json::json!([10, 10]));
    // The printed digits are within the printed error.
    let number = |key: &str| found["period"][key].as_str().unwrap().parse::<f64>().unwrap();
    assert!((number("decimal") - 7.416_298_709_205_487).abs() <= number("error"));
    // auto says what it did.
    let auto = json(&["duffing", "--set", "eps=10", "--order", "16"]);
    assert_eq!(auto["asked"], "auto");
    assert_eq!(auto["tried"].as_array().unwrap().len(), 6);
    assert!(auto["verdict"].as_str().unwrap().contains("least error estimate"));
    assert_eq!(auto["singularity"]["kind"], "logarithm");
}

#[test]
fn the_pendulum_diverges() {
    let found = json(&["pendulum"]);
    assert!(found["verdict"].as_str().unwrap().contains("diverges"));
    assert_eq!(found["best_truncation"]["order"], 5);
    assert!(found["period"]["decimal"].as_str().unwrap().starts_with("6.69997566"));
    assert!(!found["pade"]["poles"].as_array().unwrap().is_empty());
    // Not one digit: the reason, the closed form, and exit code 4.
    let output = run(&["pendulum", "--set", "amplitude=3.14159", "--format", "json"]);
    assert_eq!(output.status.code(), Some(4));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found["period"].is_null() && !found["exact_period"].is_null());
}

#[test]
fn solution_as_table_figure_and_code() {
    let found = json(&["duffing", "--order", "16", "--times", "0..3:4", "--digits", "12"]);
    let values = found["solution"]["values"].as_array().unwrap();
    assert_eq!(values.len(), 4);
    // mpmath 1.3.0, odefun.
    let x: f64 = values[1]["x"]["decimal"].as_str().unwrap().parse().unwrap();
    assert!((x - 0.233_691_791_143_141).abs() < 1e-11);
    let folder = std::env::temp_dir();
    let name =
        |kind: &str| folder.join(format!("lindstedt-evaluate-{}.{kind}", std::process::id()));
    let (svg, csv) = (name("svg"), name("csv"));
    let plots = ["--plot", svg.to_str().unwrap(), "--plot", csv.to_str().unwrap()];
    let request = ["duffing", "--order", "8", "--times", "0..5:20"];
    assert!(run(&[&request[..], &plots[..]].concat()).status.success());
    let (drawn, table) =
        (std::fs::read_to_string(&svg).unwrap(), std::fs::read_to_string(&csv).unwrap());
    assert!(drawn.contains("<polyline") && drawn.trim_end().ends_with("</svg>"));
    assert_eq!(table.lines().count(), 21);
    let _ = (std::fs::remove_file(svg), std::fs::remove_file(csv));
    let code = |language: &str| {
        let arguments = ["duffing", "--order", "16", "--code", language, "--harmonics", "9"];
        String::from_utf8(run(&arguments).stdout).unwrap()
    };
    for (language, start) in [
        ("rust", "pub fn displacement(t: f64) -> f64 {"),
        ("python", "def displacement(t):"),
        ("latex", r"\[ x(t) = "),
    ] {
        let text = code(language);
        assert!(text.contains(start), "{text}");
    }
    // The harmonics of the printed function sum to x(0) = 1.
    let python = code("python");
    let terms = python.lines().filter_map(|line| line.trim().strip_prefix('('));
    let cosines = terms.filter_map(|line| line.split(", ").nth(1)?.parse::<f64>().ok());
    assert!((cosines.sum::<f64>() - 1.0).abs() < 1e-8);
}

#[test]
fn every_format_and_every_refusal() {
    for format in ["text", "latex", "markdown"] {
        let output = run(&["duffing", "--order", "8", "--times", "0..1:3", "--format", format]);
        assert!(output.status.success() && !output.stdout.is_empty());
    }
    let cases: [(&[&str], i32); 11] = [
        (&["power-law", "--set", "n=-1/2", "--resum", "uniform"], 3),
        (&["power-law", "--set", "n=-1"], 3),
        (&["pendulum", "--resum", "uniform"], 3),
        (&["pendulum", "--set", "amplitude=pi"], 3),
        (&["duffing", "--set", "eps=-1"], 3),
        (&["power-law", "--order", "1"], 3),
        (&["duffing", "--set", "x=1"], 2),
        (&["duffing", "--times", "0..1"], 2),
        (&["duffing", "--plot", "x.png"], 2),
        (&["nothing"], 2),
        (&["stick-slip"], 3),
    ];
    for (arguments, code) in cases {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(!output.stderr.is_empty());
    }
}
