//! `lindstedt derive --tier`: the numeric tiers beside the exact one.

use crate::program::{Folder, json, lindstedt};
use rug::Float;
use serde_json::Value;

const AMPLITUDE: &str = "condition = \"initial-amplitude\"";

fn float(text: &Value) -> Float {
    Float::with_val(300, Float::parse(text.as_str().unwrap()).unwrap())
}

#[test]
fn numbers_agree_with_the_exact_tier_within_their_errors() {
    let tiers: [(&[&str], &str); 4] = [
        (&["--tier", "collocation", "--digits", "25"], "collocation"),
        (&["--tier", "collocation", "--f64"], "collocation"),
        (&["--tier", "fourier"], "fourier"),
        (&["--tier", "fourier", "--harmonics", "20"], "fourier"),
    ];
    let problems: [&[&str]; 5] = [
        &["power-law"],
        &["pendulum", "--set", "amplitude=2"],
        &["duffing"],
        &["duffing", "--normalisation", "fundamental"],
        &["van-der-pol"],
    ];
    for problem in problems {
        let start = [&["derive"], problem, &["--order", "5"]].concat();
        let exact = json(&[&start[..], &["--digits", "60"]].concat());
        for (tier, name) in tiers {
            let value = json(&[&start[..], tier].concat());
            assert_eq!(value["tier"], name);
            assert_eq!(value["order"], 5);
            assert_eq!(value["residual"]["zero"], Value::Null);
            assert!(value["method"]["nodes"].as_u64().unwrap() > 0);
            let series = value["series"].as_object().unwrap();
            assert!(series.len() >= 3);
            for (name, list) in series {
                let list = list.as_array().unwrap();
                assert_eq!(list.len(), 6, "{problem:?} {tier:?} {name}");
                for (n, number) in list.iter().enumerate() {
                    assert_eq!(number["status"], "estimated");
                    assert_eq!(number["exact"], Value::Null);
                    let truth = float(&exact["series"][name][n]["decimal"]);
                    let distance = (float(&number["decimal"]) - truth).abs();
                    let error = float(&number["error"]);
                    assert!(distance <= error, "{problem:?} {tier:?} {name} {n}: {number}");
                    assert!(!tier.contains(&"--digits") || error < 1e-24, "{name} {n}: {number}");
                }
            }
        }
    }
}

#[test]
fn as_text() {
    let arguments =
        ["derive", "power-law", "--order", "2", "--tier", "collocation", "--digits", "20"];
    let output = lindstedt(&arguments);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    // 1 - 2 ln 2.
    assert!(text.contains("-0.38629436111989061883"), "{text}");
    assert!(text.contains("Estimated numbers"), "{text}");
}

/// Files with forces that no exact ring has. T/2pi from the energy integral: for x + eps |x| x by
/// mpmath 1.3.0, for x + eps sgn x it is (2/pi) arccos(eps/(1 + eps)) = 1 - (2/pi)(eps - eps^2 + ...).
#[test]
fn forces_of_files_that_are_not_smooth() {
    let folder = Folder::new("tiers");
    let two_over_pi = std::f64::consts::FRAC_2_PI;
    let cases = [
        ("abs(x)*x", [-0.424_413_181_578_387_56, 0.275_195_606_140_537_5]),
        ("sign(x)", [-two_over_pi, two_over_pi]),
    ];
    for (force, expected) in cases {
        let path = folder.problem(&format!("x'' + x + eps*{force} = 0"), &[], AMPLITUDE);
        assert!(!lindstedt(&["derive", &path, "--quiet"]).status.success(), "exact");
        let found = json(&["derive", &path, "--order", "2", "--tier", "collocation"]);
        for (n, truth) in expected.iter().enumerate() {
            let number = &found["series"]["period_over_2pi"][n + 1];
            let value = float(&number["decimal"]).to_f64();
            assert!((value - truth).abs() < 1e-14, "{force} {n}: {value}");
        }
    }
}

/// x'' + x + eps |x| = 0 has T = pi/sqrt(1 + eps) + pi/sqrt(1 - eps), order 4 of T/2pi 35/128. Values
/// at nodes give 0.1706: they do not see the delta functions of the derivatives of |x| at x = 0.
#[test]
fn singularities_at_moving_times_are_refused() {
    for force in
        ["abs(x)", "sqrt(x^2)", "sign(x) + x^2", "abs(x)*x + x^2/2", "abs(x)*x'", "abs(x - 1/2)"]
    {
        let folder = Folder::new("kink");
        let path = folder.problem(&format!("x'' + x + eps*({force}) = 0"), &[], AMPLITUDE);
        for tier in ["collocation", "fourier"] {
            let output = lindstedt(&["derive", &path, "--order", "4", "--tier", tier]);
            let error = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(3), "{force}: {error}");
            assert!(output.stdout.is_empty());
        }
    }
}
