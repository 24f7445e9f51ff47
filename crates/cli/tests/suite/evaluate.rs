//! `lindstedt evaluate`: the contract's keys, the numbers of the issue, tables, figures, code,
//! refusals.

use crate::program::{self, Folder, example};
use serde_json::Value;
use std::process::Output;

const EVALUATE: &[&str] = &["evaluate", "--quiet"];

fn run(arguments: &[&str]) -> Output {
    program::lindstedt(&[EVALUATE, arguments].concat())
}

fn json(arguments: &[&str]) -> Value {
    program::json(&[EVALUATE, arguments].concat())
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
    // The printed digits are within the printed error, which is not much more: to the rounding of doubles.
    let number = |key: &str| found["period"][key].as_str().unwrap().parse::<f64>().unwrap();
    let error = (number("decimal") - 7.416_298_709_205_487_7).abs();
    assert!(error <= number("error") + 1e-15 && number("error") < 2e-13, "{error}");
    assert_eq!(found["measured_by"], "the closed form");
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
    let folder = Folder::new("plots");
    let (svg, csv) = (folder.path("x.svg"), folder.path("x.csv"));
    let plots = ["--plot", &svg, "--plot", &csv];
    let request = ["duffing", "--order", "8", "--times", "0..5:20"];
    assert!(run(&[&request[..], &plots[..]].concat()).status.success());
    let (drawn, table) = (folder.text("x.svg"), folder.text("x.csv"));
    assert!(drawn.contains("<polyline") && drawn.trim_end().ends_with("</svg>"));
    assert_eq!(table.lines().count(), 21);
    let code = |language: &str| {
        let arguments = ["duffing", "--order", "16", "--code", language, "--harmonics", "9"];
        String::from_utf8(run(&arguments).stdout).unwrap()
    };
    assert!(code("latex").contains(r"\[ x(t) = "));
    // An even motion has no sines, however few harmonics are asked for.
    let few = run(&["duffing", "--code", "python", "--harmonics", "2"]);
    let few = String::from_utf8(few.stdout).unwrap();
    let lines: Vec<&str> =
        few.lines().filter(|line| line.trim().starts_with('(') && line.contains(", ")).collect();
    assert!(!lines.is_empty() && lines.iter().all(|line| line.ends_with(", 0.0),")), "{few}");
    // Too few coefficients for an estimate: said, not an infinite error.
    let few = ["pendulum", "--order", "4", "--times", "0..1:2", "--f64"];
    let rough = run(&few);
    let rough = String::from_utf8(rough.stdout).unwrap();
    assert!(rough.contains("(no estimate)") && !rough.contains("+- inf"), "{rough}");
    // The harmonics of the printed function sum to x(0) = 1.
    let python = code("python");
    let terms = python.lines().filter_map(|line| line.trim().strip_prefix('('));
    let cosines = terms.filter_map(|line| line.split(", ").nth(1)?.parse::<f64>().ok());
    assert!((cosines.sum::<f64>() - 1.0).abs() < 1e-8);
}

#[test]
fn every_format() {
    for format in ["text", "latex", "markdown"] {
        let output = run(&["duffing", "--order", "8", "--times", "0..1:3", "--format", format]);
        assert!(output.status.success() && !output.stdout.is_empty());
    }
}

