//! `lindstedt stability`: every field of the contract against the reference numbers, charts,
//! warnings, refusals.
#![allow(clippy::unwrap_used, clippy::panic)]

use serde_json::Value;
use std::process::{Command, Output};

#[path = "stability/charts.rs"]
mod charts;
#[path = "stability/oracles.rs"]
mod oracles;
#[path = "stability/refusals.rs"]
mod refusals;

fn run(arguments: &[&str]) -> Output {
    let command = [&["stability", "vibro-impact"], arguments].concat();
    Command::new(env!("CARGO_BIN_EXE_lindstedt")).args(command).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = run(&[arguments, &["--format", "json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The numbers of a file of tests/data/vibro-impact.
fn data(name: &str) -> Value {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/vibro-impact/");
    serde_json::from_str(&std::fs::read_to_string(format!("{folder}{name}.json")).unwrap()).unwrap()
}

/// The `--set` arguments of a case.
fn point(case: &Value) -> Vec<String> {
    let names = ["alpha", "omega", "k", "R_r", "s", "c", "P0", "A", "B"];
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let branch = if case["params"]["branch"] == -1 { "-" } else { "+" };
    let sets = names.iter().map(|name| format!("{name}={}", text(&case["params"][*name])));
    let sets = sets.chain([format!("branch={branch}")]);
    sets.flat_map(|set| ["--set".to_owned(), set]).collect()
}

/// Where the flight of the orbit passes through the wall there is no orbit and no verdict, neither
/// for the point nor in a chart.
#[test]
fn a_chart_has_no_verdict_where_the_orbit_does_not_exist() {
    let refused = run(&["--set", "omega=1"]);
    assert_eq!(refused.status.code(), Some(3));
    let chart = json(&["--sweep", "omega=1..2:2"]);
    assert!(chart["grid"]["exact"][0][0].is_null(), "omega = 1 penetrates");
    assert!(chart["grid"]["exact"][0][1].is_boolean(), "omega = 2 does not");
    assert_eq!(chart["grid"]["agreement"]["compared"], 1);
}
