//! `lindstedt derive` with a free amplitude: formulas, numbers, warnings, refusals.

use crate::program;
use serde_json::Value;
use std::process::Output;

fn derive(arguments: &[&str]) -> Output {
    program::lindstedt(&[&["derive"], arguments].concat())
}

fn json(arguments: &[&str]) -> Value {
    program::json(&[&["derive"], arguments].concat())
}

/// Every parameter that the flight between two impacts knows.
fn flight<'a>(gains: &[&'a str; 2]) -> Vec<&'a str> {
    let mut sets = vec!["vibro-impact"];
    for set in ["alpha=1", "omega=0.8", "k=1", "c=0.05", "P0=1", gains[0], gains[1]] {
        sets.extend(["--set", set]);
    }
    sets
}

/// The names of all objects, whatever the length of the lists.
fn keys(value: &Value, path: &str, found: &mut std::collections::BTreeSet<String>) {
    if let Some(object) = value.as_object() {
        for (name, inner) in object {
            found.insert(format!("{path}/{name}"));
            keys(inner, &format!("{path}/{name}"), found);
        }
    }
    for inner in value.as_array().into_iter().flatten() {
        keys(inner, &format!("{path}[]"), found);
    }
}

/// A program that read one order reads all.
#[test]
fn every_order_has_the_same_keys() {
    let cases: [&[&str]; 2] = [&["van-der-pol", "--normalisation", "free"], &["vibro-impact"]];
    for case in cases {
        let of = |order: &str| {
            let mut found = std::collections::BTreeSet::new();
            keys(&json(&[case, &["--order", order]].concat()), "", &mut found);
            // The monomials that occur are data.
            found.retain(|key| !key.contains("/powers/"));
            found
        };
        let first = of("1");
        assert!(first.len() > 20, "{first:?}");
        assert_eq!((of("2"), of("3")), (first.clone(), first), "{case:?}");
    }
}

#[test]
fn van_der_pol_with_free_amplitude() {
    let free = ["van-der-pol", "--normalisation", "free", "--order", "4"];
    let found = json(&free);
    assert_eq!(found["normalisation"], "free-amplitude");
    let first = &found["series"]["amplitude_rate"][1];
    assert_eq!((&first[0]["power"], &first[1]["power"]), (&1.into(), &3.into()));
    assert_eq!(first[1]["coefficient"]["exact"], "-1/8");
    assert!(found["series"]["growth_rate"].is_null() && found["convergence"].is_null());
}

/// The formulas of orders 1 and 2, and the numbers of the same formulas.
#[test]
fn formulas_and_numbers_in_json() {
    let symbolic = json(&["vibro-impact", "--order", "2"]);
    let series = &symbolic["series"];
    assert_eq!(
        series["growth_rate"][1]["exact"],
        "1/2*alpha^(-1)*A*sin(alpha*T) - 1/2*c + 1/2*B - 1/2*B*cos(alpha*T)"
    );
    assert_eq!(series["growth_rate"][0]["exact"], "0");
    assert_eq!(series["frequency"][0]["exact"], "alpha");
    for name in ["growth_rate", "frequency"] {
        let second = &series[name][2];
        assert!(second["exact"].as_str().unwrap().contains("sin(alpha*T)"), "{second}");
        assert!(second["decimal"].is_null() && second["status"] == "exact");
        assert_eq!(series[name].as_array().unwrap().len(), 3);
    }
    assert_eq!((&symbolic["tier"], &symbolic["parameter"]), (&"exact".into(), &"eps".into()));
    assert_eq!(symbolic["residual"]["zero"], true);
    // Without numbers there is no radius.
    assert!(symbolic["convergence"].is_null());
    let numbers = json(&[&flight(&["A=0.02", "B=0.01"])[..], &["--order", "1"]].concat());
    let (sin, cos) = (2.5 * std::f64::consts::PI).sin_cos();
    let value = |name: &str| -> f64 {
        numbers["series"][name][1]["decimal"].as_str().unwrap().parse().unwrap()
    };
    let growth = 0.5 * (0.02 * sin - 0.05 + 0.01 * (1.0 - cos));
    let frequency = 0.5 * (0.02 * (cos - 1.0) + 0.01 * sin);
    assert!((value("growth_rate") - growth).abs() < 1e-16);
    assert!((value("frequency") - frequency).abs() < 1e-16);
    assert_eq!(numbers["tier"], "certified");
}