/// The printed file of a built-in problem gives the identical result, x(t) included.
#[test]
fn a_printed_file_is_the_built_in_problem() {
    for (name, set) in [
        ("power-law", "n=5/2"),
        ("power-law", "amplitude=3"),
        ("pendulum", "amplitude=1/2"),
        ("duffing", "eps=1/3"),
        ("van-der-pol", "eps=1/2"),
    ] {
        let folder = Folder::new("printed");
        let path = folder.file("printed.toml", program::text(&["problems", "--show", name]));
        let run = |problem: &str| {
            // A limit cycle is a series in eps^2.
            let order = if name == "van-der-pol" { "12" } else { "8" };
            let arguments = ["--set", set, "--order", order, "--times", "0..2:3"];
            let mut found = json(&[&[problem], &arguments[..]].concat());
            found["seconds"] = 0.into();
            found
        };
        assert_eq!(run(name), run(&path), "{name} {set}");
    }
    // The same equation under other names.
    let built_in = json(&["power-law", "--set", "delta=1/2", "--set", "amplitude=2"]);
    for name in ["power-law.toml", "sign-power.toml"] {
        let set = ["--set", "delta=1/2", "--set", "amplitude=2"];
        let found = json(&[&[&*example(name)], &set[..]].concat());
        for key in ["period", "frequency", "tried", "resum"] {
            assert_eq!(found[key], built_in[key], "{name} {key}");
        }
        assert_eq!(found["exact_period"]["decimal"], built_in["exact_period"]["decimal"]);
    }
}

/// Every example that has an expansion has a value; the others say why not.
#[test]
fn all_examples() {
    for (name, set) in [
        ("duffing.toml", "eps=1/5"),
        ("van-der-pol.toml", "eps=1/5"),
        ("rayleigh.toml", "eps=1/5"),
        ("duffing-van-der-pol.toml", "eps=1/10"),
        ("helmholtz-duffing.toml", "eps=1/5"),
        ("pendulum.toml", "eps=1"),
    ] {
        let found = json(&[&example(name), "--set", set, "--order", "12"]);
        assert_eq!(found["period"]["status"], "estimated", "{name}");
        assert!(found["period"]["error"].is_string(), "{name}");
        let small = set.split_once('=').unwrap();
        assert_eq!(found["at"][small.0], small.1, "{name}");
    }
    for name in ["delayed-duffing.toml", "vibro-impact.toml", "wright.toml"] {
        let set = if name == "wright.toml" { "eps=1/10" } else { "T=1" };
        let set: &[&str] = if name == "vibro-impact.toml" { &[] } else { &["--set", set] };
        let start = ["--order", "3", "--start", "1/2,0", "--times", "0..1:2"];
        let found = json(&[&[&*example(name)], set, &start[..]].concat());
        assert_eq!(found["solution"]["values"].as_array().unwrap().len(), 2, "{name}");
    }
    // No value for the small parameter: named; no expansion: why.
    program::refuses(&["evaluate", &example("duffing.toml")], 2, "eps has no value");
    program::refuses(&["evaluate", &example("stick-slip.toml")], 3, "not smooth");
    let quartic = "name = 'a'\nequation = \"x'' + x + eps*x^3 = 0\"\n";
    let folder = Folder::new("initial");
    let moving = |v| format!("{quartic}[initial]\nx = '1/2'\nvelocity = '{v}'\n");
    let path = folder.file("initial.toml", moving(0));
    let found = json(&[&path, "--set", "eps=4"]);
    assert_eq!(found["at"]["amplitude"], "1/2");
    // 2 pi/agm(sqrt 2, sqrt(3/2)), mpmath 1.3.0: the period of rho = 1.
    assert_eq!(found["exact_period"]["decimal"], "4.76802202910246080630451847006");
    let path = folder.file("initial.toml", moving(1));
    assert_eq!(run(&[&path, "--set", "eps=4"]).status.code(), Some(3));
    let _ = std::fs::remove_file(path);
}

