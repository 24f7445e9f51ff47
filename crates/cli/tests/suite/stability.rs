//! `lindstedt stability`: every field of the contract against the reference numbers, charts,
//! warnings, refusals.

use crate::program::{self, Folder, example, lindstedt, refuses, without};
use serde_json::Value;
use std::process::Output;

mod charts;
mod oracles;
mod refusals;

const STABILITY: &[&str] = &["stability", "vibro-impact"];

fn run(arguments: &[&str]) -> Output {
    lindstedt(&[STABILITY, arguments].concat())
}

fn json(arguments: &[&str]) -> Value {
    program::json(&[STABILITY, arguments].concat())
}

/// Damping over a long period is no periodic free flow, and what overflows is undecided, without NaN.
#[test]
fn long_periods_and_overflow() {
    let quick = ["--f64", "--predictor", "kbm", "--format", "json"];
    for omega in ["omega=1e-6", "omega=1e300", "omega=1e-300"] {
        let output = run(&[&["--set", omega], &quick[..]].concat());
        let shown = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(!shown.contains("NaN"), "{omega}: {shown}");
        let found: Value = serde_json::from_str(&shown).unwrap();
        let orbit = &found["orbit"];
        assert!(!orbit.to_string().contains("T-periodic"), "{omega}: {orbit}");
        let exists = &orbit["exists"];
        let expected = match exists {
            Value::Bool(true) => 0,
            Value::Null => 4,
            _ => 3,
        };
        assert_eq!(output.status.code(), Some(expected), "{omega}: {orbit}");
    }
    let periodic = run(&["--set", "c=0", "--set", "omega=1", "--set", "alpha=2", "--f64"]);
    assert_eq!(periodic.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&periodic.stdout).contains("T-periodic"));
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

fn of_file(path: &str, arguments: &[&str]) -> Value {
    program::json(&[&["stability", path], arguments].concat())
}

#[test]
fn the_printed_file_is_the_built_in_problem() {
    let folder = Folder::new("printed");
    let path = folder.file("x.toml", program::text(&["problems", "--show", "vibro-impact"]));
    let point = ["--set", "A=0.1", "--set", "B=-0.05", "--set", "k=1", "--set", "branch=+"];
    let sweeps = ["--sweep", "A=-0.3..0.3:5", "--sweep", "omega=3..3.5:3"];
    for arguments in [&point[..], &sweeps[..], &["--f64", "--order", "2"][..]] {
        let built_in = without(json(arguments), &["seconds"]);
        assert_eq!(without(of_file(&path, arguments), &["seconds"]), built_in);
        // The same oscillator in other words: the same answer, name and wording of the equation apart.
        let (other, own) = (of_file(&example("vibro-impact"), arguments), ["problem", "equation"]);
        assert_eq!(without(without(other, &["seconds"]), &own), without(built_in, &own));
    }
}

