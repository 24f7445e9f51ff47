//! `lindstedt threshold`: the contract's keys, the numbers of the issue, sweeps, figures, refusals.
#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    let command = [&["threshold", "stick-slip"], arguments].concat();
    Command::new(env!("CARGO_BIN_EXE_lindstedt")).args(command).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--format", "json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_numbers_of_the_paper() {
    let paper = json(&["--digits", "40"]);
    assert_eq!(paper["gamma_c"]["decimal"], "0.6370713428481635829717089604409953683799");
    assert_eq!(paper["cusp"]["touches_zero_at_b"], "129/70");
    for key in ["problem", "at", "gamma_c", "signed", "D", "F", "zeros", "curve", "validity"] {
        assert!(!paper[key].is_null(), "{key}");
    }
    let five = json(&["--set", "b=5", "--zeros", "vstar=0..1", "--digits", "40"]);
    let zero = |n: usize| five["zeros"][n]["decimal"].as_str().unwrap().to_owned();
    assert_eq!(zero(0), "0.3104290218799228277350389082806589197186");
    assert_eq!(zero(1), "0.5572039038594314049984802875461271027828");
    assert_eq!(five["zeros_of"]["complete"], true);
    // At b* the cusp lies on gamma = 0: one zero, decided exactly.
    let touching = json(&["--set", "b=129/70", "--zeros", "vstar=0..1"]);
    assert_eq!(touching["zeros"][0]["decimal"], "0.520881780692475690554725043195");
    assert_eq!(touching["cusp"]["signed"]["decimal"], "0");
}

#[test]
fn sweeps_in_one_and_two_parameters() {
    let curve = json(&["--sweep", "vstar=0..1:11"]);
    let points = curve["curve"].as_array().unwrap();
    assert_eq!((points.len(), curve["curve_status"].as_str().unwrap()), (11, "certified"));
    assert_eq!(points[4][1].as_f64().unwrap(), 0.637_071_342_848_163_6);
    let fast = json(&["--sweep", "vstar=0..1:11", "--f64"]);
    assert_eq!(fast["curve_status"], "estimated");
    let difference = fast["curve"][4][1].as_f64().unwrap() - points[4][1].as_f64().unwrap();
    assert!(difference.abs() < 1e-15);
    let grid = json(&["--sweep", "vstar=0..1:3", "--sweep", "b=1,5"]);
    assert_eq!(grid["grid"]["signed"].as_array().unwrap().len(), 2);
    assert!(grid["grid"]["signed"][1][1].as_f64().unwrap() < 0.0);
}

#[test]
fn figure_and_table() {
    let folder = std::env::temp_dir();
    let name =
        |kind: &str| folder.join(format!("lindstedt-threshold-{}.{kind}", std::process::id()));
    let (svg, csv) = (name("svg"), name("csv"));
    let sweeps = ["--sweep", "vstar=0..1:50", "--sweep", "b=1,2,5,10"];
    let plots = ["--plot", svg.to_str().unwrap(), "--plot", csv.to_str().unwrap()];
    assert!(run(&[&sweeps[..], &plots[..]].concat()).status.success());
    let (drawn, table) =
        (std::fs::read_to_string(&svg).unwrap(), std::fs::read_to_string(&csv).unwrap());
    // Four cusps; two zeros each for b = 2, 5, 10.
    assert_eq!((drawn.matches("<circle").count(), drawn.matches("<polygon").count()), (6, 4));
    assert!(drawn.contains("b = 10") && drawn.trim_end().ends_with("</svg>"));
    assert_eq!(table.lines().count(), 2 + 200);
    let _ = (std::fs::remove_file(svg), std::fs::remove_file(csv));
}

#[test]
fn refusals_have_their_exit_code() {
    let cases: [(&[&str], i32); 10] = [
        // Beyond every exponent: not decided, and not called zero.
        (&["--set", "omega=1e12"], 4),
        (&["--set", "a=0"], 3),
        (&["--set", "omega=-1"], 3),
        (&["--set", "x=1"], 2),
        (&["--set", "a=nan"], 2),
        (&["--sweep", "vstar=0..1"], 2),
        (&["--sweep", "gamma=0..1:5"], 2),
        (&["--plot", "x.svg"], 2),
        (&["--sweep", "b=1,2", "--plot", "/nonexistent/x.svg"], 5),
        (&["--digits", "20000"], 4),
    ];
    for (arguments, code) in cases {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(!output.stderr.is_empty());
    }
}