/// Orders 0 and 1: the partial sum, its error by the closed form, by Newton's orbit, or (in doubles) none.
#[test]
fn few_coefficients() {
    let found = json(&["power-law", "--set", "n=3", "--order", "1", "--resum", "none"]);
    let decimal = found["period"]["decimal"].as_str().unwrap();
    // 2 pi (1 + ln 2 - 1/2).
    assert_eq!(decimal, "7.497");
    let error: f64 = found["period"]["error"].as_str().unwrap().parse().unwrap();
    assert!((error - 0.0805).abs() < 1e-3, "{error}");
    assert!(found["verdict"].as_str().unwrap().contains("no estimate from so few coefficients"));
    let found = json(&["power-law", "--order", "0"]);
    assert_eq!(found["period"]["decimal"], "6.283");
    for order in ["0", "1", "3"] {
        // Nobody vouches for it: exit code 4.
        let asked = ["van-der-pol", "--order", order, "--times", "0..1:2", "--format", "json"];
        let beside = json(&asked[..5]);
        let number = |key: &str| beside["period"][key].as_str().unwrap().parse::<f64>().unwrap();
        // x(0) of the cycle at eps = 1 is 2.00861986, its period 6.66328686 (DOP853 of SciPy, rtol 1e-13).
        let distance = (number("decimal") - 6.663_286_859_323_13).abs();
        let error = number("error");
        assert!(distance <= error && error < 1.2 * distance + 1e-3, "{order}: {distance} {error}");
        assert_eq!(beside["measured_by"], "Newton's orbit");
        let x = &beside["solution"]["values"][0]["x"];
        let distance =
            (x["decimal"].as_str().unwrap().parse::<f64>().unwrap() - 2.008_619_86).abs();
        let error: f64 = x["error"].as_str().unwrap().parse().unwrap();
        assert!(distance <= error && error < 1.2 * distance + 1e-3, "{order}: {distance} {error}");
        let output = run(&[&asked[..], &["--f64"]].concat());
        assert_eq!(output.status.code(), Some(4));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(found["standing"], "undecided");
        // Four digits, and a class that says that nothing is known of their error.
        let period = &found["period"];
        assert!(period["error"].is_null() && period["status"] == "no-estimate", "{period}");
        assert_eq!(period["decimal"].as_str().unwrap().len(), 5, "{period}");
        assert_eq!(found["frequency"]["status"], "no-estimate");
        let text = run(&["van-der-pol", "--order", order, "--f64"]).stdout;
        assert!(String::from_utf8_lossy(&text).contains(" (no estimate"));
        assert!(found["verdict"].as_str().unwrap().contains("no estimate"), "{order}");
        let x = &found["solution"]["values"][0]["x"];
        assert!(x["error"].is_null() && x["status"] == "no-estimate", "{order}: {x}");
        assert!(x["decimal"].as_str().unwrap().len() < 8, "{order}: {x}");
    }
}

/// A sum that is no period is not shown as one; the error is not that of a coarse decimal.
#[test]
fn a_period_is_positive_and_has_the_digits_of_its_error() {
    for (equation, eps) in [
        ("x'' + x + eps*x^5 = 0", "eps=4404/1000"),
        ("x'' + x + eps*(x^2/2 + 3/2*x^3) = 0", "eps=1727/1000"),
    ] {
        let output = run(&[equation, "--set", eps, "--order", "5", "--resum", "none"]);
        assert_eq!(output.status.code(), Some(4), "{equation}");
        let shown = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(shown.contains("period T          not one digit"), "{shown}");
    }
    let found = json(&["duffing", "--set", "eps=20", "--order", "2"]);
    let number = |key: &str| found["period"][key].as_str().unwrap().parse::<f64>().unwrap();
    // Rounded to its error it would be 2 +- 0.57.
    assert!((number("decimal") - 1.6).abs() < 0.1 && number("error") < 0.4, "{}", found["period"]);
    assert!((number("decimal") - 1.601_205_990_328_808).abs() < number("error"));
}

