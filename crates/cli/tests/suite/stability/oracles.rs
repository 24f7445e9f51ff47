//! Two reference cases as they are printed, certified to 25 digits and in doubles to 12; all eight are those of
//! the tests of `impact`.

use super::{data, json, point};
use rug::ops::Pow;
use rug::{Float, Rational};
use serde_json::Value;

const CASES: [&str; 2] = ["O1_A", "near_grazing"];

fn decimal(text: &str) -> Rational {
    let float = Float::with_val(1000, Float::parse(text).unwrap());
    float.to_rational().unwrap()
}

/// A reference number: a string, or {re, im} of which a part is asked for.
fn reference(value: &Value, part: usize) -> Rational {
    match value {
        Value::String(text) if part == 0 => decimal(text),
        Value::String(_) => Rational::new(),
        _ => decimal(value[["re", "im"][part]].as_str().unwrap()),
    }
}

/// How precisely a run answers: decimal digits, and the size that errors are relative to at least.
struct Judge {
    digits: i32,
    doubles: bool,
}

impl Judge {
    fn compare(&self, what: &str, found: &Value, expected: &Rational, size: &Rational) {
        let text = found["decimal"].as_str().unwrap_or_else(|| panic!("{what}: {found}"));
        let off = (decimal(text) - expected).abs();
        let allowed = Rational::from(size.abs_ref()) * Rational::from(10).pow(-self.digits);
        assert!(off <= allowed, "{what}: {text} is off by {:e}", off.to_f64());
        let status = found["status"].as_str().unwrap();
        let classes: &[&str] = if self.doubles { &["estimated"] } else { &["certified", "exact"] };
        assert!(classes.contains(&status), "{what}: {status}");
        if let Some(error) = found["error"].as_str() {
            assert!(decimal(error) <= allowed, "{what}: error {error}");
        }
    }

    fn number(&self, what: &str, found: &Value, expected: &Value) {
        let expected = reference(expected, 0);
        let size = if expected.is_zero() { Rational::from(1) } else { expected.clone() };
        self.compare(what, found, &expected, &size);
    }

    /// Both parts relative to the modulus.
    fn complex(&self, what: &str, found: &Value, expected: &Value) {
        let parts = [reference(expected, 0), reference(expected, 1)];
        let modulus = parts[0].to_f64().hypot(parts[1].to_f64());
        let size = if modulus > 0.0 { modulus } else { 1.0 };
        let size = Rational::from_f64(size).unwrap();
        for (part, expected) in parts.iter().enumerate() {
            self.compare(what, &found[part], expected, &size);
        }
    }

    fn orbit(&self, what: &str, found: &Value, expected: &Value) {
        for (name, key) in [("impact_velocity", "v"), ("phase", "phi"), ("C", "C"), ("D", "D")] {
            self.number(&format!("{what} {name}"), &found[name], &expected[key]);
        }
    }

    fn prediction(&self, what: &str, kbm: &Value, expected: &Value, multipliers: bool) {
        for name in ["b2", "b1", "b0"] {
            if expected[name].is_string() {
                self.number(&format!("{what} {name}"), &kbm[name], &expected[name]);
            }
        }
        for (name, key) in [("trace", "trace"), ("determinant", "det")] {
            if expected[key].is_string() {
                self.number(&format!("{what} {name}"), &kbm[name], &expected[key]);
            }
        }
        for (n, key) in ["gamma1", "gamma2"].into_iter().enumerate().filter(|_| multipliers) {
            self.complex(&format!("{what} {key}"), &kbm["multipliers"][n], &expected[key]);
        }
        let verdict = expected["jury17"].as_str().or(expected["verdict"].as_str()).unwrap();
        assert_eq!(kbm["stable"], verdict == "stable", "{what}");
    }
}

fn modulus(value: &Value) -> f64 {
    reference(value, 0).to_f64().hypot(reference(value, 1).to_f64())
}

fn run_case(name: &str, extra: &[&str]) -> Value {
    let sets = point(&data(name));
    let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
    json(&[&sets[..], extra].concat())
}