/// The same oscillator with a mass, other names, the wall below, and the feedback written as one
/// delayed force; and one with a constant force, a sine and a delay in seconds.
#[test]
fn other_words_for_the_impact_oscillator() {
    let own = ["problem", "equation", "at", "units", "canonical", "seconds"];
    let expected = without(json(&["--set", "A=-0.05"]), &own);
    let spring = of_file(&example("impact-spring"), &[]);
    assert_eq!(spring["canonical"]["A"], "-1/20");
    assert_eq!(without(spring, &own), expected);
    let file = |equation: &str, rest: &str| {
        format!(
            "name = \"words\"\nequation = \"{equation}\"\ncondition = \"free-amplitude\"\n\
             [parameters]\np = {{ value = \"1\" }}\nw = {{ value = \"33/10\" }}\n\
             T = {{ value = \"20*pi/33\" }}\nA = {{ value = \"-1/20\" }}\n[impact]\n\
             position = \"4/5\"\ncrossing = \"rising\"\nrestitution = \"3/5\"\n{rest}"
        )
    };
    let equation = "x'' + x - 1 = p sin(w t + 1) + eps (A (x - x(t - T)) - x'/5)";
    let folder = Folder::new("words");
    let path = folder.file("x.toml", file(equation, ""));
    assert_eq!(without(of_file(&path, &[]), &own), expected);
    let swept = of_file(&path, &["--sweep", "A=-0.1..0.1:3"]);
    assert_eq!(swept["grid"]["columns"]["values"], serde_json::json!([-0.1, 0.0, 0.1]));
    let refusals = [
        (equation.replace("x'/5", "x'^3/5"), "is not linear"),
        (equation.replace("+ x - 1", "+ x - 1 + cos(2*w*t)"), "second force"),
        (equation.replace("t - T", "t - 2*w"), "no period"),
        (equation.replace("+ x - 1", "- x"), "alpha^2 > 0"),
        (equation.replace("+ x - 1", "+ pi*x"), "square of a rational multiple of pi, not pi ("),
        (equation.replace("+ x - 1", "+ 4*x + pi*x"), "of pi, not 4 + pi (a rational number"),
    ];
    for (equation, words) in refusals {
        std::fs::write(&path, file(&equation, "")).unwrap();
        refuses(&["stability", &path], 3, words);
    }
    std::fs::write(&path, file(equation, "")).unwrap();
    for wrong in [["--sweep", "T=1..2:3"], ["--set", "k=2"], ["--set", "q=1"]] {
        let output = lindstedt(&[&["stability", &path], &wrong[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
    }
    // Names are those of the file, or words.
    std::fs::write(&path, file(equation, "").replace("3/5", "6/5")).unwrap();
    refuses(&["stability", &path], 2, "the restitution, must lie between 0 and 1");
    let bare = equation.replace("p sin(w t + 1)", "sin(3 t)").replace("A (x - x(t - T))", "0");
    let wall = "[impact]\nposition = \"4/5\"\ncrossing = \"rising\"\nrestitution = \"3/5\"\n";
    std::fs::write(&path, format!("equation = \"{bare}\"\n{wall}")).unwrap();
    refuses(&["stability", &path, "--sweep", "P0=0..1:3"], 2, "have no parameter that can");
    // Without a small parameter none is missed.
    let bare = bare.replace("+ eps (0 - x'/5)", "- x'/5").replace("+ x - 1", "+ pi*x");
    std::fs::write(&path, format!("equation = \"{bare}\"\n{wall}")).unwrap();
    refuses(&["stability", &path], 3, "of pi, not pi (a rational number");
    // Without a loop nothing in the file says how many periods lie between impacts.
    let free = equation.replace("A (x - x(t - T))", "0");
    std::fs::write(&path, file(&free, "")).unwrap();
    let output = lindstedt(&["stability", &path, "--set", "k=2", "--format", "json"]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["canonical"]["k"], "2");
    assert_eq!(lindstedt(&["stability", &path, "--set", "k=1.5"]).status.code(), Some(2));
}

#[test]
fn the_time_limit_is_seen_inside_a_point() {
    // Without a limit this point takes minutes.
    let output = run(&["--set", "B=50", "--limit-seconds", "0.5"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&output.stderr).contains("time limit"));
}

#[test]
fn small_things() {
    let folder = Folder::new("row");
    json(&["--sweep", "A=-0.3..0.3:7", "--f64", "--plot", &folder.path("x.csv")]);
    let text = folder.text("x.csv");
    let columns: Vec<&str> = text.lines().map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(columns, ["A", "-0.3", "-0.2", "-0.1", "0", "0.1", "0.2", "0.3"]);
    assert_eq!(text.lines().next(), Some("A,kbm,exact"));
    let message = |arguments: &[&str]| String::from_utf8(run(arguments).stderr).unwrap();
    assert!(message(&["--set", "c=-0.1"]).contains("c must be at least 0, not -0.1"));
    assert!(message(&["--set", "k=1e20"]).contains("k is too large"));
    assert!(message(&["--sweep", "k=1..3:3"]).contains("every k has another orbit"));
    assert!(
        !message(&["--set", "A=1000", "--f64"]).contains("radius of convergence is about 0.000")
    );
    let growth = &json(&["--set", "B=0.1", "--f64"])["exact"]["return_map"];
    assert!(growth["error"].is_number() && growth["status"] == "estimated");
    refuses(&["derive", "vibro-impact", "--set", "branch=-"], 2, "branch has no meaning here");
    let output = lindstedt(&["derive", "vibro-impact", "--set", "alpha=pi", "--order", "1"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("without a value: omega, k, c"));
}

/// A force of the other sign is one half a period later: the verdicts at P0 and -P0 are those of single points.
#[test]
fn charts_go_over_the_sign_of_the_force() {
    let folder = Folder::new("chart-sign");
    let sweep = ["--sweep", "P0=-2..2:5", "--sweep", "A=1/10..1/5:2", "--plot"];
    json(&[&sweep[..], &[&folder.path("x.csv")]].concat());
    let text = folder.text("x.csv");
    let row = |p: &str| text.lines().find_map(|line| line.strip_prefix(&format!("{p},0.1,")));
    assert_eq!([row("-2"), row("-1"), row("0")], [row("2"), row("1"), Some(",")], "{text}");
    assert!(row("1").is_some_and(|row| row.len() > 1), "{text}");
}

/// Parameters that those of section 2 are computed from: a chart over them is made of the verdicts
/// at its points.
#[test]
fn charts_over_the_parameters_of_a_file() {
    let spring = example("impact-spring");
    let sweeps = ["--sweep", "m=1..3:3", "--sweep", "g=-1/2..1/2:5"];
    let found = of_file(&spring, &sweeps);
    assert_eq!(found["grid"]["columns"]["name"], "m");
    assert_eq!(found["grid"]["rows"]["values"], serde_json::json!([-0.5, -0.25, 0.0, 0.25, 0.5]));
    let mut kinds = std::collections::BTreeSet::new();
    for (row, g) in ["-1/2", "-1/4", "0", "1/4", "1/2"].iter().enumerate() {
        for (column, m) in ["1", "2", "3"].iter().enumerate() {
            let (m, g) = (format!("m={m}"), format!("g={g}"));
            let command =
                ["stability", &spring, "--set", &m, "--set", &g, "--f64", "--format", "json"];
            let point: Value = serde_json::from_slice(&lindstedt(&command).stdout).unwrap();
            for key in ["kbm", "exact"] {
                let cell = &found["grid"][key][row][column];
                assert_eq!(*cell, point[key]["stable"], "{key} at {m} {g}: {point}");
                kinds.insert(cell.to_string());
            }
        }
    }
    assert!(kinds.len() > 1, "{kinds:?}");
    // One that is a parameter of section 2 under another name, beside one that is not.
    let both = of_file(&spring, &["--sweep", "r=0.5..0.7:2", "--sweep", "d=0.2..0.6:2"]);
    let alone = of_file(&spring, &["--sweep", "r=0.5..0.7:2", "--set", "d=0.6"]);
    assert_eq!(both["grid"]["exact"][1], alone["grid"]["exact"][0]);
    for words in ["whole number", "m, d, k1"] {
        refuses(&["stability", &spring, "--sweep", "n=1..3:3"], 2, words);
    }
}

/// For B != 0 the zeros of G are certified, but as zeros of G; a spread of 0 has no digits to show.
#[test]
fn multipliers_of_an_approximation_are_called_so() {
    let text = |arguments: &[&str]| String::from_utf8(run(arguments).stdout).unwrap();
    let found = json(&["--set", "B=1/10"]);
    assert!(found["exact"]["multipliers_of"].as_str().unwrap().starts_with("zeros of G"));
    let shown = text(&["--set", "B=1/10"]);
    assert!(shown.contains("zeros of G, which approximates"), "{shown}");
    let line = shown.lines().find(|line| line.contains("growth per impact")).unwrap();
    assert_eq!(found["exact"]["return_map"]["spread"], 0.0);
    assert!(!line.contains("spread") && !line.contains("error"), "{line}");
    // Without a kick G is exact.
    assert!(json(&["--set", "A=1/10"])["exact"]["multipliers_of"].is_null());
}