/// a(t), psi(t), x(t) as table, figure and comma-separated values.
#[test]
fn averaged_motions() {
    let free = ["van-der-pol", "--normalisation", "free", "--set", "eps=1/10"];
    let set = ["--order", "8", "--state", "1,0", "--times", "0..60:7", "--digits", "16"];
    let arguments = [&free[..], &set[..]].concat();
    let found = json(&arguments);
    let number = |value: &Value, key: &str| value[key].as_str().unwrap().parse::<f64>().unwrap();
    let values = found["solution"]["values"].as_array().unwrap();
    // Taylor integration with tolerance 1e-18 (mpmath 1.3.0, odefun).
    let expected = [
        1.0, -1.128305538500262, 0.6490678955318142, 0.3233492099058716, -1.350797988542573,
        1.936387410324992, -1.868066746685336,
    ];
    for (value, expected) in values.iter().zip(expected) {
        let x = &value["x"];
        let error = (number(x, "decimal") - expected).abs();
        assert!(error <= number(x, "error") + 1e-16 && error < 1e-8, "{x} {expected}");
        assert!(value["a"]["decimal"].is_string() && value["psi"]["decimal"].is_string());
    }
    assert_eq!(values.len(), 7);
    for format in ["text", "latex", "markdown"] {
        let output = run(&[&arguments[..], &["--format", format]].concat());
        assert!(output.status.success() && output.stdout.len() > 500, "{format}");
    }
    let folder = Folder::new("averaged");
    let (svg, csv) = (folder.path("x.svg"), folder.path("x.csv"));
    let plots = ["--plot", &svg, "--plot", &csv];
    assert!(run(&[&free[..], &["--start", "1,0"], &plots[..]].concat()).status.success());
    let drawn = std::fs::read_to_string(&svg).unwrap();
    assert_eq!(drawn.matches("stroke=\"#969696\"").count(), 2, "{drawn}");
    let table = std::fs::read_to_string(&csv).unwrap();
    assert!(table.starts_with("t,a,a_error,psi,psi_error,x,x_error\n0.0,1.0,"));
    assert_eq!(table.lines().count(), 130);
    // A series whose terms grow has no estimate, and says so.
    let wild = ["van-der-pol", "--normalisation", "free", "--set", "eps=20", "--start", "2,0"];
    let found = json(&[&wild[..], &["--times", "0..1:2"]].concat());
    assert!(found["verdict"].as_str().unwrap().contains("do not decrease"));
    assert!(found["solution"]["values"][1]["x"]["error"].is_null());
}

/// Whatever method is taken, the verdict says why: the only estimate, the least, or a simpler one.
#[test]
fn choice_of_the_method() {
    let mut seen = std::collections::BTreeSet::new();
    for arguments in [
        ["power-law", "--set", "n=3", "--order", "20", "--digits", "30"],
        ["power-law", "--set", "n=1001/1000", "--order", "20", "--digits", "10"],
        ["duffing", "--set", "eps=1/100", "--order", "20", "--digits", "12"],
        ["van-der-pol", "--set", "eps=1/2", "--order", "30", "--digits", "30"],
        ["van-der-pol", "--set", "eps=2", "--order", "40", "--digits", "30"],
        ["pendulum", "--set", "amplitude=1", "--order", "14", "--digits", "20"],
    ] {
        let found = json(&arguments);
        let verdict = found["verdict"].as_str().unwrap();
        let tried = found["tried"].as_array().unwrap();
        let error = |t: &Value| t["error"].as_str().map(|e| e.parse::<f64>().unwrap());
        let own = tried.iter().find(|t| t["resum"] == found["resum"]).and_then(error);
        let Some(own) = own else { continue };
        let list: Vec<f64> = tried.iter().filter_map(error).collect();
        let least = list.iter().copied().fold(f64::INFINITY, f64::min);
        let said = if list.len() == 1 {
            "the only one of 6 methods with an error estimate"
        } else if verdict.contains("below the working precision") {
            let digits: i32 = arguments[6].parse().unwrap();
            assert!(own < 10f64.powi(-digits), "{verdict}");
            "the simplest of 6 methods whose error is below the working precision"
        } else if own <= least {
            "the least error estimate of"
        } else {
            assert!(own <= 10.0 * least, "{own} {least}");
            "within a factor 10 of the least"
        };
        assert!(verdict.contains(said), "{said}: {verdict}");
        seen.insert(said);
    }
    assert!(seen.len() > 1, "{seen:?}");
}

