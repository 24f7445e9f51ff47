//! Only digits that are known, and only claims that hold.

use crate::program::{Folder, example, json, lindstedt, refusal, refuses, root, text};
use serde_json::Value;

/// Branch points at rho = -1.306238 +- 0.690194 i, by the zeros of the discriminant of quadratic
/// approximants of order 80.
#[test]
fn the_radius_of_convergence_has_an_error_that_holds() {
    let truth = 1.306_238_f64.hypot(0.690_194);
    for order in ["12", "24", "40"] {
        let set = ["--normalisation", "fundamental", "--set", "eps=1/2", "--order", order];
        let found = json(&[&["evaluate", "duffing"], &set[..]].concat());
        let radius = &found["coefficients"];
        let (value, error) =
            (radius["radius"].as_f64().unwrap(), radius["error"].as_f64().unwrap());
        assert!((value - truth).abs() <= error, "{order}: {value} +- {error}");
        let words = found["verdict"].as_str().unwrap();
        assert!(words.contains(" +- ") && words.contains("(estimated)"), "{words}");
    }
}

#[test]
fn first_order_in_eps_is_no_statement_about_large_eps() {
    let path = &*example("holmes-duffing");
    let found = text(&["threshold", path, "--set", "eps=10"]);
    assert!(found.contains("no bound on eps is known"), "{found}");
    for problem in [path, "stick-slip"] {
        let found = json(&["threshold", problem, "--set", "eps=0"]);
        let verdict = found["validity"]["verdict"].as_str().unwrap();
        assert!(verdict.starts_with("no statement"), "{verdict}");
        assert!(!found.to_string().contains("\"crossing\""), "{found}");
    }
}

#[test]
fn rates_of_an_averaged_motion_have_errors() {
    let set = ["--normalisation", "free", "--start", "1,0", "--set"];
    let found = json(&[&["evaluate", "van-der-pol"], &set[..], &["eps=1/10"]].concat());
    assert!(found["rates"]["phase_number"]["error"].is_string(), "{found}");
    let found = text(&[&["evaluate", "van-der-pol"], &set[..], &["eps=4"]].concat());
    assert!(found.contains("(no estimate)") && !found.contains("+-"), "{found}");
}

#[test]
fn the_exponent_of_lyapunov_has_one_error() {
    let found =
        text(&["simulate", "van-der-pol", "--lyapunov", "--periods", "200", "--skip", "20"]);
    let errors: Vec<&str> = found
        .split(" +- ")
        .skip(1)
        .filter_map(|rest| rest.split([' ', '\n', ',']).next())
        .collect();
    assert!(errors.len() == 2 && errors[0] == errors[1], "{found}");
}

/// x'' + x + eps x^2 = 0 from (-2.9, 0), eps = 0.6: beyond the saddle x = -1/eps.
#[test]
fn an_escape_is_called_one() {
    let folder = Folder::new("escape");
    let path = folder.problem("x'' + x + eps*x^2 = 0", &[], "");
    let run = ["simulate", &path, "--set", "eps=0.6", "--state", "-2.9,0", "--until", "30"];
    refuses(&run, 3, "the motion escapes to infinity near t = ");
}

#[test]
fn refusals_name_the_reason() {
    refuses(&["verify", "duffing", "--small", "10,5,2"], 3, "omega^2 of order 4 is -");
    let (_, error) = refusal(&["simulate", "vibro-impact", "--state", "0,0"]);
    assert!(error.contains("behind the wall at x = -0.2"), "{error}");
    let rough =
        ["evaluate", "pendulum", "--set", "amplitude=3", "--order", "5", "--format", "json"];
    let found: Value = serde_json::from_slice(&lindstedt(&rough).stdout).unwrap();
    assert!(found["period"]["decimal"].is_null(), "{found}");
}

#[test]
fn charts_say_why_points_are_not_compared() {
    let sweeps = ["--sweep", "A=-3..3:9", "--sweep", "B=-3..3:9"];
    let found = json(&[&["stability", "vibro-impact"], &sweeps[..]].concat());
    let agreement = &found["grid"]["agreement"];
    let left: u64 =
        agreement["left_out"].as_object().unwrap().values().flat_map(Value::as_u64).sum();
    assert_eq!(agreement["compared"].as_u64().unwrap() + left, 81);
    assert!(left > 0);
}

#[test]
fn without_a_loop_nothing_is_ignored_within_its_delay() {
    let warned = |gain: &str| {
        let found = json(&["stability", "vibro-impact", "--set", gain, "--set", "B=0"]);
        found["warnings"].to_string().contains("mismatch")
    };
    assert!(!warned("A=0") && warned("A=1/1000"));
}

/// A multiplier 3e-13 outside of the unit circle is told from one on it.
#[test]
fn digits_decide_near_a_flip() {
    let found =
        json(&["stability", "vibro-impact", "--predictor", "exact", "--set", "A=-0.0292903246974"]);
    assert_eq!(found["exact"]["stable"], false, "{}", found["exact"]);
    assert_eq!(found["exact"]["zeros_in_unit_disc"], 1);
}

#[test]
fn parameters_that_occur_nowhere_are_named() {
    let folder = Folder::new("unused");
    let path = folder.problem("x'' + x + eps*c*x^3 = 0", &[("c", "1"), ("k", "2")], "");
    let (_, error) = refusal(&["problems", "--show", &path]);
    assert!(error.contains("parameter k is declared and occurs nowhere"), "{error}");
    assert!(!error.contains("parameter c "), "{error}");
    for entry in std::fs::read_dir(root().join("docs/examples")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "toml") {
            let (_, error) = refusal(&["problems", "--show", &path.to_string_lossy()]);
            assert!(!error.contains("occurs nowhere"), "{}: {error}", path.display());
        }
    }
}