/// |(A, B)| = 0.3 with T = 7.85: the terms of the series at eps = 1 grow, and the program says so.
#[test]
fn a_divergent_series_is_named_with_its_radius() {
    for (gains, diverges) in [(["A=0.2", "B=0.22"], true), (["A=0.01", "B=0.01"], false)] {
        let arguments =
            [&flight(&gains)[..], &["--order", "20", "--digits", "15", "--format", "json"]]
                .concat();
        let output = derive(&arguments);
        assert_eq!(output.status.code(), Some(0));
        let errors = String::from_utf8(output.stderr).unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let convergence = &found["convergence"];
        let radius = convergence["radius"].as_f64().unwrap();
        assert_eq!(convergence["status"], "estimated");
        assert_eq!(convergence["diverges"], diverges, "{convergence}");
        assert_eq!(radius < 1.0, diverges);
        let words = format!("diverges at eps = 1: its radius of convergence is about {radius:.3}");
        assert_eq!(errors.contains(&words), diverges, "{errors}");
        // The terms themselves: their root test against the radius.
        let size = |n: usize| {
            let part = |name: &str| -> f64 {
                found["series"][name][n]["decimal"].as_str().unwrap().parse().unwrap()
            };
            part("growth_rate").hypot(part("frequency"))
        };
        let rate = (size(20) / size(10)).powf(0.1);
        assert!((0.75..1.25).contains(&(rate * radius)), "{rate} {radius}");
    }
}

#[test]
fn refusals_have_their_reason() {
    let cases: [(&[&str], i32, &str); 6] = [
        (&["vibro-impact", "--set", "k=1"], 2, "k can only be set when all parameters are"),
        (&["vibro-impact", "--set", "alpha=pi"], 2, "alpha can only be set"),
        (&["vibro-impact", "--set", "z=1"], 2, "z"),
        (&["vibro-impact", "--normalisation", "initial"], 2, "does not offer"),
        (&["vibro-impact", "--set", "branch=+"], 2, "branch has no meaning here"),
        (&["power-law", "--normalisation", "free"], 3, "not taken"),
    ];
    for (arguments, code, words) in cases {
        let output = derive(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        println!("{arguments:?}: {message}");
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
    // The force in resonance with the free flight, at the order at which it appears.
    let mut resonant = flight(&["A=0.02", "B=0.01"]);
    resonant[4] = "omega=1";
    assert!(resonant.contains(&"omega=1") && !resonant.contains(&"omega=0.8"));
    let output = derive(&resonant);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8(output.stderr).unwrap().contains("resonance"));
}

/// The one limit cycle is listed whatever the coefficients are. Where several are not it is said why: irrational coefficients, a symbol;
/// and of a double zero, by `evaluate` too.
#[test]
fn cycles_that_are_not_listed_are_explained() {
    let free = ["--normalisation", "free", "--order", "1"];
    let told = |equation: &str| program::text(&[&["derive", equation][..], &free].concat());
    for (equation, words) in [
        ("x'' + 2*x + eps*x'*(x^4 - x^2 - 1)", "with the Floquet exponent A_1'(a_0)*eps + ..."),
        ("x'' + x + eps*(x^4*x' - x') + eps*x(t - 1)", "for the coefficients are irrational"),
        ("x'' + omega0^2*x + eps*x'*(x^4 - x^2 - 1)", "not listed without the values of omega0"),
        ("x'' + omega0^2*x + eps*x'*(x^2 - mu)", "one where a_0^2 > 0"),
        ("x'' + omega0^2*x + eps*x'*(x^2 - mu)", "  a^2 = 4*mu\n"),
        ("x'' + x + eps*(x^2*x' - x') + eps*x(t - 1)", "  a^2 = 7.36588393923158"),
    ] {
        let text = told(equation);
        assert!(text.contains(words), "{equation}: {text}");
    }
    assert!(!told("x'' + 2*x + eps*x'").contains("imit cycle"));
    let double = "x'' + x + eps*x'*(x^4 - 4*x^2 + 2)";
    let set = [&["evaluate", double][..], &free, &["--set", "eps=1/10"]].concat();
    let output = program::lindstedt(&set);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("at the amplitude 2 the leading rate has a multiple zero"), "{said}");
}