/// A sum at thousands of digits is broken off, and nothing is printed but the reason.
#[test]
fn a_resummation_is_broken_off() {
    let limit = ["--digits", "10000", "--limit-seconds", "0.5", "--format", "json"];
    for problem in ["van-der-pol", "pendulum"] {
        let output = run(&[&[problem, "--order", "20"][..], &limit[..]].concat());
        assert_eq!(output.status.code(), Some(4));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(found["error"]["code"], "limit-seconds");
    }
}

/// What is not derived but computed in numbers is predicted, too.
#[test]
fn memory_is_predicted() {
    for (problem, order) in [("pendulum", "60"), ("power-law", "3000")] {
        let output = run(&[problem, "--order", order, "--limit-memory", "1M", "--format", "json"]);
        assert_eq!(output.status.code(), Some(4), "{problem}");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(found["error"]["code"], "too-large");
    }
    assert!(run(&["pendulum", "--order", "12", "--limit-memory", "1M"]).status.success());
}

/// Harmonics below the error of the expansion are noise: the pendulum is even in t, so it has no
/// sines, and its odd harmonics alone.
#[test]
fn code_without_noise() {
    let code = |problem: &str| {
        let output = run(&[problem, "--set", "amplitude=1", "--code", "latex"]);
        String::from_utf8(output.stdout).unwrap()
    };
    let text = code("pendulum");
    assert!(text.starts_with(r"\[ x(t)") && text.contains("are left out"), "{text}");
    assert!(!text.contains("sin") && text.matches("cos").count() >= 2, "{text}");
    assert_eq!(code("duffing").matches("cos").count(), 8);
}

/// Nothing integrated is no error of 0, and an escape ends the motion.
#[test]
fn averaged_without_integration() {
    let free = ["van-der-pol", "--normalisation", "free", "--set", "eps=1/10"];
    let found = json(&free);
    assert!(found["integration_error"].is_null());
    assert!(!found["verdict"].as_str().unwrap().contains("error 0"), "{found}");
    let found = json(&[&free[..], &["--start", "1,0", "--times", "0..10:3"]].concat());
    assert!(found["integration_error"].as_f64().unwrap() > 0.0);
    let wild = ["van-der-pol", "--normalisation", "free", "--set", "eps=-5", "--start", "5,0"];
    let output = run(&[&wild[..], &["--times", "0..10:5"]].concat());
    assert_eq!(output.status.code(), Some(3));
}

/// The generated function is as near to the expansion as it says, terms left out included: here
/// x(0) = 1 exactly, and the fifth harmonic, -1.3e-7, is left out.
#[test]
fn generated_code_deviates_as_it_says() {
    let folder = Folder::new("deviation");
    let path = folder.problem("x'' + x + eps*(x^2 + x'^2) = 0", &[], "");
    let arguments = ["--set", "eps=1/5", "--code", "python", "--harmonics", "6", "--digits", "10"];
    let output = run(&[&[path.as_str()], &arguments[..]].concat());
    let code = String::from_utf8(output.stdout).unwrap();
    let (_, rest) = code.split_once("deviation from the expansion ").unwrap();
    let stated: f64 = rest.split_once(';').unwrap().0.parse().unwrap();
    let cosine = |line: &str| -> Option<f64> {
        line.trim().strip_prefix('(')?.split(", ").nth(1)?.parse().ok()
    };
    let start: f64 = code.lines().filter_map(cosine).sum::<f64>();
    assert!(stated < 2e-7, "{stated}");
    assert!((start - 1.0).abs() <= stated, "{start} {stated}");
    assert!((start - 1.0).abs() > 1e-8, "nothing is left out here: {start}");
}

/// The default order is a quick one whatever the degree: the x_n of x^4 x' have three times the harmonics of x^2 x' (order 60 takes
/// two minutes). The period is that of DOP853 of SciPy, rtol 1e-13.
#[test]
fn the_default_order_falls_with_the_degree() {
    let found = json(&["x'' + x + eps*(-x' + x^4*x'/2) = 0", "--set", "eps=1", "--digits", "14"]);
    assert_eq!(found["order"], 20);
    let period: f64 = found["period"]["decimal"].as_str().unwrap().parse().unwrap();
    assert!((period - 7.068_830_327_67).abs() < 1e-10, "{period}");
}