fn check_predictions(judge: &Judge, name: &str, extra: &[&str]) {
    let case = data(name);
    for variant in ["E", "S", "P"] {
        for order in ["1", "2", "3", "4"] {
            let options = ["--predictor", "kbm", "--variant", variant, "--order", order];
            let found = run_case(name, &[&options[..], extra].concat());
            let what = format!("{name} {variant}{order}");
            assert!(found["exact"].is_null());
            let (kbm, rates) = (&found["kbm"], &case["kbm"]["cumulative"][order]);
            assert_eq!(kbm["order"].to_string(), order);
            judge.number(&format!("{what} R"), &kbm["R"], &rates["R"]);
            judge.number(&format!("{what} alpha0"), &kbm["alpha0"], &rates["alpha0"]);
            let expected = &case[variant][order];
            match variant {
                "E" if expected["orbit"].is_null() => {
                    assert_eq!(kbm["orbit"]["exists"], false, "{what}");
                    assert!(kbm["stable"].is_null() && kbm["orbit"]["reason"].is_string());
                }
                "E" => {
                    judge.orbit(&what, &kbm["orbit"], &expected["orbit"]);
                    judge.prediction(&what, kbm, &expected["stability"], true);
                }
                _ => judge.prediction(&what, kbm, expected, true),
            }
        }
    }
}

fn check_truth(judge: &Judge, name: &str, extra: &[&str]) {
    let case = data(name);
    for (label, expected) in case["true_floquet"].as_object().unwrap() {
        let (kick, printed) = match label.as_str() {
            "classical" => ("mean", "none"),
            "chi_0_no_kick" => ("none", "none"),
            "chi_mean" => ("mean", "mean"),
            "chi_pre" => ("before", "before"),
            "chi_post" => ("after", "after"),
            other => panic!("{other}"),
        };
        let options = ["--predictor", "exact", "--kick", kick];
        let found = run_case(name, &[&options[..], extra].concat());
        let what = format!("{name} {label}");
        let orbit = &found["orbit"];
        assert_eq!((&orbit["exists"], &orbit["penetrates"]), (&true.into(), &false.into()));
        judge.orbit(&what, orbit, &case["orbit_uncontrolled"]);
        let exact = &found["exact"];
        assert!(found["kbm"].is_null());
        assert_eq!(exact["kick"], printed, "{what}");
        assert_eq!(exact["zeros_in_unit_disc"], expected["zeros_of_G_in_unit_disc"], "{what}");
        // For B != 0 the piecewise linear return map decides; it agrees in these cases.
        assert_eq!(exact["stable"], expected["verdict"] == "stable", "{what}");
        assert_eq!(exact["return_map"].is_null(), label == "classical", "{what}");
        let least = exact["complete_to_modulus"].as_f64().unwrap();
        let listed = expected["multipliers"].as_array().unwrap();
        let listed: Vec<&Value> = listed.iter().filter(|value| modulus(value) > least).collect();
        let multipliers = exact["multipliers"].as_array().unwrap();
        assert_eq!(multipliers.len(), listed.len(), "{what}");
        for (found, expected) in multipliers.iter().zip(listed) {
            judge.complex(&format!("{what} multiplier"), found, expected);
        }
    }
}

#[test]
fn certified_fields_have_25_digits() {
    let judge = Judge { digits: 25, doubles: false };
    for name in CASES {
        check_predictions(&judge, name, &["--digits", "30"]);
        check_truth(&judge, name, &["--digits", "30"]);
    }
}

/// Near grazing the wall position has the condition number s/(F - s) = 305, and b_2 is the
/// difference of numbers 300 times as large: three digits are lost.
#[test]
fn doubles_have_12_digits_where_the_orbit_is_well_conditioned() {
    for name in CASES {
        let digits = if name == "near_grazing" { 9 } else { 12 };
        let judge = Judge { digits, doubles: true };
        check_predictions(&judge, name, &["--f64"]);
        check_truth(&judge, name, &["--f64"]);
    }
}

/// More digits change nothing but the length.
#[test]
fn digits_are_those_asked_for() {
    let found = run_case("O1_A", &["--digits", "60"]);
    let decimal = found["orbit"]["impact_velocity"]["decimal"].as_str().unwrap();
    assert_eq!(decimal.len(), 62, "{decimal}");
    let known = data("O1_A")["orbit_uncontrolled"]["v"].as_str().unwrap().to_owned();
    assert!(decimal.starts_with(&known[..known.len() - 1]), "{decimal}");
}
