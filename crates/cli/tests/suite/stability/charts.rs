//! Charts, tables, warnings.

use super::{json, run};
use crate::program::Folder;

const O5: [&str; 10] =
    ["--set", "omega=3.3", "--set", "k=2", "--set", "R_r=0.8", "--set", "s=0", "--set", "c=0.05"];

/// A chart as figure, table and JSON: the same verdicts, which are those of the single points.
#[test]
fn chart_in_three_forms() {
    let folder = Folder::new("chart");
    let (svg, csv) = (folder.path("x.svg"), folder.path("x.csv"));
    let sweeps = ["--set", "A=0.2", "--sweep", "A=-0.3..0.3:13", "--sweep", "B=-0.3..0.3:7"];
    let plots = ["--plot", &svg, "--plot", &csv];
    let found = json(&[&O5[..], &sweeps[..], &plots[..]].concat());
    let grid = &found["grid"];
    assert_eq!((&grid["finished"], &grid["columns"]["name"]), (&true.into(), &"A".into()));
    let table = folder.text("x.csv");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("A,B,kbm,exact"));
    let word = |verdict: &serde_json::Value| match verdict.as_bool() {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "",
    };
    let (mut equal, mut compared) = (0, 0);
    for row in 0..7 {
        for column in 0..13 {
            let (kbm, exact) = (&grid["kbm"][row][column], &grid["exact"][row][column]);
            let fields: Vec<&str> = lines.next().unwrap().split(',').collect();
            assert_eq!(fields[2..], [word(kbm), word(exact)]);
            if kbm.is_boolean() && exact.is_boolean() {
                compared += 1;
                equal += i32::from(kbm == exact);
            }
            if (row + column) % 9 == 0 {
                let sets = [format!("A={}", fields[0]), format!("B={}", fields[1])];
                let point = ["--set", &sets[0], "--set", &sets[1], "--f64"];
                let single = json(&[&O5[..], &point].concat());
                assert_eq!(&single["kbm"]["stable"], kbm, "{sets:?}");
                // The chart's verdict is that of G; the point iterates the return map too.
                assert_eq!(&single["exact"]["stable"], exact, "{sets:?}");
            }
        }
    }
    assert_eq!(lines.next(), None);
    assert_eq!(
        (&grid["agreement"]["compared"], &grid["agreement"]["equal"]),
        (&compared.into(), &equal.into())
    );
    assert!(0 < equal && equal < compared);
    let drawn = folder.text("x.svg");
    for words in [
        "predicted stable, IS UNSTABLE",
        "predicted unstable, is unstable",
        "dots: flip",
        "cross: A = 0.2, B = 0",
        "alpha = 1,  omega = 33/10,  k = 2,  R_r = 4/5,  s = 0,  c = 1/20,  P0 = 1,  branch = +",
    ] {
        assert!(drawn.contains(words), "{words}");
    }
    assert!(drawn.trim_end().ends_with("</svg>"));
}

#[test]
fn warnings_name_the_radius_and_the_mismatch() {
    let o7 = ["--set", "omega=0.8", "--set", "R_r=0.8", "--set", "s=0.5", "--set", "c=0.05"];
    let gains = ["--set", "A=0.2", "--set", "B=0.22"];
    let output = run(&[&o7[..], &gains, &["--format", "json"]].concat());
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    let convergence = &found["kbm"]["convergence"];
    let radius = convergence["radius"].as_f64().unwrap();
    assert!(radius < 1.0 && convergence["diverges"] == true, "{convergence}");
    assert_eq!(convergence["status"], "estimated");
    // A single term has no ratio.
    assert!(convergence["ratio"].is_null());
    let words = format!("diverges at eps = 1: its radius of convergence is about {radius:.3}");
    assert!(errors.contains(&words), "{errors}");
    assert_eq!(found["warnings"].as_array().unwrap().len(), errors.lines().count());
    // A small loop converges; the impact within the delay is ignored nevertheless.
    let output = run(&["--set", "A=0.01"]);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(errors.contains("the mismatch is above 1") && !errors.contains("diverges"), "{errors}");
    // Without loop and damping the radius is infinite.
    let free = json(&["--set", "A=0", "--set", "c=0", "--order", "3"]);
    assert_eq!(free["kbm"]["convergence"]["radius"], "infinite");
    assert_eq!(free["kbm"]["R"]["status"], "exact");
}