/// The phase is that of the times whatever the harmonics are of: the sum in its default order, one of an order asked for, and
/// Newton's orbit, which the sum of so strong a cycle makes way for.
#[test]
fn code_starts_at_the_phase() {
    for (eps, order) in
        [("eps=1/10", &[][..]), ("eps=1", &["--order", "24"][..]), ("eps=3", &[][..])]
    {
        let case = [&["van-der-pol", "--set", eps, "--phase", "1"], order].concat();
        let found = json(&[&case[..], &["--times", "0"]].concat());
        let expected = &found["solution"]["values"][0]["x"];
        let code = ["--code", "python", "--harmonics", "40"];
        let written = json(&[&case[..], &code].concat());
        let terms = written["terms"].as_array().unwrap().iter();
        let start: f64 = terms.map(|term| term[1].as_f64().unwrap()).sum();
        let number = |key: &str| expected[key].as_str().unwrap().parse::<f64>().unwrap();
        let allowed = written["deviation"].as_f64().unwrap() + number("error") + 1e-14;
        let distance = (start - number("decimal")).abs();
        assert!(distance <= allowed && allowed < 1e-3, "{eps}: {distance:e} {allowed:e}");
    }
}

/// The flight is linear at every order: where not one digit of the growth rate is known, that is said.
#[test]
fn a_growth_rate_without_a_digit_is_said_to_have_none() {
    let shown = |gain: &str| {
        let output = run(&["vibro-impact", "--order", "2", "--set", gain]);
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let line = |text: &str, label: &str| {
        text.lines().find(|line| line.trim().starts_with(label)).unwrap().to_owned()
    };
    for label in ["growth rate a'/a", "frequency psi'"] {
        assert!(line(&shown("B=1/10"), label).contains("(estimated)"), "{label}");
        let without = line(&shown("B=1"), label);
        assert!(without.ends_with("not one digit: the last orders differ by more than its size"));
    }
    let found = json(&["vibro-impact", "--order", "2", "--set", "B=1"]);
    for key in ["growth_rate", "frequency"] {
        assert!(found[key].is_object() && found[key]["decimal"].is_null(), "{found}");
    }
    // Where the rate depends on the amplitude there is no such number.
    let drifting = ["van-der-pol", "--normalisation", "free", "--set", "eps=1/10"];
    assert!(json(&drifting)["growth_rate"].is_null());
}

/// x'' + x + eps (x^2 + x'^2) = 0 has B_3 = B_4 = B_5 = 0: the last orders add nothing to psi' = 1 -
/// eps^2 a^2, and the sixth does.
#[test]
fn orders_that_vanish_are_no_error_of_zero() {
    let folder = Folder::new("vanish");
    let condition = "condition = \"free-amplitude\"";
    let path = folder.problem("x'' + x + eps*(x^2 + x'^2) = 0", &[], condition);
    let rate = |order: &str| {
        let arguments = [&path, "--order", order, "--start", "1,0"];
        let found = json(&[&arguments[..], &["--set", "eps=1/10", "--digits", "20"]].concat());
        let number = &found["rates"]["phase_number"];
        let text = |key: &str| number[key].as_str().unwrap().parse::<f64>().unwrap();
        (text("decimal"), text("error"), found["rates"]["amplitude_number"]["error"].clone())
    };
    let (truth, _, drift) = rate("10");
    // It can be run backwards: a' = 0.
    assert_eq!(drift.as_str().unwrap().parse::<f64>().unwrap(), 0.0);
    assert!((truth - 0.99).abs() > 1e-7, "{truth}");
    for order in ["2", "3", "4", "5", "6"] {
        let (value, error, _) = rate(order);
        assert!((value - truth).abs() <= error && error < 0.1, "{order}: {value} +- {error}");
    }
}
